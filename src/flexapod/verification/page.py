"""The pack as a page of the documentation: what is compared, with what, and why the tolerance is what it is."""

from __future__ import annotations

from collections.abc import Sequence

from flexapod.verification.pack import Outcome

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
    """How many cases and numbers agree."""
    passed, numbers = sum(o.passed for o in outcomes), sum(len(o.checks) for o in outcomes)
    missing = sum(bool(o.not_run) for o in outcomes)
    rest = f" {missing} not run." if missing else ""
    return f"{passed} of {len(outcomes)} cases pass, {numbers} numbers compared.{rest}"


def faults(outcome: Outcome) -> list[str]:
    """The references shown to be wrong, in words."""
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


def markdown(outcomes: Sequence[Outcome]) -> str:
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
