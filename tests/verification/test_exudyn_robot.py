"""The robot in Exudyn, rigid and flexible, against ours; and what its model refuses."""

import numpy as np
import pytest

from flexapod import kinematics, model
from flexapod.analysis.simulation import simulate
from flexapod.common.errors import InputError
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_integration import Integration, extrapolate_first_order
from flexapod.verification.engines.exudyn_robot import simulate_robot

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(not EXUDYN.is_available(), reason="needs Exudyn")]

ROLL = model.AxisMotion(type="roll", amplitude=0.05, duration=0.2)
SHORT = Integration(duration=0.2, step=5e-4)


def undamped():
    robot = model.preset("paper-robot").robot
    return robot.replace(legs=tuple(leg.replace(damping=0.0) for leg in robot.legs))


def test_rigid_drive_forces_of_a_combined_motion():
    robot = model.preset("paper-robot").robot
    motion = model.CombinedMotion(
        amplitudes={"surge": 0.02, "heave": 0.03, "roll": 0.1, "pitch": -0.08, "yaw": 0.15},
        duration=0.2,
        profile="smooth",
    )
    errors = []
    for step in (1e-3, 5e-4):
        theirs = simulate_robot(robot, motion, Integration(duration=0.2, step=step, tolerance=1e-8), elements=0)
        ours = kinematics.inverse_dynamics(robot, kinematics.poses(robot, motion, theirs.time)).actuator_force
        errors.append(np.abs(theirs.actuator_force - ours).max() / np.abs(ours).max())
        assert np.abs(theirs.com_deviation).max() < 1e-10  # strokes fit the path: constraints to Newton's tolerance
    # Their multipliers are of second order in the step.
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


@pytest.fixture(scope="module")
def meshes():
    """Rings 20 and 10 mm apart on elements of 50 and 25 mm."""
    return [simulate_robot(undamped(), ROLL, SHORT, elements=n, guide=d) for n, d in ((15, 0.02), (30, 0.01))]


@pytest.fixture(scope="module")
def ours():
    return simulate(undamped(), ROLL, modes=3, axial_modes=2, step=5e-4, output_step=5e-4, duration=0.2)


def test_flexible_robot_sags_by_the_same(meshes, ours):
    # Statically rings and mesh matter only by the bending under the pistons' own weight: 20 um, to second order.
    sag = ours.com_deviation.values[0]
    assert meshes[1].com_deviation[0] == pytest.approx(sag, abs=1e-5 * np.abs(sag).max())


@pytest.mark.parametrize(
    ("name", "part"),
    [("com_deviation", 1e-2), ("actuator_force", 5e-3), ("tip_deflection", 3.4e-2)],
)
def test_flexible_robot_follows_the_same_curves(meshes, ours, name, part):
    # Rings 10 mm apart are softer than a clamp by 1.7 % of the deflection of a tip 600 mm away, and let it vibrate more
    # slowly by half of that, which doubles the difference within two periods. `part` of the peak: that for tips; less
    # for what is stretch for the most part. Rings and mesh are of first order: half the error on the finer mesh, and a
    # small part of it, of second order, after extrapolation.
    coarse, fine = (getattr(mesh, name) for mesh in meshes)
    exact = ours[name].values
    error = np.abs(fine - exact).max()
    assert error < part * np.abs(exact).max()
    assert error == pytest.approx(np.abs(coarse - exact).max() / 2, rel=0.2)
    assert np.abs(extrapolate_first_order(coarse, fine) - exact).max() < error / 3


def test_records_have_their_shapes(meshes):
    run = meshes[0]
    assert run.time.shape == (401,)
    assert run.com_deviation.shape == (401, 3)
    assert run.actuator_force.shape == (401, 6)
    assert run.tip_deflection.shape == (401, 6, 2)


def force(leg):
    return leg.replace(drive=model.ForceDrive())


@pytest.mark.parametrize(
    ("change", "motion", "settings", "key"),
    [
        (force, ROLL, {}, "leg 1: drive"),
        (lambda leg: leg.replace(damping=0.01), ROLL, {}, "leg 1: damping"),
        (lambda leg: leg, ROLL.replace(profile="linear"), {}, "motion"),
        (lambda leg: leg, ROLL, {"elements": -1}, "elements"),
        (lambda leg: leg, ROLL, {"guide": 0.0}, "guide"),
        (lambda leg: leg, ROLL, {"guide": 0.2}, "guide"),
    ],
)
def test_what_its_model_lacks_is_refused_before_anything_runs(change, motion, settings, key):
    robot = undamped()
    robot = robot.replace(legs=tuple(change(leg) for leg in robot.legs))
    with pytest.raises(InputError) as refused:
        simulate_robot(robot, motion, SHORT, **settings)
    assert refused.value.key == key


@pytest.mark.parametrize(
    "settings", [{"duration": 0.0}, {"duration": 1.0, "step": -1.0}, {"duration": 1.0, "rho_inf": 1.0}]
)
def test_integration_that_makes_no_sense_is_refused(settings):
    with pytest.raises(InputError):
        Integration(**settings)


def test_a_flexible_tripod_whose_bending_moves_the_payload():
    robot = model.preset("tripod").robot
    robot = robot.replace(legs=tuple(leg.replace(damping=0.0) for leg in robot.legs))
    motion = model.CombinedMotion(amplitudes={"heave": 0.01, "roll": 0.06}, duration=0.2)
    coarse, fine = (simulate_robot(robot, motion, SHORT, elements=n, guide=d) for n, d in ((15, 0.02), (30, 0.01)))
    ours = simulate(robot, motion, modes=3, axial_modes=2, step=5e-4, output_step=5e-4, duration=0.2)
    sag = ours.com_deviation.values[0]
    # At rest by symmetry nothing but stretch: rings and mesh do not matter.
    assert fine.com_deviation[0] == pytest.approx(sag, abs=1e-4 * np.abs(sag).max())
    for name, part in (("com_deviation", 5e-2), ("actuator_force", 2e-3), ("tip_deflection", 5e-2)):
        curve = ours[name].values
        errors = [np.abs(x - curve).max() / np.abs(curve).max() for x in (getattr(coarse, name), getattr(fine, name))]
        both = (
            np.abs(extrapolate_first_order(getattr(coarse, name), getattr(fine, name)) - curve).max()
            / np.abs(curve).max()
        )
        # Softer by d/s = 1.7 % of a deflection on the finer mesh, which lasting vibration makes twice as much; of first
        # order. The forces carry the payload, and hear of bending by a part in a thousand.
        assert errors[1] < part and both < part / 2
