"""Every example of the gallery runs, says a number that is known from outside, and shows one figure."""

import ast
import runpy
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

from flexapod.app.cli.commands_study import titles
from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = pytest.mark.unit

matplotlib.use("Agg")
FOLDER = Path(__file__).parents[2] / "src" / "flexapod" / "examples/gallery"
NOTEBOOKS = FOLDER.parent / "notebooks"
EXAMPLES = sorted(FOLDER.glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example, tmp_path, monkeypatch, capsys):
    text = example.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 70
    asserted = [node.attr for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Attribute)]
    assert any(name.startswith("assert_") for name in asserted)
    if example.stem == "co_simulation" and compiler() is None:
        pytest.skip("there is no C compiler")
    monkeypatch.chdir(tmp_path)
    plt.close("all")
    found = runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out
    assert isinstance(found["figure"], matplotlib.figure.Figure)
    assert found["figure"].axes
    plt.close("all")


@pytest.mark.parametrize("notebook", sorted(NOTEBOOKS.glob("*.py")), ids=lambda path: path.stem)
def test_notebook(notebook, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = runpy.run_path(str(notebook))
    assert capsys.readouterr().out and found["figure"].axes
    plt.close("all")


def test_all_have_titles():
    assert set(titles("--example")) == {path.stem for path in EXAMPLES}
    assert len(set(titles("--example").values())) == len(EXAMPLES) >= 20
    assert set(titles("--notebook")) == {path.stem for path in NOTEBOOKS.glob("*.py")}
    assert titles("--notebook")["first_robot"] == "A first robot"
