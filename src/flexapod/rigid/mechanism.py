"""Kinematics of any mechanism: from poses or commanded coordinates to legs, from drives to poses, in words refused."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexapod.errors import ComputationError, InputError
from flexapod.rigid.closures import Closed, Motion, Task, close, move
from flexapod.rigid.kinematics import BETA_LIMIT, LegState
from flexapod.rigid.laws import Law
from flexapod.rigid.limbs import ABSENT, COORDINATES, DRIVEN, FREE, Limbs
from flexapod.rigid.screws import screws
from flexapod.rigid.trajectory import Poses, poses_from_coordinates
from flexapod.typing import Array

__all__ = ["angles", "drives_of", "follow", "forward", "leg_state", "legs_at", "sides"]

Mask = NDArray[np.bool_]

CHI, BETA, L, GAMMA2 = (COORDINATES.index(name) for name in ("chi", "beta", "l", "gamma2"))


def legs_at(limbs: Limbs, path: Poses) -> Closed:
    """Coordinates of the legs at T poses, NaN where the legs do not reach."""
    task = Task(limbs.unknown, np.zeros(6, dtype=bool), np.zeros(3))
    return close(limbs, task, _tiled(limbs, len(path)), path)


def leg_state(limbs: Limbs, path: Poses) -> LegState:
    """Legs at T poses with two derivatives.

    Raises
    ------
    InputError
        The legs do not reach a pose, a joint folds beyond 85 deg, or a carriage leaves its side.
    """
    task = Task(limbs.unknown, np.zeros(6, dtype=bool), np.zeros(3))
    found = close(limbs, task, _tiled(limbs, len(path)), path)
    _refuse_lost(limbs, found)
    _refuse_folded(limbs, found.q)
    return _as_state(limbs, move(limbs, task, found, path))


def follow(limbs: Limbs, unknown: Mask, law: Law, pivot: Array) -> Poses:
    """Poses at T instants of a platform of which some coordinates are commanded, the `unknown` (6,) follow.

    Raises
    ------
    InputError
        The mechanism cannot take a pose with these coordinates.
    """
    task = Task(limbs.unknown, unknown, pivot)
    given = Law(*(np.where(unknown, 0.0, part) for part in law))
    found = close(limbs, task, _tiled(limbs, len(law.position)), given.position)
    _refuse_lost(limbs, found)
    moved = move(limbs, task, found, Law(found.x, *given[1:]))
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
        _refuse_lost(limbs, start)
    found = close(limbs, task, q, np.zeros((len(drives), 6)), start)
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


def angles(limbs: Limbs, q: Array) -> dict[str, Array]:
    """Angles (T, n) [rad] that must stay below 85 deg by joint, zero where a leg has no such joint.

    Of the base joint beta, of the platform joint gamma2, and of a carriage the angle between its way and the leg;
    beyond 90 deg of the latter the leg stands on the other side.
    """
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

    def cosine(q: Array) -> Array:
        columns = screws(limbs, q).columns[..., :3, :]
        return np.sum(columns[..., CHI] * columns[..., L], axis=-1) / np.where(reach > 0, reach, 1.0)

    return cosine(q) * np.sign(cosine(limbs.home[None]))


def _tiled(limbs: Limbs, count: int) -> Array:
    return np.tile(limbs.home, (count, 1, 1))


def _as_state(limbs: Limbs, moved: Motion) -> LegState:
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


def _refuse_lost(limbs: Limbs, found: Closed) -> None:
    lost = np.asarray(np.isnan(found.q).any(axis=(1, 2)))
    if not lost.any():
        return
    k = int(np.argmax(lost))
    gap = np.where(np.isfinite(found.gap[k]), found.gap[k], np.inf)
    leg = int(np.argmax(gap))
    off = f"by {1e3 * gap[leg]:.3g} mm; " if np.isfinite(gap[leg]) else ""
    raise InputError(
        f"leg {leg + 1} ({limbs.chain[leg]}) does not reach its platform joint ({off}sample {k + 1} of {len(lost)})",
        key="motion",
        allowed="poses that all legs can take",
        next_step="Reduce the motion; of a robot with fewer than six motions command only those (motion.independent)",
    )


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
