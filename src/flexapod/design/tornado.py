"""Bars of a sensitivity, the strongest first, for figures and text."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset

LEAST = 1e-3  # of the largest sensitivity of the output: what is less is left out


class TornadoBar(NamedTuple):
    """A key and what it does to an output: sensitivity, change by its `factor` [%], both perhaps NaN."""

    key: str
    sensitivity: float
    factor: float
    effect: float


def bars(data: Dataset, output: str) -> list[TornadoBar]:
    """Keys that an output depends on, the strongest first."""
    one = data.sel(output=output)
    rows = zip(one.key.values, one.sensitivity.values, one.factor.values, one.factor_effect.values, strict=True)
    known = [TornadoBar(str(key), *map(float, rest)) for key, *rest in rows if np.isfinite(rest[0])]
    known.sort(key=lambda bar: (-abs(bar.sensitivity), bar.key))
    return [bar for bar in known if abs(bar.sensitivity) > LEAST * abs(known[0].sensitivity)]


def factor_words(bar: TornadoBar) -> str:
    """Change of the output by halving or doubling, in words; empty where nothing of that kind is asked."""
    if not np.isfinite(bar.effect):
        return ""
    return f"{'half' if bar.factor < 1 else 'double'}: {bar.effect:+.2g} %"
