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
        return [row[:3] + row[4:] if len(row) > 5 else row for row in rows]

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
        case("faulty", lambda: 1 / 0),
        case("right", lambda: checks(["x"], [2.0], [2.0], 1e-3)),
    )
    monkeypatch.setattr(pack, "CASES", cases)
    run = flexapod("verify", "--json")
    assert run.exit_code == 1
    found = {c["name"]: c for c in json.loads(run.stdout)["cases"]}
    assert [found[name]["passed"] for name in ("wrong", "broken", "faulty", "right")] == [False, False, False, True]
    assert "no engine here" in found["broken"]["failure"]


def outcome(*found):
    return pack.Outcome(case=case("x", refuse), checks=found, seconds=0.0)


def test_nan_does_not_pass_and_is_the_worst():
    good = Check(what="good", reference=1.0, ours=1.0, tolerance=1.0)
    nan = Check(what="nan", reference=1.0, ours=float("nan"), tolerance=1.0)
    assert not nan.passed
    assert outcome(good, nan).worst is nan
    assert not outcome(good, nan).passed


def test_a_case_that_compares_nothing_does_not_pass():
    assert not outcome().passed


def test_a_reference_of_zero_has_no_relative_error():
    with pytest.raises(ValueError, match="absolute"):
        Check(what="x", reference=0.0, ours=0.0, tolerance=1.0)


def stop():
    raise KeyboardInterrupt


def test_a_pack_that_is_stopped_does_not_pass_and_writes_no_page(flexapod, folder, monkeypatch):
    right = case("right", lambda: checks(["x"], [2.0], [2.0], 1e-3))
    monkeypatch.setattr(pack, "CASES", (right, case("stopped", stop)))
    run = flexapod("verify", "--json", "--markdown", "a.md")
    assert run.exit_code == 130
    found = json.loads(run.stdout)
    assert (found["passed"], found["complete"], len(found["cases"])) == (False, False, 1)
    assert not (folder / "a.md").exists()
