"""A case of the verification pack: what is compared with what, and why the tolerance is what it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from flexapod.verification.engines.engine import Engine


@dataclass(frozen=True)
class Check:
    """One number: `ours` against `reference`; `tolerance` is relative, or absolute in `unit` if `absolute`.

    `fault` says what is wrong with the reference, where that is shown: the number is listed and does not count.
    """

    what: str
    reference: float
    ours: float
    tolerance: float
    unit: str = "1"
    absolute: bool = field(default=False, kw_only=True)
    fault: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        if self.reference == 0 and not self.absolute:
            raise ValueError(f"{self.what}: a reference of zero needs an absolute tolerance")

    @property
    def error(self) -> float:
        """Size of the difference, relative to the reference unless absolute."""
        difference = abs(self.ours - self.reference)
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def strain(self) -> float:
        """Error over tolerance; inf where the error is not a number."""
        return self.error / self.tolerance if np.isfinite(self.error) else float("inf")

    @property
    def within_tolerance(self) -> bool:
        """Test whether the error is a number within the tolerance."""
        return bool(np.isfinite(self.error) and self.error <= self.tolerance)


@dataclass(frozen=True, kw_only=True)
class Case:
    """A case: short `name`, `statement`, `source` of the reference, `argument` for the tolerance, how to compute it.

    `engine` is the independent program it needs; a `slow` one (half a minute and more) is computed on demand only.
    """

    name: str
    statement: str
    source: str
    argument: str
    compute: Callable[[], Iterable[Check]]
    engine: Engine | None = None
    slow: bool = False

    @property
    def obstacle(self) -> str:
        """Reason why the case cannot be computed here; empty if it can."""
        if self.engine is not None and not self.engine.is_available():
            return f"{self.engine.name} is not installed: {self.engine.install}"
        return ""


def case(
    statement: str, *, source: str, argument: str, engine: Engine | None = None
) -> Callable[[Callable[[], Iterable[Check]]], Case]:
    """Decorator of a function that computes a case, which has its name; the words: the fields of `Case`."""

    def row(compute: Callable[[], Iterable[Check]]) -> Case:
        name = compute.__name__.strip("_").replace("_", "-")
        return Case(name=name, statement=statement, source=source, argument=argument, compute=compute, engine=engine)

    return row


def checks(
    names: Sequence[str],
    reference: ArrayLike,
    ours: ArrayLike,
    tolerance: ArrayLike,
    unit: str = "1",
    *,
    absolute: bool = False,
) -> list[Check]:
    """Checks of several numbers with one tolerance or one each."""
    columns = (np.ravel(values).tolist() for values in (reference, ours, np.broadcast_to(tolerance, len(names))))
    rows = zip(names, *columns, strict=True)
    return [Check(name, a, b, bound, unit, absolute=absolute) for name, a, b, bound in rows]


def curve_checks(
    what: str, reference: ArrayLike, ours: ArrayLike, of_peak: float, of_curve: float, unit: str
) -> Iterator[Check]:
    """Checks of the largest values of curves, and of their largest difference, both as shares of the peak."""
    x, y = np.asarray(reference), np.asarray(ours)
    peak, worst = float(np.abs(x).max()), float(np.abs(x - y).max())
    yield Check(f"{what}, largest", peak, float(np.abs(y).max()), of_peak, unit)
    yield Check(f"{what}, largest difference", 0.0, worst, of_curve * peak, unit, absolute=True)
