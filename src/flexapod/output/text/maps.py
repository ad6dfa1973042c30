"""What `flexapod map` says: how much is reached, and where each quantity is least and largest."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from flexapod.analysis.results.poses import coordinate_words
from flexapod.common.quantities import column, text
from flexapod.design.maps.findings import Finding, MapFindings, axis_words
from flexapod.output.text.parts import Chapter, Item, TextTable, warnings_of

if TYPE_CHECKING:
    from xarray import Dataset

FIRST = ("frequency", "stiffness_least")  # what is said in a sentence, too


def map_items(data: Dataset, found: MapFindings) -> Iterator[Item]:
    """A map in sentences and as a table."""
    share = f"{found.reached} of {found.poses} poses are reached ({100 * found.reached / found.poses:.3g} %)"
    reasons = sorted(found.reasons.items(), key=lambda item: -item[1])
    yield Chapter(f"{share}: {axis_words(data)}.", [f"{count}: {words}" for words, count in reasons], close=True)
    if not found.quantities:
        yield "Nothing to map: choose other ranges or fixed coordinates."
    yield from (_sentence(quantity) for name in FIRST for quantity in found.quantities if quantity.name == name)
    yield ""
    if found.quantities:
        head = ["", "unit", "least", "at", "largest", "at", "home"]
        yield TextTable(head, list(map(_row, found.quantities)), left=(0, 1, 3, 5))
    yield from map("Warning: {}".format, warnings_of(data))


def _sentence(found: Finding) -> str:
    words = found.words[0].upper() + found.words[1:]
    return (
        f"{words}: {text(found.least, found.unit)} to {text(found.largest, found.unit)}; "
        f"least at {coordinate_words(found.least_at)}."
    )


def _row(found: Finding) -> list[str]:
    home = math.nan if found.home is None else found.home
    unit, (least, largest, at_home) = column([found.least, found.largest, home], found.unit)
    ends = (least, coordinate_words(found.least_at), largest, coordinate_words(found.largest_at))
    return [found.words, unit, *ends, "" if found.home is None else at_home]
