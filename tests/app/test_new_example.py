"""`flexapod new --example` and `--list`: files of the gallery, as they are."""

import json
from pathlib import Path

import pytest

pytestmark = pytest.mark.cli

EXAMPLES = Path(__file__).parents[2] / "src" / "flexapod" / "examples/gallery"


def test_an_example_is_the_file_of_the_gallery(flexapod, folder):
    done = flexapod("new", "--example", "sag_by_hand")
    assert done.exit_code == 0, done.stderr
    assert (folder / "sag_by_hand.py").read_text(encoding="utf-8") == (EXAMPLES / "sag_by_hand.py").read_text("utf-8")
    assert "python sag_by_hand.py" in done.stdout
    assert flexapod("new", "--example", "sag_by_hand").exit_code == 2  # it is there
    assert flexapod("new", "mine", "--example", "delta").exit_code == 0
    assert (folder / "mine.py").exists()


def test_list_names_presets_examples_and_notebooks(flexapod):
    said = flexapod("new", "--list")
    assert said.exit_code == 0 and "--preset machine-hexapod" in said.stdout
    assert "Sag of a hexapod, by hand" in said.stdout
    assert "delta" in json.loads(flexapod("new", "--list", "--json").stdout)["example"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--example", "sag"], "sag_by_hand"),
        (["--example", "delta", "--preset", "tripod"], "together"),
        (["--example", "delta", "--ideal"], "together"),
        (["robot.toml", "--example", "delta"], "FILE.py"),
        (["first.ipynb", "--notebook", "first_robot"], "FILE.py"),
        ([".", "--example", "delta"], "is a folder"),
        (["--list", "robot.toml"], "together with --list"),
        (["--list", "--preset", "tripod"], "together with --list"),
        ([], "NAME.toml"),
    ],
)
def test_refusals_write_nothing(flexapod, folder, arguments, words):
    done = flexapod("new", *arguments)
    assert done.exit_code == 2 and words in done.stderr
    assert not list(folder.iterdir())
