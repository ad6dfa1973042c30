"""Reach of the legs: strokes and pistons along a path, and maps of poses, Eqs. (T2.37)-(T2.39)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.inverse import leg_lengths

ROUNDING = 1e-14  # of a length; a leg as long as its limit is within it
SHORTEST, LONGEST = "shorter than its stroke allows", "longer than its stroke allows"
NO_FREE_LENGTH = "has no free length left outside its cylinder"
PULLED_OUT = "is pulled out of its cylinder"
BEHIND_JOINT = "reaches behind its universal joint"
BEFORE, BEYOND = "before the start of its stroke", "beyond the end of its stroke"
TOO_SHORT = "is shorter than its leg; without a cylinder what is missing counts as negative mass"


@dataclass(frozen=True, kw_only=True)
class Excess:
    """One leg that leaves one of its limits on a path, where it does so most.

    Attributes
    ----------
    leg : int
        1 to n.
    kind : str
        One of this module's constants, a predicate of a sentence.
    fatal : bool
        False for what only deserves a warning: a piston that passes its universal joint or does not reach it.
    value, limit : float
        Joint-to-joint length, or place of a carriage, that is reached, and its limit [m, of a crank rad].
    time, first : float
        Instant of the largest excess, and the first instant beyond the limit [s].
    turns : bool
        Value and limit are angles.
    """

    leg: int
    kind: str
    fatal: bool
    value: float
    limit: float
    time: float
    first: float
    turns: bool = False

    @property
    def message(self) -> str:
        """The finding in one sentence."""
        if self.kind in (BEFORE, BEYOND):
            value, limit, off = (self._place(x) for x in (self.value, self.limit, abs(self.value - self.limit)))
            return (
                f"Leg {self.leg}: the carriage is {self.kind}: at {value}, limit {limit} "
                f"(by {off} at t = {self.time:.3f} s, first at {self.first:.3f} s)"
            )
        subject = f"Leg {self.leg}" if self.kind in (SHORTEST, LONGEST) else f"Leg {self.leg}: the piston"
        verb = "is " if self.kind in (SHORTEST, LONGEST) else ""
        return (
            f"{subject} {verb}{self.kind}: length {self.value:.4f} m, limit {self.limit:.4f} m "
            f"(by {1e3 * abs(self.value - self.limit):.2f} mm at t = {self.time:.3f} s, first at {self.first:.3f} s)"
        )

    def _place(self, place: float) -> str:
        return f"{np.rad2deg(place):.4g} deg" if self.turns else f"{place:.4f} m"


def _worst(t: ArrayLike, length: Array, limit: Array, side: int, kind: str, fatal: bool = True) -> list[Excess]:
    """Per leg the largest excess of `side * length` over `side * limit`, if there is one."""
    t = np.asarray(t, dtype=float)
    over = side * (length - limit)
    found: list[Excess] = []
    beyond = over > ROUNDING * np.abs(limit)
    if not beyond.any():
        return found
    for leg in np.flatnonzero(np.any(beyond, axis=0)):
        k = int(np.argmax(over[:, leg]))
        found.append(
            Excess(
                leg=int(leg) + 1,
                kind=kind,
                fatal=fatal,
                value=float(length[k, leg]),
                limit=float(limit[leg]),
                time=float(t[k]),
                first=float(t[np.argmax(beyond[:, leg])]),
            )
        )
    return found


def stroke_excess(t: ArrayLike, length: Array, limits: Array) -> list[Excess]:
    """Legs outside their stroke on a path, Eq. (T2.37).

    Parameters
    ----------
    t : array_like, shape (T,)
        Instants [s].
    length : ndarray, shape (T, n)
        Joint-to-joint lengths [m].
    limits : ndarray, shape (n, 2)
        Least and largest length [m]; inf where there is none.

    Returns
    -------
    list of Excess
    """
    return _worst(t, length, limits[:, 0], -1, SHORTEST) + _worst(t, length, limits[:, 1], 1, LONGEST)


def carriage_excess(t: ArrayLike, place: Array, limits: Array, *, turns: bool) -> list[Excess]:
    """Carriages outside their stroke on a path of places (T, n) [m, or rad if it `turns`], limits (n, 2), (T14.22)."""
    found = _worst(t, place, limits[:, 0], -1, BEFORE) + _worst(t, place, limits[:, 1], 1, BEYOND)
    return [replace(excess, turns=turns) for excess in found]


def piston_excess(t: ArrayLike, length: Array, mouth: Array, piston_length: Array) -> list[Excess]:
    """Pistons that lose their free length or their guide on a path, Eq. (T2.38).

    The free length outside the mouth, l - mouth, must be positive, and the inner end, at l - Lp from the universal
    joint, must stay before the mouth. An inner end behind the universal joint (l < Lp) is reported, not fatal.
    With a mouth at the joint (mouth = 0) the piston has no guide that it could leave, and only the first rule holds;
    one that does not reach back to the joint is reported, not fatal.

    Parameters
    ----------
    t : array_like, shape (T,)
        Instants [s].
    length : ndarray, shape (T, n)
        Joint-to-joint lengths [m].
    mouth, piston_length : ndarray, shape (n,)
        Of cylinder and piston [m].

    Returns
    -------
    list of Excess
    """
    guided = np.where(mouth > 0, mouth + piston_length, np.inf)
    return (
        _worst(t, length, mouth, -1, NO_FREE_LENGTH)
        + _worst(t, length, guided, 1, PULLED_OUT)
        + _worst(t, length, np.where(mouth > 0, piston_length, -np.inf), -1, BEHIND_JOINT, fatal=False)
        + _worst(t, length, np.where(mouth > 0, np.inf, piston_length), 1, TOO_SHORT, fatal=False)
    )


def reachable(length: Array, limits: Array, mouth: Array, piston_length: Array) -> np.ndarray:
    """Test whether lengths are within strokes and pistons, bool of shape (...), Eqs. (T2.37)-(T2.38).

    Parameters
    ----------
    length : ndarray, shape (..., n)
        Joint-to-joint lengths [m].
    limits : ndarray, shape (n, 2)
    mouth, piston_length : ndarray, shape (n,)
    """
    least = np.maximum(limits[:, 0], mouth)
    most = np.minimum(limits[:, 1], np.where(mouth > 0, mouth + piston_length, np.inf))
    return np.all((length >= least) & (length > mouth) & (length <= most), axis=-1)


@dataclass(frozen=True, kw_only=True)
class WorkspaceMap:
    """Reachability of a grid of platform positions at one orientation.

    Attributes
    ----------
    reachable : ndarray of bool, shape (nx, ny, nz)
    margin : ndarray, shape (nx, ny, nz)
        Least distance of a leg from its limits [m]; negative outside.
    volume : float
        Number of reachable points times the volume of a cell [m^3]; 0 for a grid of fewer than two points an axis.
    """

    reachable: np.ndarray
    margin: Array
    volume: float


def reachable_map(
    base_joints: Array,
    platform_joints: Array,
    limits: Array,
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    rotation: ArrayLike | None = None,
) -> WorkspaceMap:
    """Map of the positions of the platform frame that the strokes allow at one orientation, Eq. (T2.39).

    Parameters
    ----------
    base_joints, platform_joints : ndarray, shape (n, 3)
        World axes; platform axes [m].
    limits : ndarray, shape (n, 2)
        Least and largest joint-to-joint length [m].
    x, y, z : array_like, shapes (nx,), (ny,), (nz,)
        Evenly spaced world coordinates of the platform frame's origin [m].
    rotation : array_like, shape (3, 3), optional
        Platform to world; default: as at home.

    Returns
    -------
    WorkspaceMap

    Raises
    ------
    InputError
        If a coordinate is not finite.
    """
    axes = [np.atleast_1d(np.asarray(a, dtype=float)) for a in (x, y, z)]
    if not all(np.all(np.isfinite(a)) for a in axes):
        raise InputError("grid coordinates must be finite", key="x, y, z", allowed="finite metres")
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    turn = np.eye(3) if rotation is None else np.asarray(rotation, dtype=float)
    length = leg_lengths(base_joints, platform_joints, grid, turn)
    margin = np.min(np.minimum(length - limits[:, 0], limits[:, 1] - length), axis=-1)
    cell = np.prod([a[1] - a[0] if len(a) > 1 else 0.0 for a in axes])
    return WorkspaceMap(reachable=margin >= 0, margin=margin, volume=float(np.sum(margin >= 0) * cell))
