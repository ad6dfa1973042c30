"""`flexapod replicate`: the paper's whole study."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, NoFigures, Quiet

if TYPE_CHECKING:
    from flexapod.paper.study import PaperStudy

__all__ = ["add"]

Folder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the results.")]
Engines = Annotated[
    bool, typer.Option("--engines", help="Also Figs. 8 and 9 by an independent engine, Exudyn (half a minute more).")
]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("replicate")(replicate)


@guarded
def replicate(
    out: Folder = Path("replicate"), engines: Engines = False, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Repeat the paper's whole study: figures, data, table of its claims, report."""
    from flexapod.app.outputs import check_writable
    from flexapod.app.terminal import print_json, print_text, progress_bar
    from flexapod.paper.claims import claims
    from flexapod.paper.engines import agreements
    from flexapod.paper.outputs import replicate as repeat
    from flexapod.study.after.summary import summary

    check_writable(out)
    with progress_bar(quiet=quiet or json) as report:
        result = repeat(out, engines=engines, figures=not no_figures, progress=report)
    found, table, agreed = summary(result["robot"]), claims(result), agreements(result.parts)
    if json:
        files = sorted(path for path in out.rglob("*") if path.is_file())
        more = {"engines": [asdict(row) for row in agreed]} if engines else {}
        print_json({"summary": found.as_dict(), "claims": [asdict(claim) for claim in table], **more, "files": files})
        _fail(result)
        return
    print_text(found.sentence)
    print_text("The paper prints about 5 mm in Y and 10 mm in Z. Its claims one by one:")
    for claim in table:
        print_text(f"{claim.where}: {claim.says}: {claim.verdict} ({claim.ours})", indent=2)
    if agreed:
        print_text("Exudyn, an independent engine, against us (largest values):")
    for row in agreed:
        print_text(f"{row.quantity}: {row.words}", indent=2)
    print_text()
    print_text(
        f"In {out}: report.html (open it in a browser), claims.md, {'' if no_figures else 'figures/ '}and data/."
    )
    _fail(result)


def _fail(result: PaperStudy) -> None:
    """Raise what went wrong in an engine, when all else is written and said."""
    for error in result.failures.values():
        raise error
