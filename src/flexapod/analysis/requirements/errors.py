"""Errors of the tool in the terms of standards, at many poses, and the part that has the largest share in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexapod.analysis.error_budget.rules import PLACE, SIGMAS, TERMS
from flexapod.common.arrays import Array

BOTH = 0.5  # of the whole: an opposing share beyond it is told, too
CALIBRATABLE, SYSTEMATIC, FIXED, CYCLES, HYSTERETIC = range(len(TERMS))


@dataclass(frozen=True, kw_only=True)
class ErrorTerms:
    """Terms (P, terms, parts, 6) of the ``parts`` at P poses, and the ``whole`` (P, 6) of the systematic ones.

    ``sag`` (P, 6), ``sag_parts`` (P, parts, 6): what a controller takes off, where it does.
    """

    parts: Sequence[str]
    terms: Array
    whole: Array
    sag: Array | None = None
    sag_parts: Array | None = None

    def components(self, name: str) -> Array:
        """Size of an error along each axis, (P, 3) [m], Eqs. (T17.9) and (T17.11)."""
        return np.abs(self._signed(name)) + self._spread(name)

    def size(self, name: str) -> Array:
        """Size of an error, (P,) [m]."""
        return np.linalg.norm(self.components(name), axis=1)

    def _signed(self, name: str) -> Array:
        """Errors with signs, (P, 3): all systematic ones, or those that calibration and correction leave."""
        if name in _REVERSAL:
            return np.zeros((len(self.whole), 3))
        left = self.whole.copy()
        if name != "pose_accuracy":
            left -= self.terms[:, CALIBRATABLE].sum(axis=1)
        if name == "pose_accuracy_corrected" and self.sag is not None:
            left -= self.sag
        return left[:, PLACE]

    def _spread(self, name: str) -> Array:
        """Errors without signs, (P, 3)."""
        if name == "pose_accuracy":
            return SIGMAS * _root(self.terms[:, FIXED])
        if name in _REVERSAL:
            return 4 * _root(self.terms[:, CYCLES]) + 2 * np.abs(self.terms[:, HYSTERETIC]).sum(axis=1)[:, PLACE]
        return np.zeros((len(self.whole), 3))

    def largest_parts(self, name: str, pose: int) -> str:
        """Part with the largest share along an error at a pose; where another one makes up for much of it, both."""
        shares = self.shares(name, pose)
        if not shares.size or not np.isfinite(shares).all() or not shares.any():
            return ""
        first, last = int(np.argmax(shares)), int(np.argmin(shares))
        return self.parts[first] + (f", {self.parts[last]}" if shares[last] < -BOTH else "")

    def shares(self, name: str, pose: int) -> Array:
        """Shares of the parts in an error at a pose, along it, (parts,); they add up to 1 but for second order."""
        components = self.components(name)[pose]
        size = float(components @ components)
        if size == 0:
            return np.zeros(len(self.parts))
        terms, along = self.terms[pose], components / size
        if name in _REVERSAL:
            found = 2 * np.abs(terms[HYSTERETIC, :, PLACE]) + 4 * _by_square(terms[CYCLES])
            return found @ along
        kept = terms[SYSTEMATIC] + (terms[CALIBRATABLE] if name == "pose_accuracy" else 0.0)
        if name == "pose_accuracy_corrected" and self.sag_parts is not None:
            kept = kept - self.sag_parts[pose]
        found = kept[:, PLACE] * np.sign(self._signed(name)[pose])
        if name == "pose_accuracy":
            found = found + SIGMAS * _by_square(terms[FIXED])
        return found @ along


_REVERSAL = ("repeatability", "minimum_incremental_motion")


def _root(parts: Array) -> Array:
    """Root of the sum of squares over the parts, (P, 3)."""
    return np.sqrt((parts**2).sum(axis=1))[:, PLACE]


def _by_square(parts: Array) -> Array:
    """What each part adds to the root of the sum of squares, (parts, 3)."""
    square = parts[:, PLACE] ** 2
    whole = np.sqrt(square.sum(axis=0))
    return np.divide(square, whole, out=np.zeros_like(square), where=whole > 0)
