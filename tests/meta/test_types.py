"""Types, found out beside the other tests: by a process that one of theirs waits for."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYRIGHT = shutil.which("pyright", path=Path(sys.executable).parent)


pytestmark = [pytest.mark.meta, pytest.mark.skipif(PYRIGHT is None, reason="pyright is not installed")]


def test_types_agree():
    roomy = os.environ | {"NODE_OPTIONS": "--max-semi-space-size=128"}  # garbage is collected less often: a twentieth
    found = subprocess.run([PYRIGHT, "src"], cwd=ROOT, env=roomy, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout


def test_every_name_that_others_see_has_a_type():
    """As a program that uses the package sees it: nothing is left to be inferred, by which type checkers differ."""
    command = [PYRIGHT, "--verifytypes", "flexapod", "--ignoreexternal", "--outputjson"]
    here = os.environ | {"PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    found = subprocess.run(command, cwd=ROOT, env=here, capture_output=True, text=True, check=False)
    complete = json.loads(found.stdout)["typeCompleteness"]
    assert complete["exportedSymbolCounts"]["withKnownType"] > 1000
    symbols = [x for x in complete["symbols"] if not x["name"].startswith("flexapod.examples.")]  # scripts, no modules
    assert not [x["name"] for x in symbols if x["isExported"] and not x["isTypeKnown"]]
