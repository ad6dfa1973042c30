"""`flexapod converge`: tables, recommendation, files; --json, bad input, Ctrl-C."""

import csv
import json

import pytest

from flexapod.analysis import open_results
from flexapod.design.convergence import plan
from flexapod.design.convergence.trials import Trials

pytestmark = pytest.mark.cli

BEAM = (('duration = "10 s"', 'duration = "0.3 s"\nstep = "1 ms"\noutput_step = "5 ms"'),)


@pytest.fixture
def beam(study, monkeypatch):
    monkeypatch.setattr(plan, "COUNTS", {"shapes": (1, 2, 3), "elements": (1, 2), "segments": (1, 2)})
    return study(*BEAM, preset="paper-actuator")


def test_what_it_prints_and_writes(flexapod, beam, folder):
    run = flexapod("converge", beam, "--accuracy", "0.03", "--ladder")
    assert run.exit_code == 0, run.stderr
    for words in (
        "settings, up to",
        "Step: observed order",
        "Errors against",
        "Recommended for 0.03",
        "    step = 0.0",
    ):
        assert words in run.stdout
    assert "Every fidelity" in run.stdout
    for name in ("convergence", "ladder"):
        assert {path.suffix for path in (folder / "study-converge").glob(f"{name}.*")} == {".nc", ".csv", ".png"}
    data = open_results(folder / "study-converge" / "convergence.nc")
    assert data.attrs["partial"] == 0
    with (folder / "study-converge" / "convergence.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert [row["family"] for row in table] == list(data.family.values)
    assert float(table[-1]["error_tip"]) == pytest.approx(float(data.error_tip[-1]))


def test_json(flexapod, beam, folder):
    run = flexapod("converge", beam, "--accuracy", "0.03", "--json", "--out", "there")
    assert run.exit_code == 0, run.stderr
    found = json.loads(run.stdout)
    assert found["partial"] is False
    assert found["accuracy"] == 0.03
    assert found["recommended"][-1].startswith("step = ")
    assert [family["family"] for family in found["families"]] == ["step", "shapes", "elements", "segments"]
    chosen = [row for row in found["settings"] if row["family"] == "recommended"]
    assert chosen[0]["error_tip"] + found["reference_error"] <= 0.03
    assert (folder / "there" / "convergence.nc").is_file()


def test_a_first_robot_has_pistons_that_shear_and_no_beam_elements(flexapod, folder, monkeypatch):
    monkeypatch.setattr(plan, "COUNTS", {"shapes": (1, 2), "elements": (1,), "segments": (1,)})
    flexapod("new", "first.toml", "--from", "home=900 mm, payload=150 kg, stroke=200 mm")
    text = (folder / "first.toml").read_text(encoding="utf-8")
    assert "shear = true" in text
    (folder / "first.toml").write_text(text + 'duration = "0.2 s"\noutput_step = "5 ms"\n', encoding="utf-8")
    run = flexapod("converge", "first.toml", "--accuracy", "0.03", "--json")
    assert run.exit_code == 0, run.stderr
    found = json.loads(run.stdout)
    assert {row["family"] for row in found["settings"]} >= {"step", "shapes"}
    assert not {"elements", "segments"} & {row["family"] for row in found["settings"]}
    assert not any(row.get("failure") for row in found["settings"])


@pytest.mark.parametrize("accuracy", ["2", "0", "-0.1", "nan"])
def test_bad_accuracy(flexapod, beam, folder, accuracy):
    run = flexapod("converge", beam, "--accuracy", accuracy)
    assert run.exit_code == 2
    assert "accuracy" in run.stderr
    assert "1e-6 to 0.5" in run.stderr
    assert not (folder / "study-converge").exists()


def test_a_study_that_is_refused_is_refused_at_once(flexapod, study):
    run = flexapod("converge", study(('max = "1.05 m"', 'max = "0.91 m"')))
    assert run.exit_code == 2
    assert "stroke" in run.stderr


@pytest.mark.parametrize("form", [(), ("--json",)])
def test_interrupt(flexapod, beam, folder, monkeypatch, form):
    run_trial, seen = Trials.run, []

    def stopped(self, setting):
        seen.append(setting)
        if setting.fidelity == "beam-fem":
            raise KeyboardInterrupt
        return run_trial(self, setting)

    monkeypatch.setattr(Trials, "run", stopped)
    run = flexapod("converge", beam, *form)
    assert run.exit_code == 130
    assert "stopped by Ctrl-C after" in run.stderr
    data = open_results(folder / "study-converge" / "convergence.nc")
    assert data.attrs["partial"] == 1
    assert set(data.family.values) == {"step", "shapes"}
    assert (folder / "study-converge" / "convergence.png").is_file()
    if form:
        assert json.loads(run.stdout)["partial"] is True
        assert json.loads(run.stderr)["error"]["kind"] == "interrupt"
