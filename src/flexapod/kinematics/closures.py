"""Closures of any mechanism, solved by Newton's method with exact rates and accelerations, Eqs. (T14.6)-(T14.10).

The legs are eliminated one by one: of the rows of a leg as many as it has unknowns give these, the others are left to
determine the platform.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.laws import Law
from flexapod.kinematics.leg_geometry import COORDINATES, Limbs
from flexapod.kinematics.rotations import blocks, exponential, quaternion, rotation_vector
from flexapod.kinematics.screws import Screws, screws
from flexapod.kinematics.trajectory import Poses, poses_from_coordinates, turning_axes

STRIDE = 0.35  # rad, or of a leg's length: the longest way in one step from home to a pose
NEWTON = 25
FAR = 10.0  # rad, or of a leg's length: on a longer way poses are followed each by its own strides, while legs follow
APART = 16  # instants of a path from one that is sought from the start to the next
NEIGHBOURS = 0.05  # rad, or of a leg's length: between these a path is smooth
TAKEN = 1e-9  # gap relative to L_c at which a pose counts as taken by the legs
CLOSE = 1e-7  # gap from which one step leaves nothing but rounding


class Task(NamedTuple):
    """Task for a mechanism: which coordinates follow from the closures, the others being given.

    `legs` (n, 8) and `platform` (6,) (surge, sway, heave, roll, pitch, yaw from home, about `pivot`) are True where a
    coordinate is unknown.
    """

    legs: Mask
    platform: Mask
    pivot: Array


@dataclass(frozen=True, kw_only=True)
class Closed:
    """Solution at T instants: leg coordinates (T, n, 8), platform coordinates (T, 6), gaps of the legs (T, n) [m]."""

    q: Array
    x: Array
    gap: Array


class _Group(NamedTuple):
    """Legs with as many rows and the same unknowns, and the inverse of what these do."""

    legs: NDArray[np.intp]
    rows: int
    unknown: NDArray[np.intp]
    inverse: Array  # (T, m, u, rows)
    left: Array  # (T, m, rows - u, rows): combinations of the rows that no unknown of the leg changes


class _Eliminated(NamedTuple):
    groups: list[_Group]
    columns: Array  # of the unknown platform coordinates (T, n, 6, d)

    def solve(self, right: Array) -> tuple[Array, Array]:
        """Unknowns of ``M dq - P dx = right`` (T, n, 6): dq (T, n, 8), dx (T, d), of too many rows the best."""
        T, n, _, d = self.columns.shape
        dx = np.zeros((T, d))
        if d:
            rest = [(g.left @ self.columns[:, g.legs, : g.rows]).reshape(T, -1, d) for g in self.groups]
            said = [(g.left @ right[:, g.legs, : g.rows, None]).reshape(T, -1) for g in self.groups]
            K, b = np.concatenate(rest, axis=1), -np.concatenate(said, axis=1)
            dx = (np.linalg.pinv(K) @ b[..., None])[..., 0]
        whole = right + (self.columns @ dx[:, None, :, None])[..., 0]
        dq = np.zeros((T, n, 8))
        for g in self.groups:
            dq[:, g.legs[:, None], g.unknown] = (g.inverse @ whole[:, g.legs, : g.rows, None])[..., 0]
        return dq, dx


def eliminate_legs(limbs: Limbs, task: Task, chain: Screws, columns: Array) -> _Eliminated:
    """Equations of a Newton step, leg by leg; `columns` (T, n, 6, d): what moves the joints of the platform."""
    scale = np.array([1.0, 1.0, 1.0, limbs.L_c, limbs.L_c, limbs.L_c])
    kinds: dict[tuple[int, ...], list[int]] = {}
    for leg, (unknown, pose) in enumerate(zip(task.legs, limbs.pose_closure, strict=True)):
        kinds.setdefault((6 if pose else 3, *np.flatnonzero(unknown).tolist()), []).append(leg)
    groups = []
    for (rows, *unknown), legs in kinds.items():
        M = chain.columns[:, legs, :rows][..., unknown] * scale[:rows, None]
        u = len(unknown)
        if u == rows:
            inverse, left = _inverse(M), np.zeros((*M.shape[:2], 0, rows))
        else:
            q, r = np.linalg.qr(M, mode="complete")
            inverse = _inverse(r[..., :u, :]) @ q[..., :u].swapaxes(-1, -2)
            left = q[..., u:].swapaxes(-1, -2) * scale[:rows]
        groups.append(_Group(np.array(legs), rows, np.array(unknown, dtype=int), inverse * scale[:rows], left))
    return _Eliminated(groups, columns)


def _inverse(matrices: Array) -> Array:
    """Inverses; the least-squares one where a matrix of the many has none."""
    try:
        return np.asarray(np.linalg.inv(matrices), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrices), dtype=np.float64)


def gaps(limbs: Limbs, chain: Screws, at: Poses) -> Array:
    """Tip less platform joint [m], and half the rotation vector's sine of their frames, world axes, Eq. (T14.6)."""
    place = chain.tip - at.place(limbs.platform)
    goal = at.rotation[:, None] @ limbs.platform_frames
    turn = np.zeros_like(place)
    met = limbs.pose_closure
    if met.any():
        turn[:, met] = np.cross(goal[:, met], chain.frame[:, met], axis=-2).sum(axis=-1) / 2
    return np.concatenate([place, turn], axis=-1)


def false_roots(limbs: Limbs, chain: Screws, rotation: Array) -> Mask:
    """Legs (T, n) that meet platforms of attitude `rotation` (T, 3, 3) half a turn off, the other root of (T14.6)."""
    goal = rotation[:, None] @ limbs.platform_frames
    return limbs.pose_closure & (np.einsum("tnij,tnij->tn", goal, chain.frame) < 0)  # (T14.23)


def _platform_columns(limbs: Limbs, task: Task, x: Array, at: Poses) -> Array:
    """Velocities of the platform joints for the unknown platform coordinates, (T, n, 6, d), Eq. (T14.7)."""
    T, n = len(x), len(limbs)
    if not task.platform.any():
        return np.zeros((T, n, 6, 0))
    columns = np.zeros((T, n, 6, 6))
    columns[..., :3, :3] = np.eye(3)
    axes = turning_axes(x[:, 3:])  # (T, 3, 3): of roll, pitch, yaw as columns
    arms = (limbs.platform - task.pivot) @ at.rotation.swapaxes(-1, -2)  # (T, n, 3)
    columns[..., :3, 3:] = np.cross(axes[:, None], arms[..., None], axis=-2)
    columns[..., 3:, 3:] = axes[:, None]
    return columns[..., task.platform]


def _poses(limbs: Limbs, task: Task, law: Law) -> Poses:
    return poses_from_coordinates(Poses.at_rest(limbs.position, limbs.rotation), law, task.pivot)


def solve_closures(limbs: Limbs, task: Task, q: Array, goal: Array | Poses, start: Closed | None = None) -> Closed:
    """Unknown coordinates such that the legs meet the platform, Eqs. (T14.6)-(T14.8).

    Newton's method, along the straight way of what is given from `start` (default: home) to `q` and `goal`: so the
    solution is the one that the mechanism reaches without taking its legs apart, at whatever instant it is asked for.

    Parameters
    ----------
    limbs : Limbs
    task : Task
    q : ndarray, shape (T, n, 8)
        Coordinates of the legs; unknown ones do not count.
    goal : ndarray, shape (T, 6), or Poses
        Platform coordinates, of which unknown ones do not count; or its T poses, if none is unknown.
    start : Closed, optional
        One solution, at which to begin.

    Returns
    -------
    Closed
        With NaN where no solution is found.
    """
    q0, x0 = (limbs.home, np.zeros(6)) if start is None else (start.q[0], start.x[0])
    parts = []
    for where in blocks(len(q)):
        part = goal.part(where) if isinstance(goal, Poses) else goal[where]
        parts.append(_close(limbs, task, q[where], part, (q0, x0)))
    found = (np.concatenate([getattr(p, name) for p in parts]) for name in ("q", "x", "gap"))
    return Closed(**dict(zip(("q", "x", "gap"), found, strict=True)))


def close_nearby(limbs: Limbs, task: Task, near: Array, goal: Poses) -> Closed:
    """Solution as of `solve_closures` by Newton's method, from coordinates `near` (T, n, 8) that are next to it."""
    parts = []
    for where in blocks(len(near)):
        at = goal.part(where)
        q, x, gap = _newton(limbs, task, near[where], np.zeros((len(at), 6)), at, CLOSE)
        if not gap.max(initial=0.0) < TAKEN * limbs.L_c:
            return solve_closures(limbs, task, near, goal)
        parts.append((q, x, gap))
    q, x, gap = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Closed(q=q, x=x, gap=gap)


def _close(limbs: Limbs, task: Task, q: Array, goal: Array | Poses, start: tuple[Array, Array]) -> Closed:
    """Solution at the instants of a block: from `start`, or from between neighbours where these lie close together."""
    if len(q) < 4 * APART:
        return _from_start(limbs, task, q, goal, start)
    at = np.unique([*range(0, len(q), APART), len(q) - 1])
    few = _from_start(limbs, task, q[at], goal.part(at) if isinstance(goal, Poses) else goal[at], start)
    flat = np.concatenate([few.x, few.q.reshape(len(at), -1)], axis=1)
    unit = np.concatenate([_units(limbs)[:6], np.tile(_units(limbs)[6:], len(limbs))])
    if not np.abs(np.diff(flat, axis=0) / unit).max(initial=0.0) < NEIGHBOURS:  # NaN neither
        return _from_start(limbs, task, q, goal, start)
    from scipy.interpolate import CubicSpline  # half a second that only long paths of other robots than six UPS need

    between = CubicSpline(at, flat)(np.arange(len(q)))
    x = between[:, :6] if isinstance(goal, Poses) else np.where(task.platform, between[:, :6], goal)
    legs = np.where(task.legs, between[:, 6:].reshape(q.shape), q)
    legs, x, gap = _newton(limbs, task, legs, x, goal if isinstance(goal, Poses) else None, CLOSE)
    if not (gap.max(initial=0.0) < TAKEN * limbs.L_c):
        return _from_start(limbs, task, q, goal, start)
    return Closed(q=legs, x=x, gap=gap)


def _from_start(limbs: Limbs, task: Task, q: Array, goal: Array | Poses, start: tuple[Array, Array]) -> Closed:
    unit, (q0, x0) = _units(limbs), start
    turn = np.zeros((len(q), 3))
    if isinstance(goal, Poses):
        turn = rotation_vector(quaternion(goal.rotation @ limbs.rotation.T))
        way = np.concatenate([goal.position - limbs.position, turn], axis=1)
    else:
        way = np.where(task.platform, 0.0, goal - x0)
    ways = np.where(task.legs, 0.0, q - q0)
    asked = np.asarray(np.isfinite(way).all(axis=1))
    way, turn = np.where(asked[:, None], way, 0.0), np.where(asked[:, None], turn, 0.0)
    far = np.maximum(np.abs(way / unit[:6]).max(axis=1), np.abs(ways / unit[6:]).max(axis=(1, 2)))
    if (far > FAR).any() and (far <= FAR).any():
        return _each_part(limbs, task, q, goal, start, far > FAR)
    steps, own = 1 + int(far.max(initial=0.0) / STRIDE), bool((far > FAR).any())
    q, x, gap = np.tile(q0, (len(q), 1, 1)), np.tile(x0, (len(q), 1)), np.zeros(ways.shape[:2])
    for k in range(1, steps + 1):
        here, share = np.arange(len(q)), np.full(len(q), k / steps)
        if own and k < steps:  # without those at their end, and those that legs have lost by more than their length
            share = k * STRIDE / far
            here = here[(share < 1) & (gap.max(axis=1, initial=0.0) < unit[0])]
            if not here.size:
                continue
        part, at = share[here, None], None
        legs = np.where(task.legs, q[here], q0 + part[..., None] * ways[here])
        hub = np.where(task.platform, x[here], x0 + part * way[here])
        if isinstance(goal, Poses):
            at = Poses.at_rest(limbs.position + part * way[here, :3], exponential(part * turn[here]) @ limbs.rotation)
            at = goal if k == steps and asked.all() else at
        q[here], x[here], gap[here] = _newton(limbs, task, legs, hub, at, CLOSE if k == steps else 1e-3)
    lost = ~(gap.max(axis=1, initial=0.0) < TAKEN * limbs.L_c) | ~asked
    q[lost], x[lost], gap[~asked] = np.nan, np.nan, np.inf
    return Closed(q=q, x=x, gap=gap)


def _each_part(
    limbs: Limbs, task: Task, q: Array, goal: Array | Poses, start: tuple[Array, Array], beyond: Mask
) -> Closed:
    """Solution at instants of which some are far from the start and others are not, each by themselves."""
    found = Closed(q=np.zeros(q.shape), x=np.zeros((len(q), 6)), gap=np.zeros(q.shape[:2]))
    for at in (np.flatnonzero(~beyond), np.flatnonzero(beyond)):
        part = _from_start(limbs, task, q[at], goal.part(at) if isinstance(goal, Poses) else goal[at], start)
        found.q[at], found.x[at], found.gap[at] = part.q, part.x, part.gap
    return found


def _units(limbs: Limbs) -> Array:
    """Units of the six platform coordinates and the eight of a leg: the length of a leg or a radian."""
    far = float(limbs.home[:, COORDINATES.index("l")].mean())
    lengths = {"l", "chi"} if limbs.carriage == "slider" else {"l"}
    return np.array([far] * 3 + [1.0] * 3 + [far if name in lengths else 1.0 for name in COORDINATES])


def _newton(
    limbs: Limbs, task: Task, q: Array, x: Array, given: Poses | None, enough: float
) -> tuple[Array, Array, Array]:
    """Newton steps until only rounding remains; q, x and the gaps of the legs [m], rotations times L_c."""
    still, unit = np.zeros_like(x), _units(limbs)
    weight = np.array([1.0, 1.0, 1.0, limbs.L_c, limbs.L_c, limbs.L_c])
    at, chain = given or _poses(limbs, task, Law(x, still, still)), screws(limbs, q)
    last, gap, off = False, np.zeros(q.shape[:2]), np.zeros(len(q), dtype=bool)
    for _ in range(NEWTON):
        at, chain = given or _poses(limbs, task, Law(x, still, still)), screws(limbs, q)
        apart = gaps(limbs, chain, at)
        gap = np.abs(apart * weight).max(axis=-1)
        if last:
            break
        last = bool(np.all(gap < enough * limbs.L_c))
        dq, dx = eliminate_legs(limbs, task, chain, _platform_columns(limbs, task, x, at)).solve(-apart)
        longest = np.abs(dx / unit[:6][task.platform]).max(axis=1, initial=0.0)
        short = STRIDE / np.maximum(np.maximum(np.abs(dq / unit[6:]).max(axis=(1, 2)), longest), STRIDE)
        dq, dx = short[:, None, None] * dq, short[:, None] * dx
        off |= ~(np.isfinite(dq).all(axis=(1, 2)) & np.isfinite(dx).all(axis=1))  # off to where nothing is found
        q, x = q + np.where(off[:, None, None], 0.0, dq), x.copy()
        x[:, task.platform] += np.where(off[:, None], 0.0, dx)
    gap[off] = np.inf
    gap[false_roots(limbs, chain, at.rotation)] = np.inf
    return q, x, gap


class ClosureMotion(NamedTuple):
    """Legs at T instants: coordinates (T, n, 8) with their rates and accelerations; the platform's, (T, 6)."""

    q: Array
    q_dot: Array
    q_ddot: Array
    platform: Law

    def part(self, where: slice) -> ClosureMotion:
        """Part of the instants."""
        return ClosureMotion(
            self.q[where], self.q_dot[where], self.q_ddot[where], Law(*(part[where] for part in self.platform))
        )


def solve_rates(limbs: Limbs, task: Task, found: Closed, given: Law | Poses) -> ClosureMotion:
    """Rates and accelerations of a solution, by the matrix of its last Newton step, Eqs. (T14.9)-(T14.10).

    Parameters
    ----------
    limbs, task, found
        As for, and of, `solve_closures`; no given coordinate of a leg moves.
    given : Law or Poses
        Platform coordinates (T, 6), where rates and accelerations of unknown ones do not count; or its poses.
    """
    lost = np.asarray(np.isnan(found.q).any(axis=(1, 2)))
    at = Closed(
        q=np.where(lost[:, None, None], limbs.home, found.q), x=np.where(lost[:, None], 0, found.x), gap=found.gap
    )
    parts = [_move(limbs, task, at, given, where) for where in blocks(len(lost))]
    q_dot, q_ddot, *rates = (np.concatenate(part) for part in zip(*parts, strict=True))
    for part in (q_dot, q_ddot, *rates):
        part[lost] = np.nan
    return ClosureMotion(found.q, q_dot, q_ddot, Law(found.x, *rates))


def _move(limbs: Limbs, task: Task, found: Closed, given: Law | Poses, where: slice) -> tuple[Array, ...]:
    q, x = found.q[where], found.x[where]
    x_dot, x_ddot = np.zeros_like(x), np.zeros_like(x)
    if not isinstance(given, Poses):
        x_dot, x_ddot = (np.where(task.platform, 0.0, part[where]) for part in given[1:])

    def platform() -> Poses:
        return given.part(where) if isinstance(given, Poses) else _poses(limbs, task, Law(x, x_dot, x_ddot))

    at, chain = platform(), screws(limbs, q)
    matrix = eliminate_legs(limbs, task, chain, _platform_columns(limbs, task, x, at))
    q_dot, x_dot[:, task.platform] = matrix.solve(
        np.concatenate([at.point(limbs.platform)[1], _each(at.omega, limbs)], axis=-1)
    )
    at = platform()
    goal = np.concatenate([at.point(limbs.platform)[2], _each(at.alpha, limbs)], axis=-1)
    q_ddot, x_ddot[:, task.platform] = matrix.solve(goal - chain.bias(q_dot))
    return q_dot, q_ddot, x_dot, x_ddot


def _each(vector: Array, limbs: Limbs) -> Array:
    return np.broadcast_to(vector[:, None], (len(vector), len(limbs), 3))
