"""What only `make test-all` runs, with the reasons: `whole.toml` as markers."""

import tomllib
from collections import defaultdict
from pathlib import Path

import pytest

HERE = Path(__file__).parent
#: Which cases of a test: all but the first, all but the last.
CASES = {"[1:]": slice(1, None), "[:-1]": slice(None, -1), "": slice(None)}


def entries():
    """Of the table: test by file and name, and which of its cases."""
    for part in tomllib.loads((HERE / "whole.toml").read_text(encoding="utf-8")).values():
        for entry in part["tests"]:
            name, bracket, cases = entry.partition("[")
            yield name, CASES[bracket + cases]


def mark_whole(items):
    """Give the marker "whole" to those among the collected tests that the table has."""
    cases = defaultdict(list)
    for item in items:
        name = item.nodeid.removeprefix("tests/").partition("[")[0]
        cases[name].append(item)
    for name, which in entries():
        for item in cases[name][which]:
            item.add_marker(pytest.mark.whole)
