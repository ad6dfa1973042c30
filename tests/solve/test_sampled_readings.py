"""What a sampled controller reads along a path of large turns, against motion, forces and Newton's law of a result."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers import sampled_springs as springs
from xarray import Dataset

import flexapod as fx
from flexapod.control import StateSpace
from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]

T = 5e-4
COM, TOOL, POINT = np.array([0.03, -0.05, 0.08]), np.array([0.1, 0.07, 0.2]), np.array([0.05, 0.0, 0.3])
GRAVITY = np.array([2.0, -3.0, -8.5])
STUDY = f"""
[robot]
type = "6-UPS"
base = {{ radius = "300 mm", half_angle = "10 deg" }}
platform = {{ radius = "150 mm", half_angle = "12 deg" }}
home_height = "0.9 m"
gravity = {GRAVITY.tolist()}
[payload]
mass = 30
inertia = [0.5, 0.7, 0.9]
com = {COM.tolist()}
tool = {TOOL.tolist()}
[leg]
cylinder = {{ mass = 2, com = 0.1, inertia = 0.05, mouth = "0.3 m" }}
piston = {{ length = "0.75 m", EA = 1e8, EI = 1e4, rhoA = 1.0 }}
stroke = {{ min = "0.6 m", max = "1.25 m" }}
drive = {{ type = "servo", stiffness = 4e5, damping = 300 }}
[motion]
type = "combined"
amplitudes = {{ surge = "30 mm", sway = "-20 mm", heave = "20 mm", roll = "12 deg", pitch = "-8 deg", yaw = "15 deg" }}
duration = "0.1 s"
hold = "20 ms"
[simulation]
fidelity = "rigid"
output_step = "{T} s"
step = "{T / 20} s"
"""
AXES = "xyz"


@dataclass(frozen=True)
class Marched:
    """A result: attitudes and centres of mass of the robot and of the rigid one that is commanded."""

    data: Dataset
    turn: Rotation
    told: Rotation
    com: np.ndarray
    com_told: np.ndarray
    joints: tuple[np.ndarray, np.ndarray]  # of leg 3, in the base and in the platform's axes

    def read(self, name: str) -> np.ndarray:
        """Readings (rows - 1,), which stand beside the instant after their own."""
        return self.data.sensor_reading.sel(sensor=name).values[1:]

    def felt(self, at: np.ndarray) -> np.ndarray:
        """Acceleration less gravity of a point of the payload (rows - 4, 3) in its axes, laid upon the start's."""
        place = self.com + self.turn.apply(at - COM)
        bend = (-place[4:] + 16 * place[3:-1] - 30 * place[2:-2] + 16 * place[1:-3] - place[:-4]) / (12 * T**2)
        return self.turn[0].apply(self.turn[2:-2].inv().apply(bend - GRAVITY))


READ = [
    *(f"tool:{x}" for x in ("x", "y", "z", "rx", "ry", "rz")), *(f"com:{x}" for x in AXES),
    *(f"accelerometer:tool:{x}" for x in AXES), *(f"accelerometer:(0.05, 0, 0.3):{x}" for x in AXES),
    "joint-force:2:x", "joint-force:5:z", "force-sensor:platform:3", "stroke:2", "drive-force:4",
]  # fmt: skip


@pytest.fixture(scope="module")
def marched(tmp_path_factory):
    """Of a controller that reads everything and asks for nothing."""
    file = tmp_path_factory.mktemp("readings") / "study.toml"
    file.write_text(STUDY)
    nothing = StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, len(READ))), C=np.zeros((1, 0)), D=np.zeros((1, len(READ))),
        inputs=tuple(READ), outputs=("drive:1",), states=(), units={}, sample=T,
    )  # fmt: skip
    study = fx.load(file)
    joints = study.robot.base_joints[2], study.robot.platform_joints[2]
    data = fx.simulate(study, controller=nothing, sample=T)
    turn, told = (
        Rotation.from_quat(data[name].values[:, [1, 2, 3, 0]])
        for name in ("platform_quaternion", "platform_quaternion_rigid")
    )
    return Marched(data, turn, told, data.com_position.values, data.com_position_rigid.values, joints)


def assert_read(marched, name, expected, near=1e-9):
    """From the first sample on; of the largest."""
    off = marched.read(name) - (expected - expected[0])[:-1]
    assert np.abs(off).max() < near * np.abs(expected - expected[0]).max()


def test_places_and_turns_beside_the_commanded_path(marched):
    """Rounding of places of a metre in millimetres: 1e-13; rotation vectors by another formula: 1e-9 with room."""
    turned = (marched.turn * marched.told.inv()).as_rotvec()
    tool = marched.com + marched.turn.apply(TOOL - COM) - marched.com_told - marched.told.apply(TOOL - COM)
    assert np.abs(turned).max() > 0.1  # so that an approximation for small turns is none
    for k, axis in enumerate(AXES):
        assert_read(marched, f"tool:{axis}", tool[:, k])
        assert_read(marched, f"tool:r{axis}", turned[:, k])
        assert_read(marched, f"com:{axis}", (marched.com - marched.com_told)[:, k])


def test_accelerometers_feel_the_second_difference_of_their_place(marched):
    """Differences of the fourth order of a vibration of w = 400 rad/s: (w T)^4 / 90 = 2e-5 of it; steps of the march
    are of the second order, (w T / 20)^2 / 12 = 8e-6, in both alike; what rings faster by legs alone gets 1e-3."""
    for name, at in (("tool", TOOL), ("(0.05, 0, 0.3)", POINT)):
        felt = marched.felt(at)
        at_rest = -marched.turn[0].apply(marched.turn[0].inv().apply(GRAVITY))
        for k, axis in enumerate(AXES):
            read = marched.read(f"accelerometer:{name}:{axis}")[2:-1] + at_rest[k]
            # the first reading is at rest: what is read later is counted from it
            assert np.abs(read - felt[:, k]).max() < 1e-3 * np.abs(felt[:, k] - at_rest[k]).max()


def test_forces_and_strokes_of_legs(marched):
    """The line of a leg by hand, from its joint in the base to that on the payload as it has turned."""
    data = marched.data
    assert_read(marched, "joint-force:2:x", data.joint_force.values[:, 1, 0])
    assert_read(marched, "joint-force:5:z", data.joint_force.values[:, 4, 2])
    assert_read(marched, "stroke:2", (data.leg_length - data.leg_length_command).values[:, 1])
    assert_read(marched, "drive-force:4", data.drive_force.values[:, 3])
    line = marched.com + marched.turn.apply(marched.joints[1] - COM) - marched.joints[0]
    along = (data.joint_force.values[:, 2] * line).sum(axis=1) / np.linalg.norm(line, axis=1)
    assert_read(marched, "force-sensor:platform:3", along)


COMMANDS = tuple(f"command:{i}" for i in range(1, 7))


@pytest.mark.parametrize("name", ["force, its sum", "stroke", "limited", "and late"])
def test_commands_of_servos_are_forces_over_their_stiffness(name):
    """A command that jumps by u pulls at once with k u; strokes are read against the path, not against that command.

    As with forces: steps of h are late by (w h)^2 / 12 of the phase, 1.6e-3 of a damped half.
    """
    law, given, own = springs.LAWS[name]
    whole = law.system()
    law_of_places = replace(whole, C=whole.C / springs.K, D=whole.D / springs.K, outputs=COMMANDS)
    if "saturate" in given:
        given = {"saturate": {"command": own["most"] / springs.K}}
    data = fx.simulate(fx.loads(springs.STUDY), controller=law_of_places, step=springs.T / 40, **given)
    z, read, held = springs.Heave().run(law, len(data.time), **own)
    assert np.abs(springs.heave(data) - z).max() < 8e-4 * np.abs(z).max()
    assert data.sensor_reading.values[1:, 3] == pytest.approx(read[:-1], abs=8e-4 * np.abs(read).max())
    assert springs.K * data.control_input.values[1:, 3] == pytest.approx(held[:-1], abs=8e-4 * np.abs(held).max())
    # a command does no work of its own: that is the drive's
    assert np.abs(data.work_control.values).max() == 0.0


def test_commands_that_jump_cost_no_order():
    """Errors against the exact recursion fall as the square of the step."""
    law, errors = springs.LAWS["force, its sum"][0], []
    whole = law.system()
    for parts in (10, 20, 40):
        given = replace(whole, C=whole.C / springs.K, D=whole.D / springs.K, outputs=COMMANDS)
        data = fx.simulate(fx.loads(springs.STUDY), controller=given, step=springs.T / parts)
        errors.append(np.abs(springs.heave(data) - springs.Heave().run(law, len(data.time))[0]).max())
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.1)


def test_readings_go_to_the_nearest_step_and_outputs_to_both_limits():
    """Of a law that hardly acts, with and without steps of its readings; a damper reaches its limits both ways."""
    law = springs.integral(1e-9).system()
    study = fx.loads(springs.STUDY)
    plain, stepped = (fx.simulate(study, controller=law, **given) for given in ({}, {"quantise": 0.3}))
    y = plain.sensor_reading.values
    # away from the middle between two steps, where rounding and what the law does decide
    sure = np.abs(np.abs((y / 0.3) % 1 - 0.5)) > 1e-6
    assert stepped.sensor_reading.values[sure] == pytest.approx((0.3 * np.rint(y / 0.3))[sure], abs=1e-12)
    assert len(np.unique(np.rint(y / 0.3))) > 5 and (y.min(), y.max()) != (0.0, 0.0)
    held = fx.simulate(study, controller=springs.LAWS["stroke"][0].system(), saturate=0.02).control_input.values
    assert (held.min(), held.max()) == (-0.02, 0.02)
