"""Lists of a study file that are too long for a form: they are counted, not shown row by row."""

from __future__ import annotations

import re
from collections.abc import Sequence

from flexapod.app.view.structure import Offer
from flexapod.model.fields import Field

__all__ = ["MOST", "parted", "without_rows"]

MOST = 20  # rows of a list that are shown

_ROW = re.compile(r"(.*?)\[(\d+)\]")


def parted(fields: Sequence[Field]) -> tuple[list[Field], dict[str, int]]:
    """Fields but for those of lists with more than `MOST` rows, and by key of such a list how many rows it has."""
    rows: dict[str, int] = {}
    for field in fields:
        if found := _ROW.match(field.key):
            rows[found[1]] = max(int(found[2]), rows.get(found[1], 0))
        elif field.kind == "rows" and isinstance(field.value, list):
            rows[field.key] = len(field.value)
    long = {key: count for key, count in rows.items() if count > MOST}
    return [field for field in fields if _list_of(field.key) not in long], long


def without_rows(offers: Sequence[Offer], long: dict[str, int]) -> list[Offer]:
    """Offers but for those that add a row to a long list or take one out."""
    return [offer for offer in offers if offer.rows not in long]


def _list_of(key: str) -> str:
    found = _ROW.match(key)
    return found[1] if found else key
