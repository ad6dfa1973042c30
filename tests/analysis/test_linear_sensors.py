"""Sensors of the linear model by hand: what lies between them is a mass, a gravity, a filter."""

import numpy as np
import pytest
from tests.helpers import motor_loops as motors
from tests.helpers.machines import BASE, machine, study

import flexapod as fx
from flexapod.verification.cases.linear import stewart

pytestmark = pytest.mark.analytic

HZ = np.array([3.0, 40.0, 300.0])
S = 2j * np.pi * HZ


def test_force_sensors_differ_by_the_mass_between_them():
    # a strut's lower rod turns about the base joint, its upper one, 0.1 kg, moves along: m s^2 of the stroke
    lin = fx.linearize(stewart(), inputs=["wrench", "drive"], outputs=["force-sensor:base", "force-sensor:drive",
                       "force-sensor:platform", "drive-force", "stroke", "joint-force"])  # fmt: skip
    base, drive, platform, force, stroke = (
        lin.select(None, name).at(HZ)
        for name in ("force-sensor:base", "force-sensor:drive", "force-sensor:platform", "drive-force", "stroke")
    )
    assert base - platform == pytest.approx(0.1 * S**2 * stroke, abs=1e-9 * np.abs(base).max())
    assert drive == pytest.approx(base, abs=1e-9 * np.abs(base).max())  # nothing of the lower rod moves along
    assert (drive == force).all()
    # and the forces on the platform carry it: sum of the joint forces and the wrench are its momentum
    joints = lin.select("wrench:fx", "joint-force").at(HZ)[:, 0].reshape(6, 3, -1).sum(axis=0)
    com = fx.linearize(stewart(), inputs="wrench", outputs="com").select("wrench:fx").at(HZ)[:, 0]
    assert joints + np.eye(3)[:, :1] == pytest.approx(S**2 * com, abs=1e-9)


def test_a_floor_that_moves_is_felt_at_the_base():
    # up and down, all struts alike: the forces on the base carry the whole robot, 1 kg and twelve rods less what the
    # lower rods weigh across: their mass along the strut is with the base
    lin = fx.linearize(stewart(), inputs="floor", outputs=["force-sensor:base", "force-sensor:platform", "stroke"])
    i = list(lin.inputs).index("floor:z")
    H = lin.at([5.0])[:, i, 0]
    base, platform, stroke = H[:6], H[6:12], H[12:]
    tips, feet = stewart().robot.platform_joints, stewart().robot.base_joints
    up = ((tips - feet) / np.linalg.norm(tips - feet, axis=1)[:, None])[:, 2]
    s = 2j * np.pi * 5.0
    # both rods move with the floor along the strut, the upper one by its stroke more
    assert base - platform == pytest.approx(0.2 * up + 0.1 * s**2 * stroke, rel=1e-9)


@pytest.mark.parametrize("name", ["machine-hexapod", "paper-robot"])
def test_accelerometers_feel_gravity_as_they_tilt(name):
    given = fx.preset(name)
    lin = fx.linearize(given, inputs="wrench", outputs=["tool", "accelerometer:tool", "accelerometer:com", "com"])
    tool, com = (lin.select(None, f"{x}").at(HZ) for x in ("tool", "com"))
    place, turn = tool[:3], tool[3:]
    tilt = np.einsum("ij,jkf->ikf", np.cross(np.eye(3), given.robot.gravity).T, turn)  # theta x g
    for at, where in (("tool", place), ("com", com)):
        felt = lin.select(None, f"accelerometer:{at}").at(HZ)
        assert felt == pytest.approx(S**2 * where + tilt, abs=1e-9 * np.abs(felt).max())


def test_a_slow_floor_moves_an_accelerometer_with_it():
    given = fx.preset("machine-hexapod")
    given = given.replace(robot=given.robot.replace(gravity=np.zeros(3)))
    lin = fx.linearize(given, inputs="floor", outputs="accelerometer:tool")
    H = lin.at([1e-2])[..., 0]
    tool = lin.position + given.robot.tool - given.robot.com  # upright, 30 um up: its legs are warm
    expected = np.concatenate([np.eye(3), np.cross(np.eye(3), tool).T], axis=1)
    assert H == pytest.approx(expected, abs=1e-6)  # (f / 56 Hz)^2


def test_a_geophone_filters_velocity():
    lin = fx.linearize(fx.preset("machine-hexapod"), inputs="wrench",
                       outputs=["accelerometer:tool", "geophone:tool[2 Hz, 0.6, 28.8]"])  # fmt: skip
    felt, shown = lin.select(None, "accelerometer").at(HZ), lin.select(None, "geophone").at(HZ)
    w = 2 * np.pi * 2.0
    assert shown == pytest.approx(28.8 * S / (S**2 + 1.2 * w * S + w**2) * felt, rel=1e-9)
    assert lin.units["geophone:tool:x"] == "V" and lin.outputs[3:] == tuple(f"geophone:tool:{x}" for x in "xyz")
    assert len(lin.states) == 180 + 6


def test_encoders_show_what_loops_hold():
    # a loop that sums its error holds what it measures: of a slow force on the tool nothing is left of it
    hold = motors.real(motors.JOINTS)
    lin = fx.linearize(study(hold, fidelity="lumped"), inputs="wrench", outputs=["encoder", "stroke", "tool"])
    H = lin.at([1e-4])[:, :, 0]
    assert np.abs(H[:6]).max() < 1e-3 * np.abs(H[6:12]).max()


def test_a_command_is_followed_slowly():
    # what drives are told the tool follows; forces are those of the motion. From the command s^2 times the response
    given = fx.preset("paper-robot")
    lin = fx.linearize(given, inputs="command", outputs=["stroke", "tool"])
    s = 2j * np.pi * 1e-3
    H = s**2 * lin.at([1e-3])[:, :, 0]
    assert H[:6] == pytest.approx(np.eye(6), abs=1e-9)
    up = []
    for heave in (1e-4, -1e-4):
        path = fx.kinematics.poses_from_home(given.robot, np.array([[0, 0, heave, 0, 0, 0]]))
        up.append(fx.kinematics.inverse_kinematics(given.robot, path).length[0])
    step = (up[0] - up[1]) / 2e-4
    # the whole robot as straight legs have it, but for what 16 um of sag turn
    assert (H[6:] @ step).real == pytest.approx(np.eye(6)[2], abs=1e-3)


def test_a_tool_is_seen_from_the_base_plate_too():
    # the plate turned and displaced as one with the rigid machine on it: seen from the plate nothing moves
    given = study(machine().replace(base_mount=BASE), fidelity="lumped")
    lin = fx.linearize(given, inputs="wrench", outputs=["tool", "tool-base", "com", "com-base"])
    H = lin.at([0.01])[:, :, 0].real
    stiff = fx.linearize(study(machine(), fidelity="lumped"), inputs="wrench", outputs=["tool", "com"])
    alone = stiff.at([0.01])[:, :, 0].real
    # weight of a ton on a base that has sagged by 3e-5 turns forces by as much
    assert H[6:12] == pytest.approx(alone[:6], abs=1e-3 * np.abs(alone[:6]).max())
    assert H[15:18] == pytest.approx(alone[6:], abs=1e-3 * np.abs(alone[6:]).max())
    assert np.abs(H[:6] - alone[:6]).max() > 0.1 * np.abs(alone[:6]).max()
    found = lin.descriptor()
    assert found.outputs == lin.outputs and found.C.shape == (18, len(found.coordinates))


def test_two_geophones_of_different_numbers_at_one_point():
    """Each is its own filter of the acceleration there; the second has its numbers in its name."""
    names = [
        "geophone:tool",
        "geophone:tool[2 Hz, 0.6, 28.8]",
        "geophone:tool[2 Hz, 0.6, 28.8]:x",
        "accelerometer:tool",
    ]
    lin = fx.linearize(fx.preset("nano-hexapod"), inputs="wrench", outputs=names)
    second = [f"geophone:tool[2 Hz, 0.6, 28.8]:{x}" for x in "xyz"]
    assert lin.outputs == (*(f"geophone:tool:{x}" for x in "xyz"), *second, *(f"accelerometer:tool:{x}" for x in "xyz"))
    assert [lin.units[f"geophone:tool{x}:z"] for x in ("", "[2 Hz, 0.6, 28.8]")] == ["m/s", "V"]
    felt = lin.select(None, "accelerometer").at(HZ)
    for outputs, hz, ratio, gain in (("geophone:tool", 4.5, 0.7, 1.0), (second, 2.0, 0.6, 28.8)):
        w = 2 * np.pi * hz
        exact = gain * S / (S**2 + 2 * ratio * w * S + w**2) * felt
        assert lin.select(None, outputs).at(HZ) == pytest.approx(exact, rel=1e-9)


def test_one_name_is_one_quantity_of_a_screw():
    """The force at its nut has a name that results do not give to its torque; the former one is told of."""
    given = fx.preset("machine-hexapod")
    lin = fx.linearize(given, inputs="wrench", outputs="force-sensor:drive")
    with pytest.warns(FutureWarning, match='ask for "force-sensor:drive"'):
        former = fx.linearize(given, inputs="wrench", outputs="drive-force")
    assert (former.C == lin.C).all() and (former.D == lin.D).all() and former.units["drive-force:1"] == "N"
    # where no screw turns, it is that of results, without a word
    assert fx.linearize(fx.preset("paper-robot"), inputs="wrench", outputs="drive-force").units["drive-force:1"] == "N"
