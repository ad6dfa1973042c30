"""No module imports one that imports it, imports inside functions counted; those for types alone are none."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest

import flexapod

pytestmark = pytest.mark.meta


def test_imports_make_no_circle():
    graph = grimp.build_graph("flexapod", exclude_type_checking_imports=True, cache_dir=None)
    packages = {module for module in graph.modules if graph.find_children(module)}
    imports = {m: graph.find_modules_directly_imported_by(m) - packages for m in graph.modules - packages}
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


def test_few_own_imports_stand_inside_functions():
    """`LazyModule` at the head of a file does the same, where it is read."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    late = {
        (path.name, node.lineno)
        for path in Path(flexapod.__file__).parent.rglob("*.py")
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(function, kinds)
        for node in ast.walk(function)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("flexapod")
    }
    assert len(late) <= 45, sorted(late)
