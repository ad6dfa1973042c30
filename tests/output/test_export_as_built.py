"""Units of robots as built and warm whose commands come from outside: what the errors of building make of a command."""

import numpy as np
import pytest
from tests.helpers.fmi_importer import Instance, Unit
from tests.helpers.samples import MECHANISMS, sample_text

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.design.first_robot import first_robot, parse_request
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.model import preset_text

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]
STEP = 5e-4
FIRST = "home=300 mm, payload=20 kg, stroke=60 mm"
HEAT = "\n[heat]\nreference = 20\nbase = 21\nplatform = 23\npiston = [22, 23, 24, 25, 26, 27]\ncylinder = 22\n"
OFF = ", ".join('["0.1 mm", "-0.05 mm", "0.02 mm"]' for _ in range(5))
GEOMETRY = '\n[geometry]\nleg_offset = ["10 um", "-20 um", "5 um", 0, "3 um", "-7 um"]\n'
GEOMETRY += f"base_joints = [[0, 0, 0], {OFF}]\n"


def unit(study, folder, **options):
    found = fx.export(study, "fmu", folder / "robot.fmu", **options)
    return Unit(found.path, folder / "unpacked"), found


def test_a_heated_piston_makes_its_leg_longer_by_what_it_grows(tmp_path):
    """Strokes are enforced, so that the drive stands at what the command and the heat make of it: 11.7e-6 / K of steel
    times 915 mm, and of offsets their own. The command that is told at the start is the drawn one."""
    more = '\n[heat]\nreference = 20\npiston = 30\n[geometry]\nleg_offset = "-20 um"\n'
    study = fx.loads(preset_text("paper-robot") + more)
    drawn = fx.inverse_kinematics(fx.preset("paper-robot"), duration=0.01).leg_length_command.values[0]
    made, _ = unit(study, tmp_path, step=STEP)
    one = Instance(made)
    np.testing.assert_allclose(made.start("drive_command"), drawn, rtol=1e-14)
    piston = study.robot.legs[0].piston
    longer = piston.length * piston.expansion * 10 - 20e-6
    assert abs(longer) > 5e-5
    for _ in range(3):
        assert one.steps(STEP) == 0, one.said
        np.testing.assert_allclose(one.get("drive_position") - drawn, longer, rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", ["machine-hexapod", "paper-robot"])
def test_commands_of_the_drawn_robot_move_the_one_as_built_as_the_march_does(tmp_path, name):
    """Told at each step what the drawn robot's legs are to be at its end; the product's own march has the same robot.

    Both differ by rounding alone: 1e-12 m, and forces by that times masses over the step's square. Without what is as
    built the tool would be off by micrometres.
    """
    text = preset_text(name)
    text += HEAT + GEOMETRY if name == "paper-robot" else f"{GEOMETRY}lead = 5e-5\n"
    points = (fx.model.Waypoint(time=2 * STEP, surge=0.0), fx.model.Waypoint(time=0.1, surge=2e-3))
    study = fx.loads(text).replace(motion=fx.model.WaypointMotion(points=points))  # a command begins where its robot is
    count = 60
    options = {"duration": count * STEP, "output_step": STEP}
    data = fx.simulate(study, step=STEP, **options)
    drawn = fx.inverse_kinematics(study, **options)
    names = ("leg_length_command", "leg_length_rate", "leg_length_acceleration")
    value, rate, change = (drawn[x].values for x in names)
    made, _ = unit(study, tmp_path, step=STEP)
    one, turn = Instance(made), study.robot.legs[0].screw.per_turn if study.robot.legs[0].screw else 1.0
    zero = made.start("drive_command") * turn - value[0]
    tool = []
    for k in range(1, count + 1):
        one.set("drive_command_acceleration", change[k] / turn)
        one.set("drive_command_rate", (rate[k] - STEP * change[k]) / turn)
        one.set("drive_command", (value[k] + zero - STEP * rate[k] + STEP**2 / 2 * change[k]) / turn)
        assert one.steps(STEP) == 0, one.said
        tool.append(one.get("tool_position"))
    assert np.abs(np.array(tool) - data.tool_position.values[1:]).max() < 1e-12
    straight = fx.simulate(study.replace(robot=study.robot.replace(heat=None, geometry=None)), step=STEP, **options)
    assert np.abs(straight.tool_position.values - data.tool_position.values).max() > 1e-6


def test_carriages_of_a_rail_that_is_too_long(tmp_path):
    """A rail whose scale is 1e-4 too long: the carriage stands off by that part of its way from home, and nothing else.

    Prescribed places from the foot of the rail; the way from home is the command less that at home.
    """
    text = sample_text("hexaglide") + "\n[geometry]\nlead = 1e-4\n"
    study = fx.loads(text, path=MECHANISMS / "hexaglide.toml")
    made, _ = unit(study, tmp_path, step=STEP)
    one, start = Instance(made), made.start("drive_command")
    home = study.robot.home_carriages
    moving = 0.05
    for k in range(20):
        one.set("drive_command", start + moving * k * STEP)
        one.set("drive_command_rate", np.full(6, moving))
        assert one.steps(STEP) == 0, one.said
    told = start + moving * 20 * STEP
    np.testing.assert_allclose(one.get("drive_position") - told, 1e-4 * (told - home), rtol=0, atol=1e-14)


def test_a_first_robot_is_a_unit_with_its_commands_as_inputs(tmp_path):
    """As `flexapod new --from` writes it: heat, tolerances, no fixed step. At rest it stays where the march begins."""
    study = fx.loads(first_robot(parse_request(FIRST)))
    assert study.robot.heat is not None and study.robot.tolerances is not None and study.simulation.step is None
    made, found = unit(study, tmp_path, step="0.5 ms")
    assert made.step == STEP and not [words for words in found.left_out if "heat" in words]
    one = Instance(made)
    begin = one.get("tool_position")
    for _ in range(20):
        assert one.steps(STEP) == 0, one.said
    # the start is an equilibrium found to 1e-10 of a metre; its heat alone moves the tool by 10 um
    np.testing.assert_allclose(one.get("tool_position"), begin, rtol=0, atol=1e-9)
    own = fx.simulate(study, step=STEP, duration=STEP, output_step=STEP).tool_position.values[0]
    np.testing.assert_allclose(begin, own, rtol=0, atol=1e-12)


def test_what_moves_by_itself_over_time_is_named_with_the_table_to_take_out(tmp_path):
    (tmp_path / "shake.csv").write_text("time [s],surge [m/s^2]\n0,0\n0.1,0.5\n")
    (tmp_path / "warm.csv").write_text("time [s],piston [degC]\n0,20\n1,25\n")
    text = preset_text("paper-robot")
    path = tmp_path / "study.toml"
    warm = fx.loads(text + '\n[heat]\nreference = 20\nfile = "warm.csv"\n', path=path)
    shaken = fx.loads(text.replace("[robot]", '[robot]\nbase_motion = { file = "shake.csv" }', 1), path=path)
    for study, words in (
        (warm, ("heat.file", "Take file of [heat] out")),
        (shaken, ("robot.base_motion", "Take base_motion of [robot] out")),
    ):
        with pytest.raises(InputError) as error:
            fx.export(study, "fmu", tmp_path / "robot.fmu", step=STEP)
        assert error.value.key == "commands" and all(word in str(error.value) for word in words)
        assert '"motion"' in str(error.value)
    fx.export(warm, "c", tmp_path / "c", step=STEP, commands="motion")


def test_a_missing_step_is_said_in_words_that_the_next_call_takes(tmp_path):
    with pytest.raises(InputError, match=r"0\.5 ms") as error:
        fx.export(fx.preset("tripod"), "fmu", tmp_path / "robot.fmu")
    assert error.value.key == "step"
