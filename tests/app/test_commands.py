"""Commands that do what they say."""

import json
import os
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as xml
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.short_runs import BRIEF

import flexapod as fx
from flexapod.analysis import open_results
from flexapod.model import ForceDrive

pytestmark = pytest.mark.cli

FIGURES = {"com-path", "deviation-by-cause", "actuator-forces", "leg-lengths", "motion", "energies", "robot"}


def test_help_names_every_command(flexapod):
    result = flexapod("--help")
    assert result.exit_code == 0
    for name in ("replicate", "new", "check", "run", "modes", "actuator"):
        assert f" {name} " in result.stdout
        assert flexapod(name, "--help").exit_code == 0
    assert flexapod("--version").stdout == f"flexapod {fx.__version__}\n"


def test_help_and_version_import_nothing_heavy():
    # What makes a start slow; half a second is held by the benchmark, on an idle machine.
    heavy = "casadi", "scipy", "numpy", "xarray", "matplotlib", "pydantic", "pint", "netCDF4"
    code = (
        "import sys\nsys.argv = ['flexapod', '--help']\nfrom flexapod.app.cli.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        f"print([name for name in {heavy} if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in run.stdout
    assert run.stderr.strip() == "[]"


def test_as_a_module_and_in_a_plain_terminal(folder):
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    command = [sys.executable, "-m", "flexapod"]
    subprocess.run([*command, "new", "a.toml"], check=True, capture_output=True)
    run = subprocess.run([*command, "check", "a.toml"], env=environment, capture_output=True, text=True, check=True)
    assert "Stiffness at the tool: 3.45 N/?m" in run.stdout


@pytest.mark.parametrize("preset", ["paper-robot", "paper-robot-radii", "paper-actuator"])
def test_new_writes_the_commented_preset(flexapod, folder, preset):
    result = flexapod("new", "my.toml", "--preset", preset)
    assert result.exit_code == 0
    assert "flexapod check my.toml" in result.stdout
    assert (folder / "my.toml").read_text(encoding="utf-8") == fx.model.preset_text(preset)
    assert [path.name for path in folder.iterdir()] == ["my.toml"]


def test_new_replaces_nothing_unless_forced(flexapod, folder):
    (folder / "my.toml").write_text("mine")
    result = flexapod("new", "my.toml")
    assert result.exit_code == 2
    assert "exists already" in result.stderr
    assert "--force" in result.stderr
    assert (folder / "my.toml").read_text() == "mine"
    assert json.loads(flexapod("new", "my.toml", "--force", "--json").stdout) == {
        "file": "my.toml",
        "preset": "paper-robot",
    }
    assert tomllib.loads((folder / "my.toml").read_text(encoding="utf-8"))["robot"]["type"] == "6-UPS"
    (folder / "folder.toml").mkdir()
    assert flexapod("new", "folder.toml", "--force").exit_code == 2
    assert flexapod("new", "other.toml", "--preset", "paper").exit_code == 2
    assert not (folder / "other.toml").exists()


def test_check_says_what_a_study_asks_for(flexapod, study):
    result = flexapod("check", study())
    assert result.exit_code == 0
    assert result.stderr == ""
    for words in (
        "Leg 3 comes nearest to its limits of 700 and 1050 mm: 71.14 mm are left.",
        "condition 8.45 at t = 1.000 s",
        "comes nearest to buckling",
        "% of yield",
        "Stiffness at the tool: 3.45 N/µm along [1.00, 0.00, 0.00]",
        "21.71       0.0056  payload",
        "below 1 µm at once",
    ):
        assert words in result.stdout


def test_check_as_data(flexapod, study):
    data = json.loads(flexapod("check", study(), "--json").stdout)
    assert data["kind"] == "robot"
    assert [leg["leg"] for leg in data["legs"]] == [1, 2, 3, 4, 5, 6]
    assert data["legs"][2]["stroke_margin"]["value"] == pytest.approx(0.07114, abs=1e-5)
    undamped = json.loads(flexapod("check", study(("damping = 0.005", "damping = 0"), *JUMP), "--json").stdout)
    assert undamped["vibration"]["settling"] is None  # never: JSON knows no infinity
    words = flexapod("check", "study.toml").stdout
    assert "without damping it does not fall below 1 µm" in words


JUMP = [('profile = "quintic" ', 'profile = "linear" ')]


def test_check_of_a_rigid_robot(flexapod, study):
    result = flexapod("check", study(('"assumed-modes"', '"rigid"'), ("modes = 3", "")))
    assert result.exit_code == 0
    assert "nothing that could vibrate" in result.stdout
    assert "None that could be estimated." in result.stdout


def test_check_of_an_actuator(flexapod, study):
    file = study(preset="paper-actuator")
    words = flexapod("check", file).stdout
    assert "between 1.83 and 2.83 m" in words
    assert "2.292, 14.37, 40.23" in words
    beam = json.loads(flexapod("check", file, "--json").stdout)["beam"]
    # Closed form: (beta L)^2 sqrt(EI / rhoA L^4).
    expected = np.array([1.875104068712, 4.694091132974, 7.854757438238]) ** 2 / (2 * np.pi) * (756.65 / 4.02) ** 0.5
    assert beam[0]["frequency"] == pytest.approx(expected / 1.83**2, rel=1e-9)
    assert beam[1]["frequency"] == pytest.approx(expected / 2.83**2, rel=1e-9)
    found = json.loads(flexapod("modes", file, "--json").stdout)["modes"]
    assert [mode["frequency"] for mode in found] == pytest.approx(expected / 1.83**2, rel=1e-9)


def test_modes_at_a_pose(flexapod, study, folder):
    result = flexapod("modes", study(), "--pose", "roll=20deg, heave=0.01", "--count", "5")
    assert result.exit_code == 0, result.stderr
    assert "The lowest 5 of 48 modes" in result.stdout
    data = json.loads(flexapod("modes", "study.toml", "--pose", "roll=20deg,heave=10mm", "--json").stdout)
    expected = fx.modes(fx.load("study.toml"), {"roll": np.deg2rad(20), "heave": 0.01})
    assert [mode["frequency"] for mode in data["modes"]] == pytest.approx(expected.frequency.values.tolist())
    assert data["modes"][0]["kind"] == "payload"
    assert data["files"] == []
    assert [path.name for path in folder.iterdir()] == ["study.toml"]


def test_modes_on_disk(flexapod, study, folder):
    result = flexapod("modes", study(('"assumed-modes"', '"lumped"'), ("modes = 3", "")), "--out", "shapes")
    assert result.exit_code == 0, result.stderr
    assert {path.name for path in (folder / "shapes").iterdir()} == {"modes.nc", "modes.png"}
    assert open_results("shapes/modes.nc").sizes["mode"] == 6  # closed legs that only stretch follow the payload


def test_run_writes_results_figures_and_report(flexapod, study, folder):
    result = flexapod("run", study(*BRIEF))
    assert result.exit_code == 0, result.stderr
    assert result.stderr == ""
    assert result.stdout.startswith("The payload's centre of mass misses its rigid path by up to")
    assert "In study-run: results.nc, results.csv, report.html (open it in a browser)" in result.stdout
    out = folder / "study-run"
    assert {path.stem for path in out.glob("*.png")} >= FIGURES and "figures (PNG)" in result.stdout
    assert not [path for path in out.iterdir() if path.name.startswith(".")]  # no temporary file is left
    data, direct = open_results(out / "results.nc"), fx.run(fx.load("study.toml"))
    np.testing.assert_array_equal(data.com_deviation, direct.com_deviation)
    assert data.attrs["study"] == Path("study.toml").read_text(encoding="utf-8")
    page = unescape((out / "report.html").read_text(encoding="utf-8")).replace("\N{NO-BREAK SPACE}", " ")
    assert fx.study.summary(direct).sentence in page
    table = np.genfromtxt(out / "results.csv", delimiter=",", names=True, encoding="utf-8")
    assert len(table) == data.sizes["time"]


def test_run_writes_the_formats_asked_for(flexapod, study, folder):
    result = flexapod("run", study(*BRIEF), "--format", "PDF, svg", "--out", "out")
    assert result.exit_code == 0, result.stderr
    out = folder / "out"
    assert {path.stem for path in out.glob("*.pdf")} == {path.stem for path in out.glob("*.svg")} >= FIGURES
    for figure in out.glob("*.svg"):
        xml.parse(figure)
    assert not list(out.glob("*.png")) and (out / "com-path.pdf").read_bytes().startswith(b"%PDF")
    assert "figures (PDF and SVG)" in result.stdout
    assert (out / "report.html").read_text(encoding="utf-8").count("data:image/png") >= len(FIGURES)


@pytest.mark.parametrize("command", ["run", "actuator"])
@pytest.mark.parametrize(("formats", "named"), [("jpg", "jpg"), ("png,gif", "gif"), (",", ",")])
def test_unknown_formats_are_refused_before_anything_is_computed(
    flexapod, study, folder, monkeypatch, command, formats, named
):
    monkeypatch.setattr("flexapod.analysis.run", lambda *_, **__: pytest.fail("computed"))
    result = flexapod(
        command, study(preset=f"paper-{'robot' if command == 'run' else 'actuator'}"), "--format", formats
    )
    assert result.exit_code == 2
    assert f"--format = {named}: is not a format of figures" in result.stderr
    assert "png, svg, pdf" in result.stderr
    assert [path.name for path in folder.iterdir()] == ["study.toml"]


def test_run_as_json(flexapod, study, folder):
    file = study(*BRIEF)
    result = flexapod("run", file, "--out", "deep/er", "--json")
    assert result.exit_code == 0
    assert result.stderr == ""
    data = json.loads(result.stdout)
    assert data["partial"] is False
    assert data["folder"] == "deep/er"
    assert all((folder / name).is_file() for name in data["files"])
    assert data["summary"]["axes"][0]["per_cent"] is None  # no travel along x
    assert data["summary"]["peak"] == pytest.approx(fx.study.summary(fx.run(fx.load(file))).peak)


@pytest.mark.parametrize("command", ["actuator", "run"])
def test_actuator(flexapod, study, folder, command):
    file = study(('duration = "10 s"', 'duration = "0.2 s"'), preset="paper-actuator")
    result = flexapod(command, file)
    assert result.exit_code == 0, result.stderr
    assert "The tip leaves the hub's line by up to 6.96 mm, at t = 0.2 s" in result.stdout
    names = {path.name for path in (folder / "study-run").iterdir()}
    assert {"results.nc", "results.csv", "report.html", "response.png"} <= names


def test_failure_in_mid_course_keeps_what_was_computed(flexapod, study, folder):
    # Drives without force: the payload falls until a piston has slid into its cylinder.
    (folder / "forces.csv").write_text(
        "time [s]," + ",".join(f"leg {i} [N]" for i in range(1, 7)) + "\n0,0,0,0,0,0,0\n2,0,0,0,0,0,0\n"
    )
    drive = ('drive = { type = "prescribed" }', 'drive = { type = "force", law = "csv", file = "forces.csv" }')
    changes = [pair for pair in BRIEF if "0.2 s" not in pair[1]]
    file = study(*changes, drive, more="\n[initial]\nstart = 'moving'\n")
    assert isinstance(fx.load(file).robot.legs[0].drive, ForceDrive)
    result = flexapod("run", file, "--json")
    assert result.exit_code == 1
    error = json.loads(result.stderr)["error"]
    assert error["kind"] == "computation"
    for words in ("leg 1", "at t = 0.3", "slid wholly into the cylinder", "Check drive forces"):
        assert words in error["what"]
    told = json.loads(result.stdout)
    assert told["partial"] is True
    data = open_results("study-run/results.nc")
    assert data.attrs["partial"] == 1
    assert data.attrs["failure"] in error["what"]
    assert "Incomplete" in (folder / "study-run" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("command", ["run", "modes"])
def test_folder_that_cannot_be_written_to(flexapod, study, folder, command):
    (folder / "taken").write_text("a file")
    result = flexapod(command, study(*BRIEF), "--out", "taken/results")
    assert result.exit_code == 2
    assert "--out = taken/results" in result.stderr
    assert "is a file" in result.stderr
    assert (folder / "taken").read_text() == "a file"


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="this user may write everywhere")
def test_folder_without_permission(flexapod, study, folder):
    (folder / "locked").mkdir(mode=0o500)
    result = flexapod("run", study(*BRIEF), "--out", "locked/results")
    assert result.exit_code == 2
    assert "Permission denied" in result.stderr


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no place where nobody may write")
def test_folder_where_nobody_may_write(flexapod, study):
    result = flexapod("run", study(*BRIEF), "--out", "/proc/self/results")
    assert result.exit_code == 2
    assert "--out = /proc/self/results: cannot be written to" in result.stderr


def test_full_disk_is_told_and_leaves_no_half_file(flexapod, study, folder, monkeypatch):
    def full(data, path, **_):
        Path(path).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("flexapod.analysis.store.write", full)
    result = flexapod("run", study(*BRIEF))
    assert result.exit_code == 2
    assert "No space left on device" in result.stderr
    assert list((folder / "study-run").iterdir()) == []


def test_fault_of_ours_is_one_line_and_how_to_report_it(flexapod, study, monkeypatch):
    monkeypatch.setattr("flexapod.analysis.description.robot_description.describe", lambda _: 1 / 0)
    monkeypatch.delenv("FLEXAPOD_DEBUG", raising=False)
    result = flexapod("check", study())
    assert result.exit_code == 1
    assert "unexpected ZeroDivisionError" in result.stderr
    assert "report it" in result.stderr
    assert "Traceback" not in result.stderr
    assert json.loads(flexapod("check", "study.toml", "--json").stderr)["error"]["kind"] == "fault"
    monkeypatch.setenv("FLEXAPOD_DEBUG", "1")
    assert "Traceback" in flexapod("check", "study.toml").stderr


def test_debug_option_shows_where_bad_input_was_found(flexapod, monkeypatch):
    monkeypatch.setenv("FLEXAPOD_DEBUG", "0")
    result = flexapod("--debug", "check", "nowhere.toml")
    assert result.exit_code == 2
    assert "Traceback" in result.stderr
    assert "Error: nowhere.toml" in result.stderr
