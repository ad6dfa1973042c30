"""Kinematics of any mechanism against closed forms, differences of time and each other."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS, THREE, built, hexapod, leg, ring, sliders, tangents, three_rps

from flexapod import kinematics
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics import mechanism
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, limbs
from flexapod.kinematics.mobility import constraint_wrenches, drive_jacobian
from flexapod.kinematics.screws import screws
from flexapod.model.motion import AxisMotion, CombinedMotion

pytestmark = pytest.mark.consistency

SIX = {"surge": 0.03, "sway": 0.02, "heave": 0.04, "roll": 0.15, "pitch": -0.1, "yaw": 0.12}
TILTS, SHIFTS, FLAT = ("heave", "roll", "pitch"), ("surge", "sway", "heave"), ("surge", "sway", "yaw")
LOWER = {"3-RPS": TILTS, "3-PRS": TILTS, "3-SPR": TILTS, "3-UPU": SHIFTS, "3-PUU": SHIFTS, "3-UPS+UP": SHIFTS}
MOVING = [name for name in ROBOTS if name != "1-UPS"]


def motion(name):
    axes = FLAT if "planar" in name else LOWER.get(name, tuple(SIX))
    return CombinedMotion(amplitudes={axis: SIX[axis] for axis in axes}, duration=1.0, pivot=[0.0, 0.02, 0.05])


def moved(name, t):
    robot = ROBOTS[name]()
    path = kinematics.poses(robot, motion(name), t)
    return robot, path, kinematics.inverse_kinematics(robot, path)


def test_screws_are_derivatives_of_tips_and_frames():
    # Central differences with h = 1e-5 of numbers of order 1: error below 1e-9 from rounding, 1e-9 from h^2.
    rng = np.random.default_rng(1)
    for name in ("6-RUS", "6-UCU", "3-SPR", "3-UPS+UP", "6-PUS"):
        legs = limbs(ROBOTS[name](), rigid=True)
        q, rates = legs.home + 0.3 * rng.normal(size=(2, len(legs), 8)), rng.normal(size=(2, len(legs), 8))
        before, at, after = (screws(legs, q + h * rates) for h in (-1e-5, 0.0, 1e-5))
        twist = (at.columns @ rates[..., None])[..., 0]
        spin = (after.frame - before.frame) / 2e-5 @ at.frame.swapaxes(-1, -2)
        np.testing.assert_allclose(twist[..., :3], (after.tip - before.tip) / 2e-5, rtol=0, atol=1e-8)
        np.testing.assert_allclose(
            twist[..., 3:], np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1), rtol=0, atol=1e-8
        )
        change = ((after.columns - before.columns) / 2e-5 @ rates[..., None])[..., 0]
        np.testing.assert_allclose(at.bias(rates), change, rtol=0, atol=1e-7)


def test_the_general_way_is_the_closed_form_where_there_is_one():
    t = np.linspace(0.0, 1.0, 41)
    robot, path, closed = moved("6-UPS", t)
    legs = limbs(robot, rigid=True)
    found = mechanism.leg_state(legs, path, mechanism.legs_at(legs, path))
    for name in ("length", "alpha", "beta", "rate", "alpha_dot", "beta_dot", "accel", "alpha_ddot", "beta_ddot"):
        expected = getattr(closed, name)
        # rounding alone, through a matrix of condition below 10
        np.testing.assert_allclose(getattr(found, name), expected, rtol=0, atol=3e-14 * max(1, np.abs(expected).max()))


@pytest.mark.parametrize("name", MOVING)
def test_rates_are_derivatives_in_time(name):
    # Central differences over 2 h = 2e-4 s of a quintic: error h^2 x'''/6 < 1e-8 x 60 x 0.15 / 6, twice as derivative.
    h, middle = 1e-4, np.array([0.21, 0.5, 0.83])
    _, path, legs = moved(name, np.concatenate([middle - h, middle, middle + h]))
    for names in (
        ("length", "rate", "accel"), ("alpha", "alpha_dot", "alpha_ddot"), ("beta", "beta_dot", "beta_ddot"),
        ("chi", "chi_dot", "chi_ddot"), ("spin", "spin_dot", "spin_ddot"), ("gamma", "gamma_dot", "gamma_ddot"),
    ):  # fmt: skip
        values = [getattr(legs, part) for part in names]
        if values[0] is None:
            continue
        for value, rate in itertools.pairwise(values):
            difference = (value[6:] - value[:3]) / (2 * h)
            np.testing.assert_allclose(rate[3:6], difference, rtol=0, atol=2e-6)
    for value, rate in (("position", "velocity"), ("velocity", "acceleration"), ("omega", "alpha")):
        difference = (getattr(path, value)[6:] - getattr(path, value)[:3]) / (2 * h)
        np.testing.assert_allclose(getattr(path, rate)[3:6], difference, rtol=0, atol=2e-6)


@pytest.mark.parametrize("name", MOVING)
def test_legs_end_at_their_platform_joints_and_keep_their_joints(name):
    robot, path, legs = moved(name, np.linspace(0.0, 1.0, 11))
    of_legs = limbs(robot, rigid=True)
    q = np.stack([legs.coordinate(coordinate)[0] for coordinate in COORDINATES], axis=-1)
    chain = screws(of_legs, q)
    np.testing.assert_allclose(chain.tip, path.point(robot.platform_joints)[0], rtol=0, atol=1e-14)
    goal = path.rotation[:, None] @ of_legs.platform_frames
    met = of_legs.pose_closure
    np.testing.assert_allclose(chain.frame[:, met], goal[:, met], rtol=0, atol=1e-14)
    held = of_legs.state == 1
    np.testing.assert_array_equal(q[:, held], np.broadcast_to(of_legs.home[held], q[:, held].shape))


def test_tripod_has_its_known_parasitic_motions():
    """3-RPS: x = h/2 (R11 - R22), y = -h R21, and no torsion, R12 = R21 (Carretero et al. 2000, J. Mech. Des. 122)."""
    robot, radius = three_rps(), 0.2
    asked = CombinedMotion(amplitudes={"heave": 0.05, "roll": 0.35, "pitch": -0.3}, duration=1.0)
    path = kinematics.poses(robot, asked, np.linspace(0.0, 1.0, 21))
    R, place = path.rotation, path.position - robot.home_position
    np.testing.assert_allclose(place[:, 0], radius / 2 * (R[:, 0, 0] - R[:, 1, 1]), rtol=0, atol=1e-15)
    np.testing.assert_allclose(place[:, 1], -radius * R[:, 1, 0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(R[:, 0, 1], R[:, 1, 0], rtol=0, atol=1e-15)
    assert np.abs(place[:, :2]).max() > 5e-3  # not small at these tilts


@pytest.mark.parametrize("name", MOVING)
def test_drives_lead_back_to_the_pose(name):
    robot, path, legs = moved(name, np.linspace(0.0, 1.0, 6))
    drives = kinematics.drive_positions(robot, path)
    back = kinematics.forward_kinematics(robot, drives)
    np.testing.assert_allclose(back.position, path.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(back.rotation, path.rotation, rtol=0, atol=1e-12)
    again = kinematics.forward_kinematics(
        robot, drives[-1], kinematics.Poses.at_rest(path.position[3], path.rotation[3])
    )
    np.testing.assert_allclose(again.position[0], path.position[-1], rtol=0, atol=1e-12)
    rates = np.concatenate([legs.coordinate(c)[1][:, :, None] for c in COORDINATES], axis=-1)
    rates = rates[:, limbs(robot, rigid=True).state == DRIVEN]
    twist = np.concatenate([path.velocity, path.omega], axis=1)
    np.testing.assert_allclose(
        (kinematics.drive_jacobian(robot, path) @ twist[..., None])[..., 0], rates, rtol=0, atol=1e-13
    )


def test_wrenches_of_legs_UPS_are_rows_of_the_length_jacobian():
    robot, path, _ = moved("6-UPS", np.linspace(0.0, 1.0, 5))
    legs, point = limbs(robot, rigid=True), np.array([0.1, 0.0, 0.2])
    expected = length_jacobian(robot.base_joints, robot.platform_joints, path.position, path.rotation, point)
    q = mechanism.legs_at(legs, path).q
    np.testing.assert_allclose(constraint_wrenches(legs, q, path, point), expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(drive_jacobian(legs, q, path, point), expected, rtol=0, atol=1e-14)
    crossed = ROBOTS["6-UCU"]()
    ours, theirs = kinematics.singularity(crossed, path), kinematics.singularity(robot, path)
    np.testing.assert_allclose(ours.smallest_singular_value, theirs.smallest_singular_value, rtol=1e-12)
    np.testing.assert_allclose(ours.determinant, theirs.determinant, rtol=1e-12)


def test_a_singular_pose_of_a_tripod_is_found():
    """Legs RPS that lie in the plane of the platform's joints cannot carry it."""
    robot = built("3-RPS", ring(0.5, THREE), ring(0.2, THREE), 1e-9, [leg("RPS", a) for a in tangents(THREE)])
    flat = kinematics.nearest_singularity(robot, kinematics.home_pose(robot))
    assert flat.smallest_singular_value < 1e-8
    crossing = kinematics.Poses.at_rest([[0, 0, 0.1], [0, 0, -0.1]], np.eye(3))
    assert kinematics.singularity(robot, crossing).sign_changes.tolist() == [0]


def test_a_carriage_keeps_its_side():
    """Rods level with their upright rails' ends are the limit: beyond, each would stand on the other side."""
    robot = sliders("PUS", length=0.45)
    start = limbs(robot, rigid=True)
    assert np.all(mechanism.sides(start, start.home[None]) > 0.5)
    with pytest.raises(InputError, match=r"leg \d meets its carriage at 8\d\.\d deg|does not reach"):
        path = kinematics.poses(robot, AxisMotion(type="surge", amplitude=0.3, duration=1.0), np.linspace(0, 1, 101))
        kinematics.inverse_kinematics(robot, path)


def test_poses_out_of_reach_are_refused_with_leg_and_instant():
    robot = sliders("PUS", length=0.45)
    path = kinematics.poses(robot, AxisMotion(type="surge", amplitude=0.6, duration=1.0), np.linspace(0, 1, 11))
    with pytest.raises(InputError, match=r"leg \d, PUS, does not reach its platform joint .*sample \d+ of 11"):
        kinematics.inverse_kinematics(robot, path)
    with pytest.raises(InputError, match=r"leg \d, RPS, does not reach"):
        kinematics.inverse_kinematics(three_rps(), kinematics.Poses.at_rest([0.05, 0, 0.6], np.eye(3)))


def test_joints_that_fold_are_refused():
    robot = hexapod("UCU", height=0.35)
    with pytest.raises(InputError, match=r"(base|platform) joint of leg \d folds to 8\d\.\d deg"):
        path = kinematics.poses(robot, AxisMotion(type="roll", amplitude=2.2, duration=1.0), np.linspace(0, 1, 201))
        kinematics.inverse_kinematics(robot, path)


def test_drives_that_no_pose_fits_are_refused():
    robot = three_rps()
    with pytest.raises(InputError, match=r"\(3,\) or \(T, 3\)"):
        kinematics.forward_kinematics(robot, np.ones(6))
    with pytest.raises(ComputationError, match="No pose fits the drives of sample 1"):
        kinematics.forward_kinematics(robot, [0.05, 1.0, 0.05])


def test_all_postures_are_for_six_legs_ups():
    with pytest.raises(InputError, match="six legs UPS"):
        kinematics.postures(three_rps(), [0.6, 0.6, 0.6])


def test_mirrored_tripod_mirrors():
    robot = three_rps()
    t = np.linspace(0.0, 1.0, 5)
    one, other = (
        kinematics.poses(
            robot, CombinedMotion(amplitudes={"heave": 0.02, "roll": s * 0.3, "pitch": 0.2}, duration=1.0), t
        )
        for s in (1, -1)
    )
    np.testing.assert_allclose(one.position * [1, -1, 1], other.position, rtol=0, atol=1e-15)


def test_home_and_general_poses_of_the_base():
    """The same robot turned and moved as a whole: lengths and drives do not know."""
    robot = ROBOTS["3-UPS+UP"]()
    turn, shift = kinematics.rotation_matrix([0.3, -0.2, 0.5]), np.array([1.0, -2.0, 0.5])
    legs = [
        one.replace(base_joint=one.base_joint.replace(axis=turn @ one.base_joint.axis))
        if one.base_joint.axis is not None
        else one
        for one in robot.legs
    ]
    there = robot.replace(
        base_joints=robot.base_joints @ turn.T + shift,
        home={"position": turn @ robot.home_position + shift, "rotation": [0.3, -0.2, 0.5]},
        legs=tuple(legs),
    )
    path = kinematics.poses(robot, motion("3-UPS+UP"), np.linspace(0, 1, 5))
    moved_path = kinematics.Poses.at_rest(path.position @ turn.T + shift, turn @ path.rotation)
    np.testing.assert_allclose(
        kinematics.drive_positions(there, moved_path), kinematics.drive_positions(robot, path), rtol=0, atol=1e-13
    )


def test_a_motion_turns_on_top_of_home():
    """R = R_motion R_home and p = p_home + x + R_home c - R c, (T2.12)."""
    robot = ROBOTS["6-UPS"]().replace(home={"position": [0.02, -0.03, 0.8], "rotation": [0.1, -0.05, 0.2]})
    pivot = np.array([0.05, 0.1, 0.2])
    asked = CombinedMotion(amplitudes={"surge": 0.03, "pitch": 0.2}, duration=1.0, pivot=pivot)
    start, end = (kinematics.poses(robot, asked, [t]) for t in (0.0, 1.0))
    np.testing.assert_allclose(start.position[0], robot.home_position, rtol=0, atol=1e-15)
    np.testing.assert_allclose(start.rotation[0], robot.home_rotation, rtol=0, atol=1e-15)
    turn = kinematics.rotation_matrix([0, 0.2, 0])
    np.testing.assert_allclose(end.rotation[0], turn @ robot.home_rotation, rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        end.place(pivot)[0], robot.home_position + robot.home_rotation @ pivot + [0.03, 0, 0], rtol=0, atol=1e-15
    )
    by_name = kinematics.poses_from_home(robot, np.array([[0.03, 0, 0, 0, 0.2, 0]]))
    np.testing.assert_allclose(by_name.rotation, end.rotation, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("plane", "axes", "third"), [("yz", ("sway", "heave", "roll"), "surge"),
                                                      ("zx", ("heave", "surge", "pitch"), "sway")])  # fmt: skip
def test_planes_are_the_same_plane_seen_otherwise(plane, axes, third):
    flat, t = ROBOTS["planar 3-PRR"](), np.linspace(0, 1, 5)
    turn = np.roll(np.eye(3), {"yz": 1, "zx": 2}[plane], axis=0)  # x, y, z of the plane xy onto those of this plane
    legs = tuple(one.replace(carriage=one.carriage.replace(axis=turn @ one.carriage.axis)) for one in flat.legs)
    robot = built("3-PRR", flat.base_joints @ turn.T, flat.platform_joints @ turn.T, 0.0, legs, plane=plane)
    sizes = (0.02, 0.03, 0.2)
    first, other = (
        kinematics.drive_positions(
            r, kinematics.poses(r, CombinedMotion(amplitudes=dict(zip(names, sizes, strict=True)), duration=1.0), t)
        )
        for r, names in ((flat, FLAT), (robot, axes))
    )
    np.testing.assert_allclose(other, first, rtol=0, atol=1e-14)
    with pytest.raises(InputError, match=f"asks for {third} of a robot with 3 motions"):
        kinematics.poses(robot, AxisMotion(type=third, amplitude=0.1, duration=1.0), t)


def test_limbs_of_the_flexible_robot_keep_what_the_rigid_path_releases():
    robot = ROBOTS["6-FPF"]()
    stiff, free = limbs(robot), limbs(robot, rigid=True)
    assert stiff.pose_closure.all() and not free.pose_closure.any()
    assert (stiff.state[:, 1:3] == 1).all() and (free.state[:, 1:3] == 0).all()
    assert replace(free, state=free.state).plain
