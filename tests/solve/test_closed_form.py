"""Forces and errors of more than six legs UPS, in closed form, against equations of motion and a minimum by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.kinematics.jacobian import sharing_inverse
from flexapod.kinematics.mobility import constraint_wrenches
from flexapod.model import Study
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics import ideal_robot
from flexapod.solve.statics.rigid_forces import displacement_by_error

pytestmark = pytest.mark.consistency

EXAMPLES = Path(__file__).parents[2] / "examples" / "mechanisms"
WRENCH = np.array([100.0, -50.0, 30.0, 4.0, -3.0, 5.0])


def _eight(drive: str = "") -> Study:
    """Eight legs, of which two push, or hold as the others do; the last three pistons are softer."""
    study = fx.load(EXAMPLES / "eight-legs.toml")
    legs = list(study.robot.legs)
    if not drive:
        legs[6:] = [leg.replace(drive=legs[0].drive) for leg in legs[6:]]
    for k in range(5, 8):
        legs[k] = legs[k].replace(piston=legs[k].piston.replace(diameter=0.015))
    return study.replace(robot=study.robot.replace(legs=tuple(legs)))


@pytest.mark.parametrize("drive", ["", "force"])
def test_forces_and_errors_are_those_of_the_equations_of_motion(drive: str) -> None:
    path = RigidPath(_eight(drive), np.linspace(0.0, 0.8, 9))
    found, (_, theirs) = ideal_robot.rigid_forces(path, WRENCH), ideal_robot.reactions(path, WRENCH)
    assert found.open_forces == theirs.open_forces == (0 if drive else 2)
    size = np.abs(theirs.joint_force).max()
    np.testing.assert_allclose(found.joint_force, theirs.joint_force, rtol=0, atol=1e-12 * size)
    in_leg = ideal_robot.rigid_system(path.robot).kernel.shapes.l_index
    np.testing.assert_allclose(found.drive_force, theirs.held[..., in_leg], rtol=0, atol=1e-12 * size)
    if drive:
        np.testing.assert_array_equal(found.drive_force[:, 6:], 500.0)


def test_errors_are_those_of_virtual_work() -> None:
    path = RigidPath(_eight(), np.linspace(0.0, 0.8, 5))
    system = ideal_robot.rigid_system(path.robot)
    ideal = kinematics.RigidPoses(ideal_robot.idealize_robot(path.robot), path.poses, path.legs)
    steps = displacement_by_error(system, rigid_motion(system, ideal)[0])[:, :, system.kernel.shapes.l_index]
    found = ideal_robot.rigid_errors(path)
    np.testing.assert_allclose(found[:, :, ideal_robot.LENGTH], steps, rtol=0, atol=1e-12 * np.abs(steps).max())
    assert not np.delete(found, ideal_robot.LENGTH, axis=2).any()


def test_shares_are_of_least_energy() -> None:
    rng = np.random.default_rng(3)
    lines, stiffness, wrench = rng.normal(size=(4, 9, 6)), rng.uniform(1e7, 9e7, 9), rng.normal(size=6)
    force = sharing_inverse(lines, stiffness) @ wrench
    np.testing.assert_allclose(np.einsum("tni,tn->ti", lines, force), np.tile(wrench, (4, 1)), atol=1e-13)

    def energy(f: Array) -> Array:
        return (f**2 / stiffness).sum(axis=-1)

    free = np.linalg.svd(lines.swapaxes(1, 2))[2][:, 6:]  # forces of the legs against each other
    for way in np.moveaxis(free, 1, 0):
        for side in (1e-3, -1e-3):
            assert (energy(force + side * way) > energy(force)).all()


def test_a_singular_pose_is_refused() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        sharing_inverse(np.zeros((1, 8, 6)) + np.eye(8, 6) * [1, 1, 1, 1, 1, 0], np.ones(8))


def test_constraints_are_those_of_the_closures() -> None:
    path = RigidPath(_eight(), np.linspace(0.0, 0.8, 5))
    legs = kinematics.rigid_limbs(path.robot)
    expected = constraint_wrenches(legs, path.closed_legs.q, path.poses, legs.platform.mean(axis=0))
    singular = np.linalg.svd(expected / np.array([1, 1, 1, legs.L_c, legs.L_c, legs.L_c]), compute_uv=False)
    np.testing.assert_allclose(path.singularity.smallest_singular_value, singular[:, -1], rtol=1e-12)
