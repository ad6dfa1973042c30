"""Where tests stand: under the wing that they test, none reading another, each wing of the package with its own."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.meta

TESTS = Path(__file__).parents[1]
FILES = sorted(TESTS.rglob("test_*.py"))
WINGS = {path.parent.name for path in (TESTS.parent / "src" / "flexapod").glob("*/__init__.py")}
PROJECT = {"golden", "last_stage", "meta"}


def test_a_file_stands_under_its_wing_or_is_about_the_project():
    folders = {str(path.parent.relative_to(TESTS)) for path in FILES}
    assert folders == WINGS | PROJECT


def test_what_files_of_tests_share_stands_in_helpers():
    reads = re.compile(r"^\s*(?:from|import) tests\.[\w.]*test_|^\s*from tests\.\w+ import .*\btest_", re.MULTILINE)
    assert not [str(path.relative_to(TESTS)) for path in FILES if reads.search(path.read_text(encoding="utf-8"))]
