"""Verdicts in commands: the first line, JSON, exit codes of --strict, and the report."""

import json

import pytest

pytestmark = pytest.mark.cli
ASKED = '\n[requirement]\ntravel = "5 mm"\npose_accuracy_calibrated = "1 um"\nsettling_time = "1 s"\n'


@pytest.fixture
def asked(study):
    return study(preset="machine-hexapod", more=ASKED)


@pytest.mark.parametrize("command", ["check", "budget"])
def test_the_verdict_is_first_and_strict_has_its_code(flexapod, asked, command):
    plain = flexapod(command, asked)
    assert plain.exit_code == 0
    assert plain.stdout.startswith("No: pose accuracy calibrated ")
    assert flexapod(command, asked, "--strict").exit_code == 3
    found = flexapod(command, asked, "--strict", "--set", "requirement.pose_accuracy_calibrated=1 mm")
    assert found.exit_code == 0
    assert found.stdout.startswith("Yes: all 3 requirements are kept.")
    told = json.loads(flexapod(command, asked, "--json").stdout)["verdict"]
    assert told["kept"] is False
    assert [row["kept"] for row in told["requirements"]] == [True, False, True]


def test_strict_without_requirement_is_refused(flexapod, study):
    path = study(preset="machine-hexapod")
    found = flexapod("check", path, "--strict")
    assert found.exit_code == 2
    assert "[requirement]" in found.stderr
    assert flexapod("check", path).stdout.startswith("The path keeps all limits.")


def test_not_judged_is_not_kept(flexapod, study):
    path = study(more='\n[requirement]\npose_accuracy = "1 m"\n')
    found = flexapod("check", path, "--strict")
    assert found.exit_code == 3
    assert found.stdout.startswith("Not judged: pose accuracy (the study has no [tolerances]")
    assert flexapod("check", path).exit_code == 0


def test_a_run_judges_its_own_record_and_its_report_says_so_first(flexapod, asked, folder):
    keys = ("--set", "simulation.fidelity=lumped", "--set", "motion.hold=0.05")
    found = flexapod("run", asked, "--no-figures", "--out", "out", "--strict", *keys)
    assert found.exit_code == 3, found.stderr
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h1>No: pose accuracy calibrated" in page
    assert "in this run" in found.stdout


def test_a_map_says_it_first(flexapod, asked):
    found = flexapod("map", asked, "--x", "heave:3", "--no-figures")
    assert found.exit_code == 0, found.stderr
    assert found.stdout.startswith("No: pose accuracy calibrated ")
