"""Kinematics of any mechanism: legs from poses or commanded coordinates, poses from drives."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.closures import Closed, ClosureMotion, Task, solve_closures, solve_rates
from flexapod.kinematics.inverse import BETA_LIMIT, NO_LENGTH, LegState
from flexapod.kinematics.laws import Law
from flexapod.kinematics.leg_geometry import ABSENT, COORDINATES, DRIVEN, FREE, Limbs
from flexapod.kinematics.screws import screws
from flexapod.kinematics.trajectory import Poses, places, poses_from_coordinates

BEYOND, NEAR = 1000.0, 2.0  # lengths of a leg: farther away no path leads; first look at how far its legs can follow
LOOKS = 33  # instants of each

CHI, BETA, L, GAMMA2 = (COORDINATES.index(name) for name in ("chi", "beta", "l", "gamma2"))


def legs_at(limbs: Limbs, path: Poses) -> Closed:
    """Coordinates of the legs at T poses, NaN where the legs do not reach."""
    task = Task(limbs.unknown, np.zeros(6, dtype=bool), np.zeros(3))
    found = solve_closures(limbs, task, _tiled(limbs, len(path)), path)
    found.q.flags.writeable = False
    return found


def moved_legs(limbs: Limbs, path: Poses, found: Closed) -> ClosureMotion:
    """Coordinates of the legs at T poses with two derivatives; `found`: as of `legs_at` there."""
    task = Task(limbs.unknown, np.zeros(6, dtype=bool), np.zeros(3))
    return solve_rates(limbs, task, found, path)


def leg_state(limbs: Limbs, path: Poses, found: Closed, moved: ClosureMotion | None = None) -> LegState:
    """Legs at T poses with two derivatives; `found`: as of `legs_at` there; `moved`: of them, where it is known.

    Raises
    ------
    InputError
        The legs do not reach a pose, a joint folds beyond 85 deg, or a carriage leaves its side.
    """
    refuse_lost(limbs, found)
    _refuse_folded(limbs, found.q)
    return _as_state(limbs, moved_legs(limbs, path, found) if moved is None else moved)


def follow(limbs: Limbs, unknown: Mask, law: Law, pivot: Array, t: Array | None = None) -> Poses:
    """Poses at T instants of a platform of which some coordinates are commanded, the `unknown` (6,) follow.

    Raises
    ------
    InputError
        The mechanism cannot take a pose with these coordinates at an instant `t` (T,); without instants such poses
        are NaN.
    """
    return poses_of(limbs, follow_with_legs(limbs, unknown, law, pivot, t), pivot)


def follow_with_legs(limbs: Limbs, unknown: Mask, law: Law, pivot: Array, t: Array | None = None) -> ClosureMotion:
    """Coordinates of the legs and of the platform of `follow`, with two derivatives."""
    task = Task(limbs.unknown, unknown, pivot)
    given = Law(*(np.where(unknown, 0.0, part) for part in law))
    found = solve_closures(limbs, task, _tiled(limbs, len(law.position)), given.position)
    if t is not None:
        refuse_lost(limbs, found, t)
    return solve_rates(limbs, task, found, Law(found.x, *given[1:]))


def poses_of(limbs: Limbs, moved: ClosureMotion, pivot: Array) -> Poses:
    """Poses of a platform whose coordinates are about a pivot."""
    return poses_from_coordinates(Poses.at_rest(limbs.position, limbs.rotation), moved.platform, pivot)


def forward(limbs: Limbs, drives: Array, guess: Poses | None = None) -> Poses:
    """Poses at positions (T, m) of the m driven coordinates, as the study file counts them, Eq. (T14.17).

    Raises
    ------
    InputError
        The positions are not m numbers for each pose.
    ComputationError
        No pose is found from the guess (default: home).
    """
    driven, drives = limbs.state == DRIVEN, np.atleast_2d(drives)
    if drives.shape[1] != driven.sum() or not np.isfinite(drives).all():
        raise InputError(
            "do not fit the drives", key="lengths", allowed=f"({driven.sum()},) or (T, {driven.sum()}) finite numbers"
        )
    task = Task(limbs.state == FREE, ~limbs.hub_held, np.zeros(3))
    q = _tiled(limbs, len(drives))
    q[:, driven] = drives
    q[..., CHI] = np.where(driven[:, CHI], q[..., CHI] - limbs.carriage_zero, q[..., CHI])
    start = None
    if guess is not None:
        start = legs_at(limbs, guess)
        refuse_lost(limbs, start)
    found = solve_closures(limbs, task, q, np.zeros((len(drives), 6)), start)
    if np.isnan(found.q).any():
        k = int(np.argmax(np.isnan(found.q).any(axis=(1, 2))))
        raise ComputationError(
            f"No pose fits the drives of sample {k + 1} near the guess",
            next_step="Start from a nearer guess",
        )
    rest = np.zeros_like(found.x)
    return poses_from_coordinates(Poses.at_rest(limbs.position, limbs.rotation), Law(found.x, rest, rest))


def drives_of(limbs: Limbs, q: Array) -> Array:
    """Positions (T, m) of the driven coordinates as the study file counts them, from leg coordinates (T, n, 8)."""
    q = q.copy()
    q[..., CHI] += limbs.carriage_zero
    return q[:, limbs.state == DRIVEN]


class Reach(NamedTuple):
    """Legs at T poses, whether they can take them or not.

    Attributes
    ----------
    length, carriage : ndarray, shape (T, n)
        From joint to joint [m]; places of the carriages as the study file counts them [m, rad], zero without one. NaN
        where the legs do not reach.
    angles : dict of ndarray, shape (T, n)
        Angles [rad] that must stay below 85 deg, by joint: of the base joint beta, of the platform joint gamma2, and
        between the way of a carriage and its leg, which beyond 90 deg stands on the other side. Zero without one.
    gap : ndarray, shape (T, n)
        By how much the leg misses its platform joint [m].
    """

    length: Array
    carriage: Array
    angles: dict[str, Array]
    gap: Array

    @property
    def lost(self) -> Mask:
        """Poses that the legs do not reach, (T,)."""
        return ~np.all(self.length >= NO_LENGTH, axis=1)


def reach(limbs: Limbs, found: Closed) -> Reach:
    """Demands of T poses on the legs, by their coordinates there as of `legs_at`."""
    place = np.where(limbs.state[:, CHI] != ABSENT, found.q[..., CHI] + limbs.carriage_zero, 0.0)
    return Reach(found.q[..., L], place, angles(limbs, found.q), found.gap)


def coordinates_of(legs: LegState) -> Array:
    """`COORDINATES` of the legs, (T, n, 8)."""
    return np.stack([legs.coordinate(name)[0] for name in COORDINATES], axis=-1)


def axes(limbs: Limbs, q: Array) -> Array:
    """Unit vectors along the legs at coordinates (T, n, 8), (T, n, 3)."""
    return screws(limbs, q).columns[..., :3, L]


def angles(limbs: Limbs, q: Array) -> dict[str, Array]:
    """Angles (T, n) by joint as of `Reach`."""
    found = {}
    for name, k in (("base joint", BETA), ("platform joint", GAMMA2)):
        free = limbs.state[:, k] == FREE
        if free.any():
            found[name] = np.where(free, np.abs(q[..., k]), 0.0)
    if limbs.carriage:
        found["carriage"] = np.where(limbs.state[:, CHI] != ABSENT, np.arccos(np.clip(sides(limbs, q), -1, 1)), 0.0)
    return found


def sides(limbs: Limbs, q: Array) -> Array:
    """Cosine of the angle between a carriage's way and the leg (T, n), positive on the side of home, Eq. (T14.18)."""
    reach = np.ones(len(limbs))
    if limbs.carriage == "crank":
        reach = np.linalg.norm(np.cross(limbs.carriage_axis, limbs.carriage_arm), axis=1)

    columns = screws(limbs, np.concatenate([q, limbs.home[None]])).columns[..., :3, :]
    cosine = np.sum(columns[..., CHI] * columns[..., L], axis=-1) / np.where(reach > 0, reach, 1.0)
    return cosine[:-1] * np.sign(cosine[-1])


def _tiled(limbs: Limbs, count: int) -> Array:
    return np.tile(limbs.home, (count, 1, 1))


def _as_state(limbs: Limbs, moved: ClosureMotion) -> LegState:
    parts = zip(("", "_dot", "_ddot"), moved[:3], strict=True)
    values: dict[str, Array] = {}
    for end, q in parts:
        values |= {"alpha" + end: q[..., 1], "beta" + end: q[..., BETA]}
        values[{"": "length", "_dot": "rate", "_ddot": "accel"}[end]] = q[..., L]
        for name, k in (("chi", CHI), ("spin", 3)):
            if (limbs.state[:, k] != ABSENT).any():
                values[name + end] = q[..., k]
        if limbs.pose_closure.any():
            values["gamma" + end] = q[..., GAMMA2 - 1 :]
    return LegState(**values)


def lost_words(limbs: Limbs, gap: Array) -> str:
    """Clause on the leg that misses its platform joint by the most; `gap` (n,) [m] of one pose."""
    gap = np.where(np.isfinite(gap), gap, np.inf)
    leg = int(np.argmax(gap))
    off = f" (by {1e3 * gap[leg]:.3g} mm)" if np.isfinite(gap[leg]) else ""
    return f"leg {leg + 1}, {limbs.chain[leg]}, does not reach its platform joint{off}"


def refuse_lost(limbs: Limbs, found: Closed, t: Array | None = None) -> None:
    """Refuse poses that the legs do not reach, with leg and instant `t` (T,), else with the number of the pose."""
    lost = np.asarray(np.isnan(found.q).any(axis=(1, 2)))
    if not lost.any():
        return
    k = int(np.argmax(lost))
    where = f"sample {k + 1} of {len(lost)}" if t is None else f"at t = {t[k]:.6g} s"
    raise InputError(
        f"{lost_words(limbs, found.gap[k])}: {where}",
        key="motion",
        allowed="poses that all legs can take",
        next_step="Reduce the motion; of a robot with fewer than six motions command only those (motion.independent)",
    )


def refuse_far(limbs: Limbs, law: Law, pivot: Array, t: Array) -> None:
    """Refuse a path that leads beyond all robots: some length is not what it was meant to be.

    Raises
    ------
    InputError
    """
    size, way = _ways_of(limbs, law, pivot)
    k = int(np.argmax(way))
    if not way[k] <= BEYOND * size:
        raise InputError(
            f"leads the platform {way[k]:.4g} m away from home at t = {t[k]:.6g} s, and the robot's legs are "
            f"{size:.4g} m long",
            key="motion",
            allowed=f'at most {BEYOND:g} times that; numbers are in m and rad, text has its unit: "8 mm"',
            next_step="Look at amplitudes and pivot of the motion",
        )


def first_looks(limbs: Limbs, law: Law, pivot: Array) -> Iterator[NDArray[np.intp]]:
    """Indices of few instants of a path that leads far, at which to see whether legs follow, ever farther from home.

    None of paths near home.
    """
    size, way = _ways_of(limbs, law, pivot)
    radius = NEAR * size
    while radius < way.max(initial=0.0):
        yield np.unique(np.linspace(0, np.argmax(way > radius), LOOKS).astype(np.intp))
        radius *= 2


def _ways_of(limbs: Limbs, law: Law, pivot: Array) -> tuple[float, Array]:
    """The size of a robot [m], and how far away from home a path leads (T,) [m]."""
    place = limbs.position + law.position[:, :3]
    if pivot.any():
        place = places(Poses.at_rest(limbs.position, limbs.rotation), law, pivot)[0]
    return max(float(limbs.home[:, L].mean()), limbs.L_c), np.linalg.norm(place - limbs.position, axis=1)


_NEXT = {
    "base joint": "Turn the axis of the base joint, or reduce the motion",
    "platform joint": "Turn the axis of the platform joint, or reduce the motion",
    "carriage": "There the carriage cannot hold its leg, and beyond it stands on the other side: reduce the motion, or "
    "change carriage.side",
}


def _refuse_folded(limbs: Limbs, q: Array) -> None:
    for joint, angle in angles(limbs, q).items():
        if angle.max(initial=0.0) > BETA_LIMIT:
            instant, leg = np.argwhere(angle > BETA_LIMIT)[0]
            what = (
                f"the {joint} of leg {leg + 1} folds to"
                if joint != "carriage"
                else f"leg {leg + 1} meets its carriage at"
            )
            raise InputError(
                f"{what} {np.rad2deg(angle[instant, leg]):.1f} deg (sample {instant + 1} of {len(q)})",
                key=f"leg {leg + 1}",
                allowed="at most 85 deg",
                next_step=_NEXT[joint],
            )
