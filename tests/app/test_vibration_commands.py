"""Disturbances on the command line: `modes` and `check` say them, files hold them."""

import json

import pytest
from tests.helpers.short_runs import BRIEF

from flexapod.analysis import open_results

pytestmark = pytest.mark.cli

FLOOR = '\n[disturbance]\nfloor = "VC-A"\n'


def test_modes_say_and_write_what_disturbances_do(flexapod, study, folder):
    path = study(*BRIEF, more=FLOOR)
    said = flexapod("modes", path, "--pose", "roll=2deg", "--out", "found")
    assert said.exit_code == 0, said.stderr
    assert "Disturbances shake the tool there by x " in said.stdout
    names = {f"{name}.{kind}" for name in ("modes", "vibration") for kind in ("nc", "png")}
    assert {file.name for file in (folder / "found").iterdir()} == names
    data = open_results(folder / "found" / "vibration.nc")
    told = json.loads(flexapod("modes", path, "--pose", "roll=2deg", "--json").stdout)
    assert told["vibration_rms"] == pytest.approx(data.vibration_rms.values)
    assert "Disturbances\n  Disturbances shake the tool at home" in flexapod("check", path).stdout


def test_modes_answer_although_a_vibration_has_no_size(flexapod, study):
    noise = '\n[disturbance]\nforce_noise = "noise.csv"\n'
    path = study(*BRIEF, more=noise)
    (path.parent / "noise.csv").write_text("frequency [Hz], force [N^2/Hz]\n1, 1\n100, 1\n")
    said = flexapod("modes", path)
    assert said.exit_code == 0, said.stderr
    assert "Vibration by disturbances cannot be said" in said.stdout
    assert "hold their positions" in said.stdout.replace("\n", " ")
