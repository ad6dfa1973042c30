"""Legs as bodies: angles of joints from home and their limits, room between legs; paths, runs, maps, words."""

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.helpers.machines import TUBE, machine, study
from tests.helpers.mechanisms import built, ring
from tests.helpers.samples import sample_study
from typer.testing import CliRunner

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.description.clearance import stroke_ends
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.bodies import CYLINDER, clearance, joint_angles, pairs_of_legs
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.app.cli.cli import app
from flexapod.common.errors import InputError
from flexapod.common.ranking import first_least
from flexapod.kinematics import bodies
from flexapod.kinematics.rotations import exponential
from flexapod.model import Home, to_toml
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.leg import Stroke
from flexapod.output.text.answers import bodies_words

pytestmark = pytest.mark.unit

LIMITED = {"base_joint": Joint(max_angle=0.2), "platform_joint": Joint(max_angle=0.1)}


def test_the_distance_of_two_legs_is_that_of_their_axes_less_the_radii():
    # Two rods of length 1 and one of 0.5 m, thick 0.02 m: crossing at right angles 0.3 m apart; end to end; parallel.
    feet = np.array([[[0, 0, 0], [0.5, -0.5, 0.3], [2.0, 0, 0]]], dtype=float)
    tips = np.array([[[1, 0, 0], [0.5, 0.5, 0.3], [2.0, 0.5, 0]]], dtype=float)
    radii, mouth = np.full((3, 2), 0.01), np.zeros(3)
    for pair, gap in (((0, 1), 0.28), ((0, 2), 0.98), ((1, 2), np.hypot(1.5, 0.3) - 0.02)):
        found = kinematics.nearest_legs(feet, tips, mouth, radii, np.array([pair]))
        assert found.gap == pytest.approx([gap], abs=1e-12)
    assert kinematics.nearest_legs(feet, tips, mouth, radii, np.array([(0, 1), (0, 2), (1, 2)])).legs.tolist() == [
        [0, 1]
    ]


def test_of_legs_equally_near_the_first_two_are_named():
    """Three upright rods on a regular triangle: which pair was the nearest followed the last bits of their places."""
    corners = 0.3 * np.array([[1, 0], [-0.5, 0.75**0.5], [-0.5, -(0.75**0.5)]])
    feet = np.zeros((40, 3, 3))
    feet[..., :2] = corners + 1e-13 * np.random.default_rng(7).normal(size=(40, 3, 2))
    pairs = np.array([(0, 1), (0, 2), (1, 2)])
    found = kinematics.nearest_legs(
        feet, feet + np.array([0.0, 0.0, 1.0]), np.full(3, 0.4), np.full((3, 2), 0.01), pairs
    )
    np.testing.assert_allclose(found.gap, 0.3 * 3**0.5 - 0.02, rtol=0, atol=1e-12)
    assert (found.legs == [0, 1]).all()


def test_distances_are_those_of_a_search():
    # Any two legs, a cylinder and a piston each: the least distance by a search over both, each from its own start.
    rng = np.random.default_rng(5)
    feet, tips = rng.normal(size=(2, 40, 2, 3))
    mouth, radii = np.array([0.4, 0.0]), np.array([[0.05, 0.03], [0.02, 0.02]])
    ours = kinematics.nearest_legs(feet, tips, mouth, radii, np.array([(0, 1)])).gap
    for foot, tip, gap in zip(feet, tips, ours, strict=True):
        share = mouth[0] / np.linalg.norm(tip[0] - foot[0])
        least = np.inf
        for (low, high), radius in (((0, min(share, 1)), 0.05), ((share, 1), 0.03)):
            if high <= low:
                continue
            way = tip - foot
            found = minimize(
                lambda x, way=way, foot=foot: np.sum((foot[0] + x[0] * way[0] - foot[1] - x[1] * way[1]) ** 2),
                [0.5 * (low + high), 0.5], bounds=[(low, high), (0, 1)], tol=1e-15,
            )  # fmt: skip
            least = min(least, np.sqrt(found.fun) - radius - 0.02)
        if share < 1:  # a mouth beyond the tip is refused by the checks
            assert gap == pytest.approx(least, abs=1e-6)


def test_along_a_path_few_pairs_of_bodies_are_looked_at(monkeypatch):
    # Every instant for itself has the same bits, on a path and in any order of its poses.
    path = RigidPath(fx.preset("paper-robot"), np.linspace(0.0, 0.5, 301))
    tips, length = path.place(path.robot.platform_joints), path.legs.length
    looked, apart = [], bodies._apart
    monkeypatch.setattr(bodies, "_apart", lambda *ends: looked.append(ends[0][0].size) or apart(*ends))
    found = clearance(path.robot, tips, path.axes, length)
    assert sum(looked) < 0.25 * len(tips) * 4 * len(pairs_of_legs(path.robot))
    for some in (*(slice(k, k + 1) for k in (0, 31, 32, 150, 300)), np.random.default_rng(1).permutation(301)):
        here = clearance(path.robot, tips[some], path.axes[some], length[some])
        assert np.array_equal(here.gap, found.gap[some]) and np.array_equal(here.legs, found.legs[some])


def test_turns_are_those_of_the_platform_about_a_leg():
    # An upright leg, whose platform rolls by 0.3: it turns by that at the platform alone, wherever home points to.
    for home in ([0, 0, 0], [0.2, -0.1, 0.4]):
        robot = machine().replace(home=Home(position=[0, 0, 1.0], rotation=home))
        rotation = exponential(np.array([[0.3, 0, 0]])) @ robot.home_rotation
        axes = (robot.home_vectors / robot.home_lengths[:, None])[None]
        found = joint_angles(robot, axes, rotation)
        np.testing.assert_allclose(found[..., 0], 0.0, atol=1e-12)
        about = np.arccos(np.clip(0.3**0 - (1 - np.cos(0.3)) * (1 - axes[0, :, 0] ** 2), -1, 1))
        np.testing.assert_allclose(found[0, :, 1], about, atol=1e-9)


def test_legs_that_meet_at_a_joint_and_legs_in_a_plane_are_no_pairs():
    assert len(pairs_of_legs(machine())) == 15
    pairs = built("6-UPS", ring(0.7, [0, 0, 120, 120, 240, 240]), ring(0.4, [60, 300, 60, 180, 180, 300]), 1.0,
                  list(machine().legs), payload=machine().payload)  # fmt: skip
    assert len(pairs_of_legs(pairs)) == 9
    assert pairs_of_legs(sample_study("planar").robot) == []


def test_a_path_beyond_the_angle_of_a_joint_is_refused():
    quick = study(machine(**LIMITED))
    most = fx.simulate(quick, fidelity="rigid").joint_turn
    assert fx.simulate(quick, fidelity="rigid").joint_margin.values.min() > 0
    base = float(most.sel(end="base").max())
    tight = study(machine(base_joint=Joint(max_angle=0.5 * base)))
    with pytest.raises(InputError, match=r"leg \d turns by .* deg from home at its base joint") as caught:
        fx.simulate(tight)
    assert caught.value.key == "leg.base_joint.max_angle"
    assert f"at least {np.rad2deg(base):.4g} deg" in str(caught.value)
    for bad in (-0.1, 0.0, 4.0):
        with pytest.raises(InputError, match="max_angle"):
            Joint(max_angle=bad)


def test_a_run_says_how_much_is_left():
    data = fx.simulate(study(machine(**LIMITED)))
    np.testing.assert_allclose(data.joint_margin, [0.2, 0.1] - data.joint_turn, atol=1e-15)
    words = bodies_words(data)
    assert "the least of all joints" in words[0]
    assert "come nearest to each other" in words[1]
    k = first_least(data.leg_clearance.values)
    assert " and ".join(map(str, data.nearest_legs.values[k])) in words[1]
    assert "joint_margin" not in fx.simulate(study(machine()))


def test_a_map_has_margins_and_leaves_out_what_joints_cannot_reach():
    axes = {"surge": np.linspace(-0.3, 0.3, 7)}
    free, tight = (fx.workspace_map(machine(**joints), axes, fidelity="lumped") for joints in ({}, LIMITED))
    assert (free.reason == 0).all()
    beyond = (free.base_joint_angle > 0.2) | (free.platform_joint_angle > 0.1)
    assert 0 < beyond.sum() < 7
    np.testing.assert_array_equal(tight.reason != 0, beyond)
    least = np.minimum(0.2 - free.base_joint_angle, 0.1 - free.platform_joint_angle)
    np.testing.assert_allclose(tight.joint_margin, least.where(~beyond), atol=1e-12)
    assert "joint_margin" not in free
    assert free.nearest_legs.dims == ("surge", "pair") and (free.nearest_legs[:, 0] < free.nearest_legs[:, 1]).all()
    assert float(free.leg_clearance.min()) == pytest.approx(
        min(_gap(machine(), surge) for surge in axes["surge"]), abs=1e-12
    )


def test_the_two_legs_that_a_map_names_are_those_that_stand_together():
    # Feet of legs 3 and 4 on 0.7 m are moved to 8 deg from each other, 98 mm; all others are 12 deg apart or more, and
    # on the platform legs that are neighbours there are 100 mm apart or more, on 0.4 m.
    lower = np.array([-10.0, 10, 116, 124, 230, 250])
    close = machine(lower=lower, piston=TUBE.replace(diameter=0.02))
    found = fx.workspace_map(close, {"surge": [-0.05, 0.0, 0.05]}, fidelity="lumped")
    np.testing.assert_array_equal(found.nearest_legs, [[3, 4]] * 3)
    said = describe(study(close)).clearance
    feet, tips = close.base_joints[2:4], close.home_height * np.array([0, 0, 1]) + close.platform_joints[2:4]

    def apart(x):
        return np.linalg.norm(np.subtract(*(a + share * (b - a) for share, a, b in zip(x, feet, tips, strict=True))))

    assert said.legs == (3, 4)
    axes = minimize(apart, [0.5, 0.5], bounds=[(0, 1)] * 2)
    assert said.home == pytest.approx(axes.fun - CYLINDER * 0.02, rel=1e-6)  # there both are cylinders
    still = study(close, duration=2e-3, fidelity="rigid")
    run = fx.simulate(still.replace(motion=still.motion.replace(amplitude=0.0)))
    np.testing.assert_array_equal(run.nearest_legs, [[3, 4]] * len(run.time))


def _gap(robot, surge):
    pose = kinematics.home_pose(robot)
    pose = kinematics.Poses.at_rest(pose.position + np.array([surge, 0, 0]), pose.rotation)
    legs = kinematics.inverse_kinematics(robot, pose)
    return clearance(robot, pose.place(robot.platform_joints), kinematics.leg_axes(robot, pose), legs.length).gap[0]


def test_all_legs_at_the_ends_of_their_strokes():
    # Alike legs: the platform rises and sinks without turning, and joints at both ends turn by the same angle.
    robot = machine(**LIMITED, stroke=Stroke(min=0.95, max=1.2))
    short, long = stroke_ends(robot)
    assert short.shortest and not long.shortest
    for end, length in ((short, 0.95), (long, 1.2)):
        flat = robot.home_vectors[0, :2] @ robot.home_vectors[0, :2]
        turn = abs(np.arccos(np.sqrt(flat) / robot.home_lengths[0]) - np.arccos(np.sqrt(flat) / length))
        assert (end.base, end.platform) == pytest.approx((turn, turn), abs=1e-9)
        assert end.margin == pytest.approx(0.1 - turn, abs=1e-9)
        assert end.gap > 0
    assert stroke_ends(machine()) == ()
    apart = robot.legs[0].replace(stroke=Stroke(min=0.95, max=3.0))
    assert stroke_ends(robot.replace(legs=(apart, *robot.legs[1:])))[-1].shortest  # the others do not meet it


def test_thick_legs_run_into_each_other(tmp_path):
    # Pistons as thick as half the way between neighbours, cylinders more: said with legs and instant, not refused.
    robot = machine()
    thick = robot.legs[0].piston.replace(diameter=0.15)
    assert 0.15 * CYLINDER > _gap(robot, 0.0)
    crowded = study(robot.replace(legs=tuple(leg.replace(piston=thick) for leg in robot.legs)))
    assert any("run into each other" in line for line in fx.simulate(crowded, fidelity="rigid").warnings.splitlines())
    file = tmp_path / "mine.toml"
    file.write_text(to_toml(study(machine(**LIMITED))), encoding="utf-8")
    assert "max_angle" in file.read_text(encoding="utf-8")
    said = CliRunner().invoke(app, ["check", str(file)])
    assert said.exit_code == 0
    assert "of 11.46 deg" in said.output
    assert "come nearest to each other" in said.output
