"""Compensated studies where the robot goes: equilibria by `fx.modes`, motion by `fx.simulate`, files by commands."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.samples import sample_study
from typer.testing import CliRunner

import flexapod as fx
from flexapod.analysis import check_path
from flexapod.app.cli.cli import app
from flexapod.commissioning.feedforward.stable_inversion import elastic_compensation
from flexapod.kinematics import coordinates, poses
from flexapod.model.file.files import preset_text

pytestmark = pytest.mark.consistency

SIX = ("paper-robot", "paper-robot-radii", "flight-simulator", "machine-hexapod", "small-hexapod", "nano-hexapod")
INSTANTS = (0.0, 0.31, 0.5, 0.82, 1.0)  # of the motion's duration; none of them a Chebyshev point but the ends


def placed(study: fx.Study, motion: fx.model.Motion, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Place of the platform's origin and attitude of coordinates about the pivot, by SciPy's rotations."""
    x = coordinates(motion, share * study.motion.duration).position[0]
    R0, pivot = study.robot.home_rotation, study.motion.pivot
    R = Rotation.from_euler("xyz", x[3:]).as_matrix() @ R0
    return study.robot.home_position + R0 @ pivot + x[:3] - R @ pivot, R


def loaded_tool(study: fx.Study, motion: fx.model.Motion, share: float) -> np.ndarray:
    """Tool of the equilibrium at the pose that is commanded, as `fx.modes` finds it."""
    p, R = placed(study, motion, share)
    angles = Rotation.from_matrix(R @ study.robot.home_rotation.T).as_euler("xyz")
    pose = np.concatenate([p - study.robot.home_position, angles])
    found = fx.modes(study, pose=pose)
    w, *xyz = found.platform_quaternion.values
    return found.platform_position.values + Rotation.from_quat([*xyz, w]).as_matrix() @ study.robot.tool


@pytest.mark.parametrize("name", SIX)
def test_one_correction_leaves_a_thousandth_of_the_static_miss(name: str) -> None:
    study = fx.preset(name)
    ahead = fx.compensate(study, corrections=1)
    before, after = [], []
    for share in INSTANTS:
        p, R = placed(study, study.motion, share)
        wanted = p + R @ study.robot.tool
        before.append(np.linalg.norm(loaded_tool(study, study.motion, share) - wanted))
        after.append(np.linalg.norm(loaded_tool(study, ahead.motion, share) - wanted))
    assert max(after) < 1e-3 * max(before)
    assert ahead.robot == study.robot


def test_a_robot_of_three_motions_has_its_tool_on_the_path_in_what_it_commands() -> None:
    """The tool of a delta is met in all three; turns of its platform by weight are left."""
    study = sample_study("delta")
    own, ahead = fx.simulate(study), fx.simulate(fx.compensate(study))
    miss = [np.linalg.norm((x.tool_position - own.tool_position_rigid).values[0]) for x in (own, ahead)]
    # two corrections by differences of 1e-6 leave the square of what one leaves, 1e-3
    assert miss[1] < 1e-4 * miss[0]


def test_inertia_made_up_for_leaves_a_twentieth_of_the_miss_in_motion() -> None:
    study = fx.preset("machine-hexapod")
    own = fx.simulate(study)
    wanted = own.tool_position_rigid
    miss = {order: fx.simulate(fx.compensate(study, order)).tool_position - wanted for order in (0, 2)}
    peak = {order: np.linalg.norm(x, axis=1).max() for order, x in miss.items()}
    assert peak[2] < 0.05 * np.linalg.norm(own.tool_position - wanted, axis=1).max()
    assert peak[2] < 0.05 * peak[0]  # what moves of it alone


def test_the_file_does_what_the_study_does(tmp_path: Path) -> None:
    study = fx.preset("small-hexapod")
    ahead = fx.compensate(study, out=tmp_path / "ahead.toml")
    assert (tmp_path / "ahead.csv").exists()
    again = fx.load(tmp_path / "ahead.toml")
    assert np.array_equal(again.motion.pose, ahead.motion.pose)
    assert np.array_equal(again.motion.time, ahead.motion.time)
    told = CliRunner().invoke(app, ["check", str(tmp_path / "ahead.toml"), "--json"])
    assert told.exit_code == 0, told.output
    assert json.loads(told.stdout)
    np.testing.assert_array_equal(fx.simulate(again).tool_position, fx.simulate(ahead).tool_position)


def test_words_say_what_it_brings() -> None:
    (said,) = fx.compensate(fx.preset("paper-robot")).notes
    assert "less than 1 pm in place of 17.7 µm" in said
    assert "lie beside the wanted path" in said


def test_a_path_that_leaves_the_workspace_is_refused_with_its_instant() -> None:
    study = fx.preset("paper-robot")
    with pytest.raises(fx.InputError, match="t = "):
        fx.compensate(study.replace(motion=study.motion.replace(amplitude=1.5)))


def test_commands_that_leave_the_stroke_are_refused_where_the_path_does_not() -> None:
    """The longest leg has room for half of what its commands need beyond the path."""
    study = fx.preset("paper-robot")
    longest = fx.inverse_kinematics(study).leg_length_command.max().item()
    farther = fx.inverse_kinematics(fx.compensate(study)).leg_length_command.max().item()
    assert farther > longest + 1e-6
    legs = tuple(leg.replace(stroke=leg.stroke.replace(max=0.5 * (longest + farther))) for leg in study.robot.legs)
    tight = study.replace(robot=study.robot.replace(legs=legs))
    check_path(tight)
    with pytest.raises(fx.InputError, match="commanded path that makes up for the deviation") as refused:
        fx.compensate(tight)
    assert "t = " in str(refused.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"load": fx.model.Load(wrench=fx.model.StepWrench(amplitude=[0, 0, 9.0, 0, 0, 0], time=0.5))}, "jumps"),
        ({"motion": fx.model.AxisMotion(type="heave", amplitude=0.01, duration=1.0, profile="trapezoid")}, "jump"),
    ],
)
def test_what_would_have_to_jump_is_refused(change: dict[str, object], words: str) -> None:
    with pytest.raises(fx.InputError, match=words):
        fx.compensate(fx.preset("paper-robot").replace(**change), 2)


@pytest.mark.parametrize(("given", "key"), [({"order": 1}, "order"), ({"corrections": 0}, "corrections")])
def test_numbers_that_mean_nothing_are_refused(given: dict[str, int], key: str) -> None:
    with pytest.raises(fx.InputError, match=key):
        fx.compensate(fx.preset("paper-robot"), **given)


def test_elastic_motion_made_up_for_leaves_less_than_inertia_alone() -> None:
    """A way of two periods of the first mode: the march against the wanted path, which begins a little later."""
    study = fx.preset("paper-robot")
    motion = fx.model.AxisMotion(type="surge", amplitude=0.02, duration=0.1, profile="smooth", hold=0.1)
    exact = study.simulation.replace(duration=None, tolerance=1e-5, output_step=5e-4)
    study = study.replace(motion=motion, simulation=exact)
    found = elastic_compensation(study)
    peak, turned = {}, 0.0
    for name, ahead, early in (
        ("own", study, 0.0),
        ("inertia", fx.compensate(study, 2), 0.0),
        ("elastic", found.study, found.early),
    ):
        data = fx.simulate(ahead)
        t = np.maximum(data.time.values - early, 0.0)
        wanted = poses(study.robot, motion, t).place(study.robot.tool)
        peak[name] = np.linalg.norm(data.tool_position.values - wanted, axis=1).max()
        leaning = data.rotation_deviation.values - data.rotation_deviation.values[0]
        turned = turned or np.linalg.norm(leaning, axis=1).max()
    # what is missed without commands is linear in the march to its own angle, 2e-3, and what turns meanwhile
    assert found.turned[0] == pytest.approx(turned, rel=0.01)
    # light legs are springs: commands are the path and its acceleration, none before it and after
    assert found.early == found.late == 0.0
    assert peak["elastic"] < 2e-3 * peak["own"]
    assert peak["elastic"] < 0.5 * peak["inertia"]
    assert "before the path begins" in found.study.notes[-1]


def test_a_machine_on_soft_feet_is_answered_after_the_path() -> None:
    """Its base rings long after the path: what is told to the drives then keeps the tool where it should be."""
    feet = {"stiffness": [3e7, 3e7, 5e7, 3e6, 3e6, 4e6], "loss": 0.02, "mass": 350.0, "inertia": [60.0, 60.0, 100.0]}
    text = preset_text("machine-hexapod")
    told = ", ".join(f"{key} = {value}" for key, value in feet.items())
    study = fx.loads(text.replace("[robot]\n", f"[robot]\nbase_mount = {{ {told} }}\n"))
    brisk = study.motion.replace(duration=0.3, hold=0.3)
    study = study.replace(motion=brisk, simulation=study.simulation.replace(modes=1))
    found = elastic_compensation(study)
    peak = []
    for ahead, early in ((study, 0.0), (fx.compensate(study, 2), 0.0), (found.study, found.early)):
        data = fx.simulate(ahead)
        wanted = poses(study.robot, brisk, np.maximum(data.time.values - early, 0.0)).place(study.robot.tool)
        peak.append(np.linalg.norm(data.tool_position.values - wanted, axis=1).max())
    assert found.late > 0.1
    assert peak[1] < 0.2 * peak[0]
    assert peak[2] < 0.02 * peak[0]


def test_robots_whose_elastic_motion_is_not_inverted_are_refused() -> None:
    with pytest.raises(fx.InputError, match="six motions"):
        fx.compensate(fx.preset("tripod"), "stable-inversion")


def test_what_is_not_to_be_made_up_for_is_not():
    """Without what warms it commands are those of the cold machine as drawn; with it they differ by micrometres."""
    study = fx.preset("machine-hexapod")
    assert study.robot.heat is not None
    drawn = study.replace(robot=study.robot.replace(geometry=None, heat=None))
    left, plain, whole = (
        fx.compensate(x, corrections=1, as_built=built).motion
        for x, built in ((study, False), (drawn, True), (study, True))
    )
    np.testing.assert_allclose(left.pose, plain.pose, atol=1e-12)
    assert np.abs(whole.pose - left.pose)[:, :3].max() > 1e-6
