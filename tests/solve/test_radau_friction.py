"""Friction of strokes within a tolerance: what turns over in a thousandth of a second is within it, too."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers.runs import paper_robot, run_robot, with_legs

from flexapod import simulate
from flexapod.model import ServoDrive, StrokeFriction, load, override
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence

STRUT = Path(__file__).parents[2] / "examples/mechanisms/strut.toml"
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
STRIBECK = {"force": 60.0, "presliding": 1e-5, "stribeck": {"force": 90.0, "rate": 2e-3}}
FRICTIONS = {
    "plain": {"force": 60.0, "presliding": 1e-5},
    "stribeck": STRIBECK,
    "viscous": STRIBECK | {"viscous": 200.0, "damping_time": 1e-3},
}


@cache
def roll(friction):
    """Roll of 5 degrees in 0.2 s and rest; the place of the payload with steps of 10 and 5 us, extrapolated."""
    study = paper_robot(duration=0.4, output_step=1e-3)
    motion = study.motion.replace(amplitude=np.radians(5.0), duration=0.2, hold=0.2)
    drive = ServoDrive(stiffness=2e7, damping=1e4, friction=StrokeFriction(**FRICTIONS[friction]))
    study = with_legs(study.replace(motion=motion), drive=drive)
    coarse, fine = (run_robot(override(study, step=h, output_step=1e-3))["pose"][:, :3] for h in (1e-5, 5e-6))
    return study, fine + (fine - coarse) / 3


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_roll_with_friction_of_the_strokes(friction, tolerance):
    """Errors were 1.4, 5 and 32 times tolerances of 1e-4, 1e-5 and 1e-6: estimates took friction for smooth."""
    study, true = roll(friction)
    march = prepare(override(study, tolerance=tolerance))
    parts = [chunk for chunk in march.chunks]
    found = np.concatenate([chunk.recording.pose[:, :3] for chunk in parts])
    deviation = simulate(override(study, tolerance=tolerance)).com_deviation.values
    # The reference's own error, by its steps and their halves 2.6e-7 / 15 of the peak, is a fiftieth of the least.
    error = np.abs(found - true).max() / np.abs(deviation).max()
    assert error < tolerance
    assert error < 2 * parts[-1].error < 3 * tolerance  # and the estimate says so
    assert march.counters.steps < 4000


@cache
def one_mass():
    """A strut that only stretches, upright: mass, stiffness, servo's spring and damper, its study, stretch in time."""
    stiffness, damping, length, g, EA = 2e4, 20.0, 0.75, 9.81, 1e5
    friction = StrokeFriction(force=2.0, presliding=5e-6, stribeck={"force": 3.0, "rate": 5e-3})
    study = override(load(STRUT), fidelity="lumped", duration=0.1, output_step=1e-3)
    drive = ServoDrive(stiffness=stiffness, damping=damping, friction=friction)
    study = with_legs(
        study, lambda leg: leg.replace(drive=drive, damping=0.0, piston=leg.piston.replace(EA=EA, E=None))
    )
    study = study.replace(robot=study.robot.replace(gravity=[-g, 0.0, 0.0]))
    # The piston's points move by 1 - x / length of its driven end: a third of its mass, half of its weight.
    mass, k = study.robot.legs[0].piston.rhoA * length, stiffness + EA / length

    def rates(_, y):
        x, v, z = y
        limit = 5e-6 * (1 + 0.5 * np.exp(-((v / 5e-3) ** 2)))
        return [v, (-mass * g / 2 - k * x - damping * v - 2.0 / 5e-6 * z) / (mass / 3), v - abs(v) / limit * z]

    t = np.linspace(0.0, 0.1, 101)
    found = solve_ivp(rates, (0.0, 0.1), [0.0, 0.0, 0.0], "DOP853", t, rtol=1e-12, atol=1e-18, max_step=1e-5)
    return study, found.y[0]


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_one_mass_on_one_bristle(tolerance):
    """It swings to and fro until its bristle holds it; by SciPy. The stretch is minus the stroke's change."""
    study, true = one_mass()
    found = -simulate(override(study, tolerance=tolerance)).axial_amplitude.values[:, 0, 0]
    assert np.abs(found - true).max() < tolerance * np.abs(true).max()
