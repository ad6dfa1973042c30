"""`flexapod verify` and the page of the documentation that it writes."""

import json
import os
from pathlib import Path

import pytest
from tests.helpers.pack_outcomes import outcome

from flexapod.common.errors import ComputationError
from flexapod.solve.kernel import kernel
from flexapod.verification import pack
from flexapod.verification.case import Case, Check, checks
from flexapod.verification.cases import CASES
from flexapod.verification.engines.engine import CALCULIX, EXUDYN, MUJOCO, Engine
from flexapod.verification.pack import notes, verification_markdown

pytestmark = pytest.mark.cli

PAGE = (Path(__file__).parents[2] / "docs" / "verification.md").read_text(encoding="utf-8")
ROWS = {row[0]: row for line in PAGE.splitlines() if len(row := line.strip("| ").split(" | ")) == 6}
SECTIONS = {name: text for name, _, text in (part.partition("\n") for part in PAGE.split("\n### ")[1:])}
FAST = [case for case in CASES if not case.slow]
#: Files of cases that ask kernels for a few matrices: not optimised they have the same bits in a third of the time.
MATRICES = ("bending", "exports", "frequencies", "machines", "stiffness")


def subject(case):
    """The file that a case stands in."""
    return getattr(case.compute, "func", case.compute).__module__.rpartition(".")[2]


def shared(case):
    """What cases of a subject have in common is computed once, by one process; another subject may be by another."""
    return pytest.param(case.name, id=case.name, marks=pytest.mark.xdist_group(f"pack of {subject(case)}"))


@pytest.fixture
def compiled_as_called(name, monkeypatch):
    """Kernels of a case that has a few calls of them are not optimised."""
    few = any(case.name == name and subject(case) in MATRICES for case in FAST)
    if few:
        monkeypatch.setattr("flexapod.mechanics.symbolic.compiler.FLAGS", ("-O0",))
    yield
    if few:
        kernel.cache_clear()


@pytest.mark.usefixtures("compiled_as_called")
@pytest.mark.parametrize("name", [shared(case) for case in FAST])
def test_a_case_passes_says_why_and_is_what_the_page_shows(name):
    """The page is made by `flexapod verify --markdown docs/verification.md`.

    What varies from machine to machine is left out: which number of a case lies nearest to its tolerance, our own
    numbers, and references that an engine computes.
    """
    found = outcome(name)
    assert found.is_verified or (found.not_run and found.not_run == found.case.obstacle), found
    assert all((found.case.statement, found.case.source, found.case.argument))
    assert SECTIONS[name].strip() == verification_markdown([found]).partition(f"\n### {name}\n")[2].strip()
    row = ROWS[name]
    assert row[-1] == found.verdict
    if found.checks and found.case.engine is None:
        references = {c.what: f"{c.reference:.8g}" for c in found.checks}
        assert row[2].split(" ")[0] == references[row[1]]


def test_the_page_has_every_case_in_its_place():
    names = [case.name for case in FAST]
    assert len(names) == len(set(names)) >= 11
    assert [name for name in ROWS if name not in ("Case", "---")] == list(SECTIONS) == names


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
    assert "singularities: Ma & Angeles 1991" in run.stdout
    assert "singularities" in (folder / "a.md").read_text(encoding="utf-8")
    assert "Ma &amp; Angeles" in (folder / "a.html").read_text(encoding="utf-8")


def test_unknown_case(flexapod):
    run = flexapod("verify", "--only", "dietmeier")
    assert run.exit_code == 2
    assert "dietmaier" in run.stderr


def case(name, compute, **more):
    return Case(name=name, statement="s", source="s", argument="a", compute=compute, **more)


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


def outcome_of(*found):
    return pack.Outcome(case=case("x", refuse), checks=found, seconds=0.0)


def test_nan_does_not_pass_and_is_the_worst():
    good = Check(what="good", reference=1.0, ours=1.0, tolerance=1.0)
    nan = Check(what="nan", reference=1.0, ours=float("nan"), tolerance=1.0)
    assert not nan.within_tolerance
    assert outcome_of(good, nan).worst is nan
    assert not outcome_of(good, nan).is_verified


def test_a_case_that_compares_nothing_does_not_pass():
    assert not outcome_of().is_verified


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


NONE = Engine(name="Nastran", program="no-such-program", install="buy it")


def right():
    return checks(["x"], [2.0], [2.0], 1e-3)


def test_an_absent_engine_is_told_and_does_not_fail(flexapod, monkeypatch):
    cases = (case("right", right), case("absent", right, engine=NONE))
    monkeypatch.setattr(pack, "CASES", cases)
    run = flexapod("verify")
    assert run.exit_code == 0, run.stderr
    assert "Nastran is not installed: buy it" in " ".join(run.stdout.split())
    assert "1 of 2 cases pass, 1 numbers compared. 1 not run." in run.stdout
    found = {c["name"]: c for c in json.loads(flexapod("verify", "--json").stdout)["cases"]}
    assert [found[name]["verdict"] for name in ("right", "absent")] == ["pass", "not run"]
    assert not found["absent"]["passed"]


def test_slow_cases_come_with_all_or_by_name(flexapod, monkeypatch):
    monkeypatch.setattr(pack, "CASES", (case("fast", right), case("slow", right, slow=True)))

    def names(*words):
        return [c["name"] for c in json.loads(flexapod("verify", "--json", *words).stdout)["cases"]]

    assert (names(), names("--all"), names("--only", "slow")) == (["fast"], ["fast", "slow"], ["slow"])


def test_a_reference_at_fault_is_told_and_does_not_count():
    wrong = Check(what="x", reference=1.0, ours=1.1, tolerance=1e-3, fault="It is not converged.")
    assert not outcome_of(wrong).is_verified  # nothing else was compared
    both = outcome_of(wrong, *right())
    assert both.is_verified
    assert "x: the reference gives 1, we 1.1. It is not converged." in notes(both)


@pytest.mark.parametrize("engine", [CALCULIX, EXUDYN, MUJOCO], ids=lambda engine: engine.name)
def test_engines_that_the_environment_promises_are_there(engine):
    if os.environ.get("FLEXAPOD_ENGINES") != "required":
        pytest.skip("FLEXAPOD_ENGINES=required makes an absent engine a failure")
    assert engine.is_available(), engine.install
