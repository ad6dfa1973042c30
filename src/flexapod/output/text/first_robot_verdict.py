"""Verdict on a first robot as text: bounds that it keeps, and of those that it misses the best that can be had."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexapod.common.quantities import number, text
from flexapod.output.text.verdict import answer

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.design.first_robot import Attained


def attained_sentences(data: Dataset | None, best: Sequence[Attained]) -> list[str]:
    """Sentences on a verdict and what variants of the robot attain; none without bounds."""
    if data is None:
        return []
    lines = [answer(data)]
    if best:
        kept = [row for k in range(data.sizes["requirement"]) if (row := data.isel(requirement=k)).kept]
        names = (_name(str(row.requirement.item())) for row in kept)
        lines += [f"Kept: {', '.join(names)}."] if kept else []
    return lines + [f"{_name(one.name).capitalize()}: {_best_words(one)}." for one in best]


def attained_as_dict(best: Sequence[Attained]) -> list[dict[str, object]]:
    """The best of what is missed as plain data."""
    return [dict(vars(one)) for one in best]


def _best_words(one: Attained) -> str:
    if one.best == one.found:
        return "neither larger robots nor cooler parts do better"
    found, wanted = (number(x) if one.unit in ("1", "") else text(x, one.unit) for x in (one.best, one.wanted))
    cooler = f" and no part more than {number(one.warmest, 2)} K above the reference temperature"
    there = f"with home = {text(one.home, 'm', 4)}{cooler if one.warmth < 1 else ''}"
    return f"{'yes' if one.kept else 'at best'} {found} for {wanted}, {there}"


def _name(name: str) -> str:
    return name.replace("_", " ").replace(".", " ")
