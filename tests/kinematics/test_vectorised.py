"""A path at once is the same as its poses one by one, across the blocks in which it is evaluated."""

from dataclasses import fields

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics
from flexapod.kinematics.laws import Law
from flexapod.kinematics.rotations import BLOCK
from flexapod.kinematics.trajectory import poses_from_coordinates

pytestmark = pytest.mark.property

ROBOT = fx.preset("paper-robot").robot
COUNT = 2 * BLOCK + 37
LOOKED_AT = (0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK - 1, 2 * BLOCK, COUNT - 1)

# Sums of a dozen products of size 1 in another order: some 1e-15 of the largest entry. Forces pass through a 6 x 6
# solution whose matrix has a condition below 100 on these poses.
LENGTHS, FORCES = 1e-14, 1e-12


@pytest.fixture(scope="module")
def path():
    numbers = np.random.default_rng(5)
    size = np.array([0.05, 0.05, 0.05, 0.3, 0.3, 0.3])
    law = Law(*(scale * size * numbers.uniform(-1, 1, (COUNT, 6)) for scale in (1, 3, 10)))
    return poses_from_coordinates(kinematics.home_pose(ROBOT), law, (0.02, 0.1, 0.3))


def one_by_one(path, function):
    return np.stack([np.asarray(function(k, path.part(slice(k, k + 1))))[0] for k in LOOKED_AT])


def agree(whole, single, tolerance):
    assert np.abs(whole[list(LOOKED_AT)] - single).max() <= tolerance * np.abs(whole).max()


@pytest.mark.parametrize("name", [f.name for f in fields(kinematics.LegState) if f.default is not None])
def test_legs(path, name):
    whole = getattr(kinematics.inverse_kinematics(ROBOT, path), name)
    assert whole.shape == (COUNT, 6) and whole.flags.c_contiguous
    agree(whole, one_by_one(path, lambda k, pose: getattr(kinematics.inverse_kinematics(ROBOT, pose), name)), LENGTHS)


@pytest.mark.parametrize("name", [f.name for f in fields(kinematics.RigidForces)])
def test_forces(path, name):
    wrench = np.random.default_rng(6).normal(size=(COUNT, 6)) * 100
    whole = getattr(kinematics.inverse_dynamics(ROBOT, path, wrench), name)
    assert whole.flags.c_contiguous
    single = one_by_one(path, lambda k, pose: getattr(kinematics.inverse_dynamics(ROBOT, pose, wrench[k]), name))
    agree(whole, single, FORCES)


def test_known_legs_change_nothing(path):
    plain = kinematics.inverse_dynamics(ROBOT, path)
    given = kinematics.inverse_dynamics(ROBOT, path, legs=kinematics.inverse_kinematics(ROBOT, path))
    np.testing.assert_array_equal(given.actuator_force, plain.actuator_force)


@pytest.mark.parametrize("local", [ROBOT.platform_joints, ROBOT.payload.com])
def test_points(path, local):
    for k, whole in enumerate(path.point(local)):
        agree(whole, one_by_one(path, lambda _, pose, k=k: pose.point(local)[k]), LENGTHS)
    np.testing.assert_allclose(path.place(local), path.point(local)[0], rtol=0, atol=LENGTHS)


def test_jacobian(path):
    joints = ROBOT.base_joints, ROBOT.platform_joints
    whole = kinematics.length_jacobian(*joints, path.position, path.rotation)
    agree(
        whole,
        one_by_one(path, lambda _, pose: kinematics.length_jacobian(*joints, pose.position, pose.rotation)),
        LENGTHS,
    )


def test_directions_are_those_of_the_legs(path):
    legs = kinematics.inverse_kinematics(ROBOT, path)
    found = kinematics.reach(ROBOT, path)
    np.testing.assert_allclose(found.length, legs.length, rtol=0, atol=LENGTHS)
    np.testing.assert_allclose(found.angles["universal joint"], np.abs(legs.beta), rtol=0, atol=LENGTHS)


def test_a_folded_joint_is_named_with_its_sample_beyond_the_first_block(path):
    rotation = np.array(path.rotation)
    position = np.array(path.position)
    k = BLOCK + 5
    first_axis = kinematics.home_frames(ROBOT)[2, :, 0]  # leg 3 along the first axis of its universal joint
    rotation[k], position[k] = np.eye(3), ROBOT.base_joints[2] + 0.9 * first_axis - ROBOT.platform_joints[2]
    with pytest.raises(fx.InputError, match=rf"leg 3 folds to beta = 90.0 deg \(sample {k + 1} of {COUNT}\)"):
        kinematics.inverse_kinematics(ROBOT, kinematics.Poses.at_rest(position, rotation))


@pytest.mark.parametrize(
    ("kind", "amplitude"), [("roll", 0.46), ("pitch", 1.2), ("yaw", 1.0), ("yaw", 2.5), ("sway", 0.3), ("heave", 0.0)]
)
def test_the_pose_nearest_to_a_singularity_is_that_of_the_whole_path(kind, amplitude):
    motion = fx.model.AxisMotion(type=kind, amplitude=amplitude, duration=1.0)
    poses = kinematics.poses(ROBOT, motion, np.linspace(0.0, 1.5, 1501))
    whole, found = kinematics.singularity(ROBOT, poses), kinematics.nearest_singularity(ROBOT, poses)
    # The same matrices go through the same LAPACK routine: equal to the last digit, the index up to exact ties.
    assert found.smallest_singular_value == whole.smallest_singular_value.min()
    assert whole.smallest_singular_value[found.worst] == found.smallest_singular_value
    assert found.condition == whole.condition[found.worst]
    np.testing.assert_array_equal(found.sign_changes, whole.sign_changes)
    assert (len(found.sign_changes) > 0) == (amplitude == 2.5)


def test_one_wild_pose_between_two_looks_is_found():
    home = kinematics.home_pose(ROBOT)
    position, rotation = np.tile(home.position, (500, 1)), np.tile(home.rotation, (500, 1, 1))
    turn = kinematics.rotation_matrix([0.0, 0.0, np.deg2rad(89.9)])  # a yaw of 90 deg is singular
    rotation[237] = turn
    poses = kinematics.Poses.at_rest(position, rotation)
    assert kinematics.nearest_singularity(ROBOT, poses).worst == 237
