"""The claims of the paper one by one, by whose they are: what it says, what we get, verdict, reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from flexapod.verification.paper import (
    claims_actuator,
    claims_outlook,
    claims_readings,
    claims_rigid,
    claims_robot,
    claims_variants,
)
from flexapod.verification.paper.claim import WHOSE, Claim
from flexapod.verification.paper.rows import ClaimRow
from flexapod.verification.paper.study import PaperStudy

CLAIM_HEAD = ("Where", "The paper", "What we get", "Verdict", "Reason")
_SUBJECTS = (
    claims_actuator,
    claims_rigid,
    claims_robot,
    claims_outlook,
    claims_readings,
    claims_variants,
)
_FOUND = [row for module in _SUBJECTS for row in vars(module).values() if isinstance(row, ClaimRow)]

#: The paper's own in its order; what it asks for next; then other readings and what would give the deviation.
ROWS = tuple(row for whose in WHOSE for row in _FOUND if row.whose == whose)


def claims(result: PaperStudy) -> tuple[Claim, ...]:
    """All claims in the order of `ROWS`.

    Parameters
    ----------
    result : PaperStudy
        From `replicate`.
    """
    return tuple(claim for row in ROWS for claim in row.claims(result))


def group_by_owner(table: Sequence[Claim]) -> dict[str, list[Claim]]:
    """The claims by the words for whose they are, in their order; without those of which there are none."""
    found = {words: [claim for claim in table if claim.whose == whose] for whose, words in WHOSE.items()}
    return {words: some for words, some in found.items() if some}


def verdict_summary(table: Sequence[Claim]) -> str:
    """Number of claims, and of those of each verdict, as text."""
    verdicts = Counter(claim.verdict for claim in table)
    each = ", ".join(f"{verdict} {count}" for verdict, count in verdicts.most_common())
    return f"{len(table)} rows: {each}."


def claims_markdown(table: Sequence[Claim]) -> str:
    """The claims as Markdown: a title, a count and a table for each of whose they are."""
    return "\n".join(_chapter(words, some) for words, some in group_by_owner(table).items())


def _chapter(words: str, table: Sequence[Claim]) -> str:
    rows = [(c.where, c.says, c.ours, f"**{c.verdict}**", c.reason) for c in table]
    lines = [_line(CLAIM_HEAD), _line(("---",) * len(CLAIM_HEAD)), *(_line(row) for row in rows)]
    return "\n".join([f"### {words}", "", verdict_summary(table), "", *lines]) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
