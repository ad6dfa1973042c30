"""Exported C under the compiler's warnings: none, for every preset and sample mechanism."""

import subprocess
import zipfile

import pytest
from tests.helpers.robot_c import STRICT
from tests.helpers.samples import MECHANISMS

import flexapod as fx
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.model import PRESETS, ActuatorStudy
from flexapod.output.exchange.c_source import FLAGS

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]
SAMPLES = {path.stem: path for path in sorted(MECHANISMS.glob("*.toml"))}
ROBOTS = [name for name in PRESETS if not isinstance(fx.preset(name), ActuatorStudy)]


def checked(folder, *sources):
    """Compile as users do: what only is seen while optimising is seen."""
    for source in sources:
        line = [*compiler(), *FLAGS, *STRICT, "-c", "-o", f"{source}.o", source]
        found = subprocess.run(line, cwd=folder, capture_output=True, text=True)
        assert found.returncode == 0, found.stderr[:2000]


@pytest.mark.parametrize("name", [*ROBOTS, *SAMPLES])
def test_c_has_no_warnings(tmp_path, name):
    study = fx.load(SAMPLES[name]) if name in SAMPLES else fx.preset(name)
    fx.export(study, "c", tmp_path, commands="motion", step=2e-4)
    checked(tmp_path, "robot.c", "main.c")


def test_sources_of_a_unit_have_no_warnings(tmp_path):
    found = fx.export(fx.preset("tripod"), "fmu", tmp_path / "robot.fmu", step=2e-4)
    with zipfile.ZipFile(found.path) as archive:
        archive.extractall(tmp_path)
    checked(tmp_path / "sources", "robot.c", "fmi3.c")
