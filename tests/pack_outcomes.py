"""Outcomes of the verification pack for tests, each computed once in a process.

Who asks for them belongs to the group "pack" of pytest-xdist, so that one process does. That every case passes is
tested in `tests/cli/test_verify.py`.
"""

from functools import cache

from flexapod.verify.cases import CASES
from flexapod.verify.pack import verify


@cache
def outcome(name):
    """Of a case by its name."""
    return verify([name])[0]


def outcomes():
    """Of all cases that are not slow."""
    return tuple(outcome(case.name) for case in CASES if not case.slow)
