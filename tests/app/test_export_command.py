"""`flexapod export`: the deck as a file, and what CalculiX makes of it."""

import json
import re

import numpy as np
import pytest
from tests.helpers.short_runs import BRIEF

from flexapod import load, modes
from flexapod.output.exchange.pose_deck import ELEMENTS, MODES
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX

pytestmark = pytest.mark.cli


def test_writes_a_deck_named_after_the_study(flexapod, study, folder):
    run = flexapod("export", study())
    assert run.exit_code == 0, run.stderr
    text = (folder / "study.inp").read_text(encoding="ascii")
    assert text.startswith("*HEADING\nstudy: robot with locked drives\n")
    assert "ccx -i study" in run.stdout and "flexapod modes study.toml" in run.stdout


def test_json_pose_and_file(flexapod, study, folder):
    path = folder / "decks" / "rolled.inp"
    counts = ("--elements", 4, "--count", 3)
    run = flexapod("export", study(), "--format", "abaqus", "--pose", "roll=5deg", *counts, "--out", path, "--json")
    assert run.exit_code == 0, run.stderr
    assert json.loads(run.stdout) == {"file": str(path), "format": "abaqus", "elements": 4, "modes": 3}
    text = path.read_text(encoding="ascii")
    assert "roll 5 deg" in text and "*FREQUENCY\n3\n" in text


def test_defaults_of_command_and_call_agree(flexapod, study):
    found = json.loads(flexapod("export", study(), "--json").stdout)
    assert (found["elements"], found["modes"]) == (ELEMENTS, MODES)


def test_keeps_a_file_that_exists(flexapod, study, folder):
    (folder / "study.inp").write_text("mine", encoding="ascii")
    run = flexapod("export", study())
    assert (run.exit_code, (folder / "study.inp").read_text(encoding="ascii")) == (2, "mine")
    assert "--force" in run.stderr
    assert flexapod("export", "study.toml", "--force").exit_code == 0
    assert (folder / "study.inp").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--format", "calculix"), "a deck that CalculiX reads as well"),
        (("--elements", "1"), "from 2 to 500"),
        (("--count", "0"), "from 1 to 500"),
        (("--pose", "heave=2m"), "within the strokes"),
        (("--pose", "up=2m"), "heave"),
        (("--out", "deck.txt"), "FILE.inp"),
        (("--out", "."), "is a folder"),
    ],
)
def test_bad_input(flexapod, study, folder, arguments, words):
    run = flexapod("export", study(), *arguments)
    assert run.exit_code == 2
    assert words in run.stderr
    assert [path.name for path in folder.iterdir()] == ["study.toml"]


@pytest.mark.parametrize(
    ("format", "ending", "words"),
    [("mjcf", "xml", "Steps of"), ("gltf", "glb", "Left out: forces"), ("vtk", "pvd", "Warp By Vector")],
)
def test_other_formats_are_named_after_the_study_and_say_what_they_leave_out(
    flexapod, study, folder, format, ending, words
):
    file = study(*BRIEF)
    run = flexapod("export", file, "--format", format)
    assert run.exit_code == 0, run.stderr
    assert f"study.{ending}" in run.stdout and words in " ".join(run.stdout.split())
    assert (folder / f"study.{ending}").stat().st_size > 1000
    again = flexapod("export", file, "--format", format)
    assert again.exit_code == 2 and "--force" in again.stderr
    found = json.loads(flexapod("export", file, "--format", format, "--force", "--json").stdout)
    assert found["file"] == f"study.{ending}" and found["format"] == format and found["left_out"]
    assert found["files"][0] == f"study.{ending}"


def test_many_files_are_a_line_with_their_number(flexapod, study, folder):
    """All of them are in JSON; on the terminal it was one line a file, 1603 for a study of a second."""
    file = study(*BRIEF)
    run = flexapod("export", file, "--format", "vtk")
    assert run.exit_code == 0, run.stderr
    there = sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix in (".vtp", ".vtu", ".pvd"))
    assert len(there) > 20
    said = " ".join(run.stdout.split())
    (count,) = re.findall(r"Written: study\.pvd, and in study: (\d+) files \(VT[PU]\)\.", said)
    assert int(count) == len(there) - 1 and said.count("Written") == 1 and len(run.stdout.splitlines()) < 15
    found = json.loads(flexapod("export", file, "--format", "vtk", "--force", "--json").stdout)
    assert sorted(found["files"]) == sorted(str(path.relative_to(folder)) for path in there)


def test_options_of_formats_reach_them(flexapod, study, folder):
    file = study(*BRIEF)
    rigid = flexapod("export", file, "--format", "mjcf", "--fidelity", "rigid")
    assert rigid.exit_code == 0 and "bend_1" not in (folder / "study.xml").read_text()
    assert flexapod("export", file, "--format", "gltf", "--magnify", 100).exit_code == 0
    named = ("--inputs", "wrench:fx, force:(0, 0, 0.1):x, command", "--outputs", "tool:z", "--pose", "roll=1deg")
    assert flexapod("export", file, "--format", "mat", *named, "--out", "robot.npz").exit_code == 0
    with np.load(folder / "robot.npz") as read:
        assert (read["B"].shape[1], read["C"].shape[0]) == (8, 1)
    unknown = flexapod("export", file, "--format", "mat", "--inputs", "wrnch")
    assert unknown.exit_code == 2 and "--inputs" in unknown.stderr and "wrench" in unknown.stderr
    step = flexapod("export", file, "--format", "fmu", "--step", "1 m")
    assert step.exit_code == 2 and "--step = 1 m: is not a time" in step.stderr
    for wrong, option in ((("--format", "gltf", "--elements", 4), "--elements"), (("--step", "1ms"), "--step")):
        run = flexapod("export", file, *wrong)
        assert run.exit_code == 2 and option in run.stderr and "is not an option of" in run.stderr


def test_an_actuator_is_no_robot(flexapod, study):
    run = flexapod("export", study(preset="paper-actuator"))
    assert run.exit_code == 2
    assert "the study of a robot" in run.stderr


@pytest.mark.skipif(not CALCULIX.is_available(), reason=f"CalculiX is not installed: {CALCULIX.install}")
@pytest.mark.parametrize(
    "drive",
    [
        '{ type = "servo", stiffness = 2e8, damping = 0 }',
        '{ type = "force", law = "rigid", feedback = { stiffness = 2e8, damping = 0 } }',
    ],
)
def test_calculix_finds_the_frequencies_and_the_sag_of_the_study(flexapod, study, folder, drive):
    """A tube on servo or force drives under a load, at a pose: no case of the verification pack has these.

    Shear and rotary inertia take (r lambda / s)^2 (1 + E / k G) / 2 = 0.13 % of the first bending frequency, which 16
    elements raise by 0.01 %. What turns with the payload, m g times 0.4 m over its stiffness of 17.88 kg m^2 (16 Hz)^2
    of the first frequency, is 0.2 % of that stiffness, and likewise of the sag.
    """
    changes = (
        ('diameter = "27 mm", length', 'diameter = "30 mm", inner_diameter = "20 mm", length'),
        ('drive = { type = "prescribed" }', f"drive = {drive}"),
    )
    file = study(*changes, more="\n[load]\nwrench = [100, -200, 300, 20, 30, -40]\n")
    run = flexapod("export", file, "--pose", "pitch=5deg,heave=20mm", "--elements", 16, "--count", 8)
    assert run.exit_code == 0, run.stderr
    found = calculix.run((folder / "study.inp").read_text(encoding="ascii"))
    ours = modes(load(file), {"pitch": 0.08726646259971647, "heave": 0.02}, modes=6)
    assert found.frequencies() == pytest.approx(ours.frequency.values[:8], rel=2e-3)
    assert found.frequencies()[0] == pytest.approx(ours.frequency.values[0], rel=1e-3)
    _, moved = found.displacements("PAYLOAD")
    sag = ours.com_sag.values
    assert moved[0].mean(axis=0) == pytest.approx(sag, abs=2e-3 * abs(sag).max())


def test_names_and_poses_that_the_other_programs_cannot_take_are_refused(flexapod, folder):
    assert flexapod("new", "r.toml").exit_code == 0
    run = flexapod("export", "r.toml", "--out", "my robot.inp")
    assert run.exit_code == 2 and "letters" in run.stderr
    run = flexapod("export", "r.toml", "--pose", "yaw=90deg")
    assert run.exit_code != 0 and not list(folder.glob("*.inp"))


def test_what_decks_do_not_have_is_refused_with_the_study_file(flexapod, study):
    file = study(("[leg] ", '[leg]\nguide = { gland = "200 N/um", head = "200 N/um" } '))
    error = json.loads(flexapod("export", file, "--json").stderr)["error"]
    assert (error["key"], error["file"]) == ("leg.guide", str(file))
    assert error["allowed"] and error["next_step"]
    option = json.loads(flexapod("map", file, "--x", "surge=5..3mm", "--json").stderr)["error"]
    assert (option["key"], option["file"]) == ("--x", None)
