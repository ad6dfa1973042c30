"""The claims and figures of the paper one by one: what it says, what we get, verdict, reason."""

from __future__ import annotations

from collections.abc import Sequence

from flexapod.paper import (
    claims_actuator,
    claims_readings,
    claims_rigid,
    claims_robot,
    claims_variants,
    claims_welded,
)
from flexapod.paper.claim import Claim
from flexapod.paper.rows import ClaimRow
from flexapod.paper.study import PaperStudy

CLAIM_HEAD = ("Where", "The paper", "What we get", "Verdict", "Reason")
_SUBJECTS = (claims_actuator, claims_rigid, claims_robot, claims_readings, claims_variants, claims_welded)

#: In the order of the paper, then other readings, what the deviation depends on, what would give it.
ROWS = tuple(row for module in _SUBJECTS for row in vars(module).values() if isinstance(row, ClaimRow))


def claims(result: PaperStudy) -> tuple[Claim, ...]:
    """All claims in the order of `ROWS`.

    Parameters
    ----------
    result : PaperStudy
        From `replicate`.
    """
    return tuple(claim for row in ROWS for claim in row.claims(result))


def markdown(table: Sequence[Claim]) -> str:
    """The claims as a table in Markdown."""
    rows = [(c.where, c.says, c.ours, f"**{c.verdict}**", c.reason) for c in table]
    lines = [_line(CLAIM_HEAD), _line(("---",) * len(CLAIM_HEAD)), *(_line(row) for row in rows)]
    return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
