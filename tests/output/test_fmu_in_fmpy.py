"""Units in FMPy: nothing to complain of, and the march of the same study."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]
STEP = 5e-4


@pytest.fixture(scope="module")
def fmpy():
    return pytest.importorskip("fmpy")


@pytest.fixture(scope="module")
def unit(tmp_path_factory):
    def made(commands):
        path = tmp_path_factory.mktemp(commands) / "robot.fmu"
        return str(fx.export(fx.preset("paper-robot"), "fmu", path, commands=commands, step=STEP).path)

    return made


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("commands", ["inputs", "motion"])
def test_nothing_to_complain_of(fmpy, unit, commands):
    from fmpy.validation import validate_fmu

    assert validate_fmu(unit(commands)) == []


@pytest.mark.filterwarnings("default")
def test_its_run_is_the_march(fmpy, unit):
    """The same steps with commands as series to 1e-13 and vectors of another width: 1e-12 m."""
    found = fmpy.simulate_fmu(
        unit("motion"), stop_time=400 * STEP, step_size=STEP, output_interval=STEP, output=["tool_position"]
    )
    data = fx.simulate(fx.preset("paper-robot"), step=STEP, output_step=STEP, duration=400 * STEP)
    np.testing.assert_allclose(found["time"], data.time.values, atol=1e-9)
    assert np.abs(np.asarray(found["tool_position"]) - data.tool_position.values).max() < 1e-12
