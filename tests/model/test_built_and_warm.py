"""Tables of the machine as built and warm: what is read, what is refused and with which words."""

import numpy as np
import pytest
from tests.helpers import machines, mechanisms

from flexapod import accuracy, loads
from flexapod.common.errors import InputError
from flexapod.common.quantities import text as text_of
from flexapod.model import (
    Expansion,
    Geometry,
    Gradient,
    Heat,
    Joint,
    LengthSpread,
    RatioSpread,
    Tolerances,
    preset_text,
    to_toml,
)

pytestmark = pytest.mark.unit

TEXT = preset_text("paper-robot")


def study(text, folder=None):
    return loads(TEXT + text, path=None if folder is None else folder / "robot.toml")


def test_all_forms_are_read_and_written():
    text = """
[geometry]
base_joints = [["1 mm", 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, "-2 um"]]
leg_offset = [1e-6, 0, 0, 0, 0, 0]
lead = 6e-5
[heat]
reference = "22 degC"
piston = "25 degC"
cylinder = [22, 22, 22, 23, 23, 22]
expansion = { base = "12e-6 1/K" }
[tolerances]
base_joints = "20 um"
platform_joints = { box = "50 um" }
leg_offset = { sigma = 1e-5 }
lead = "C5"
EI = 0.03
density = { box = 0.02 }
bow = "30 um"
"""
    robot = study(text).robot
    assert robot.geometry.base_joints[0, 0] == 1e-3 and robot.geometry.leg_offset.shape == (6,)
    assert robot.heat.piston.tolist() == [25.0] and robot.heat.expansion == Expansion(base=12e-6)
    assert robot.tolerances == Tolerances(
        base_joints=2e-5, platform_joints=LengthSpread(box=5e-5), leg_offset=1e-5, lead=RatioSpread(box=0.018 / 300),
        EI=0.03, density=RatioSpread(box=0.02), bow=3e-5,
    )  # fmt: skip
    assert loads(to_toml(study(text))).robot == robot


def test_a_table_over_time_is_read_and_kept(tmp_path):
    (tmp_path / "heat.csv").write_text("time [s], piston [degC], cylinder 3 [degC]\n0, 20, 20\n600, 24, 21\n")
    heat = study('[heat]\nfile = "heat.csv"\n', tmp_path).robot.heat
    assert heat.columns == ("piston", "cylinder 3")
    assert heat.temperatures("piston", 6).tolist() == [[20.0] * 6, [24.0] * 6]
    assert heat.temperatures("cylinder", 6)[1].tolist() == [20, 20, 21, 20, 20, 20]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("time [s], piston [degC]\n0, 20\n10,\n", "Fill the gap"),
        ("time [s], piston [degC]\n1, 20\n10, 21\n", "does not start at 0"),
        ("time [s], piston [degC]\n0, 20\n10, 21\n5, 22\n", "goes back in time"),
        ("time [s], piston [K]\n0, 20\n10, 21\n", "degrees Celsius"),
        ("time [s], gear [degC]\n0, 20\n10, 21\n", "unknown column"),
        ("time [s], piston [degC], piston 2 [degC]\n0, 20, 20\n10, 21, 21\n", "a column for each of its legs"),
        ("time [s], piston [degC]\n0, 20\n10, -280\n", "below absolute zero"),
    ],
)
def test_tables_over_time_with_faults_are_refused(tmp_path, table, words):
    (tmp_path / "heat.csv").write_text(table)
    with pytest.raises(InputError, match=words):
        study('\n[heat]\nfile = "heat.csv"\n', tmp_path)


def test_a_piston_of_unknown_material_expands_like_steel_and_that_is_said():
    robot = mechanisms.hexapod().replace(heat=Heat(piston=25.0))  # pistons by EI, EA, rhoA
    study = loads(TEXT).replace(robot=robot)
    assert any("steel's is taken" in remark for remark in study.warnings)
    known = robot.replace(heat=Heat(piston=25.0, expansion=Expansion(piston=1e-6)))
    assert not any("steel" in remark for remark in study.replace(robot=known).warnings)


def test_a_part_has_one_temperature(tmp_path):
    (tmp_path / "heat.csv").write_text("time [s], piston [degC]\n0, 20\n600, 24\n")
    with pytest.raises(InputError, match="together with its column"):
        study('\n[heat]\nfile = "heat.csv"\npiston = 22\n', tmp_path)


def test_what_a_robot_does_not_have_has_neither_errors_nor_heat():
    for robot, built, words in (
        (mechanisms.six_rus(), {"geometry": Geometry(lead=1e-5)}, "driven strokes and sliders"),
        (mechanisms.six_rus(), {"heat": Heat(cylinder=25.0)}, "no leg has"),
        (mechanisms.three_rps(), {"heat": Heat(gradient=Gradient(piston=1.0))}, "carry moments"),
        (mechanisms.planar(), {"geometry": Geometry(base_joints=[[0, 0, 1e-4]] * 3)}, "leaves the plane"),
        (mechanisms.eight(), {"geometry": Geometry(leg_offset=[1e-5] * 6)}, "each of 8 legs"),
        (mechanisms.eight(), {"heat": Heat(piston=[20.0] * 6)}, "each of 8 legs"),
    ):
        with pytest.raises(InputError, match=words):
            robot.replace(**built)


def test_a_check_says_how_far_the_machine_as_built_is_off():
    from flexapod.analysis.pose_errors.home_accuracy import home_accuracy
    from flexapod.output.text.description import accuracy_words

    assert accuracy_words(home_accuracy(study(""))) == ()
    text = '\n[geometry]\nleg_offset = "10 um"\n[heat]\npiston = 25\n[tolerances]\nleg_offset = "20 um"\n'
    found = loads((TEXT + text).replace("\nstroke =", '\nbase_joint = { play = "5 um" }\nstroke =', 1))
    built, spread, play = accuracy_words(home_accuracy(found))
    assert "most of it by heat of the pistons" in built and "standard deviations" in spread and "play" in play


def test_what_check_says_of_temperatures_over_time(tmp_path):
    from flexapod.analysis.pose_errors.home_accuracy import home_accuracy
    from flexapod.output.text.description import accuracy_words

    (tmp_path / "heat.csv").write_text("time [s], piston [degC]\n0, 20\n600, 26\n1200, 24\n")
    more = '[heat]\nfile = "heat.csv"\nexpansion = { piston = 1.2e-5 }\n'
    found = study(more, tmp_path)
    (words,) = accuracy_words(home_accuracy(found))  # as drawn at the start
    moved = float(np.linalg.norm(accuracy(found).pose_drift[1, :3]))
    assert words.startswith(
        f"the temperatures of heat.file move the tool at home by up to {text_of(moved, 'm', 3)} from"
    )
    assert words.endswith("at t = 600 s")


@pytest.mark.parametrize("draws", [-1, 1.5, True])
def test_a_number_of_draws_is_a_whole_number(draws):
    import flexapod as fx

    with pytest.raises(InputError, match="draws"):
        fx.accuracy(study(""), draws=draws)


def test_a_sweep_of_parts_that_are_not_in_the_file_keeps_no_causes():
    from tests.helpers.sweeps import quick

    import flexapod as fx

    warm = {"vary": [{"key": "heat.piston", "values": [20, 25]}]}
    with pytest.raises(InputError, match="other causes at other points"):
        fx.sweep(quick(), warm | {"keep": {"scalars": ["cause_share"]}}, workers=0)
    found = fx.sweep(quick(), warm | {"keep": {"scalars": ["com_deviation_start"]}}, workers=0)
    assert float(found.com_deviation_start[1] - found.com_deviation_start[0]) != 0


@pytest.mark.parametrize("end", ["base", "platform"])
@pytest.mark.parametrize("what", ["play", "eccentricity"])
def test_errors_of_joints_that_are_none_are_refused_at_both_ends(end, what):
    robot = machines.machine()
    joint = Joint(**{what: 0.06 * float(robot.home_lengths.max())})
    with pytest.raises(InputError, match="is not an error of a leg") as caught:
        machines.machine(**{f"{end}_joint": joint})
    assert caught.value.key == f"leg.{end}_joint.{what}"
