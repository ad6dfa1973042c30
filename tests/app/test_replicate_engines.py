"""`flexapod replicate --engines`: what it says, writes, refuses, and how it stops. The engine has tests of its own."""

import json
import os
import re
import signal
import subprocess
import sys
from dataclasses import replace

import pytest
from tests.helpers.paper_parts import at_hand

from flexapod import model
from flexapod.analysis import modes, simulate, simulate_actuator
from flexapod.common.errors import ComputationError
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.paper import engines
from flexapod.verification.paper import figures as paper_figures
from flexapod.verification.paper.outputs import replicate
from flexapod.verification.paper.report import paper_page
from flexapod.verification.paper.study import PaperStudy

pytestmark = pytest.mark.cli

ASKED = {
    "engine": "Exudyn", "engine_version": "1.2.3", "elements": [30, 60], "guide": [0.01, 0.005], "step": 2.5e-4,
    "seconds": 12.0, "refinement_com_deviation": [1e-9, 2e-9, 3e-9], "refinement_actuator_force": 0.5,
    "refinement_tip_deflection": 1e-7,
}  # fmt: skip


@pytest.fixture(scope="module")
def parts():
    """What the report needs of the study, from one short run, and an engine that differs by 2 nm and 3 N."""
    study = model.preset("paper-robot")
    motion = model.AxisMotion(type="roll", amplitude=0.003, duration=0.08, hold=0.02)
    ours = simulate(study.replace(motion=motion), step=1e-3, output_step=1e-3, duration=0.1)
    theirs = ours.assign(com_deviation=ours.com_deviation + 2e-9, actuator_force=ours.actuator_force + 3.0)
    theirs = theirs.assign_attrs(ASKED)
    plain = {name: ours for name in ("robot", "robot-rigid", "jump", "robot-rigid-same-step", "robot-undamped")}
    actuator = simulate_actuator(model.preset("paper-actuator"), modes=1, step=1e-3, duration=0.01)
    plain["modes"] = modes(study)
    return {**plain, "actuator-3": actuator, "robot-exudyn-rigid": theirs, "robot-exudyn": theirs}


@pytest.fixture
def few(monkeypatch):
    """No claims, and only the figures of the engine."""
    for module in ("claims", "outputs"):
        monkeypatch.setattr(f"flexapod.verification.paper.{module}.claims", lambda _: [])
    for name in ("_actuator", "_robot", "_outlook", "_variants"):
        monkeypatch.setattr(paper_figures, name, lambda _: [])


def replaced(monkeypatch, result):
    def repeat(folder, *, engines, formats, progress):
        assert engines
        folder.mkdir(exist_ok=True)
        (folder / "report.html").write_text("page")
        return result

    monkeypatch.setattr("flexapod.verification.paper.outputs.replicate", repeat)


def test_answer(flexapod, few, parts, monkeypatch):
    replaced(monkeypatch, PaperStudy(parts=parts))
    result = flexapod("replicate", "--engines")
    assert result.exit_code == 0, result.stderr
    assert "Exudyn, an independent engine, against us" in result.stdout
    assert re.search(
        r"deviation of the centre of mass in Y: ours [\d.]+ µm, Exudyn .* at most 2 nm apart", result.stdout
    )
    rows = json.loads(flexapod("replicate", "--engines", "--json").stdout)["engines"]
    force = next(row for row in rows if row["quantity"] == "drive force, flexible legs")
    assert (force["unit"], force["refinement"]) == ("N", 0.5)
    assert force["difference"] == pytest.approx(3.0)
    assert rows[0]["refinement"] is None


def test_engine_that_fails_is_told_when_all_else_is_written(flexapod, few, parts, monkeypatch):
    error = ComputationError("Exudyn crashed (SIGSEGV)", next_step="Use fewer elements")
    own = {name: data for name, data in parts.items() if "exudyn" not in name}
    replaced(monkeypatch, PaperStudy(parts=own, failures={"robot-exudyn": error}))
    result = flexapod("replicate", "--engines")
    assert result.exit_code == 1
    assert "In replicate: report.html" in result.stdout
    assert "Exudyn crashed (SIGSEGV)" in result.stderr and "Use fewer elements" in result.stderr
    page = paper_page(PaperStudy(parts=own, failures={"robot-exudyn": error}), [], {})
    assert "Not computed: robot-exudyn: Exudyn crashed (SIGSEGV)" in page


def test_report_names_engine_version_settings_and_how_to_repeat(few, parts, tmp_path, monkeypatch):
    monkeypatch.setattr("flexapod.verification.paper.outputs.compute", at_hand(PaperStudy(parts=parts)))
    replicate(tmp_path)
    for name in ("engine-forces-rigid", "engine-forces-flexible", "engine-com-path"):
        assert (tmp_path / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for name in ("robot-exudyn", "robot-exudyn-rigid", "robot-undamped", "robot-rigid-same-step"):
        assert {f"{name}.nc", f"{name}.csv"} <= {path.name for path in (tmp_path / "data").iterdir()}
    page = (tmp_path / "report.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert '<a href="#independent-engine">Independent engine</a>' in page
    section = page.split('<section id="independent-engine">')[1].split("</section>")[0]
    for words in ("Exudyn 1.2.3", "24 s", "steps of 0.25 ms", "30 and 60 cable elements", "10 and 5 mm apart", "2 nm"):
        assert words in section
    assert len(re.findall("<figure[ >]", section)) == 3
    assert "pip install" in section and "flexapod replicate --engines --out DIR" in section
    assert page.count("flexapod replicate --engines --out DIR") == 2


def test_report_without_the_engine_does_not_speak_of_it(few, parts):
    own = {name: data for name, data in parts.items() if "exudyn" not in name}
    page = paper_page(PaperStudy(parts=own), [], {})
    assert "independent-engine" not in page and "--engines" not in page
    assert "flexapod replicate --out DIR" in page


def test_absent_engine_is_refused_before_anything_is_touched(flexapod, folder, monkeypatch):
    monkeypatch.setattr(engines, "EXUDYN", replace(EXUDYN, module="no_such_module"))
    (folder / "old").mkdir()
    (folder / "old" / "report.html").write_text("of an older run")
    result = flexapod("replicate", "--engines", "--out", "old")
    assert result.exit_code == 2
    assert "not installed" in result.stderr and EXUDYN.install in result.stderr
    assert [path.name for path in (folder / "old").iterdir()] == ["report.html"]
    error = json.loads(flexapod("replicate", "--engines", "--json").stderr)["error"]
    assert (error["key"], error["exit_code"]) == ("--engines", 2)


#: The command without its other parts, in a process that sends itself SIGINT while Exudyn computes.
PROGRAM = """
import os, signal, subprocess, sys
from contextlib import contextmanager
from flexapod.app.cli import cli, commands_proof
from flexapod.verification.paper import study

started, told = [], []
class Popen(subprocess.Popen):
    def __init__(self, *arguments, **settings):
        super().__init__(*arguments, **settings)
        started.append(self)

@contextmanager
def bar(*, quiet):
    def report(words, share):
        if started and not told:
            told.append(words)
            os.kill(os.getpid(), signal.SIGINT)
    yield report

subprocess.Popen, commands_proof.terminal.progress_bar, study.STEPS = Popen, bar, ()
study.ENGINE_STEPS = study.ENGINE_STEPS[-1:]
sys.argv = ["flexapod", "replicate", "--engines", "--out", sys.argv[1]]
try:
    cli.main()
finally:
    print(told, [process.wait(5) for process in started])
"""


@pytest.mark.skipif(sys.platform == "win32" or not EXUDYN.is_available(), reason="needs Exudyn and SIGINT")
def test_ctrl_c_ends_the_engine(folder):
    def heed_interrupts():
        signal.signal(signal.SIGINT, signal.default_int_handler)

    command = [sys.executable, "-c", PROGRAM, "out"]
    environment = os.environ | {"TMPDIR": str(folder)}
    run = subprocess.run(
        command, capture_output=True, text=True, timeout=300, preexec_fn=heed_interrupts, env=environment
    )
    assert run.returncode == 130, run.stderr
    assert "stopped by Ctrl-C" in run.stderr and "Traceback" not in run.stderr
    # the shell that watches over the engine, and the engine
    assert run.stdout.strip() == f"['Exudyn, flexible legs'] {[-signal.SIGKILL.value] * 2}"
    assert not list(folder.glob("flexapod-*"))
