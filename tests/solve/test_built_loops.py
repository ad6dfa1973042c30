"""Loops as a wheel brings them give the bits of loops compiled here, at every level that this processor has."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tools.build_wheels import SYSTEMS, compiled_loops

from flexapod.mechanics.symbolic import processor
from flexapod.mechanics.symbolic.processor import LEVELS, system_name, x86_level, x86_target

HERE = system_name(sys.platform, processor.platform.machine()) == SYSTEMS["linux"].name
pytestmark = [
    pytest.mark.consistency,
    pytest.mark.skipif(not HERE or not shutil.which("gcc"), reason="wheels with loops to be tried here are of Linux"),
]
BODIES = {2: 2, 3: 4, 4: 8}
#: Both time loops, with all that they record: a hash; the file that was taken, its bodies side by side, and what was
#: compiled beside it.
CALL = """
import hashlib, json, sys
from pathlib import Path
from flexapod.mechanics.symbolic import compiler, processor
processor.BUILT = Path(sys.argv[1])
compiled, build = [], compiler._build
compiler._build = lambda units, flags, *rest: (compiled.append(flags[0]), build(units, flags, *rest))[1]
import flexapod as fx
from flexapod.solve.time import native
taken, written = [], native.written_library
native.written_library = lambda *given, **more: taken.append(written(*given, **more)) or taken[-1]
study, digest = fx.preset("paper-robot"), hashlib.sha256()
for settings in ({"duration": 0.3}, {"duration": 0.05, "tolerance": None, "step": 5e-4}):
    data = fx.simulate(study.replace(simulation=study.simulation.replace(**settings))).load()
    for name in sorted(data.data_vars):
        digest.update(data[name].values.tobytes() if data[name].dtype.kind in "fi" else b"")
(library,) = taken
told = {"file": Path(library._name).name, "bodies": compiler.lanes(library)}
print(json.dumps({"digest": digest.hexdigest(), **told, "compiled": sorted(set(compiled))}))
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> dict[int, Path]:
    """Folders with the loops of one level each."""
    work = tmp_path_factory.mktemp("work")
    folders = {level: tmp_path_factory.mktemp(f"v{level}") for level in LEVELS}
    for name, content in compiled_loops(SYSTEMS["linux"], work).items():
        (level,) = (level for level in LEVELS if f"-{x86_target(level)}-" in name)
        (folders[level] / name).write_bytes(content)
    return folders


def ran(built: Path, cache: Path, compiler: str = "") -> dict:
    """What `CALL` says with the loops of a folder, an empty cache, and ``CC``."""
    known = {name: value for name, value in os.environ.items() if name != "CC"} | {"FLEXAPOD_CACHE": str(cache)}
    known |= {"CC": compiler} if compiler else {}
    done = subprocess.run([sys.executable, "-c", CALL, str(built)], env=known, text=True, capture_output=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("level", LEVELS)
def test_bits_are_those_of_loops_compiled_here(level, wheel, tmp_path):
    if level > x86_level(processor._features()):
        pytest.skip("this processor is older")
    told = ran(wheel[level], tmp_path / "cache")
    assert (told["file"], told["bodies"]) == (next(wheel[level].iterdir()).name, BODIES[level])
    assert told["compiled"] == ["-O1"]  # equations alone
    here = ran(tmp_path, tmp_path / "other", f"gcc -march={x86_target(level)}")
    assert here["compiled"] == ["-O1", "-O3"]
    assert here["digest"] == told["digest"]
    if BODIES[level] == BODIES[x86_level(processor._features())]:  # nor are they those of an older processor
        assert ran(tmp_path, tmp_path / "native")["digest"] == told["digest"]


def test_a_compiler_that_does_not_know_the_target_makes_loops_of_its_own(wheel, tmp_path, monkeypatch):
    """Equations for this processor have eight bodies side by side, loops of the wheel four: they do not go together."""
    if x86_level(processor._features()) < 4:
        pytest.skip("this processor is older")
    old = tmp_path / "bin" / "cc"
    old.parent.mkdir()
    old.write_text('#!/bin/sh\ncase "$*" in *-march=x86-64-*) echo bad value; exit 1;; esac\nexec gcc "$@"\n')
    old.chmod(0o700)
    monkeypatch.setenv("PATH", str(old.parent), prepend=os.pathsep)
    told = ran(wheel[3], tmp_path / "cache")
    assert (told["bodies"], told["compiled"]) == (8, ["-O1", "-O3"])
    told = ran(wheel[4], tmp_path / "other")
    assert (told["bodies"], told["compiled"]) == (8, ["-O1"])
