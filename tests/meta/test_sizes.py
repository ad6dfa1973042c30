"""Sizes of files and functions, and what must not stand in them."""

import ast
import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.meta

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src").rglob("*.py"))
MAX_FILE, MAX_FUNCTION = 400, 60
TEXTS = {".py", ".toml", ".md", ".cff", ".yaml", ".txt", ""}
SKIPPED = {
    ".venv",
    ".git",
    "build",
    ".ruff_cache",
    ".pytest_cache",
    "__pycache__",
    ".hypothesis",
    ".import_linter_cache",
}


def functions(tree: ast.AST) -> list[tuple[str, int]]:
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    found = [n for n in ast.walk(tree) if isinstance(n, kinds)]
    return [(n.name, (n.end_lineno or n.lineno) - n.lineno + 1 - example_lines(n)) for n in found]


def example_lines(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of the example in a docstring: it is read on the page of the call, and run, but is not of the function."""
    _, head, example = (ast.get_docstring(function) or "").partition("\n\nExamples\n--------\n")
    return len(example.splitlines()) + 3 if head else 0


def project_files() -> list[Path]:
    return [
        path
        for path in sorted(ROOT.rglob("*"))
        if path.is_file() and path.suffix in TEXTS and not SKIPPED & set(path.relative_to(ROOT).parts)
    ]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_and_functions_stay_short(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= MAX_FILE
    long = [(name, lines) for name, lines in functions(ast.parse(text)) if lines > MAX_FUNCTION]
    assert not long, f"functions above {MAX_FUNCTION} lines: {long}"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_identifiers_are_ascii(path):
    names = {node.id for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Name)}
    assert all(name.isascii() for name in names)


def test_no_paths_of_one_machine():
    # Split, so that this file does not match itself.
    pattern = re.compile("/ho" + "me/|/wo" + "rk/|/tm" + "p/|/ro" + "ot/|file:/" + "//|[A-Z]:\\\\" + "Users")
    found = [
        f"{path.relative_to(ROOT)}:{i}: {line.strip()}"
        for path in project_files()
        for i, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1)
        if pattern.search(line)
    ]
    assert not found, "\n".join(found)


def test_no_stubs_or_leftovers():
    pattern = re.compile("TO" + "DO|FIX" + "ME|XX" + "X|NotImplemented" + "Error")
    found = [str(path.relative_to(ROOT)) for path in SOURCES if pattern.search(path.read_text(encoding="utf-8"))]
    assert not found
