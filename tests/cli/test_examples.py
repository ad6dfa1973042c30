"""Every example runs, without a warning; the README shows the first one with what it prints."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from flexapod.symbolic.compiler import compiler

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run_example(example, folder):
    command = [sys.executable, "-W", "error", str(example)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example, tmp_path):
    if "import fmpy" in example.read_text(encoding="utf-8"):
        pytest.importorskip("fmpy")
        if compiler() is None:
            pytest.skip("there is no C compiler")
    run = run_example(example, tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stderr == ""
    assert run.stdout and "False" not in run.stdout


def test_there_are_examples():
    assert EXAMPLES


def test_readme_shows_the_first_example_and_its_output(tmp_path):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    example = ROOT / "examples" / "a_first_robot.py"
    assert re.search(r"```python\n(.*?)```", readme, re.DOTALL)[1] == example.read_text(encoding="utf-8")
    # Printed with three digits: rounding of another processor does not show.
    assert re.search(r"```text\n(.*?)```", readme, re.DOTALL)[1] == run_example(example, tmp_path).stdout
