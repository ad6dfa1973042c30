"""`flexapod replicate`: the paper's whole study."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, Quiet

__all__ = ["add"]

Folder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the results.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("replicate")(replicate)


@guarded
def replicate(out: Folder = Path("replicate"), json: Json = False, quiet: Quiet = False) -> None:
    """Repeat the paper's whole study: figures, data, table of its claims, report."""
    from flexapod.app.outputs import check_writable
    from flexapod.app.replicate import replicate as repeat
    from flexapod.app.terminal import print_json, print_text, progress_bar
    from flexapod.study.paper.claims import claims
    from flexapod.study.summary import summary

    check_writable(out)
    with progress_bar(quiet=quiet or json) as report:
        result = repeat(out, progress=report)
    found, table = summary(result["robot"]), claims(result)
    if json:
        files = sorted(path for path in out.rglob("*") if path.is_file())
        print_json({"summary": found.as_dict(), "claims": [asdict(claim) for claim in table], "files": files})
        return
    print_text(found.sentence)
    print_text("The paper prints about 5 mm in Y and 10 mm in Z. Its claims one by one:")
    for claim in table:
        print_text(f"{claim.where}: {claim.says}: {claim.verdict} ({claim.ours})", indent=2)
    print_text()
    print_text(f"In {out}: report.html (open it in a browser), claims.md, figures/ and data/.")
