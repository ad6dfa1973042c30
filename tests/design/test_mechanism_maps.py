"""Checks and maps of robots with carriages and with fewer than six motions."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS, THREE, built, leg, ring, sliders, tangents
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.analysis.checks.checks import check_geometry
from flexapod.analysis.checks.reachability import REASONS, rigid_codes
from flexapod.design.maps.grid import usual_axes
from flexapod.model.motion import AxisMotion

pytestmark = pytest.mark.unit


def codes(robot, **values):
    columns = np.zeros((len(next(iter(values.values()))), 6))
    for name, column in values.items():
        columns[:, ["surge", "sway", "heave", "roll", "pitch", "yaw"].index(name)] = column
    path = fx.kinematics.poses_from_home(robot, columns)
    return [REASONS[code].flag for code in rigid_codes(fx.kinematics.RigidPoses(robot, path), from_home=True)]


def limited(robot, low, high):
    """The same sliders with a stroke around their places at home."""
    places = robot.home_carriages
    return robot.replace(
        legs=tuple(
            leg.replace(carriage=leg.carriage.replace(stroke={"min": place + low, "max": place + high}))
            for leg, place in zip(robot.legs, places, strict=True)
        )
    )


def test_codes_say_what_stops_a_delta():
    robot = limited(sliders("PUU", tangents(THREE), THREE, THREE, length=0.4, side=1), -0.1, 0.08)
    found = codes(robot, surge=[0.0, 0.02, 0.3, 0.9], heave=[0.05, 0.09, 0.0, 0.0])
    # 0.05 m up all three carriages rise by 0.05 m; 0.09 m is beyond their 0.08 m; far out no rod reaches
    assert found == ["reached", "carriage_stops", "carriage_stops", "out_of_reach"]
    values = np.array([[0, 0, 0.05, 0, 0, 0], [0.02, 0, 0.09, 0, 0, 0], [0.9, 0, 0, 0, 0, 0.0]])
    assert fx.kinematics.reachable(robot, fx.kinematics.poses_from_home(robot, values)).tolist() == [True, False, False]


def test_margins_of_a_map_are_those_of_the_sliders():
    robot = limited(ROBOTS["6-PUS"](), -0.1, 0.1)
    data = fx.workspace_map(robot, {"heave": np.array([-0.05, 0.0, 0.05, 0.12])})
    np.testing.assert_allclose(data.stroke_margin.values[:3], [0.05, 0.1, 0.05], rtol=0, atol=1e-12)
    assert data.reason.values.tolist()[:3] == [0, 0, 0] and data.reason.values[3] != 0


def test_a_map_of_a_tripod_has_the_poses_that_it_can_take():
    data = fx.workspace_map(ROBOTS["3-RPS"](), {"heave": np.array([-0.02, 0.02]), "roll": np.array([-0.2, 0.0, 0.2])})
    assert (data.reason.values == 0).all()
    # mirrored in the plane of y and z: the same robot
    np.testing.assert_allclose(data.smallest_singular_value[:, 0], data.smallest_singular_value[:, 2], rtol=1e-9)


def test_a_map_of_a_motion_that_the_robot_does_not_have_is_refused():
    with pytest.raises(fx.InputError, match="asks for surge of a robot with 3 motions: heave, roll, pitch"):
        fx.workspace_map(ROBOTS["3-RPS"](), {"surge": np.array([0.0, 0.1])})


def test_a_map_varies_what_the_robot_can_do_unless_told():
    given = {"3-RPS": ["heave", "roll"], "6-PUS": ["surge", "heave"]}
    assert {name: usual_axes(ROBOTS[name]()) for name in given} == given
    with pytest.raises(fx.InputError, match=r"platform\.fixed.*nothing to map.*flexapod modes"):
        fx.workspace_map(sample_study("strut"))


def study(robot, kind, amplitude):
    return fx.Study(robot=robot, motion=AxisMotion(type=kind, amplitude=amplitude, duration=1.0))


REFUSED = {
    "carriage": ("6-PUS", "heave", 0.12, r"Leg \d: the carriage is beyond the end of its stroke: .*limit .* m \(by"),
    "reach": ("3-PUU", "surge", 0.5, r"leg \d, PUU, does not reach its platform joint .*at t = 0\.\d+ s"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_paths_that_no_robot_can_follow_are_refused(name):
    kind, axis, amplitude, words = REFUSED[name]
    robot = ROBOTS[kind]()
    if name == "carriage":
        robot = limited(robot, -0.1, 0.1)
    with pytest.raises(fx.InputError, match=words):
        check_geometry(study(robot, axis, amplitude))


def test_a_robot_whose_drives_do_not_hold_it_is_refused_before_its_path():
    legs = [leg("UPU", axis, axis) for axis in ring(1.0, THREE)]
    robot = built("3-UPU", ring(0.35, THREE), ring(0.2, THREE), 0.6, legs)
    with pytest.raises(fx.InputError, match=r"with all drives locked it still has 2 motions: .*: singular at home"):
        check_geometry(study(robot, "heave", 0.01))


def test_a_crank_that_leaves_its_stroke_is_named_in_degrees():
    robot = limited(ROBOTS["6-RUS"](), -0.2, 0.2)
    with pytest.raises(fx.InputError, match=r"Leg \d: the carriage is b.* deg, limit .* deg \(by .* deg at t"):
        check_geometry(study(robot, "heave", 0.06))


def test_a_rod_that_meets_its_rail_at_right_angles_is_refused():
    """Surge until the first rod, 0.65 m long, is 0.649 m away from its rail: asin(0.649 / 0.65) = 86.8 deg."""
    robot = ROBOTS["6-PUS"]()
    x, y = (robot.home_tips - robot.base_joints)[:, :2].T
    way = (np.sqrt(0.649**2 - y**2) - x).min()
    with pytest.raises(fx.InputError, match=r"between leg \d and the way of its carriage the angle is 86.8 deg"):
        check_geometry(study(robot, "surge", float(way)))


@pytest.mark.parametrize("name", [name for name in ROBOTS if name != "1-UPS"])
def test_a_small_motion_of_every_robot_passes(name):
    axis = "surge" if "planar" in name or name in ("3-UPU", "3-PUU") else "heave"
    check_geometry(study(ROBOTS[name](), axis, 0.01))


def test_poses_of_a_tripod_by_name_are_completed():
    robot = ROBOTS["3-RPS"]()
    data = fx.stiffness(robot, {"roll": 0.2})
    assert np.isfinite(data.stiffness.values).all()


def test_a_map_of_poses_that_have_no_equilibrium_says_why():
    # The legs of this 3-UPU give way wherever the map looks: no pose is left to compute anything about.
    found = fx.workspace_map(ROBOTS["3-UPU"](), {"surge": [0.02], "heave": [0.01, 0.02]})
    assert (found.reason != 0).all() and np.isnan(found.static_deviation_size).all()
