"""Findings of a verdict: what was found for each requirement, where, and whether that keeps it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.ranking import first_largest

HOME = np.zeros(6)


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Judgement for one key: the worst value over poses and states, SI units.

    ``at_most``: whether it is bounded from above; ``found`` NaN where there is no number, ``why`` then says the reason;
    ``complete``: it has a number in all poses and states that count; ``sure``: no other pose can be worse; ``pose``
    (6,): surge to yaw of the box, or in words ``place``; ``leg`` from 1, 0 without one; ``part`` with the largest
    share; ``home`` and ``home_state``: value there of the warm robot under the same payload, NaN where there is none.
    """

    name: str
    unit: str
    wanted: float
    at_most: bool
    found: float = np.nan
    complete: bool = True
    sure: bool = False
    pose: Array | None = None
    place: str = ""
    state: str = ""
    leg: int = 0
    part: str = ""
    home: float = np.nan
    home_state: str = ""
    why: str = ""

    @property
    def margin(self) -> float:
        """Rest of the bound, below 0 where the requirement is missed."""
        return self.wanted - self.found if self.at_most else self.found - self.wanted

    @property
    def is_missed(self) -> bool:
        """Test whether one pose or state misses it, whatever others do."""
        return bool(self.margin < 0)

    @property
    def is_kept(self) -> bool:
        """Test whether it is kept: a number everywhere that counts, and none that misses."""
        return self.complete and bool(self.margin >= 0)

    @property
    def is_judged(self) -> bool:
        """Test whether it is judged: kept or missed."""
        return self.is_kept or self.is_missed

    def without_number(self, why: str) -> Judgement:
        """The same without a number, for a reason in words."""
        return replace(self, found=np.nan, complete=False, why=why)


def worst_of(values: Array, *, at_most: bool) -> int | None:
    """Place of the worst of values, NaN left out, the first of those that tie; None where all are NaN."""
    sizes = np.where(np.isnan(values), -np.inf, values if at_most else -values)
    return None if np.isneginf(sizes).all() and np.isnan(values).all() else int(first_largest(sizes))
