"""Accuracy of a pose: first order against exact, covariance against draws, boxes, play."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers import machines, mechanisms
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.analysis.pose_errors.bent_legs import bent_legs
from flexapod.analysis.pose_errors.error_sources import accuracy_rows
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.pose_errors.tolerances import tolerance_effects
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import ComputationError, InputError
from flexapod.model import Geometry, Gradient, Heat, Joint, LengthSpread, RatioSpread, Tolerances

pytestmark = pytest.mark.consistency

POSE = {"surge": 0.02, "heave": 0.03, "roll": 0.1, "yaw": -0.15}
ROBOTS = {
    "6-UPS": (lambda: paper_robot().robot, POSE),
    "3-RPS": (mechanisms.three_rps, {"heave": 0.03, "roll": 0.08}),
    "6-PUS": (lambda: mechanisms.sliders("PUS"), {"surge": 0.02, "roll": 0.05}),
    "6-RUS": (mechanisms.six_rus, {"surge": 0.01, "roll": 0.03}),
    "3-UPS+UP": (mechanisms.tricept, {"roll": 0.05, "pitch": -0.1}),
}


def errors_of(robot, size, seed=3):
    rng = np.random.default_rng(seed)
    found = {name: size * rng.normal(size=(robot.count, 3)) for name in ("base_joints", "platform_joints")}
    return Geometry(**found, leg_offset=size * rng.normal(size=robot.count))


@pytest.mark.parametrize("kind", ROBOTS)
def test_what_the_first_order_leaves_out_is_of_second_order(kind):
    robot, pose = (x() if callable(x) else x for x in ROBOTS[kind])
    left, sizes = [], (4e-4, 2e-4, 1e-4)
    for size in sizes:
        found = fx.accuracy(robot.replace(geometry=errors_of(robot, size)), pose)
        left.append(np.linalg.norm(found.pose_error - found.pose_error_first_order))
        assert not str(found.attrs["warnings"])
        assert left[-1] < 0.02 * np.linalg.norm(found.pose_error)
    # The next term is smaller by the errors over the size of the robot, 1e-3.
    np.testing.assert_allclose(np.log2(np.divide(left[:-1], left[1:])), 2.0, atol=0.05)


def test_parts_add_up_and_rows_of_a_budget_are_theirs():
    robot = paper_robot().robot.replace(
        geometry=Geometry(leg_offset=1e-5, lead=1e-4),
        heat=Heat(piston=24.0, base=21.0),
        tolerances=Tolerances(base_joints=2e-5, lead=RatioSpread(box=6e-5)),
    )
    study = paper_robot().replace(robot=robot)
    found = fx.accuracy(study, POSE)
    assert list(found.error.values) == ["leg_offset", "lead", "heat_base", "heat_piston"]
    whole = found.pose_error_by_part.sum(("error", "leg"))
    np.testing.assert_allclose(whole, found.pose_error_first_order, atol=1e-18)
    path = kinematics.poses_from_home(robot, np.array([[0.02, 0, 0.03, 0.1, 0, -0.15]]))
    table = accuracy_rows(study, path)
    kinds = [(row.part, row.kind, row.nature) for row in table]
    assert kinds == [
        ("leg_offset", "systematic", "calibratable"), ("lead", "systematic", "calibratable"),
        ("heat_base", "systematic", "drifting"), ("heat_piston", "systematic", "drifting"),
        ("base_joints tolerance", "random", ""), ("lead tolerance", "random", ""),
    ]  # fmt: skip
    np.testing.assert_allclose([row.by_leg for row in table[:4]], found.pose_error_by_part, atol=1e-18)
    np.testing.assert_allclose([row.by_leg for row in table[4:]], found.pose_sigma_by_tolerance, atol=1e-18)
    np.testing.assert_allclose(
        (found.pose_sigma_by_tolerance**2).sum(("tolerance", "leg")), found.pose_sigma**2, rtol=1e-12
    )


def test_a_tolerance_of_the_lead_counts_from_home():
    """Legs that are e (l - l_home) too long; by hand from the distances of the joints."""
    size, robot = 6e-5, paper_robot().robot.replace(tolerances=Tolerances(lead=RatioSpread(box=6e-5)))
    at_home = fx.accuracy(robot, {"heave": 0.0})
    assert (at_home.pose_worst < 1e-17).all()  # rounding of lengths, 1e-16 m, times e
    found = fx.accuracy(robot, {"heave": 0.05})
    up, arms = np.array([0, 0, robot.home_height + 0.05]), robot.platform_joints

    def lengths(move):
        turned = Rotation.from_rotvec(move[3:]).apply(arms - robot.tool) + robot.tool
        return np.linalg.norm(up + move[:3] + turned - robot.base_joints, axis=1)

    home = np.linalg.norm(robot.base_joints - arms - [0, 0, robot.home_height], axis=1)
    J = np.array([(lengths(1e-6 * e) - lengths(-1e-6 * e)) / 2e-6 for e in np.eye(6)]).T
    effect = size * np.linalg.inv(J) * (lengths(np.zeros(6)) - home)
    # Differences over 2 um of lengths known to 1e-16 m: 1e-9 of the Jacobian.
    np.testing.assert_allclose(found.pose_worst, np.abs(effect).sum(axis=1), rtol=1e-6)
    np.testing.assert_allclose(found.pose_sigma, np.sqrt((effect**2).sum(axis=1) / 3), rtol=1e-6)


@pytest.mark.parametrize("kind", ["6-UPS", "3-RPS"])
def test_the_covariance_is_that_of_machines_drawn(kind):
    robot, pose = (x() if callable(x) else x for x in ROBOTS[kind])
    spread = Tolerances(
        base_joints=2e-5, platform_joints=LengthSpread(box=3e-5), leg_offset=1e-5, lead=RatioSpread(box=6e-5)
    )
    found = fx.accuracy(robot.replace(tolerances=spread), pose, draws=10_000, seed=1)
    drawn = np.sqrt(np.diag(found.sample_covariance))
    # The standard deviation of 10,000 draws is known to 1 / sqrt(20,000) = 0.7 %: 3 % are four of these.
    np.testing.assert_allclose(drawn, found.pose_sigma, rtol=0.03)
    outer = np.outer(found.pose_sigma, found.pose_sigma)
    np.testing.assert_allclose(found.sample_covariance / outer, found.pose_covariance / outer, atol=0.05)
    assert (np.abs(found.sample_mean) < 0.05 * found.pose_sigma).all()  # a mean of 10,000: 1 %
    assert int(found.sample_count) == 10_000


def test_the_worst_case_is_attained_in_a_corner_of_the_box():
    robot = paper_robot().robot.replace(tolerances=Tolerances(leg_offset=LengthSpread(box=1e-5), base_joints=2e-5))
    found = fx.accuracy(robot, POSE)
    at = sensitivity(
        kinematics.RigidPoses(robot, kinematics.poses_from_home(robot, np.array([[0.02, 0, 0.03, 0.1, 0, -0.15]])))
    )
    effect = next(
        one for one in tolerance_effects(robot, at, np.zeros(6), lambda: np.zeros((6, 6))) if one.boxed
    ).effect[:, 0]
    corners = np.array([np.array(signs) @ effect for signs in itertools.product((-1, 1), repeat=6)])
    np.testing.assert_allclose(np.abs(corners).max(axis=0), found.pose_worst, rtol=1e-12)
    inside = np.random.default_rng(0).uniform(-1, 1, (1000, 6)) @ effect
    assert (np.abs(inside) <= found.pose_worst.values).all()
    only = robot.replace(tolerances=Tolerances(leg_offset=LengthSpread(box=1e-5)))
    drawn = fx.accuracy(only, POSE, draws=500)
    assert (drawn.sample_largest <= 1.01 * drawn.pose_worst).all()  # exact poses: 1e-4 beside the linear form


def loose(robot, **play):
    drive = play.pop("backlash", None)
    joints = {name: Joint(play=size) for name, size in play.items()}
    legs = tuple(leg.replace(**joints, drive=leg.drive.replace(backlash=drive)) for leg in robot.legs)
    return robot.replace(legs=legs)


def test_play_lies_where_the_force_presses_it():
    robot = loose(paper_robot().robot, base_joint=1e-5, platform_joint=2e-5, backlash=4e-6)
    found = fx.accuracy(
        robot,
        POSE,
    )
    assert found.pressing_force.shape == (3, 6)
    # The leg between its joints as long as forces make it: shorter where they press.
    half = np.array([5e-6, 2e-6, 1e-5])[:, None]
    offset = -(np.sign(found.pressing_force.values) * half).sum(axis=0)
    shifted = fx.accuracy(paper_robot().robot.replace(geometry=Geometry(leg_offset=offset)), POSE)
    np.testing.assert_allclose(found.play_error, shifted.pose_error_first_order, rtol=1e-9, atol=1e-16)
    assert (np.abs(found.play_error) <= found.play_worst).all()


def test_a_change_of_sign_conserves_the_play():
    # A payload that is thrown up and down presses its legs both ways.
    study = paper_robot()
    motion = fx.model.AxisMotion(type="heave", amplitude=0.05, duration=0.08)
    study = study.replace(robot=loose(study.robot, base_joint=1e-5), motion=motion)
    data = fx.play(study)
    assert data.sizes["jump"] >= 6
    assert set(data.jump_place.values) == {"base_joint"}
    assert int(data.sign_changes.sel(place="base_joint").sum()) == data.sizes["jump"]
    path = RigidPath(study, data.jump_time.values)
    for k in range(data.sizes["jump"]):
        # Lengths change by the whole play, 10 um, of that leg alone.
        J = kinematics.drive_jacobian(study.robot, path.poses.part(slice(k, k + 1)), study.robot.tool)[0]
        lengths = J @ data.jump_size.values[k]
        expected = np.zeros(6)
        expected[int(data.jump_leg[k]) - 1] = 1e-5
        np.testing.assert_allclose(np.abs(lengths), expected, atol=2e-8)  # between instants 40 us apart


def test_half_the_travel_of_all_places():
    robot = loose(paper_robot().robot, base_joint=1e-5, backlash=4e-6)
    np.testing.assert_allclose(half_play(robot), np.array([5e-6, 2e-6, 0.0])[:, None] * np.ones(6))
    assert "play_error" not in fx.accuracy(paper_robot().robot)


def test_backlash_of_a_nut_is_that_of_its_drive():
    drive = machines.SCREW.replace(nut=machines.NUT.replace(backlash=8e-6))
    np.testing.assert_allclose(half_play(machines.machine(drive=drive))[1], 4e-6)


def test_backlash_of_a_slider_counts_along_its_way():
    robot = mechanisms.sliders("PUS")
    found = fx.accuracy(loose(robot, backlash=1e-5), {"surge": 0.02})
    sign = np.sign(found.pressing_force.sel(place="drive"))
    at = sensitivity(kinematics.RigidPoses(robot, kinematics.poses_from_home(robot, np.array([[0.02, 0, 0, 0, 0, 0]]))))
    np.testing.assert_allclose(found.play_error, -(sign.values * 5e-6) @ at.coordinate[0, :, 0], atol=1e-19)


def crooked(robot, bow=None, eccentricity=None, **piston):
    legs = tuple(
        leg.replace(
            piston=leg.piston.replace(bow=bow, **piston),
            base_joint=Joint(eccentricity=eccentricity),
            platform_joint=Joint(eccentricity=eccentricity),
        )
        for leg in robot.legs
    )
    return robot.replace(legs=legs)


def test_bent_legs_grow_and_shorten_as_the_beam_column_does():
    # y'' EI + P (y + y0) = 0 outside of the mouth by differences, the rigid part turning with the slope there.
    robot = crooked(mechanisms.hexapod(), bow=1e-3)
    leg, at = robot.legs[0], sensitivity(kinematics.RigidPoses(robot, kinematics.home_pose(robot)))
    m, s, EI = leg.cylinder.mouth, robot.home_lengths[0] - leg.cylinder.mouth, leg.piston.EI
    euler = buckling_load(leg, np.array([s]))[0]
    push = 0.3 * euler
    found = bent_legs(robot, at, np.full(6, push))
    n = 4000
    x, h, k = np.linspace(0, s, n + 1), s / n, np.sqrt(euler / EI)
    start = 1e-3 * np.sin(k * (s - x))
    A = (np.eye(n + 1, k=1) - 2 * np.eye(n + 1) + np.eye(n + 1, k=-1)) / h**2 + push / EI * np.eye(n + 1)
    b = -push / EI * start
    A[0], b[0] = 0, 0.0
    A[0, :3] = m * np.array([-1.5, 2.0, -0.5]) / h  # y = m y' at the mouth
    A[0, 0] -= 1.0
    A[-1], b[-1] = 0, 0.0
    A[-1, -1] = 1.0
    y = np.linalg.solve(A, b) + start
    # Differences are right to (h k)^2 of order 1e-6, and the matrix is worse conditioned by 1 / 0.7.
    np.testing.assert_allclose(found.deflection[0], np.abs(y).max(), rtol=1e-4)
    slopes = [np.trapezoid(np.gradient(z, h) ** 2, x) + z[0] ** 2 / m for z in (y, start)]
    np.testing.assert_allclose(found.shorter[0], 0.5 * (slopes[0] - slopes[1]), rtol=1e-3)
    np.testing.assert_allclose(found.share, 0.3)


def test_eccentric_ends_bend_a_bar_by_the_secant_formula():
    robot = mechanisms.hexapod()
    legs = tuple(
        leg.replace(cylinder=leg.cylinder.replace(mouth=0.0), base_joint=Joint(eccentricity=1e-3),
                    platform_joint=Joint(eccentricity=1e-3))
        for leg in robot.legs
    )  # fmt: skip
    robot = robot.replace(legs=tuple(leg.replace(piston=leg.piston.replace(length=2.0)) for leg in legs))
    at = sensitivity(kinematics.RigidPoses(robot, kinematics.home_pose(robot)))
    euler = np.pi**2 * robot.legs[0].piston.EI / robot.home_lengths**2
    for share in (0.05, 0.3, 0.6):
        found = bent_legs(robot, at, share * euler)
        secant = 1e-3 / np.cos(np.pi / 2 * np.sqrt(share))
        np.testing.assert_allclose(found.deflection, secant, rtol=0.015)  # one half wave: 1 % as the theory says
        k, L = np.pi * np.sqrt(share) / robot.home_lengths, robot.home_lengths
        bending = 0.5 * (1e-3 * k / np.cos(k * L / 2)) ** 2 * (L / 2 - np.sin(k * L) / (2 * k))
        exact = bending + 2e-6 * k * np.tan(k * L / 2)  # and the arms at both ends turn
        assert (found.shorter < exact).all() and (1.24 * found.shorter > exact).all()


def test_a_piston_that_is_warmer_on_one_side_is_bent():
    # 1 K across 27 mm of steel, 0.6 m long, pinned: 11.8e-6 / 0.027 * 0.36 / 8 = 19.7 um.
    robot = paper_robot().robot.replace(heat=Heat(gradient=Gradient(piston=1.0)))
    legs = tuple(leg.replace(cylinder=leg.cylinder.replace(mouth=0.0, com=0.0)) for leg in robot.legs)
    free = robot.replace(legs=tuple(leg.replace(piston=leg.piston.replace(length=2.0)) for leg in legs))
    at = sensitivity(kinematics.RigidPoses(free, kinematics.home_pose(free)))
    sag = 11.8e-6 / 0.027 * free.home_lengths**2 / 8
    found = bent_legs(free, at, np.zeros(6))
    np.testing.assert_allclose(found.deflection, sag, rtol=1e-12)
    # kappa^2 L^3 / 24: the half wave of the same height has 1 % more slope than the arc.
    arc = (11.8e-6 / 0.027) ** 2 * free.home_lengths**3 / 24
    np.testing.assert_allclose(found.shorter, arc, rtol=0.08)
    data = fx.accuracy(robot)
    assert list(data.error.values) == ["bent_legs"] and np.abs(data.pose_error[:3]).max() < 1e-7


def test_bent_legs_are_a_row_and_a_thrust_beyond_the_euler_load_is_said():
    robot = crooked(paper_robot().robot, bow=1e-3, eccentricity=2e-4)
    found = fx.accuracy(robot)
    assert list(found.error.values) == ["bent_legs"]
    assert found.leg_bow.min() > 1e-3 * 0.9 and found.euler_share.max() < 0.05
    assert np.abs(found.pose_error).max() < 1e-6  # second order, as the theory says
    soft = crooked(paper_robot().robot, bow=1e-3, EI=5.0, E=None, density=None)
    with pytest.raises(ComputationError, match="beyond its Euler load"):
        fx.accuracy(soft)


def test_stiffer_pistons_are_longer_under_thrust():
    robot = paper_robot().robot.replace(tolerances=Tolerances(EA=0.01))
    found = fx.accuracy(robot)
    legs = tuple(leg.replace(piston=leg.piston.replace(EA=leg.piston.EA * 1.01, E=None, density=None))
                 if i == 1 else leg for i, leg in enumerate(robot.legs))  # fmt: skip
    drawn, other = (fx.modes(x, fidelity="lumped").com_sag for x in (robot, robot.replace(legs=legs)))
    moved = other - drawn
    share = found.pose_sigma_by_tolerance[0, 1, :3]
    # First order in 1 %, and the sag: parts of a thousand; thrust taken as the mean of both ends.
    np.testing.assert_allclose(np.abs(moved), share, rtol=0.03, atol=1e-12)


@pytest.mark.parametrize("name", ["bow", "EI", "density"])
def test_scatter_of_pistons_is_that_of_pistons_which_differ(name):
    # One leg 1 % off: first order in it, so parts of a hundred beside the square, which only the bow has.
    robot = crooked(machines.machine(), bow=1e-3).replace(
        tolerances=Tolerances(**{name: 1e-5 if name == "bow" else 0.01})
    )
    found = fx.accuracy(robot).pose_sigma_by_tolerance[0, 1]
    leg = robot.legs[1]
    field = {"bow": "bow", "EI": "EI", "density": "rhoA"}[name]
    piston = leg.piston.replace(**{field: 1.01 * getattr(leg.piston, field)})
    other = robot.replace(legs=(robot.legs[0], leg.replace(piston=piston), *robot.legs[2:]))
    if name == "density":
        drawn, heavier = (fx.modes(x, fidelity="assumed-modes").com_sag.values for x in (robot, other))
        still = robot.replace(payload=robot.payload.replace(tool=robot.payload.com))
        moved = heavier - drawn
        found = fx.accuracy(still).pose_sigma_by_tolerance[0, 1]
    else:
        moved = (fx.accuracy(other).pose_error - fx.accuracy(robot).pose_error).values[:3]
    np.testing.assert_allclose(np.abs(moved), found[:3], rtol=0.02, atol=1e-13)


@pytest.mark.parametrize("boxed", [False, True])
@pytest.mark.parametrize("bow", [None, 2e-4])
def test_scatter_of_pistons_is_that_of_machines_drawn(bow, boxed):
    # The square of a bow counts alone where legs are straight: its variance is known to 1 %, that of chi-square.
    def spread(size, kind):
        return kind(box=size) if boxed else kind(sigma=size)

    robot = crooked(machines.machine(), bow=bow)
    given = Tolerances(bow=spread(1e-4, LengthSpread), EI=spread(0.05, RatioSpread))
    heavy = Tolerances(density=spread(0.05, RatioSpread))
    for tolerances in (given, heavy):
        data = fx.accuracy(robot.replace(tolerances=tolerances), draws=10_000, seed=2)
        drawn = np.sqrt(np.diag(data.sample_covariance))
        kept = data.pose_sigma.values > 1e-15  # of bows some picometres
        assert kept[:3].all()
        np.testing.assert_allclose(drawn[kept], data.pose_sigma.values[kept], rtol=0.03)
        if boxed:
            assert (data.sample_largest <= 1.001 * data.pose_worst + 1e-15).all()


def test_scatter_of_bending_where_joints_carry_moments_is_refused():
    robot = mechanisms.three_rps()
    for name, size in (("EI", 0.01), ("bow", 1e-5)):
        with pytest.raises(InputError, match="carry moments") as caught:
            robot.replace(tolerances=Tolerances(**{name: size}))
        assert caught.value.key == f"tolerances.{name}"
    assert fx.accuracy(robot.replace(tolerances=Tolerances(density=0.01))).pose_sigma[2] > 0


def test_redundant_legs_share_errors_by_their_compliance_and_say_so():
    robot = mechanisms.eight()
    found = fx.accuracy(robot.replace(geometry=Geometry(leg_offset=[1e-5, *[0.0] * 7])))
    assert "first order" in found.attrs["warnings"]
    np.testing.assert_array_equal(found.pose_error, found.pose_error_first_order)
    every = fx.accuracy(with_legs(paper_robot(), lambda leg: leg))
    assert not np.abs(every.pose_error).max()
