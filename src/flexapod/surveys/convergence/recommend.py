"""The cheapest setting that keeps an accuracy: a step and a discretisation that together stay below it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flexapod.surveys.convergence.trials import Setting

ALIKE = 1.10  # costs within 10 % are the same: timings vary by as much


@dataclass(frozen=True, kw_only=True)
class Step:
    """A step [s], the number of them, and the relative error they cause."""

    step: float
    steps: int
    error: float


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Fidelity and shapes, the seconds a step takes with them, and the relative error they cause."""

    setting: Setting
    per_step: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A setting with its expected error (both parts added) and cost [s]."""

    setting: Setting
    error: float
    cost: float


def candidates(steps: Sequence[Step], shapes: Sequence[Discretisation], accuracy: float) -> list[Candidate]:
    """Settings whose two errors together keep the accuracy, cheapest first; of equally cheap ones the most accurate.

    Parameters
    ----------
    steps, shapes : sequences
        What can be combined; failed runs have an error of NaN and never qualify.
    accuracy : float
        Allowed relative error.
    """
    left = [
        Candidate(
            setting=Setting(**{**vars(d.setting), "step": s.step, "tolerance": None}),
            error=s.error + d.error,
            cost=s.steps * d.per_step,
        )
        for s in steps
        for d in shapes
        if s.error + d.error <= accuracy
    ]
    ordered = []
    while left:
        cheapest = min(c.cost for c in left)
        best = min((c for c in left if c.cost <= ALIKE * cheapest), key=lambda c: c.error)
        ordered.append(best)
        left.remove(best)
    return ordered
