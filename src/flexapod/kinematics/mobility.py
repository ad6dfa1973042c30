"""Mobility of a mechanism, Eqs. (T14.11)-(T14.14), and constraint wrenches of its legs, (T14.19)-(T14.21).

Everything is counted by rank, at one posture: a mechanism may have more motions there than next to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.closures import gaps
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, FREE, HELD, Limbs
from flexapod.kinematics.rotations import carried_twists, exponential
from flexapod.kinematics.screws import screws
from flexapod.kinematics.trajectory import Poses

RANK = 1e-9  # singular values below this fraction of the largest count as zero
NEARLY = 5e-3  # ... and below which small errors of axes may have made them of zeros
FAR = 0.05  # rad, or of L_c: how far displaced postures lie from one
STEPS, SETTLED = 30, 1e-12  # on the way back to the closures; gap [m, rad] at which they are closed


@dataclass(frozen=True, kw_only=True)
class Mobility:
    """Motions of a mechanism at one posture.

    Attributes
    ----------
    freedoms : int
        Of all joints together, idle turns of legs included.
    gruebler : int
        Motions by counting joints and loops alone.
    mobility : int
        Motions by rank, internal ones included.
    redundant : int
        Closure rows that say what others say: mobility less `gruebler`.
    locked : int
        Motions left with all drives locked, internal ones included; of the platform `locked_platform`.
    self_stress : int
        Forces that drives and joints can exert against each other, the platform unloaded.
    internal : tuple of (int, str)
        Legs that can move while the platform stands, 1 to n, and how.
    platform : ndarray, shape (6, d)
        Twists of the platform at its frame's origin, in world axes: orthonormal, translations in units of L_c.
    locked_platform : ndarray, shape (6, d')
        The same with all drives locked.
    """

    freedoms: int
    gruebler: int
    mobility: int
    redundant: int
    locked: int
    self_stress: int
    internal: tuple[tuple[int, str], ...]
    platform: Array
    locked_platform: Array


class Posture(NamedTuple):
    """One posture: coordinates of the legs (1, n, 8), place (3,) [m] and attitude (3, 3) of the platform frame."""

    q: Array
    place: Array
    turn: Array

    @classmethod
    def home(cls, limbs: Limbs) -> Posture:
        """Posture at home."""
        return cls(limbs.home[None], limbs.position, limbs.rotation)


class _Rank(NamedTuple):
    rank: int
    null: Array  # (columns, columns - rank)


def mobility(limbs: Limbs, at: Posture | None = None) -> Mobility:
    """Motions of the mechanism at one posture (default: home), Eqs. (T14.11)-(T14.13)."""
    at = Posture.home(limbs) if at is None else at
    matrix, driven = _matrix(limbs, at)
    free, locked = _rank(matrix), _rank(matrix[:, ~driven])
    hub = int(6 - limbs.hub_held.sum())
    return Mobility(
        freedoms=matrix.shape[1] - hub,
        gruebler=matrix.shape[1] - matrix.shape[0],
        mobility=matrix.shape[1] - free.rank,
        redundant=matrix.shape[0] - free.rank,
        locked=matrix.shape[1] - int(driven.sum()) - locked.rank,
        self_stress=matrix.shape[0] - locked.rank,
        internal=_internal(limbs, at.q),
        platform=_platform(limbs, free.null),
        locked_platform=_platform(limbs, locked.null),
    )


def nearly_redundant(limbs: Limbs) -> int:
    """Number of closure rows at home that are nearly dependent, as where axes miss being parallel."""
    values = np.linalg.svd(_matrix(limbs, Posture.home(limbs))[0], compute_uv=False)
    return int(((values > RANK * values[0]) & (values < NEARLY * values[0])).sum())


def _unknown(limbs: Limbs) -> Mask:
    """Coordinates that move, (n, 8), the three of a ball joint among them."""
    moves = np.isin(limbs.state, (FREE, DRIVEN))
    moves[~limbs.pose_closure, COORDINATES.index("gamma1") :] = True
    moves[:, COORDINATES.index("spin")] |= limbs.idle
    return moves


def _unit(limbs: Limbs) -> Array:
    """Units (8,) of the legs' coordinates: L_c or a radian."""
    slides = {"l", "chi"} if limbs.carriage == "slider" else {"l"}
    return np.array([limbs.L_c if name in slides else 1.0 for name in COORDINATES])


def _matrix(limbs: Limbs, at: Posture) -> tuple[Array, Mask]:
    """Rates of all moving coordinates to closure rows, six a leg, without units; which columns are driven."""
    n, moves = len(limbs), _unknown(limbs)
    columns = screws(limbs, at.q).columns[0] * _rows(limbs)[:, None] * _unit(limbs)
    arms = limbs.platform @ at.turn.T / limbs.L_c
    legs = np.zeros((n, 6, n, 8))
    legs[np.arange(n), :, np.arange(n)] = columns
    left = legs.reshape(6 * n, 8 * n)[:, moves.ravel()]
    right = -carried_twists(arms).reshape(6 * n, 6)[:, ~limbs.hub_held]
    driven = (limbs.state == DRIVEN).ravel()[moves.ravel()]
    return np.hstack([left, right]), np.concatenate([driven, np.zeros(right.shape[1], dtype=bool)])


def _rank(matrix: Array) -> _Rank:
    _, values, v = np.linalg.svd(matrix)
    rank = int(np.sum(values > RANK * values[0]))
    return _Rank(rank, v[rank:].T)


def _platform(limbs: Limbs, null: Array) -> Array:
    """Orthonormal basis (6, d) of the platform's part of motions."""
    part = np.zeros((6, null.shape[1]))
    held = limbs.hub_held
    part[~held] = null[null.shape[0] - int((~held).sum()) :]
    u, values, _ = np.linalg.svd(part)
    return u[:, : int(np.sum(values > np.sqrt(RANK)))]


def _internal(limbs: Limbs, q: Array) -> tuple[tuple[int, str], ...]:
    moves, columns, found = _unknown(limbs), screws(limbs, q).columns[0], []
    for leg in range(len(limbs)):
        matrix = (columns[leg] * _rows(limbs)[:, None] * _unit(limbs))[:, moves[leg]]
        count = matrix.shape[1] - _rank(matrix).rank
        if count:
            idle = limbs.idle[leg] and count == 1
            found.append((leg + 1, "turn about the leg's own axis" if idle else "move while the platform stands"))
    return tuple(found)


def displaced(limbs: Limbs, at: Posture | None = None) -> list[Posture]:
    """Two postures next to one (default: home) that the mechanism can take, Eq. (T14.14).

    A step along a mixture of all its motions, then back to the closures on the shortest way; fewer, if there is none.
    """
    start = Posture.home(limbs) if at is None else at
    return [found for side in (1, -1) if (found := _displaced(limbs, start, side * FAR)) is not None]


def _displaced(limbs: Limbs, at: Posture, far: float) -> Posture | None:
    null = _rank(_matrix(limbs, at)[0]).null
    # weights without a pattern, to which a symmetric mechanism could answer with a special posture
    step = null @ (far * np.cos(1.0 + 2.3 * np.arange(null.shape[1])))
    for _ in range(STEPS):
        at = _moved(limbs, at, step)
        apart = gaps(limbs, screws(limbs, at.q), Poses.at_rest(at.place, at.turn))[0]
        if np.abs(apart).max() < SETTLED * max(limbs.L_c, 1.0):
            return at
        step = -np.linalg.pinv(_matrix(limbs, at)[0], rcond=RANK) @ (apart * _rows(limbs)).ravel()
    return None


def _moved(limbs: Limbs, at: Posture, step: Array) -> Posture:
    """Posture after a step of all moving coordinates, in their units."""
    moves, hub, dq, twist = _unknown(limbs), ~limbs.hub_held, np.zeros((len(limbs), 8)), np.zeros(6)
    dq[moves], twist[hub] = step[: moves.sum()], step[moves.sum() :]
    return Posture(at.q + dq * _unit(limbs), at.place + limbs.L_c * twist[:3], exponential(twist[3:]) @ at.turn)


def _rows(limbs: Limbs) -> Array:
    """One over the units of the six closure rows of a leg."""
    return np.array([1 / limbs.L_c] * 3 + [1.0] * 3)


CLEAR = 0.1  # share of a driven coordinate's screw that the free ones must leave for it to name a wrench


def constraint_wrenches(limbs: Limbs, q: Array, path: Poses, point: Array) -> Array:
    """Unit wrenches of the locked legs as rows of twists of a platform `point`, (T, m, 6), Eq. (T14.19).

    Of a leg UPS that is its row of the length Jacobian. Rows of one leg are normal to each other, moments taken at the
    platform joint in units of L_c; those of poses that the legs do not reach are zero.
    """
    lost = np.asarray(np.isnan(q).any(axis=(1, 2)))
    columns = screws(limbs, np.where(lost[:, None, None], limbs.home, q)).columns
    joints = _joint_columns(limbs, path, point)
    rows = [
        _wrenches(limbs, leg, columns[:, leg]) @ joints[:, leg, : 6 if pose else 3]
        for leg, pose in enumerate(limbs.pose_closure)
    ]
    found = np.concatenate(rows, axis=1)
    found[lost] = 0.0
    return found


def _wrenches(limbs: Limbs, leg: int, columns: Array) -> Array:
    """Rows (T, k, 3 or 6) that no free coordinate of a leg changes, each continuous along a path."""
    rows = 6 if limbs.pose_closure[leg] else 3
    scale = np.array([1.0, 1.0, 1.0, limbs.L_c, limbs.L_c, limbs.L_c])[:rows]
    free, named = _names(limbs, leg, rows, scale)
    whole = columns[:, :rows][..., free + named] * scale[:, None]
    left = np.linalg.inv(whole)[:, len(free) :]
    q, r = np.linalg.qr(left.swapaxes(-1, -2))
    sign = np.sign(np.diagonal(r, axis1=-2, axis2=-1))
    return (q * sign[:, None]).swapaxes(-1, -2) * scale


def _names(limbs: Limbs, leg: int, rows: int, scale: Array) -> tuple[list[int], list[int]]:
    """Free coordinates of a leg, and the others after which its wrenches are named: as independent as can be."""
    columns = screws(limbs, limbs.home[None]).columns[0, leg, :rows] * scale[:, None]
    size = np.linalg.norm(columns, axis=0)
    units = columns / np.where(size > 0, size, 1.0)
    state = limbs.state[leg]
    free, named = np.flatnonzero(state == FREE).tolist(), []
    while len(free) + len(named) < rows:
        basis = np.linalg.qr(units[:, free + named])[0] if free or named else np.zeros((rows, 0))
        left = np.linalg.norm(units - basis @ (basis.T @ units), axis=0)
        left[(state != DRIVEN) & (state != HELD)] = 0.0
        left[(state == DRIVEN) & (left > CLEAR)] += 1.0
        left[free + named] = -1.0
        named.append(int(np.argmax(left)))
    return free, named


def _joint_columns(limbs: Limbs, path: Poses, point: Array) -> Array:
    """Matrices from a twist of the platform at `point` to the motion of its joints, (T, n, 6, 6)."""
    return carried_twists((limbs.platform - point) @ path.rotation.swapaxes(-1, -2))


def drive_jacobian(limbs: Limbs, q: Array, path: Poses, point: Array) -> Array:
    """Rates of the driven coordinates, leg by leg, for a twist of a platform `point`, (T, m, 6), Eq. (T14.20).

    Valid for the twists that the mechanism has.
    """
    columns, joints = screws(limbs, q).columns, _joint_columns(limbs, path, point)
    found = []
    for leg, pose in enumerate(limbs.pose_closure):
        rows, moves = 6 if pose else 3, np.flatnonzero(limbs.unknown[leg])
        inverse = np.linalg.pinv(columns[:, leg, :rows][..., moves])
        found.append((inverse @ joints[:, leg, :rows])[:, limbs.state[leg, moves] == DRIVEN])
    return np.concatenate(found, axis=1)
