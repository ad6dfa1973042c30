"""What check, run, budget and their report say in a line, and where the rest of it is."""

import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import flexapod as fx
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.idealizations import MACHINES, idealization
from flexapod.app.cli.cli import app
from flexapod.common.quantities import along_axes, brief
from flexapod.model import ActuatorStudy, override
from flexapod.output.report.report import warnings_section
from flexapod.output.text import html
from flexapod.output.text.answers import run_counts
from flexapod.output.text.budget import budget_counts
from flexapod.output.text.description import ideal_words, rest_words
from flexapod.solve.statics.parts import part_stiffness

pytestmark = pytest.mark.unit

RUN = CliRunner()
KINDS = {"joints": ("base_joint", "platform_joint"), "plates": ("base_plate", "top_plate")}


@pytest.fixture(scope="module")
def machine():
    return fx.preset("machine-hexapod")


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("machine") / "machine.toml"
    assert RUN.invoke(app, ["new", str(path), "--preset", "machine-hexapod"]).exit_code == 0
    return path


@pytest.fixture(scope="module")
def checked(file):
    return RUN.invoke(app, ["check", str(file)]).stdout


@pytest.mark.parametrize("name", MACHINES)
def test_shares_of_machines_are_those_of_the_presets(name):
    """Rounded to a per cent each, as the pages say; all that is no piston, joint or plate is a drive's."""
    length, told = MACHINES[name]
    robot = fx.preset(name).robot
    assert length == pytest.approx(robot.home_lengths[0], abs=1e-3)
    give = {part: 1 / k[0] for part, k in part_stiffness(robot, robot.home_lengths).items()}
    shares = {kind: sum(give.get(part, 0.0) for part in parts) for kind, parts in KINDS.items()}
    shares["drives"] = sum(give.values()) - sum(shares.values()) - give["piston"]
    for kind, share in told.items():
        assert share == pytest.approx(100 * shares[kind] / sum(give.values()), abs=0.6)


def test_ideal_parts_are_named_and_compared_with_a_machine_of_that_size(machine):
    names = ("paper-robot", "tripod", "flight-simulator", "nano-hexapod")
    told = {name: ideal_words(idealization(study.robot)) for name in names
            if not isinstance(study := fx.preset(name), ActuatorStudy)}  # fmt: skip
    assert told["paper-robot"].startswith("Ideal, without give: joints, drives, plates; in machine-hexapod,")
    assert "90 % of a leg's compliance and most of its miss" in told["paper-robot"]
    assert "in motion-base" in told["flight-simulator"] and "96 %" in told["flight-simulator"]
    assert told["nano-hexapod"] is None and ideal_words(idealization(machine.robot)) is None
    stiff = machine.robot.legs[0].base_joint.replace(stiffness=None)
    legs = tuple(leg.replace(base_joint=stiff, platform_joint=stiff) for leg in machine.robot.legs)
    words = ideal_words(idealization(machine.robot.replace(legs=legs)))
    assert words.startswith("Ideal, without give: joints; in machine-hexapod") and "54 %" in words


def test_machines_say_what_a_run_and_a_budget_count(machine):
    assert "one machine as drawn, warm," in run_counts(machine.robot) and "tolerances and" in run_counts(machine.robot)
    assert "all machines made to these tolerances" in budget_counts(machine.robot)
    assert run_counts(fx.preset("paper-robot").robot) is None


def test_heat_and_weight_are_told_apart_with_signs(machine, checked):
    """By hand: each made alone. Once "is off by 18.5 um" of 30.9 up and 12.4 down."""
    words = rest_words(describe(machine).poses[0].rest)
    total, heat, weight = (float(x) for x in re.findall(r"z ([+-][\d.]+) µm", words))
    cold = machine.replace(robot=machine.robot.replace(heat=None))
    sag = fx.modes(cold).com_sag.values
    light = machine.replace(robot=machine.robot.replace(gravity=np.zeros(3)))
    lift = fx.modes(light).com_sag.values
    assert (heat, weight) == pytest.approx((1e6 * lift[2], 1e6 * sag[2]), abs=0.06)  # three digits are told
    assert total == pytest.approx(heat + weight, abs=0.15) and heat > 0 > weight  # three roundings
    assert words in checked


def test_frequencies_of_check_are_a_table(checked):
    assert max(map(len, checked[checked.index("frequency [Hz]"):].splitlines()[:7])) < 60  # fmt: skip
    rows = re.findall(r"^ +[\d.]+ +[\d.]+  [a-z].*$", checked, flags=re.MULTILINE)
    assert len(rows) == 12  # six at most of each of two poses


def test_a_remark_is_one_line_and_verbose_says_the_rest(file, checked):
    """Once the remark about short pistons had 60 words."""
    remark = next(line for line in checked.splitlines() if "times the width" in line)
    assert len(remark) < 120 and "Timoshenko" not in checked and "--verbose" in checked
    whole = RUN.invoke(app, ["check", str(file), "--verbose"]).stdout
    assert "Timoshenko" in whole and "More about" not in whole
    told = json.loads(RUN.invoke(app, ["check", str(file), "--json"]).stdout)
    assert any("Timoshenko" in line for line in told["remarks"]) and told["ideal"] is None


def test_explanations_are_folded_away_in_a_report():
    data = fx.simulate(override(fx.preset("machine-hexapod"), fidelity="lumped"), duration=0.01)
    told = warnings_section(data)
    first, rest = brief(data.attrs["warnings"].splitlines()[0])
    assert f"<details><summary>{html.escape(first)}</summary>{html.escape(rest)}</details>" in told
    assert len(first) < 120 and first.startswith("leg 1") and "also legs 2, 3, 4, 5, 6" in first


def test_nothing_along_an_axis_has_no_unit():
    assert along_axes([1.2e-6, 0.0, -19.3e-6]) == "x 1.2 µm, y 0, z -19.3 µm"
    assert along_axes([1.2e-6, 0.0, -19.3e-6], signed=True) == "x +1.2 µm, z -19.3 µm"
    assert along_axes(np.zeros(3), signed=True) == "0"


def test_a_remark_without_an_explanation_is_whole():
    assert brief("leg 1: 0.5 mm are left") == ("leg 1: 0.5 mm are left", "")
    assert brief("It is so. Because 1.5 is") == ("It is so", "Because 1.5 is")


def test_run_and_budget_say_what_is_ideal_and_what_they_count(tmp_path):
    path = tmp_path / "first.toml"
    wish = ["--from", "home=300 mm, payload=20 kg, duration=0.1 s", "--ideal"]
    assert RUN.invoke(app, ["new", str(path), *wish]).exit_code == 0
    line = ideal_words(idealization(fx.load(path).robot))
    for command in (["check"], ["budget"], ["run", "--no-figures"]):
        assert line in RUN.invoke(app, [command[0], str(path), *command[1:]]).stdout.replace("\n  ", " ")
        assert json.loads(RUN.invoke(app, [command[0], str(path), *command[1:], "--json"]).stdout)["ideal"] == line
    assert html.escape(line) in (tmp_path / "first-run" / "report.html").read_text(encoding="utf-8")
