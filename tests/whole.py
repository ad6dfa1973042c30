"""What only `make test-all` runs, with the reasons: `whole.toml` as markers."""

import tomllib
from collections import defaultdict
from pathlib import Path

import pytest

HERE = Path(__file__).parent
#: Which cases of a test: all but the first, all but the last. Any other text in brackets is a case by itself.
CASES = {"1:": slice(1, None), ":-1": slice(None, -1)}


def entries():
    """Of the table: a test by file and name, and what stands in brackets after it."""
    for part in tomllib.loads((HERE / "whole.toml").read_text(encoding="utf-8")).values():
        for entry in part["tests"]:
            name, _, cases = entry.partition("[")
            yield name, cases.removesuffix("]")


def mark_whole(items):
    """Give the marker "whole" to those among the collected tests that the table has."""
    cases = defaultdict(list)
    for item in items:
        name, _, _ = item.nodeid.removeprefix("tests/").partition("[")
        cases[name].append(item)
    for name, which in entries():
        found = cases[name]
        if which:
            found = found[CASES[which]] if which in CASES else [x for x in found if x.nodeid.endswith(f"[{which}]")]
        for item in found:
            item.add_marker(pytest.mark.whole)
