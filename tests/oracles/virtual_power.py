"""Motion and forces of a rigid mechanism by screws: exact rates and accelerations, then virtual power.

Positions: products of exponentials, closed by Newton. A screw is (turn, velocity of the point at the origin). The
screw of joint j moves with what stands before it, d/dt s_j = V_(j-1) x s_j, so that rates and accelerations are linear
equations with the same matrix: no differences. Every leg is cut at the platform; the wrench it passes there does no
work on motions of its passive joints, and the wrenches balance the platform. Equations by name: K. M. Lynch and
F. C. Park, Modern Robotics (2017), sections 4, 5 and 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

CLOSED = 1e-14
RANK = 1e-9  # of singular values: far below any geometry, far above rounding


@dataclass(frozen=True)
class Motion:
    """Coordinates with rates and accelerations, leg by leg and of the platform (surge sway heave yaw pitch roll)."""

    legs: list
    platform: tuple


@dataclass(frozen=True)
class Forces:
    """Drive forces (n,), NaN for passive legs; force and moment at the tip on the platform, at the base on the leg."""

    drive: np.ndarray
    tip_force: np.ndarray
    tip_moment: np.ndarray
    base_force: np.ndarray
    base_moment: np.ndarray
    open: int  # combinations of forces that rigid statics does not settle


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def screws(chain):
    """Screws of the joints at home, (n, 6)."""
    rows = [np.r_[j.axis, np.cross(j.point, j.axis)] if j.kind == "R" else np.r_[0, 0, 0, j.axis] for j in chain.joints]
    return np.array(rows).reshape(-1, 6)


def moved(screw, amount):
    """Displacement (4, 4) along a screw."""
    w, v = screw[:3], screw[3:]
    T = np.eye(4)
    if not w.any():
        T[:3, 3] = v * amount
        return T
    W = skew(w)
    T[:3, :3] += np.sin(amount) * W + (1 - np.cos(amount)) * W @ W
    T[:3, 3] = (np.eye(3) - T[:3, :3]) @ np.cross(w, v) + np.outer(w, w) @ v * amount
    return T


def carried(T, screw):
    """The screw in a place displaced by T."""
    w = T[:3, :3] @ screw[:3]
    return np.concatenate([w, T[:3, :3] @ screw[3:] + skew(T[:3, 3]) @ w])


def bracket(a, b):
    """Rate of a screw b that moves with the motion a."""
    turn = skew(a[:3])
    return np.concatenate([turn @ b[:3], turn @ b[3:] + skew(a[3:]) @ b[:3]])


def placed(chain, q):
    """Displacements after 0, 1, ... joints, and the screws where they are now."""
    places, now = [np.eye(4)], []
    for screw, amount in zip(screws(chain), q, strict=True):
        now.append(carried(places[-1], screw))
        places.append(places[-1] @ moved(screw, amount))
    return places, np.array(now).reshape(-1, 6)


def motions(now, rates, accelerations=None):
    """Motions after 0, 1, ... joints, and their rates; without accelerations the part that rates alone give."""
    V, A = [np.zeros(6)], [np.zeros(6)]
    for j, screw in enumerate(now):
        push = 0.0 if accelerations is None else accelerations[j]
        A.append(A[-1] + bracket(V[-1], screw) * rates[j] + screw * push)
        V.append(V[-1] + screw * rates[j])
    return V, A


def split(mechanism, z):
    """Coordinates leg by leg, and the platform's."""
    ends = np.cumsum([len(leg.joints) for leg in mechanism.legs])
    *legs, hub = np.split(z, ends)
    return legs, hub


def gap(leg_place, hub_place):
    """The small displacement between both sides of a closure as a screw."""
    E = leg_place @ np.linalg.inv(hub_place)
    R = E[:3, :3]
    return np.r_[R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 2 * E[:3, 3]] / 2


def matrix(mechanism, legs, hub):
    """Closures and given coordinates: matrix of their rates."""
    columns = sum(len(leg.joints) for leg in mechanism.legs) + 6
    _, platform = placed(mechanism.platform, hub)
    rows, at = [], 0
    for leg, q in zip(mechanism.legs, legs, strict=True):
        block = np.zeros((6, columns))
        block[:, at : at + len(q)] = placed(leg, q)[1].T
        block[:, -6:] = -platform.T
        rows.append(block)
        at += len(q)
    given = np.zeros((len(mechanism.independent), columns))
    given[np.arange(len(mechanism.independent)), columns - 6 + np.array(mechanism.independent)] = 1
    return np.concatenate([*rows, given])


def solved(A, b):
    """Least squares, shortest: exact where equations depend on one another but agree, as in planar robots."""
    x, *_ = np.linalg.lstsq(A, b, rcond=RANK)
    return x


def follow(mechanism, given, rates, accelerations, guess=None, steps=2):
    """Coordinates of all joints where the independent ones of the platform have `given` values (d,)."""
    count = sum(len(leg.joints) for leg in mechanism.legs) + 6
    z = np.zeros(count) if guess is None else np.concatenate([*(q for q, *_ in guess.legs), guess.platform[0]])
    start = z[count - 6 + np.array(mechanism.independent)]
    for share in np.arange(1, steps + 1) / steps:
        z = _closed(mechanism, z, start + share * (np.asarray(given) - start))
    legs, hub = split(mechanism, z)
    A = matrix(mechanism, legs, hub)
    closures = 6 * len(mechanism.legs)
    v = solved(A, np.r_[np.zeros(closures), rates])
    leg_rates, hub_rates = split(mechanism, v)
    _, bend = motions(placed(mechanism.platform, hub)[1], hub_rates)
    bends = [
        motions(placed(leg, q)[1], qd)[1][-1] - bend[-1]
        for leg, q, qd in zip(mechanism.legs, legs, leg_rates, strict=True)
    ]
    right = np.r_[-np.concatenate(bends), accelerations]
    a = solved(A, right)
    for x, b in ((v, np.r_[np.zeros(closures), rates]), (a, right)):
        if np.abs(A @ x - b).max() > 1e-9 * (1 + np.abs(b).max()):
            raise ValueError("the mechanism does not have this motion")
    pushes, hub_pushes = split(mechanism, a)
    return Motion(list(zip(legs, leg_rates, pushes, strict=True)), (hub, hub_rates, hub_pushes))


def _closed(mechanism, z, given):
    error = np.inf
    for _ in range(40):
        legs, hub = split(mechanism, z)
        end = placed(mechanism.platform, hub)[0][-1]
        gaps = [gap(placed(leg, q)[0][-1], end) for leg, q in zip(mechanism.legs, legs, strict=True)]
        miss = np.r_[np.concatenate(gaps), hub[list(mechanism.independent)] - given]
        before, error = error, np.abs(miss).max()
        if error < CLOSED or (error < 1e-12 and error >= before):
            return z
        z = z - solved(matrix(mechanism, legs, hub), miss)
    raise ValueError(f"not closed: {error:.2g}")


def needed(chain, gravity, q, rates, accelerations):
    """Wrenches at the origin that the bodies after 0, 1, ... joints need together (n + 1, 6), and the screws now."""
    places, now = placed(chain, q)
    V, A = motions(now, rates, accelerations)
    own = np.zeros((len(places), 6))
    for body in chain.bodies:
        T, (w, v), (dw, dv) = places[body.after], np.split(V[body.after], 2), np.split(A[body.after], 2)
        c, inertia = T[:3, :3] @ body.com + T[:3, 3], T[:3, :3] @ body.inertia @ T[:3, :3].T
        velocity = v + np.cross(w, c)
        force = body.mass * (dv + np.cross(dw, c) + np.cross(w, velocity) - gravity)
        moment = inertia @ dw + np.cross(w, inertia @ w)
        own[body.after] += np.r_[moment + np.cross(c, force), force]
    return np.cumsum(own[::-1], axis=0)[::-1], now


def forces(mechanism, motion, wrench=None, weights=None):
    """Forces for a motion; `wrench` (6,) = force, moment at the tool, world axes.

    Where rigid statics leaves forces open, those of the least sum of weights (n,) times squared thrusts at the tips.
    """
    legs, count = mechanism.legs, len(mechanism.legs)
    load = needed(mechanism.platform, mechanism.gravity, *motion.platform)[0][0]
    place = placed(mechanism.platform, motion.platform[0])[0][-1]
    tool = place[:3, :3] @ mechanism.tool + place[:3, 3]
    wrench = np.zeros(6) if wrench is None else np.asarray(wrench, float)
    load = load - np.r_[wrench[3:] + np.cross(tool, wrench[:3]), wrench[:3]]
    parts = [needed(leg, mechanism.gravity, *state) for leg, state in zip(legs, motion.legs, strict=True)]
    rows, right = [np.tile(np.eye(6), count)], [load]
    for i, (leg, (whole, now)) in enumerate(zip(legs, parts, strict=True)):
        passive = [j for j in range(len(now)) if j != leg.drive]
        block = np.zeros((len(passive), 6 * count))
        block[:, 6 * i : 6 * i + 6] = now[passive]
        rows.append(block)
        right.append(-np.array([now[j] @ whole[j + 1] for j in passive]))
    G, b = np.concatenate(rows), np.concatenate(right)
    lam = solved(G, b)
    if np.abs(G @ lam - b).max() > 1e-8 * np.abs(b).max():
        raise ValueError("these drives cannot hold the platform")
    lam, free = _settled(G, lam, mechanism, motion, weights)
    return _named(legs, motion, parts, place, lam.reshape(count, 6), free)


def _settled(G, lam, mechanism, motion, weights):
    """The forces of least weighted squares among those that rigid statics allows."""
    legs, null = mechanism.legs, null_space(G, rcond=RANK)
    D = np.zeros((len(legs), lam.size))
    for i, (leg, state) in enumerate(zip(legs, motion.legs, strict=True)):
        along = (leg.tip - leg.base) / np.linalg.norm(leg.tip - leg.base)
        rod = leg.bodies[-1].after if leg.bodies else len(leg.joints)
        D[i, 6 * i + 3 : 6 * i + 6] = placed(leg, state[0])[0][rod][:3, :3] @ along
    root = np.ones(len(legs)) if weights is None else np.sqrt(np.asarray(weights) / np.max(weights))
    U, size, V = np.linalg.svd(root[:, None] * (D @ null), full_matrices=False)
    share = np.divide(U.T @ (root * (D @ lam)), size, out=np.zeros_like(size), where=size > RANK)
    return lam - null @ (V.T @ share), int((size > RANK).sum())


def _named(legs, motion, parts, place, lam, free):
    drive = np.full(len(legs), np.nan)
    tips, bases = np.zeros((len(legs), 6)), np.zeros((len(legs), 6))
    for i, (leg, (whole, now)) in enumerate(zip(legs, parts, strict=True)):
        if leg.drive is not None:
            drive[i] = now[leg.drive] @ (whole[leg.drive + 1] + lam[i])
        tips[i] = _at(lam[i], place[:3, :3] @ leg.tip + place[:3, 3])
        first = (
            2 if leg.joints and leg.joints[0].name == "carriage" else 0
        )  # joints before the bodies of the leg itself
        T = placed(leg, motion.legs[i][0])[0][first // 2]
        base = T[:3, :3] @ leg.base + T[:3, 3]
        own = whole[first] if first < len(whole) else np.zeros(6)
        bases[i] = _at(own + lam[i], base)
    return Forces(drive, tips[:, 3:], tips[:, :3], bases[:, 3:], bases[:, :3], free)


def _at(wrench, point):
    """Moment about a point instead of the origin."""
    return np.r_[wrench[:3] - np.cross(point, wrench[3:]), wrench[3:]]


def mobility(mechanism, motion=None):
    """Motions, with drives locked, and self-stresses of the drives: ranks of the joints' screws."""
    zero = [np.zeros(len(leg.joints)) for leg in mechanism.legs], np.zeros(6)
    legs, hub = zero if motion is None else ([q for q, *_ in motion.legs], motion.platform[0])
    closures = matrix(mechanism, legs, hub)[: 6 * len(mechanism.legs)]
    drives, at = [], 0
    for leg in mechanism.legs:
        drives += [at + leg.drive] if leg.drive is not None else []
        at += len(leg.joints)
    lock = np.zeros((len(drives), closures.shape[1]))
    lock[np.arange(len(drives)), drives] = 1
    free = closures.shape[1] - np.linalg.matrix_rank(closures, RANK)
    locked = np.concatenate([closures, lock])
    rank = np.linalg.matrix_rank(locked, RANK)
    redundant = len(closures) - np.linalg.matrix_rank(closures, RANK)
    return {
        "joints": closures.shape[1] - 6,
        "mobility": free,
        "redundant": redundant,
        "locked": closures.shape[1] - rank,
        "self_stress": len(locked) - rank,
    }
