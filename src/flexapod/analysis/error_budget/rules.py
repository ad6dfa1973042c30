"""Sums of the rows of an error budget, by their kinds, Eqs. (T17.3)-(T17.11)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.common.arrays import Array
from flexapod.common.ranking import largest_item

KINDS = ("systematic", "hysteretic", "random", "dynamic_peak", "dynamic_rms")
SIGMAS = 3.0  # of random rows, in the worst case and in accuracies
RP = np.sqrt(2 / np.pi) + 3 * np.sqrt(1 - 2 / np.pi)  # mean and 3 standard deviations of |x|, x normal, sigma 1
PLACE = slice(3)


def combine_by_kind(kind: str, parts: Array) -> Array:
    """Sum over the first axis by the rule of a kind: with signs, of sizes, of squares, Eqs. (T17.3)-(T17.5)."""
    if kind == "hysteretic":
        return np.add.reduce(np.abs(parts))
    return np.sqrt(np.add.reduce(parts * parts)) if kind == "random" else np.add.reduce(parts)


#: Terms of which accuracies and repeatabilities are made: systematic errors that calibration takes out and others,
#: standard deviations of what stands in a machine and of what differs between approaches, bounds of reversal.
TERMS = ("calibratable", "systematic", "fixed", "cycles", "hysteretic")


def error_terms(rows: Sequence[ErrorRow], parts: Sequence[str]) -> Array:
    """Each of `TERMS` of each part, (terms, parts, 6): of rows of one part and term their sum by its rule."""
    found = np.zeros((len(TERMS), len(parts), 6))
    for row in rows:
        term, part = TERMS.index(_term(row)), parts.index(row.part)
        found[term, part] = combine_by_kind(
            row.kind, np.array([found[term, part], combine_by_kind(row.kind, row.by_leg)])
        )
    return found


def _term(row: ErrorRow) -> str:
    if row.kind == "random":
        return "fixed" if row.stands else "cycles"
    return "calibratable" if row.nature == "calibratable" else row.kind


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Rows of n legs, and of kinds whose rows have signs the ``whole`` (6,) that they add up to but for a residual."""

    rows: list[ErrorRow]
    whole: dict[str, Array]

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts, in the order of their rows."""
        return tuple(self._numbers)

    @cached_property
    def _sums(self) -> dict[str, list[tuple[ErrorRow, Array]]]:
        """The rows of each kind with what they add up to over the legs by its rule, (6,)."""
        found: dict[str, list[tuple[ErrorRow, Array]]] = {kind: [] for kind in KINDS}
        for row in self.rows:
            found[row.kind].append((row, combine_by_kind(row.kind, row.by_leg)))
        return found

    @cached_property
    def _numbers(self) -> dict[str, int]:
        """Parts by name, numbered in the order of their rows."""
        return {part: k for k, part in enumerate(dict.fromkeys(row.part for row in self.rows))}

    @cached_property
    def _by_part(self) -> dict[str, Array]:
        """Error of each part by kind, (parts, 6)."""
        found = {kind: np.zeros((len(self._numbers), 6)) for kind in KINDS}
        for kind, rows in self._sums.items():
            parts: dict[str, list[Array]] = {}
            for row, x in rows:
                parts.setdefault(row.part, [np.zeros(6)]).append(x)
            for part, of_rows in parts.items():
                found[kind][self._numbers[part]] = combine_by_kind(kind, np.array(of_rows))
        return found

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of error in the budget; dynamic ones along a motion only."""
        return KINDS if "dynamic_peak" in self.whole else KINDS[:3]

    def sum_of_rows(self, kind: str, chosen: Callable[[ErrorRow], bool] = lambda row: True) -> Array:
        """Sum (6,) of the rows of a kind, or of some of them, by its rule; without what is left out of first order."""
        found = [x for row, x in self._sums[kind] if chosen(row)]
        return combine_by_kind(kind, np.array([np.zeros(6), *found]))

    def part_error(self, part: str, kind: str) -> Array:
        """Error of a part of one kind, (6,)."""
        return self._by_part[kind][self._numbers[part]]

    def total(self, kind: str) -> Array:
        """The whole of a kind, (6,)."""
        return self.whole[kind] if kind in self.whole else self.sum_of_rows(kind)

    def residual(self, kind: str) -> Array:
        """Whole of a kind less the sum of its rows, (6,), Eq. (T17.2)."""
        return self.total(kind) - self.sum_of_rows(kind)

    @property
    def worst(self) -> Array:
        """Largest size of each component if all kinds are at their worst at once, (6,), Eq. (T17.6)."""
        return self._worst(self.total, self.sum_of_rows)

    def _worst(self, total: Callable[[str], Array], rule: Callable[[str], Array]) -> Array:
        most = np.abs(total("systematic")) + rule("hysteretic") + SIGMAS * rule("random")
        return most + (np.abs(total("dynamic_peak")) if "dynamic_peak" in self.kinds else 0.0)

    @property
    def rss(self) -> Array:
        """Root of the sum of the squares of all kinds, (6,), Eq. (T17.7)."""
        kinds = [kind for kind in self.kinds if kind != "dynamic_peak"]
        return np.sqrt(np.sum([self.total(kind) ** 2 for kind in kinds], axis=0))

    @cached_property
    def sizes(self) -> dict[str, float]:
        """Size of the worst that each part does to the tool's place [m]."""
        alone = self._by_part.__getitem__
        worst = self._worst(alone, alone)[:, PLACE]
        return {part: float(np.sqrt(x @ x)) for part, x in zip(self.parts, worst, strict=True)}

    @cached_property
    def shares(self) -> dict[str, float]:
        """Sizes of the parts over the sum of all sizes, Eq. (T17.8)."""
        return {part: size / (sum(self.sizes.values()) or 1.0) for part, size in self.sizes.items()}

    @property
    def largest(self) -> str:
        """The part with the largest share."""
        return largest_item(self.parts, key=lambda part: self.sizes[part])

    @property
    def calibrated_budget(self) -> Budget:
        """The budget of a machine whose constant errors are known and taken out, at rest."""
        return Budget(rows=[row for row in self.rows if row.nature != "calibratable" and not row.stands], whole={})

    def with_half(self, part: str) -> Budget:
        """The budget if every error of a part were half as large."""
        rows = [row._replace(by_leg=0.5 * row.by_leg) if row.part == part else row for row in self.rows]
        return replace(self, rows=rows, whole={k: x - 0.5 * self.part_error(part, k) for k, x in self.whole.items()})

    def accuracy(self, *, calibrated: bool) -> Array:
        """Systematic error and 3 standard deviations of what is fixed in a machine but unknown, (6,), Eq. (T17.9)."""
        known = self.sum_of_rows("systematic", lambda row: row.nature == "calibratable")
        fixed = self.sum_of_rows("random", lambda row: row.stands)
        whole = self.total("systematic")
        return np.abs(whole - known) if calibrated else np.abs(whole) + SIGMAS * fixed

    @property
    def cycles(self) -> Array:
        """Standard deviation from one approach to the next, (6,)."""
        return self.sum_of_rows("random", lambda row: not row.stands)

    @property
    def unidirectional(self) -> Array:
        """Repeatability of approaches from one side, (6,): 4 standard deviations (ISO 230-2), Eq. (T17.10)."""
        return 4 * self.cycles

    @property
    def bidirectional(self) -> Array:
        """Repeatability with the reversal value, twice the bound of play and friction, (6,), Eq. (T17.11)."""
        return self.unidirectional + 2 * self.sum_of_rows("hysteretic")

    @property
    def repeatability(self) -> float:
        """Pose repeatability RP (ISO 9283), mean distance and 3 standard deviations, at most [m], Eq. (T17.12)."""
        return float(RP * np.linalg.norm(self.cycles[PLACE]))
