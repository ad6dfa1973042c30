"""`fx.mobility`: counts, names and sentences of a robot at a pose."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS

import flexapod as fx

pytestmark = pytest.mark.unit


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
    pose = fx.kinematics.poses_from_home(robot, np.array([[0, 0, 0.02, 0.2, 0, 0.0]]))
    arms = robot.platform_joints @ pose.rotation[0].T
    velocity = twist[:, None, :3] + np.cross(twist[:, None, 3:], arms)
    along = np.einsum("mlk,lk->ml", velocity, np.array([leg.base_joint.axis for leg in robot.legs]))
    np.testing.assert_allclose(along, 0.0, atol=1e-12)


def test_a_pose_out_of_reach_is_refused():
    with pytest.raises(fx.InputError, match="does not reach its platform joint"):
        fx.mobility(ROBOTS["6-PUS"](), {"surge": 0.7})


WELDED = """
[robot]
type = "1-FP"
base = {{ joints = [[0, 0, 0]] }}
platform = {{ joints = [[0, 0, 0]] }}
home_height = "0.8 m"
[payload]
mass = 10
inertia = [0.1, 0.1, 0.1]
com = [0, 0, "50 mm"]
[leg]
passive = {passive}
cylinder = {{ mass = "3 kg", com = "0.16 m", inertia = 0.025, mouth = "0.3 m" }}
piston = {{ diameter = "20 mm", length = "0.75 m", material = "steel" }}
[motion]
type = "heave"
amplitude = "20 mm"
duration = "0.2 s"
"""


def test_what_a_weld_alone_holds_is_named_where_a_path_is_refused():
    """A piston welded to base and platform moves along one axis; a path turns it freely, and said nothing of it."""
    study = fx.loads(WELDED.format(passive="false"))
    reason = "but for what its welds and flexures (F) hold: on the rigid path these turn freely"
    assert reason in fx.mobility(study).attrs["words"]
    with pytest.raises(fx.InputError) as refused:
        fx.simulate(study)
    assert reason in refused.value.what and "without welds and flexures" in refused.value.allowed
    assert len(fx.modes(study).frequency) > 2 and np.isfinite(fx.stiffness(study).stiffness).all()
    hinged = fx.loads(WELDED.format(passive="false").replace("1-FP", "1-UP"))
    assert "weld" not in fx.mobility(hinged).attrs["words"]


def test_a_robot_that_nothing_drives_has_motions_all_the_same():
    """A share of the payload for each driven leg was a division by zero."""
    assert int(fx.mobility(fx.loads(WELDED.format(passive="true"))).mobility) == 3
