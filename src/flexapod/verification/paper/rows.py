"""A row of the table of claims: what the paper says, the parts of the study to look at, and the numbers found there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from flexapod.verification.paper.claim import NEXT, OWN, VARIANT, Claim
from flexapod.verification.paper.study import PaperStudy

Numbers = Callable[..., Claim | Sequence[Claim]]


@dataclass(frozen=True, kw_only=True)
class ClaimRow:
    """Row of the table: what the paper `says`, and the `numbers` of the named parts or of the whole study."""

    whose: str
    where: str
    says: str
    parts: tuple[str, ...]
    expected: str
    numbers: Numbers

    def claims(self, study: PaperStudy) -> list[Claim]:
        """Claims of the row: one, or one for each that the numbers tell apart."""
        found = self.numbers(*(study[name] for name in self.parts)) if self.parts else self.numbers(study)
        return [
            replace(
                said,
                whose=self.whose,
                where=said.where or self.where,
                says=said.says or self.says,
                expected=self.expected,
            )
            for said in ([found] if isinstance(found, Claim) else found)
        ]


def row(where: str, says: str, *parts: str, expected: str = "", whose: str = OWN) -> Callable[[Numbers], ClaimRow]:
    """Decorator of the function of a row's numbers; the words: the fields of `ClaimRow`."""
    return lambda numbers: ClaimRow(
        whose=whose, where=where, says=says, parts=parts, expected=expected, numbers=numbers
    )


#: The same for a row in which the paper is read, or its robot changed, in a way of ours.
variant: Callable[..., Callable[[Numbers], ClaimRow]] = partial(row, whose=VARIANT)
#: The same for what the paper names as a limit of its study or as work to come.
outlook: Callable[..., Callable[[Numbers], ClaimRow]] = partial(row, whose=NEXT)
