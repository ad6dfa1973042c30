"""Verification pack: every case run by itself, and the outcomes as a page of the documentation.

A failure of one case leaves the others. The page says what is compared, with what, and why the tolerance is
what it is.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from flexapod.analysis.results.time_history import Report
from flexapod.common.errors import FlexapodError, check_known
from flexapod.verification.case import Case, Check
from flexapod.verification.cases import CASES


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Outcome of a case: its checks, or why it failed or was not run; `seconds` it took."""

    case: Case
    checks: tuple[Check, ...]
    seconds: float
    failure: str = ""
    not_run: str = ""

    @property
    def valid_checks(self) -> tuple[Check, ...]:
        """The checks whose reference is not at fault."""
        return tuple(check for check in self.checks if not check.fault)

    @property
    def is_verified(self) -> bool:
        """Test whether all checks were computed and are within tolerance, those of wrong references aside."""
        return (
            not self.failure and bool(self.valid_checks) and all(check.within_tolerance for check in self.valid_checks)
        )

    @property
    def verdict(self) -> str:
        """Verdict as text: pass, fail, not run, not computed."""
        if self.not_run:
            return "not run"
        if self.failure:
            return "not computed"
        return "pass" if self.is_verified else "fail"

    @property
    def worst(self) -> Check | None:
        """The check that comes nearest to its tolerance or exceeds it most; None if nothing was computed."""
        return max(self.valid_checks, key=lambda check: check.strain, default=None)

    def as_dict(self) -> dict[str, object]:
        """Outcome as a dictionary of plain data."""
        rows = [{**asdict(check), "error": check.error, "passed": check.within_tolerance} for check in self.checks]
        words = {name: getattr(self.case, name) for name in ("name", "statement", "source", "argument")}
        state = {"verdict": self.verdict, "passed": self.is_verified, "failure": self.failure, "not_run": self.not_run}
        return {**words, **state, "seconds": self.seconds, "checks": rows}


def verify(
    only: Sequence[str] = (),
    *,
    slow: bool = False,
    progress: Report | None = None,
    keep: Callable[[Outcome], None] | None = None,
) -> tuple[Outcome, ...]:
    """Compute the cases of the verification pack.

    Parameters
    ----------
    only : sequence of str
        Names of cases; none: all that are not slow.
    slow : bool
        Also the slow ones.
    progress : callable, optional
        Called with the name of the case and the share of the whole that is done.
    keep : callable, optional
        Called with each outcome as soon as it is there.

    Returns
    -------
    tuple of Outcome
        In the order of the pack.

    Raises
    ------
    InputError
        A name that no case has.
    """
    chosen = _chosen(only, slow)
    outcomes = []
    for i, case in enumerate(chosen):
        if progress is not None:
            progress(case.name, i / len(chosen))
        outcomes.append(_computed(case))
        if keep is not None:
            keep(outcomes[-1])
    return tuple(outcomes)


def _chosen(only: Sequence[str], slow: bool) -> list[Case]:
    names = [case.name for case in CASES]
    for name in only:
        check_known(name, names, "--only", "is not a case")
    return [case for case in CASES if case.name in only or (not only and (slow or not case.slow))]


def _computed(case: Case) -> Outcome:
    if obstacle := case.obstacle:
        return Outcome(case=case, checks=(), seconds=0.0, not_run=obstacle)
    begin = time.perf_counter()
    try:
        found, failure = tuple(case.compute()), ""
    except Exception as error:  # whatever a case does, the others are computed
        words = str(error) if isinstance(error, FlexapodError) else f"{type(error).__name__}: {error}"
        found, failure = (), words
    return Outcome(case=case, checks=found, seconds=time.perf_counter() - begin, failure=failure)


HEAD = ("Case", "Nearest to its tolerance", "Reference", "Ours", "Tolerance", "Verdict", "Time")


def rows(outcomes: Sequence[Outcome]) -> list[tuple[str, ...]]:
    """A row for each case, under `HEAD`: the check that comes nearest to its tolerance."""
    return [_row(outcome) for outcome in outcomes]


def _row(outcome: Outcome) -> tuple[str, ...]:
    worst, time = outcome.worst, f"{outcome.seconds:.2g} s"
    if worst is None:
        return (outcome.case.name, outcome.failure or outcome.not_run, "", "", "", outcome.verdict, time)
    unit = "" if worst.unit == "1" else f" {worst.unit}"
    bound = f"{worst.tolerance:.2g}{unit}" if worst.absolute else f"{worst.tolerance:.2g} of it"
    reference, ours = (f"{value:.8g}{unit}" for value in (worst.reference, worst.ours))
    return (outcome.case.name, worst.what, reference, ours, bound, outcome.verdict, time)


def sentence(outcomes: Sequence[Outcome]) -> str:
    """Summary of outcomes in a sentence: cases that pass, numbers compared, cases not run."""
    passed, numbers = sum(o.is_verified for o in outcomes), sum(len(o.checks) for o in outcomes)
    missing = sum(bool(o.not_run) for o in outcomes)
    rest = f" {missing} not run." if missing else ""
    return f"{passed} of {len(outcomes)} cases pass, {numbers} numbers compared.{rest}"


def faults(outcome: Outcome) -> list[str]:
    """References shown to be wrong, a sentence each."""
    return [
        f"{c.what}: the reference gives {c.reference:.8g}, we {c.ours:.8g}. {c.fault}"
        for c in outcome.checks
        if c.fault
    ]


def notes(outcome: Outcome) -> list[str]:
    """Source, tolerance and faults of references of a case, a sentence each."""
    engine = outcome.case.engine
    asked = [f"Engine: {engine.name}, `{engine.install}`."] if engine else []
    told = [f"Source: {outcome.case.source}.", *asked, f"Tolerance: {outcome.case.argument}."]
    return [*told, *faults(outcome)]


def verification_markdown(outcomes: Sequence[Outcome]) -> str:
    """The page `docs/verification.md`."""
    table = [HEAD[:-1], ("---",) * (len(HEAD) - 1), *(row[:-1] for row in rows(outcomes))]
    lines = ["| " + " | ".join(cells) + " |" for cells in table]
    cases = [
        f"### {o.case.name}\n\n{o.case.statement}: {len(o.checks)} numbers.\n\n"
        + "\n".join(f"- {line}" for line in notes(o))
        for o in outcomes
    ]
    head = (
        "# Verification\n\nWritten by `flexapod verify --markdown FILE`, which computes every number on the spot. "
        "Many more comparisons are in `tests/`.\n"
    )
    return "\n".join([head, sentence(outcomes), "", *lines, "", "## Cases", "", "\n\n".join(cases), ""])
