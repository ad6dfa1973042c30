"""Every example runs, without a warning; the README shows the first one with what it prints."""

import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = pytest.mark.cli

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """`ran(example)`: what it returns and says, in a folder of its own."""

    @cache
    def run(example):
        command = [sys.executable, "-W", "error", str(example)]
        folder = tmp_path_factory.mktemp(example.stem)
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)

    return run


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example, ran):
    if "import fmpy" in example.read_text(encoding="utf-8"):
        pytest.importorskip("fmpy")
        if compiler() is None:
            pytest.skip("there is no C compiler")
    run = ran(example)
    assert run.returncode == 0, run.stderr
    assert run.stderr == ""
    assert run.stdout and "False" not in run.stdout


def test_there_are_examples():
    assert EXAMPLES


def test_readme_shows_the_first_example_and_its_output(ran):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    example = ROOT / "examples" / "a_first_robot.py"
    assert re.search(r"```python\n(.*?)```", readme, re.DOTALL)[1] == example.read_text(encoding="utf-8")
    # Printed with three digits: rounding of another processor does not show.
    assert re.search(r"```text\n(.*?)```", readme, re.DOTALL)[1] == ran(example).stdout
