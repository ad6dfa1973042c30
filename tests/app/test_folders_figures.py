"""Where commands write when nothing is said, and what `--no-figures` leaves out."""

import json
import os
from pathlib import Path

import pytest
from tests.helpers.sweeps import QUICK

from flexapod.design.convergence import plan

pytestmark = pytest.mark.cli

PICTURES = (".png", ".svg", ".pdf")
SWEEP = """
[[vary]]
key = "payload.mass"
values = ["100 kg", "101 kg"]
"""


@pytest.fixture
def far(study, folder) -> Path:
    """A short study in another folder than the current one."""
    (folder / "robots").mkdir()
    (folder / "robots" / "mine.toml").write_bytes(Path(study(*QUICK)).read_bytes())
    (folder / "study.toml").unlink()
    return Path("robots/mine.toml")


@pytest.mark.parametrize(
    ("command", "options", "wrote"),
    [
        ("run", (), "mine-run/report.html"),
        ("map", ("--x", "heave=0..1mm:2", "--count", "2"), "mine-map/map.nc"),
        ("sweep", ("sweep.toml", "--workers", "0"), "mine-sweep/sweep.csv"),
        ("export", (), "mine.inp"),
    ],
)
def test_results_lie_beside_the_study_in_a_folder_of_their_own(flexapod, far, folder, command, options, wrote):
    """Once all of them wrote into one folder of the current one, named after the study."""
    (folder / "sweep.toml").write_text(SWEEP)
    before = set(folder.iterdir())
    drawn = () if command == "export" else ("--no-figures",)
    result = flexapod(command, far, *options, *drawn)
    assert result.exit_code == 0, result.stderr
    assert (folder / "robots" / wrote).is_file()
    assert set(folder.iterdir()) == before
    assert str(Path("robots", wrote).parent if drawn else Path("robots", wrote)) in result.stdout.replace("\n", "")


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("run", ("--format", "pdf")),
        ("map", ("--x", "heave=0..1mm:2")),
        ("converge", ("--accuracy", "0.3")),
        ("sweep", ("sweep.toml", "--workers", "0")),
        ("modes", ()),
    ],
)
def test_no_figures(flexapod, far, folder, monkeypatch, command, options):
    (folder / "sweep.toml").write_text(SWEEP)
    monkeypatch.setattr(plan, "COUNTS", {"shapes": (1, 2), "elements": (1,), "segments": (1,)})
    monkeypatch.setattr("flexapod.output.figures.save", lambda *_, **__: pytest.fail("drawn"))
    result = flexapod(command, far, *options, "--no-figures", "--out", "out", "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["files"]
    written = [name for _, _, names in os.walk("out") for name in names]
    assert written and not [name for name in written if name.endswith(PICTURES)]


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("map", ("--x", "heave=0..1mm:2")),
        ("sweep", ("sweep.toml", "--workers", "0")),
        ("modes", ()),
        ("budget", ()),
        ("frf", ("--points", "2")),
    ],
)
def test_figures_in_the_formats_asked_for(flexapod, far, folder, command, options):
    (folder / "sweep.toml").write_text(SWEEP)
    result = flexapod(command, far, *options, "--format", "svg,pdf", "--out", "out", "--json")
    assert result.exit_code == 0, result.stderr
    assert {path.suffix for path in Path("out").iterdir() if path.suffix in PICTURES} == {".svg", ".pdf"}


def test_the_report_of_a_run_without_figures_keeps_the_answer_and_the_robot(flexapod, far):
    assert flexapod("run", far, "--no-figures").exit_code == 0
    page = Path("robots/mine-run/report.html").read_text(encoding="utf-8")
    assert "misses its rigid path by up to" in page and 'id="replay"' in page
    assert 'href="#figures"' not in page and "data:image/png" not in page


def test_no_figures_of_a_single_actuator(flexapod, study, folder):
    file = study(('duration = "10 s"', 'duration = "0.1 s"'), preset="paper-actuator")
    assert flexapod("actuator", file, "--no-figures").exit_code == 0
    assert {path.name for path in (folder / "study-run").iterdir()} == {"results.nc", "results.csv", "report.html"}
