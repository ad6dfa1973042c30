"""`fx.mobility`: counts, names and sentences of a robot at a pose."""

import numpy as np
import pytest
from tests.mechanisms import ROBOTS

import flexapod as fx


def test_mobility_of_the_papers_robot():
    data = fx.mobility(fx.preset("paper-robot"))
    assert [int(data[name]) for name in ("mobility", "locked", "redundant", "self_stress")] == [6, 0, 0, 0]
    assert data.motions.values.tolist() == ["surge", "sway", "heave", "roll", "pitch", "yaw"]
    assert data.mobility_nearby.values.tolist() == [6, 6]
    assert data.attrs["words"] == "6 motions: surge, sway, heave, roll, pitch, yaw"


def test_mobility_at_a_pose_names_what_goes_together():
    robot = ROBOTS["3-RPS"]()
    data = fx.mobility(robot, {"roll": 0.2, "heave": 0.02})
    assert int(data.mobility) == 3 and data.motions.values[0] == "heave"
    assert any("roll with" in name for name in data.motions.values)
    twist = data.motion_twist.values
    # the hinges stay shut: no joint on the platform moves along the hinge of its leg
    pose = fx.rigid.poses_from_home(robot, np.array([[0, 0, 0.02, 0.2, 0, 0.0]]))
    arms = robot.platform_joints @ pose.rotation[0].T
    velocity = twist[:, None, :3] + np.cross(twist[:, None, 3:], arms)
    along = np.einsum("mlk,lk->ml", velocity, np.array([leg.base_joint.axis for leg in robot.legs]))
    np.testing.assert_allclose(along, 0.0, atol=1e-12)


def test_a_pose_out_of_reach_is_refused():
    with pytest.raises(fx.InputError, match="does not reach its platform joint"):
        fx.mobility(ROBOTS["6-PUS"](), {"surge": 0.7})
