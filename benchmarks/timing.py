"""Repeated measurements side by side, and what is said of them."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass

__all__ = ["Spread", "interleaved"]


@dataclass(frozen=True)
class Spread:
    """Median and range of repeated measurements."""

    values: tuple[float, ...]

    @property
    def median(self) -> float:
        """The middle one."""
        return statistics.median(self.values)

    def text(self, unit: str = "s", factor: float = 1.0, digits: int = 3) -> str:
        """Median, and least and largest in brackets."""
        middle, least, most = (f"{factor * x:.{digits}g}" for x in (self.median, min(self.values), max(self.values)))
        return f"{middle} {unit} ({least} to {most})"


def interleaved(actions: Mapping[str, Callable[[], float]], repeats: int) -> dict[str, Spread]:
    """Spreads of what the actions return, called in turn, A B C A B C: whatever disturbs the machine disturbs all."""
    found: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(repeats):
        for name, action in actions.items():
            found[name].append(action())
    return {name: Spread(tuple(values)) for name, values in found.items()}
