"""Commands that prove: `replicate` repeats the paper's study, `verify` the verification pack."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    USUAL,
    Format,
    Json,
    NoFigures,
    Quiet,
    check_writable,
    parse_formats,
)
from flexapod.common.files import write_text
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text import terminal
from flexapod.output.text.parts import Bullets, Chapter, Item, TextTable

if TYPE_CHECKING:
    from flexapod.analysis.results import summary
    from flexapod.output.text import html as text_html
    from flexapod.verification import pack
    from flexapod.verification.pack import Outcome
    from flexapod.verification.paper import claims, outputs
    from flexapod.verification.paper import engines as paper_engines
    from flexapod.verification.paper.study import PaperStudy
else:
    summary = LazyModule("flexapod.analysis.results.summary")
    text_html = LazyModule("flexapod.output.text.html")
    pack = LazyModule("flexapod.verification.pack")
    claims = LazyModule("flexapod.verification.paper.claims")
    paper_engines = LazyModule("flexapod.verification.paper.engines")
    outputs = LazyModule("flexapod.verification.paper.outputs")

Folder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the results.")]
Engines = Annotated[
    bool, typer.Option("--engines", help="Also Figs. 8 and 9 by an independent engine, Exudyn (half a minute more).")
]


@report_failures
def replicate(
    out: Folder = Path("replicate"), engines: Engines = False, formats: Format = USUAL,
    no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Repeat the paper's whole study: figures, data, table of its claims, report."""
    check_writable(out)
    drawn = parse_formats(formats, no_figures)
    with terminal.progress_bar(quiet=quiet or json) as report:
        result = outputs.replicate(out, engines=engines, formats=drawn, progress=report)
    found, table, agreed = (
        summary.summary(result["robot"]),
        claims.claims(result),
        paper_engines.agreements(result.parts),
    )

    def data() -> dict[str, object]:
        files = sorted(path for path in out.rglob("*") if path.is_file())
        more = {"engines": [asdict(row) for row in agreed]} if engines else {}
        return {"summary": found.as_dict(), "claims": [asdict(claim) for claim in table], **more, "files": files}

    items: list[Item] = [found.sentence, "The paper prints about 5 mm in Y and 10 mm in Z."]
    for title, some in claims.group_by_owner(table).items():
        told = [f"{claim.where}: {claim.says}: {claim.verdict} ({claim.ours})" for claim in some]
        items.append(Chapter(f"{title} ({claims.verdict_summary(some)[:-1]}):", told))
    if agreed:
        theirs = [f"{row.quantity}: {row.words}" for row in agreed]
        items += [Chapter("Exudyn, an independent engine, against us (largest values):", theirs, close=True)]
    figures = "" if no_figures else "figures/ "
    items += ["", f"In {out}: report.html (open it in a browser), claims.md, {figures}and data/."]
    terminal.print_answer(items, data, json=json)
    _fail(result)


def _fail(result: PaperStudy) -> None:
    """Raise what went wrong in an engine, when all else is written and said."""
    for error in result.failures.values():
        raise error


Only = Annotated[list[str] | None, typer.Option("--only", metavar="NAME", help="This case; may be given again.")]
All = Annotated[bool, typer.Option("--all", help="Also the slow cases (minutes).")]
Page = Annotated[Path | None, typer.Option("--html", metavar="FILE", help="Also write the table as a page.")]
Markdown = Annotated[Path | None, typer.Option("--markdown", metavar="FILE", help="Also write it as Markdown.")]


@report_failures
def verify(
    only: Only = None,
    slow: All = False,
    html: Page = None,
    markdown: Markdown = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute cases with published or closed-form answers: reference, ours, tolerance, verdict, time."""
    for key, file in (("--html", html), ("--markdown", markdown)):
        check_writable(None if file is None else file.parent, key)
    outcomes: list[Outcome] = []
    interrupted = False
    with terminal.progress_bar(quiet=quiet or json) as report:
        try:
            pack.verify(only or (), slow=slow, progress=report, keep=outcomes.append)
        except KeyboardInterrupt:
            interrupted = True
    passed = not interrupted and all(o.is_verified or o.not_run for o in outcomes)
    if not interrupted:
        _write(outcomes, html, markdown)
    state = {"passed": passed, "complete": not interrupted}
    terminal.print_answer(_verified(outcomes), lambda: {**state, "cases": [o.as_dict() for o in outcomes]}, json=json)
    if interrupted:
        raise KeyboardInterrupt
    if not passed:
        raise typer.Exit(1)


def _verified(outcomes: list[Outcome]) -> Iterator[Item]:
    """The table of the cases, sources of their references, how many agree."""
    yield TextTable(pack.HEAD, pack.rows(outcomes), left=(0, 1))
    yield ""
    yield "Sources of the references"
    for o in outcomes:
        yield f"  {o.case.name}: {o.case.source}"
        yield from (f"    {fault}" for fault in pack.faults(o))
    yield ""
    yield pack.sentence(outcomes)


def _write(outcomes: list[Outcome], html: Path | None, markdown: Path | None) -> None:
    if markdown is not None:
        write_text(markdown, pack.verification_markdown(outcomes))
    if html is not None:
        marks = {"pass": "good", "fail": "bad", "not computed": "bad", "not run": "open"}
        cases = [
            text_html.section(o.case.name, o.case.name, [f"{o.case.statement}.", Bullets(pack.notes(o)), _checks(o)])
            for o in outcomes
        ]
        table = TextTable(pack.HEAD, pack.rows(outcomes), marks=marks)
        write_text(html, text_html.page("flexapod: verification", pack.sentence(outcomes), [table, *cases]))


def _checks(outcome: Outcome) -> TextTable:
    head = ("What", "Reference", "Ours", "Error", "Tolerance", "Verdict")
    rows = [
        (c.what, f"{c.reference:.10g}", f"{c.ours:.10g}", f"{c.error:.2g}", f"{c.tolerance:.2g}",
         "reference at fault" if c.fault else "pass" if c.within_tolerance else "fail")
        for c in outcome.checks
    ]  # fmt: skip
    return TextTable(head, rows, marks={"pass": "good", "fail": "bad"})
