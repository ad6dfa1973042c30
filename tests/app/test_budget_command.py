"""`flexapod budget`: the answer first, then its table; JSON, chart, refusals."""

import json

import pytest
from tests.helpers.short_runs import BRIEF

import flexapod as fx
from flexapod.analysis import open_results
from flexapod.output.text.budget import peak_budget, table

pytestmark = pytest.mark.cli

PLAY = '\n[tolerances]\nleg_offset = "10 um"\n[heat]\nreference = 20\npiston = 23\nexpansion = { piston = 1.2e-5 }\n'


def test_a_pose_in_words_numbers_and_a_chart(flexapod, study, folder):
    path = study(*BRIEF, more=PLAY)
    said = flexapod("budget", path, "--pose", "roll=2deg", "--out", "found")
    assert said.exit_code == 0, said.stderr
    first, _, head, *_ = said.stdout.splitlines()
    assert first.startswith("The largest culprit at the pose is the ")
    assert "would bring the worst case of the tool's place from" in first
    assert head.split()[:3] == ["part", "kind", "share"]
    assert "heat of the pistons" in said.stdout
    assert "-0.00 " not in said.stdout
    assert {file.name for file in (folder / "found").iterdir()} == {"budget.nc", "budget.png"}
    data = open_results(folder / "found" / "budget.nc")
    whole = (data.budget.sum("part") + data.budget_residual).sel(kind="systematic")
    assert abs(whole - data.budget_total.sel(kind="systematic")).max() < 1e-15
    told = json.loads(flexapod("budget", path, "--pose", "roll=2deg", "--json").stdout)
    assert told["summary"][0] == first
    assert {part["part"] for part in told["parts"]} == {"axial-strain", "heat_piston", "leg_offset tolerance"}
    assert sum(part["share"] for part in told["parts"]) == pytest.approx(1.0)


def test_heat_that_lifts_a_machine_is_not_called_a_sag(flexapod, study):
    path = study(*BRIEF, more=PLAY)
    assert fx.modes(fx.load(path)).com_sag[2] > 0
    assert "(the centre of mass is off by" in flexapod("modes", path).stdout
    assert "sag" not in flexapod("map", path, "--count", "2", "--no-figures").stdout


def test_the_budget_of_a_run_names_its_instant(study):
    found = peak_budget(fx.simulate(fx.load(study(*BRIEF, more=PLAY))))
    assert f"at the pose of t = {found.attrs['pose_time']:.4g} s is the" in found.attrs["summary"]


def test_along_the_motion(flexapod, study):
    said = flexapod("budget", study(*BRIEF, more=PLAY), "--motion", "--json")
    assert said.exit_code == 0, said.stderr
    told = json.loads(said.stdout)
    assert set(told["total"]) == {"systematic", "hysteretic", "random", "dynamic_peak", "dynamic_rms"}
    assert 0 <= told["worst_time"] <= 0.2
    assert f"t = {told['worst_time']:.4g} s" in told["summary"][0]


def test_what_cannot_be(flexapod, study):
    path = study(*BRIEF)
    both = flexapod("budget", path, "--motion", "--pose", "roll=2deg")
    assert both.exit_code == 2
    assert "--pose" in both.stderr
    actuator = study(preset="paper-actuator")
    assert flexapod("budget", actuator).exit_code == 2


def test_the_chart_names_parts_largest_first():
    data = fx.budget(fx.preset("paper-robot"), {"roll": 0.2})
    left, right = fx.plot.budget(data).axes
    assert [label.get_text() for label in left.get_yticklabels()] == [
        "stretch of the pistons",
        "bending of the pistons",
    ]
    assert len(right.texts) == 12
    shares = [float(text.get_text()) for text in right.texts[:6]]
    assert sum(shares) == pytest.approx(100, abs=3)


def test_turns_that_are_rounding_read_nothing():
    """Legs that are alike let the tool sink, straight: 4e-16 rad were shown as 0.0000000003778 µrad."""
    head, rows = table(fx.budget(fx.preset("motion-base")))
    assert [row[head.index("ry [deg]")] for row in rows] == ["0"] * len(rows)
