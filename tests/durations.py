"""Tests over several processes: a file stays in one of them, and what takes longest comes first.

`durations.toml` has the seconds of each file. Written anew from what a run has told:

    .venv/bin/python -m pytest -n 2 --dist loadgroup --junit-xml build/tests.xml
    .venv/bin/python -m tests.durations build/tests.xml

A file without an entry comes after those that have one.
"""

import sys
import tomllib
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

from xdist.scheduler.loadgroup import LoadGroupScheduling

TABLE = Path(__file__).with_suffix(".toml")
LEAST = 0.5  # s; what takes less may come at any time


def seconds(table=TABLE):
    """Of each file that takes some, by its path."""
    return tomllib.loads(table.read_text(encoding="utf-8"))


class LongestFirst(LoadGroupScheduling):
    """Groups as marked, files where nothing is marked; the longest of those that wait goes to who is free."""

    def __init__(self, config, log=None):
        super().__init__(config, log)
        self.seconds = seconds()

    def _split_scope(self, nodeid):
        return super()._split_scope(nodeid).partition("::")[0]

    def _assign_work_unit(self, node):
        self.workqueue.move_to_end(max(self.workqueue, key=self._takes), last=False)
        super()._assign_work_unit(node)

    def _takes(self, scope):
        files = {nodeid.partition("::")[0] for nodeid in self.workqueue[scope]}
        return sum(self.seconds.get(file, 0.0) for file in files)


def measured(junit):
    """Seconds of each file in a table that pytest has written."""
    found = Counter()
    for case in ElementTree.parse(junit).getroot().iter("testcase"):
        place = case.get("classname").split(".")
        found["/".join(place[:3]) + ".py"] += float(case.get("time"))
    return found


def main(junit):
    rows = sorted((file, took) for file, took in measured(junit).items() if took >= LEAST)
    head = "# Seconds that files of tests take; written by `python -m tests.durations FILE`.\n"
    TABLE.write_text(head + "".join(f'"{file}" = {took:.1f}\n' for file, took in rows), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
