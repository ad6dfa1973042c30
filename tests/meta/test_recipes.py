"""Recipes do what they say: their lines of Python, of the study file and of the terminal are run, in their order."""

import re
import shlex
import tomllib
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest
from typer.testing import CliRunner

from flexapod.app.cli.cli import app
from flexapod.model import preset_text
from flexapod.model.file.fields import read_notes

pytestmark = pytest.mark.unit

matplotlib.use("Agg")
RECIPES = sorted((Path(__file__).parents[2] / "docs" / "how-to").glob("*.md"))
RECIPES = [path for path in RECIPES if path.name != "index.md"]
BLOCK = re.compile(r"```(python|console|toml)\n(.*?)```", re.DOTALL)


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.stem)
def test_recipe(recipe, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("robot.toml").write_text(preset_text("machine-hexapod"), encoding="utf-8")
    blocks = BLOCK.findall(recipe.read_text(encoding="utf-8"))
    assert any(kind != "text" for kind, _ in blocks)
    names = {"__name__": "recipe"}
    for kind, text in blocks:
        if kind == "python":
            exec(compile(text, str(recipe), "exec"), names)
        elif kind == "console":
            run_lines(text)
        else:
            data = merged(tomllib.loads(Path("robot.toml").read_text(encoding="utf-8")), tomllib.loads(text))
            error = read_notes(data, tmp_path)[1]
            assert error is None, error
    plt.close("all")


def run_lines(text):
    for line in text.splitlines():
        words = shlex.split(line.removeprefix("$ "))
        assert line.startswith("$ flexapod ")
        done = CliRunner().invoke(app, words[1:], prog_name="flexapod")
        assert done.exit_code == 0, f"{line}: {done.stdout}{done.stderr}"


def merged(whole, part):
    """Tables with those of a recipe in them; a motion stands for itself."""
    for name, value in part.items():
        inner = isinstance(value, dict) and isinstance(whole.get(name), dict) and name != "motion"
        whole[name] = merged(whole[name], value) if inner else value
    return whole


def test_there_are_recipes():
    assert len(RECIPES) >= 25
