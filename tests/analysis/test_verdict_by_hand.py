"""Verdicts by formulas in a line or two: gears, oil, pivots, payloads, temperatures over time, drives at rest."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.envelope import envelope
from flexapod.analysis.requirements.states import warm_heat
from flexapod.analysis.results.bodies import clearance
from flexapod.common.arrays import Array
from flexapod.design import first_robot
from flexapod.design.optimisation.problem import read_problem
from flexapod.design.optimisation.search import Evaluation
from flexapod.design.sensitivity import _factor
from flexapod.design.variants import Variants
from flexapod.kinematics.envelope import Box
from flexapod.model import ConstantWrench, Heat, Load, Study

pytestmark = pytest.mark.consistency
EXAMPLES = Path(__file__).parents[2] / "examples" / "mechanisms"
GEARED = {"leg[3].drive.rotor.ratio": 2.0, "leg[3].drive.lead": "1.5 mm"}
GRAVITY = [2.0, -3.0, -9.0]


@pytest.fixture(scope="module")
def stage() -> Study:
    """The stage of 25 kg, its gravity tilted, its tool off the middle."""
    request = first_robot.parse_request("home=184.3 mm, payload=25 kg, stroke=70.94 mm")
    found = fx.loads(first_robot.first_robot(request))
    return found.with_values({"robot.gravity": GRAVITY, "payload.tool": [0.05, -0.03, 0.227]})


def judged(study: Study, **asked: object):
    return fx.verdict(study.replace(requirement=fx.model.Requirement(**asked)))


def number(data, name: str) -> float:
    return float(data.found.sel(requirement=name))


def pushed(study: Study, at: kinematics.Poses) -> Array:
    """Forces of the drives at rest, (P, legs), by the public call."""
    return np.array(kinematics.inverse_dynamics(study.robot, at).actuator_force)


def test_a_gear_makes_the_screw_slower(stage: Study) -> None:
    """3000 rpm over 2 times 1.5 mm: the third leg is the slowest."""
    data = judged(stage.with_values(GEARED), velocity="1 mm/s")
    assert number(data, "velocity") == pytest.approx(50 / 2 * 1.5e-3, rel=1e-9)
    assert int(data.leg[0]) == 3


def test_a_gear_makes_the_screw_stronger_at_rest(stage: Study) -> None:
    """Thrust times lead over a turn of the motor, without friction, of which a corner asks most."""
    geared = stage.with_values({
        **GEARED, "leg[3].drive.limits": {"torque": "0.004 N m"}, "motion.duration": "1000 s",
        "motion.amplitude": "0.01 mm", "leg.drive.efficiency": 1.0, "leg.drive.friction": {"torque": "1e-9 N m"},
    })  # fmt: skip
    data = judged(geared, travel={"surge": "10 mm"}, force_margin=0.1)
    path = kinematics.poses_from_home(
        stage.robot, np.outer([0.0, -1.0, 1.0], np.eye(6)[0] * 0.01), None, stage.robot.tool
    )
    turn, limits = np.full(6, 1e-3), np.full(6, 0.06)
    turn[2], limits[2] = 1.5e-3 / 2, 0.004
    shares = np.abs(pushed(geared, path)) * turn / (2 * np.pi) / limits
    pose, leg = np.unravel_index(shares.argmax(), shares.shape)
    assert (pose > 0, leg) == (True, 2)
    assert number(data, "force_margin") == pytest.approx(1 / shares.max(), rel=3e-3)  # of where it sags to
    one = data.sel(requirement="force_margin")
    assert (int(one.leg), one.pose.item()) == (3, ("", "surge -10 mm", "surge 10 mm")[pose])


def test_oil_fills_the_larger_area() -> None:
    study = fx.preset("motion-base")
    oil = study.robot.legs[0].cylinder_of_oil
    assert max(oil.areas) > 1.5 * min(oil.areas)
    found = number(judged(study, velocity="1 m/s"), "velocity")
    assert found == pytest.approx(oil.limits.flow / max(oil.areas), rel=1e-9)


@pytest.mark.parametrize("pivot", ["tool", "platform", [0.02, 0.01, -0.05]])
def test_turns_leave_their_pivot_in_place(stage: Study, pivot: object) -> None:
    data = judged(stage, rotation="2 deg", pivot=pivot, first_frequency="1 Hz")
    robot = stage.robot
    point = {"tool": robot.tool, "platform": np.zeros(3)}[pivot] if isinstance(pivot, str) else np.array(pivot)
    path = kinematics.poses_from_home(robot, data.worst_pose.sel(requirement="first_frequency").values[None])
    assert path.place(point) == pytest.approx(kinematics.home_pose(robot).place(point), abs=1e-12)
    assert np.abs(path.rotation[0] - kinematics.home_pose(robot).rotation[0]).max() > 0.03


def test_the_warm_instant_is_that_of_the_farthest_drift(stage: Study) -> None:
    """Of all rows that where the tool has moved farthest, as budgets of constant temperatures say."""
    rows = [[20.0, 20.0, 20.0], [26.0, 22.0, 21.0], [21.0, 29.0, 27.0], [24.0, 24.0, 24.0]]
    robot = stage.robot
    table = Heat(time=[0, 10, 20, 30], columns=("base", "screw", "piston"), table=rows)
    cold = fx.budget(stage.replace(robot=robot.replace(heat=None))).budget_total.sel(kind="systematic").values[:3]
    moved = []
    for base, screw, piston in rows:
        heat = Heat(base=base, screw=screw, piston=piston)
        one = fx.budget(stage.replace(robot=robot.replace(heat=heat)))
        moved.append(np.linalg.norm(one.budget_total.sel(kind="systematic").values[:3] - cold))
    base, screw, piston = rows[int(np.argmax(moved))]
    found = warm_heat(robot.replace(heat=table))
    assert (found.base, found.screw[0], found.piston[0]) == (base, screw, piston)


def test_the_light_payload_counts_along_the_motion(stage: Study) -> None:
    """A load of 300 N upwards and a payload of 30 kg hold each other; without it the screws are pulled."""
    lifted = stage.with_values({"robot.gravity": [0, 0, -9.81]}).replace(
        load=Load(wrench=ConstantWrench(value=[0, 0, 300.0, 0, 0, 0]))
    )
    names = {"life": "1 h", "force_margin": 0.1, "stress_factor": 1}
    both = judged(lifted, payload=["2 kg", "30 kg"], **names)
    single = {mass: judged(lifted, payload=f"{mass} kg", **names) for mass in (2, 30)}
    for name in names:
        assert number(both, name) == min(number(one, name) for one in single.values()), name
    assert number(both, "stress_factor") == number(single[2], "stress_factor") < number(single[30], "stress_factor")


def test_acceleration_of_the_worse_payload(stage: Study) -> None:
    both = judged(stage, payload=["5 kg", "25 kg"], acceleration="1 m/s^2")
    assert number(both, "acceleration") == min(
        number(judged(stage, payload=f"{mass} kg", acceleration="1 m/s^2"), "acceleration") for mass in (5, 25)
    )


def test_a_corrected_accuracy_keeps_what_heat_does(stage: Study) -> None:
    """The controller knows the sag of the robot as drawn under its own payload, neither heat nor another payload."""
    bare = stage.replace(robot=stage.robot.replace(tolerances=None))
    drawn = bare.replace(robot=bare.robot.replace(heat=None))

    def moved(study: Study) -> Array:
        return np.array(fx.budget(study).budget_total.sel(kind="systematic").values[:3])

    data = judged(bare, pose_accuracy_corrected="1 um")
    assert number(data, "pose_accuracy_corrected") == pytest.approx(
        np.linalg.norm(moved(bare) - moved(drawn)), rel=1e-9
    )
    assert str(data.state.values[0]) == "warm, 25 kg"


def test_accuracies_and_repeatability_are_those_of_budgets(stage: Study) -> None:
    asked = {"pose_accuracy": "1 um", "pose_accuracy_calibrated": "1 um", "repeatability": "1 um"}
    data = judged(stage.replace(robot=stage.robot.replace(heat=None)), travel={"heave": "5 mm"}, **asked)
    cold = stage.replace(robot=stage.robot.replace(heat=None))
    budgets = [fx.budget(cold, {"heave": z}) for z in (-0.005, 0.0, 0.005)]
    for name, part in (
        ("pose_accuracy", lambda one: one.pose_accuracy.sel(state="uncalibrated")),
        ("pose_accuracy_calibrated", lambda one: one.pose_accuracy.sel(state="calibrated")),
        ("repeatability", lambda one: one.repeatability_bidirectional),
    ):
        expected = max(np.linalg.norm(part(one).values[..., :3]) for one in budgets)
        assert number(data, name) == pytest.approx(expected, rel=1e-9), name


def test_singularity_is_the_least_of_the_box() -> None:
    study = fx.preset("machine-hexapod")
    data = judged(study, travel={"heave": "20 mm"}, rotation={"yaw": "30 deg"}, singularity=0.1)
    values = np.array([[0, 0, z, 0, 0, a] for z in (-0.02, 0, 0.02) for a in np.deg2rad([-30, 0, 30])])
    at = kinematics.RigidPoses(study.robot, kinematics.poses_from_home(study.robot, values, None, study.robot.tool))
    least = at.singularity.smallest_singular_value
    assert number(data, "singularity") == pytest.approx(least.min(), rel=1e-9)
    assert least.min() < 0.99 * least.max()


def test_clearance_is_the_least_of_the_box() -> None:
    """Legs that a yaw leads towards each other: by the turned robot alone."""
    study = fx.preset("paper-robot")
    data = judged(study, rotation={"yaw": "40 deg", "pitch": "10 deg"}, clearance="0 m")
    alone = []
    for yaw in (-40, 0, 40):
        for pitch in (-10, 0, 10):
            pose = np.array([[0, 0, 0, 0, np.deg2rad(pitch), np.deg2rad(yaw)]])
            path = kinematics.poses_from_home(study.robot, pose, None, study.robot.tool)
            at = kinematics.RigidPoses(study.robot, path)
            tips = path.place(study.robot.platform_joints)
            nearest = clearance(study.robot, tips, at.directions, at.reach.length)
            assert nearest is not None
            alone.append(nearest.gap[0])
    assert number(data, "clearance") == pytest.approx(min(alone), rel=1e-12)
    assert min(alone) < 0.99 * max(alone)


@pytest.mark.parametrize("end", [-0.15, 0.15])
def test_carriages_leave_either_end(end: float) -> None:
    """Upright rails of 0 to 0.6 m: a heave moves all carriages by as much."""
    robot = fx.load(EXAMPLES / "hexaglide.toml").robot
    home = kinematics.RigidPoses(robot, kinematics.home_pose(robot)).reach.carriage[0]
    found = envelope(robot, Box.from_ranges({"heave": (min(end, -0.02), max(end, 0.02))})).carriage
    assert found is not None
    place = home.max() + end if end > 0 else home.min() + end
    assert found.value == pytest.approx(place, rel=1e-9)
    assert found.margin == pytest.approx(0.6 - place if end > 0 else place, rel=1e-9)
    assert found.limit == (0.6 if end > 0 else 0.0)


def test_screws_count_at_rest_in_the_corners(stage: Study) -> None:
    """A motion of 1 mm and a box of 30 mm: a fourth of Euler's load, half allowed, of the shaft drawn out most."""
    small = stage.with_values({"motion.amplitude": "1 mm", "motion.duration": "20 s"})
    data = judged(small, travel={"heave": ["0 mm", "30 mm"]}, buckling_factor=1)
    robot = small.robot
    path = kinematics.poses_from_home(robot, np.array([[0, 0, 0.03, 0, 0, 0]]), None, robot.tool)
    screw, along = robot.legs[0].screw, kinematics.RigidPoses(robot, path).reach.length[0] - robot.legs[0].begins
    euler = 0.25 * np.pi**2 * screw.material.E * np.pi / 64 * screw.root_diameter**4 / along**2
    expected = (0.5 * euler / np.maximum(pushed(small, path)[0], 1e-9)).min()
    assert number(data, "buckling_factor") == pytest.approx(expected, rel=3e-3)


def test_a_payload_that_buckles_all_poses_is_not_judged() -> None:
    data = judged(fx.preset("paper-robot").with_values({"payload.mass": 1e4}), pose_accuracy_calibrated="1 um")
    assert not data.judged.any()
    assert "buckles" in str(data.why.values[0])


def test_slopes_at_a_bound_are_those_inside() -> None:
    """Differences to one side: area of the piston 2 D per D."""
    study = fx.preset("paper-robot")
    variants = Variants(study)
    thick = {"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm"}
    problem = read_problem({"variables": [thick], "objective": {"minimise": "piston_mass"}}, variants)
    found = Evaluation(problem, variants, None)
    for place, width in ((0.0, 15e-3), (0.5, 37.5e-3), (1.0, 60e-3)):
        at = np.array([place])
        mass = found.at(at, ()).outputs["piston_mass"]
        slope = found.slopes(at, ())["piston_mass"][0]
        assert slope == pytest.approx(2 * mass / width * 45e-3, rel=1e-3)


def test_stiffnesses_are_doubled_and_errors_halved() -> None:
    for dimension in ("stiffness", "rotational stiffness", "axial stiffness", "bending stiffness"):
        assert _factor("leg.any", [SimpleNamespace(dimension=dimension)]) == 2.0  # type: ignore[list-item]
    assert _factor("tolerances.base_joints", []) == 0.5
    assert np.isnan(_factor("payload.mass", [SimpleNamespace(dimension="mass")]))  # type: ignore[list-item]


def test_multipliers_have_the_sign_of_differences() -> None:
    """Of a limit from above, of an objective that is most and of one that is least: by optima of two limits."""
    study, thick = fx.preset("paper-robot"), {"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm"}
    for objective, name, limits in (
        ({"maximise": "first_frequency"}, "piston_mass", ({"most": 20.0}, {"most": 20.2})),
        ({"minimise": "piston_mass"}, "static_deviation_size", ({"most": 20e-6}, {"most": 20.2e-6})),
    ):
        one, other = (
            fx.optimise(study, {"variables": [thick], "objective": objective, "constraints": {name: limit}})
            for limit in limits
        )
        assert one.attrs["status"] == "kept"
        slope = (other.objective - one.objective).item() / (limits[1]["most"] - limits[0]["most"])
        assert one.multiplier.item() == pytest.approx(slope, rel=0.03), name
