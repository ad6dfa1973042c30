"""Without a C compiler the readable twin of the time loop takes over: the same march, and one warning."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.moving import SOFT, moving
from tests.helpers.runs import FIELDS, paper_robot, run_actuator, run_robot

from flexapod.model import (
    Actuator,
    ActuatorLoad,
    ActuatorMotion,
    ActuatorStudy,
    ConstantLaw,
    CsvWrench,
    Simulation,
    override,
    preset,
)
from flexapod.solve.kernel import kernel

pytestmark = pytest.mark.contract

ROOT = Path(__file__).parents[2]


@pytest.fixture
def interpreted(monkeypatch):
    """Run a study with and without a compiler; the kernels of one are not those of the other."""

    def both(run, study):
        with_compiler = run(study)
        kernel.cache_clear()
        monkeypatch.setenv("FLEXAPOD_COMPILER", "none")
        return with_compiler, run(study)

    yield both
    kernel.cache_clear()


def same(ours, other, h):
    # Both stop where closures of metres meet rounding: 1e-14 m, here ten times that. Rates and accelerations hold it
    # over h and h^2 / 4 (generalized-alpha), forces move 100 kg with it.
    place, accel = 1e-13, 1e-13 / (h**2 / 4)
    bounds = {"q": place, "pose": place, "closure": place, "v": place / (h / 2), "v_dot": accel, "time": 0.0}
    for name in FIELDS:
        bound = bounds.get(name, max(100 * accel, 1e-12 * np.abs(other[name]).max(initial=0.0)))
        np.testing.assert_allclose(ours[name], other[name], rtol=0, atol=bound, err_msg=name)


def test_prescribed_actuator(interpreted):
    study = override(preset("paper-actuator"), step=1e-3, output_step=1e-2, duration=0.1)
    compiled, twin = interpreted(run_actuator, study)
    same(twin, compiled, 1e-3)


def test_driven_actuator(interpreted):
    study = ActuatorStudy(
        actuator=Actuator(
            length=3.66, rhoA=4.02, EI=756.65, free_length=1.83, hub_inertia=3.0, gravity=1.0, tip_mass=0.2
        ),
        motion=ActuatorMotion(rotation=None, extension=None),
        load=ActuatorLoad(torque=ConstantLaw(value=5.0), force=ConstantLaw(value=-3.0)),
        simulation=Simulation(basis="tip-load", modes=2, duration=0.1, step=1e-3, output_step=1e-2),
    )
    compiled, twin = interpreted(run_actuator, study)
    same(twin, compiled, 1e-3)


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_robot(interpreted, fidelity):
    modes = {"modes": 2} if fidelity == "assumed-modes" else {}
    study = override(paper_robot(), fidelity=fidelity, step=1e-3, output_step=5e-3, duration=0.03, **modes)
    compiled, twin = interpreted(run_robot, study)
    same(twin, compiled, 1e-3)


def test_jumps_and_corners_between_outputs(interpreted):
    study = override(paper_robot(), fidelity="lumped", step=1e-3, output_step=5e-3, duration=0.02)
    time, value = [0, 0.0123, 0.0123, 0.0157, 1], np.array([0, 0, 1, 0.5, 0.5])
    study = study.replace(load={"wrench": CsvWrench(time=time, wrench=value[:, None] * np.full(6, 50.0))})
    compiled, twin = interpreted(run_robot, study)
    same(twin, compiled, 3e-4)  # the shortest step


def test_it_is_said_once():
    # Two kernels in a process of its own, so that no other test has heard the warning before.
    code = (
        "from tests.helpers.runs import run_actuator; from flexapod.model import override, preset; "
        "study = override(preset('paper-actuator'), step=1e-3, output_step=1e-3, duration=2e-3); "
        "[run_actuator(override(study, modes=k)) for k in (1, 2)]"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=os.environ | {"FLEXAPOD_COMPILER": "none"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stderr.count("No C compiler") == 1
    assert "gcc or clang" in done.stderr


def test_robot_with_a_passive_guide(interpreted):
    """Attitudes closed, welds held beside balls that are free."""
    study = moving("3-UPS+UP", axial_modes=0, modes=1, step=1e-3, output_step=1e-3, duration=5e-3, drive=SOFT)
    compiled, twin = interpreted(run_robot, study)
    same(twin, compiled, 1e-3)
