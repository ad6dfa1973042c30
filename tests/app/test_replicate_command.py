"""`flexapod replicate` on the terminal; what it computes and draws has tests of its own."""

import json

import pytest
from tests.helpers.paper_parts import whole_study

from flexapod.common.errors import ComputationError

pytestmark = [pytest.mark.cli, pytest.mark.xdist_group("claims")]  # one process computes the parts
ANGLES = (10.0, 29.0)


def replaced(monkeypatch, action):
    def repeat(folder, *, engines, formats, progress):
        progress("robot", 0.5)
        folder.mkdir()
        (folder / "report.html").write_text("page")
        return action()

    monkeypatch.setattr("flexapod.verification.paper.outputs.replicate", repeat)


def test_answer_and_claims(flexapod, folder, monkeypatch):
    replaced(monkeypatch, lambda: whole_study(ANGLES))
    result = flexapod("replicate")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("The payload's centre of mass misses its rigid path by up to")
    assert "Fig. 9" in result.stdout
    assert "does not hold" in result.stdout
    titles = ("The paper's own claims (22 rows: holds 6", "What the paper asks for next (7 rows", "Variants of ours")
    places = [result.stdout.index(title) for title in titles]
    assert places == sorted(places)
    assert "In replicate: report.html" in result.stdout
    data = json.loads(flexapod("replicate", "--out", "other", "--json").stdout)
    assert data["files"] == ["other/report.html"]
    assert data["summary"]["largest_cause"] == "axial-strain"
    assert {"whose", "where", "says", "ours", "verdict", "reason"} == set(data["claims"][0])


def test_failures(flexapod, folder, monkeypatch):
    def fail():
        raise ComputationError("the robot cannot start", next_step="See `flexapod check`")

    def stop():
        raise KeyboardInterrupt

    replaced(monkeypatch, fail)
    result = flexapod("replicate", "--out", "a")
    assert result.exit_code == 1
    assert "the robot cannot start" in result.stderr
    replaced(monkeypatch, stop)
    result = flexapod("replicate", "--out", "b")
    assert result.exit_code == 130
    assert "stopped by Ctrl-C; files already written are whole" in result.stderr
    (folder / "taken").write_text("")
    assert flexapod("replicate", "--out", "taken").exit_code == 2
