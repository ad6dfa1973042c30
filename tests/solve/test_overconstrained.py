"""Robots whose joints say twice what they hold: settled by elasticity; where nothing yields, shared or refused."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS, built, leg
from tests.helpers.moving import moving
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.model import AxisMotion, CombinedMotion, Simulation, Study, override
from flexapod.solve.statics.ideal_robot import rigid_forces

pytestmark = pytest.mark.consistency

X, Y = np.eye(3)[:2]


def exechon(fidelity, tilt=0.0):
    """2-UPR+SPR: two conditions too many as long as the axes on the platform are parallel."""
    base = [[0.35, 0, 0], [-0.35, 0, 0], [0, 0.35, 0]]
    top = [[0.2, 0, 0], [-0.2, 0, 0], [0, 0.2, 0]]
    axes = [(X, Y), (X, Y + tilt * X), (None, X)]
    legs = [leg(chain, *each) for chain, each in zip(("UPR", "UPR", "SPR"), axes, strict=True)]
    robot = built("2-UPR+SPR", base, top, 0.6, legs)
    simulation = Simulation(fidelity=fidelity, step=1.25e-4, duration=0.02, output_step=1e-3)
    moving = CombinedMotion(amplitudes={"heave": 0.02, "roll": 0.05, "pitch": 0.05}, duration=0.5)
    return Study(robot=robot, motion=moving, simulation=simulation, initial={"start": "moving"})


def test_rigid_legs_share_what_is_open():
    study = exechon("rigid")
    data = fx.run(study)
    forces = rigid_forces(
        fx.kinematics.rigid_poses(study.robot, study.motion, data.time.values),
        np.zeros(6),
    )
    assert forces.open_forces == 2
    assert "rigid statics leaves 2 forces open" in data.attrs["warnings"]
    # second order in 4000 steps of a motion, when the integrator's own start, 1e-3 of the forces, has died away
    ours, rigid = data.drive_force.values[10:], forces.drive_force[10:]
    np.testing.assert_allclose(ours, rigid, atol=1e-4 * np.abs(rigid).max())


def test_elastic_legs_settle_it():
    data = fx.run(exechon("lumped"))
    assert "open" not in data.attrs["warnings"]
    assert data.closure_residual.max() < 1e-12


@pytest.mark.parametrize("fidelity", ["rigid", "lumped"])
def test_axes_that_miss_being_parallel_leave_fewer_motions(fidelity):
    with pytest.raises(fx.InputError, match=r"of a robot with 2 motions: .* It is nearly over-constrained: but"):
        fx.run(exechon(fidelity, tilt=0.02))


def test_a_missing_motion_of_an_ordinary_robot_has_no_such_cause():
    with pytest.raises(fx.InputError) as caught:
        fx.kinematics.poses(ROBOTS["3-UPU"](), AxisMotion(type="roll", amplitude=0.05, duration=1.0), [0.0, 1.0])
    assert "nearly" not in str(caught.value)


def test_rigid_legs_between_fixed_points_are_refused():
    study = override(sample_study("strut"), fidelity="rigid")
    with pytest.raises(fx.InputError, match="robot 1-UPS does not say what forces"):
        fx.run(study)


def test_rigid_legs_that_are_welded_are_refused_before_they_are_moved():
    with pytest.raises(fx.InputError, match="robot 6-FPF is over-constrained by its fixed joints"):
        fx.run(moving("6-FPF", fidelity="rigid", modes=None))
