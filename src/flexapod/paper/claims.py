"""The claims and figures of the paper one by one: what it says, what we get, verdict, reason."""

from __future__ import annotations

from collections.abc import Sequence

from flexapod.paper.claim import Claim
from flexapod.paper.claims_actuator import actuator_claims
from flexapod.paper.claims_readings import reading_claims
from flexapod.paper.claims_rigid import rigid_claims
from flexapod.paper.claims_robot import robot_claims
from flexapod.paper.claims_variants import explanation_claims, variant_claims
from flexapod.paper.study import PaperStudy

CLAIM_HEAD = ("Where", "The paper", "What we get", "Verdict", "Reason")


def claims(result: PaperStudy) -> tuple[Claim, ...]:
    """All claims in the order of the paper, then other readings, what the deviation depends on, what would give it.

    Parameters
    ----------
    result : PaperStudy
        From `replicate`.
    """
    return (
        *actuator_claims(result),
        *rigid_claims(result),
        *robot_claims(result),
        *reading_claims(result),
        *variant_claims(result),
        *explanation_claims(result),
    )


def markdown(table: Sequence[Claim]) -> str:
    """The claims as a table in Markdown."""
    rows = [(c.where, c.says, c.ours, f"**{c.verdict}**", c.reason) for c in table]
    lines = [_line(CLAIM_HEAD), _line(("---",) * len(CLAIM_HEAD)), *(_line(row) for row in rows)]
    return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
