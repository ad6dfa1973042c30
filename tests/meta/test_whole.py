"""What only `make test-all` runs: every entry names a test that there is, once."""

import ast
from pathlib import Path

import pytest
from tests.whole import entries

pytestmark = pytest.mark.meta

TESTS = Path(__file__).parents[1]
WHOLE = list(entries())
FILES = sorted({name.partition("::")[0] for name, _ in WHOLE})


def names(file):
    """Tests of a file, those of classes after the name of their class."""
    parts = ast.parse((TESTS / file).read_text(encoding="utf-8")).body
    inside = {f"{part.name}::": part.body for part in parts if isinstance(part, ast.ClassDef)}
    found = [(before, part) for before, body in [("", parts), *inside.items()] for part in body]
    return {before + x.name for before, x in found if isinstance(x, ast.FunctionDef) and x.name.startswith("test_")}


@pytest.mark.parametrize("file", FILES)
def test_entries_name_tests(file):
    named = [(name.partition("::")[2], cases) for name, cases in WHOLE if name.startswith(f"{file}::")]
    assert len(named) == len(set(named))
    assert {name for name, _ in named} <= names(file)
