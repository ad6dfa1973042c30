"""Forces of legs that neither bend nor stretch follow the tolerance, whatever the mechanism."""

import numpy as np
import pytest
from tests.helpers.moving import moving

import flexapod as fx
from flexapod.model import Piston

pytestmark = pytest.mark.convergence

G = 9.81


def rigid(study, tolerance, **more):
    return fx.simulate(study, fidelity="rigid", tolerance=tolerance, **more)


def weightless_legs(kind):
    """The robot with a payload alone that has mass, on a quintic by 30 mm in a tenth of a second."""
    given = moving(kind, step=None)
    bodies = {"cylinder": given.robot.legs[0].cylinder.replace(mass=0.0, inertia=0.0)}
    bodies["piston"] = Piston(length=0.75, EA=1.1e8, EI=5000.0, rhoA=0.0)
    legs = tuple(leg.replace(**bodies) for leg in given.robot.legs)
    motion = given.motion.replace(profile="quintic")
    return given.replace(robot=given.robot.replace(legs=legs), motion=motion)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_massless_legs_carry_what_newton_says(tolerance):
    """m (g + a) with a = 30 mm (60 x - 180 x^2 + 120 x^3) / T^2 of x = t / T; the sum of the legs' upward forces."""
    data = rigid(weightless_legs("6-UPS"), tolerance, duration=0.12)
    x = np.minimum(data.time.values / 0.1, 1.0)
    right = 100.0 * (G + 0.03 * (60 * x - 180 * x**2 + 120 * x**3) / 0.1**2)
    up = data.joint_force.sel(axis="z").sum("leg").values
    peak = np.linalg.norm(data.joint_force.values, axis=-1).max()
    assert np.abs(up - right).max() < 6 * tolerance * peak  # of six legs, each within the tolerance of the peak


@pytest.mark.parametrize("kind", ["6-UPS", "3-RPS", "6-PUS", "3-UPS+UP"])
def test_drive_forces_are_those_of_inverse_dynamics_within_the_tolerance(kind):
    given, errors, balances = moving(kind, step=None), [], []
    given = given.replace(motion=given.motion.replace(profile="quintic"))
    name = "drive_force_rigid" if kind == "6-PUS" else "actuator_force_rigid"
    for tolerance in (1e-3, 1e-5):
        data = rigid(given, tolerance)
        right = data[name].values
        found = (data.actuator_force if name.startswith("actuator") else data.drive_force).values
        peak = np.abs(data.joint_force.values).max()  # what the estimate is over: closure forces
        errors.append(np.nanmax(np.abs(found - right)) / peak)
        assert errors[-1] < tolerance
        assert 0 < data.attrs["estimated_force_error"] < 1.1 * tolerance
        kept = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        balances.append(np.ptp((kept - data.work_drive - data.work_external).values) / np.ptp(data.work_drive.values))
    # Works are sums of the powers at the same stages, of the forces' errors over strokes of both signs.
    assert errors[1] < 0.1 * errors[0] and balances[1] < 10 * tolerance


def test_the_estimate_is_near_the_error():
    data = rigid(fx.preset("paper-robot"), 1e-5)
    error = np.abs((data.drive_force - data.actuator_force_rigid).values).max()
    error /= np.linalg.norm(data.joint_force.values, axis=-1).max()
    assert error < 1e-5
    assert 0.3 < error / data.attrs["estimated_force_error"] < 1.1


def test_forces_follow_the_tolerance_without_a_compiler(monkeypatch):
    monkeypatch.setenv("FLEXAPOD_COMPILER", "none")
    given = moving("3-RPS", step=None, output_step=5e-3)
    data = rigid(given, 1e-2, duration=0.05)
    error = np.abs((data.actuator_force - data.actuator_force_rigid).values).max()
    assert error < 1e-2 * np.abs(data.actuator_force_rigid.values).max()
