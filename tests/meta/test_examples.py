"""The example of the README runs, without a warning, and prints what stands there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.cli

README = Path(__file__).parents[2] / "README.md"


def test_the_example_of_the_readme_prints_what_stands_there(tmp_path):
    readme = README.read_text(encoding="utf-8")
    example = re.search(r"```python\n(.*?)```", readme, re.DOTALL)[1]
    command = [sys.executable, "-W", "error", "-c", example]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0 and run.stderr == "", run.stderr
    # Printed with three digits: rounding of another processor does not show.
    assert re.search(r"```text\n(.*?)```", readme, re.DOTALL)[1] == run.stdout
