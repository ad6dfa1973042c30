"""`flexapod verify` and the page of the documentation that it writes."""

import json
from pathlib import Path

import pytest

from flexapod.errors import ComputationError
from flexapod.study.verify import pack
from flexapod.study.verify.case import Case, Check, checks
from flexapod.study.verify.page import markdown

PAGE = Path(__file__).parents[2] / "docs" / "verification.md"


@pytest.fixture(scope="module")
def outcomes():
    return pack.verify()


def test_every_case_passes_and_says_why(outcomes):
    assert len(outcomes) == len({outcome.case.name for outcome in outcomes}) >= 11
    for outcome in outcomes:
        assert outcome.passed, outcome
        assert all((outcome.case.statement, outcome.case.source, outcome.case.argument, outcome.checks))


def test_the_page_is_what_the_program_writes(outcomes):
    """Made by `flexapod verify --markdown docs/verification.md`; our own numbers may vary and are left out."""

    def fixed(text):
        rows = [line.split(" | ") for line in text.splitlines()]
        return [row[:1] + row[-2:] if len(row) > 5 else row for row in rows]

    assert fixed(PAGE.read_text(encoding="utf-8")) == fixed(markdown(outcomes))


def test_json_of_one_case(flexapod):
    run = flexapod("verify", "--only", "cubic-hexapod", "--json")
    assert run.exit_code == 0, run.stderr
    found = json.loads(run.stdout)
    assert found["passed"] is True
    assert [case["name"] for case in found["cases"]] == ["cubic-hexapod"]
    assert {"what", "reference", "ours", "error", "tolerance", "passed"} <= set(found["cases"][0]["checks"][0])


def test_files(flexapod, folder):
    run = flexapod("verify", "--only", "singularities", "--html", "a.html", "--markdown", "a.md")
    assert run.exit_code == 0, run.stderr
    assert "1 of 1 cases pass" in run.stdout
    assert "singularities" in (folder / "a.md").read_text(encoding="utf-8")
    assert "Ma &amp; Angeles" in (folder / "a.html").read_text(encoding="utf-8")


def test_unknown_case(flexapod):
    run = flexapod("verify", "--only", "dietmeier")
    assert run.exit_code == 2
    assert "dietmaier" in run.stderr


def case(name, compute):
    return Case(name=name, statement="s", source="s", argument="a", compute=compute)


def refuse():
    raise ComputationError("no engine here")


def test_a_failed_case_leaves_the_others(flexapod, monkeypatch):
    cases = (
        case("wrong", lambda: [Check(what="x", reference=1.0, ours=1.1, tolerance=1e-3)]),
        case("broken", refuse),
        case("right", lambda: checks(["x"], [2.0], [2.0], 1e-3)),
    )
    monkeypatch.setattr(pack, "CASES", cases)
    run = flexapod("verify", "--json")
    assert run.exit_code == 1
    found = {c["name"]: c for c in json.loads(run.stdout)["cases"]}
    assert [found[name]["passed"] for name in ("wrong", "broken", "right")] == [False, False, True]
    assert "no engine here" in found["broken"]["failure"]


def test_nan_does_not_pass():
    assert not Check(what="x", reference=1.0, ours=float("nan"), tolerance=1.0).passed
