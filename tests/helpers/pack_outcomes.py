"""Outcomes of the verification pack for tests, each computed once in a process.

That every case passes is tested in `tests/app/test_verify_command.py`, the cases of a subject (`verification/cases`) by
one process: their group of pytest-xdist is "pack of SUBJECT", and who else asks for one of them belongs to it.
"""

from functools import cache

from flexapod.verification.pack import verify


@cache
def outcome(name):
    """Of a case by its name."""
    return verify([name])[0]
