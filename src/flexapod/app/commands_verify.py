"""`flexapod verify`: the verification pack, computed on the spot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, Quiet

if TYPE_CHECKING:
    from flexapod.proof.pack import Outcome

__all__ = ["add"]

Only = Annotated[list[str] | None, typer.Option("--only", metavar="NAME", help="This case; may be given again.")]
All = Annotated[bool, typer.Option("--all", help="Also the slow cases (minutes).")]
Page = Annotated[Path | None, typer.Option("--html", metavar="FILE", help="Also write the table as a page.")]
Markdown = Annotated[Path | None, typer.Option("--markdown", metavar="FILE", help="Also write it as Markdown.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("verify")(verify)


@guarded
def verify(
    only: Only = None,
    slow: All = False,
    html: Page = None,
    markdown: Markdown = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute cases with published or closed-form answers: reference, ours, tolerance, verdict, time."""
    from flexapod.app.outputs import check_writable
    from flexapod.app.terminal import print_json, print_table, print_text, progress_bar
    from flexapod.proof import page
    from flexapod.proof.pack import verify as compute

    for key, file in (("--html", html), ("--markdown", markdown)):
        check_writable(None if file is None else file.parent, key)
    outcomes: list[Outcome] = []
    interrupted = False
    with progress_bar(quiet=quiet or json) as report:
        try:
            compute(only or (), slow=slow, progress=report, keep=outcomes.append)
        except KeyboardInterrupt:
            interrupted = True
    passed = not interrupted and all(o.passed or o.not_run for o in outcomes)
    if not interrupted:
        _write(outcomes, html, markdown)
    if json:
        state = {"passed": passed, "complete": not interrupted}
        print_json({**state, "cases": [o.as_dict() for o in outcomes]})
    else:
        print_table(page.HEAD, page.rows(outcomes), left=(0, 1))
        print_text()
        print_text("Sources of the references")
        for o in outcomes:
            print_text(f"  {o.case.name}: {o.case.source}")
            for fault in page.faults(o):
                print_text(f"    {fault}")
        print_text()
        print_text(page.sentence(outcomes))
    if interrupted:
        raise KeyboardInterrupt
    if not passed:
        raise typer.Exit(1)


def _write(outcomes: list[Outcome], html: Path | None, markdown: Path | None) -> None:
    from flexapod.files import replacing
    from flexapod.proof import page
    from flexapod.report import html as parts

    if markdown is not None:
        with replacing(markdown) as file:
            file.write_text(page.markdown(outcomes), encoding="utf-8")
    if html is not None:
        marks = {"pass": "good", "fail": "bad", "not computed": "bad", "not run": "open"}
        cases = [
            parts.section(o.case.name, o.case.name, parts.paragraph(f"{o.case.statement}."),
                          parts.bullets(page.notes(o)), _checks(o))
            for o in outcomes
        ]  # fmt: skip
        table = parts.table(page.HEAD, page.rows(outcomes), marks)
        with replacing(html) as file:
            text = parts.page("flexapod: verification", page.sentence(outcomes), [table, *cases])
            file.write_text(text, encoding="utf-8")


def _checks(outcome: Outcome) -> str:
    from flexapod.report import html as parts

    head = ("What", "Reference", "Ours", "Error", "Tolerance", "Verdict")
    rows = [
        (c.what, f"{c.reference:.10g}", f"{c.ours:.10g}", f"{c.error:.2g}", f"{c.tolerance:.2g}",
         "reference at fault" if c.fault else "pass" if c.passed else "fail")
        for c in outcome.checks
    ]  # fmt: skip
    return parts.table(head, rows, {"pass": "good", "fail": "bad"})
