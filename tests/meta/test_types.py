"""Types, found out beside the other tests: by a process that one of theirs waits for."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYRIGHT = shutil.which("pyright", path=Path(sys.executable).parent)


@pytest.mark.skipif(PYRIGHT is None, reason="pyright is not installed")
def test_types_agree():
    found = subprocess.run([PYRIGHT, "src"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout
