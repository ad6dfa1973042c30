"""Names and first words: a docstring says what a thing is or does, a module is named by its topic."""

import ast
import functools
import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.meta

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src" / "flexapod").rglob("*.py"))
VAGUE = frozenset(
    "Of Those As That It Its What Where How Which Whether These This They There With By In On For From If When".split()
)
PARTICIPLE = re.compile(r"[^_]*(ed|en|wn|ld|ught|ven|ade|id|ept)")
PREPOSITIONS = frozenset(
    "about above across after against ahead along among apart around as at before behind below beside between beyond "
    "by down for from in inside into near of off on onto out outside over past per since than through to toward under "
    "until up upon with within without".split()
)
PRONOUNS = frozenset("all any both each every it its one others own some such that their these they this those".split())
#: First words that stand, with the reason.
VAGUE_ON_PURPOSE: dict[str, str] = {
    "cli.flexapod": "the program in one sentence, as its help and the package's summary have it",
    "shaken_floor.shaken_floor": "the heading of an example",
    "when_bending_matters.when_bending_matters": "the heading of an example",
}
#: Names that only look like participles (grid, rigid, build), or belong to users or to a library (sampled, disabled).
MOST_PARTICIPLES = 45
#: Modules whose name is no participle, or says which of two it is.
MODULES = frozenset({"grid", "interpreted", "overconstrained", "solid"})


@functools.cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def names() -> list[str]:
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    return [n.name for path in SOURCES for n in ast.walk(tree(path)) if isinstance(n, kinds) and n.name[0] != "_"]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT / "src")))
def test_a_docstring_begins_with_the_thing(path):
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    found = [
        f"{getattr(node, 'name', path.stem)}: {doc.splitlines()[0]}"
        for node in ast.walk(tree(path))
        if isinstance(node, kinds) and (doc := ast.get_docstring(node)) and doc.split()[0].strip(",.:") in VAGUE
    ]
    vague = [line for line in found if f"{path.stem}.{line.split(':')[0]}" not in VAGUE_ON_PURPOSE]
    assert not vague, "\n".join(vague)


def test_few_docstrings_begin_vaguely_on_purpose():
    assert len(VAGUE_ON_PURPOSE) <= 10 and all(VAGUE_ON_PURPOSE.values())


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT / "src")))
def test_a_module_is_named_by_its_topic(path):
    name = path.parent.name if path.name == "__init__.py" else path.stem
    assert name not in PREPOSITIONS | PRONOUNS
    assert not PARTICIPLE.fullmatch(name) or name in MODULES, "a participle alone"


def test_few_functions_are_named_by_a_bare_participle():
    found = [name for name in names() if PARTICIPLE.fullmatch(name)]
    assert len(found) <= MOST_PARTICIPLES, sorted(found)
