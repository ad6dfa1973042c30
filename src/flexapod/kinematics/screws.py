"""Legs as chains of screws: where their tips and joint frames are, how they move, Eqs. (T14.1)-(T14.5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, Limbs
from flexapod.kinematics.rotations import Vector, cross, dot, time_last

_BODY = COORDINATES.index("l") + 1  # coordinates that move the tip; the later ones turn the joint frame alone


@dataclass(frozen=True, kw_only=True)
class Screws:
    """n legs at T instants.

    Attributes
    ----------
    tip : ndarray, shape (T, n, 3)
        World axes [m].
    frame : ndarray, shape (T, n, 3, 3)
        Joint frame at the end of the leg, ``R F_L Gamma``, to the world.
    columns : ndarray, shape (T, n, 6, 8)
        Velocity of the tip and angular velocity of the joint frame for each of `COORDINATES`, world axes.
    """

    tip: Array
    frame: Array
    columns: Array

    def bias(self, rates: Array) -> Array:
        """Accelerations (T, n, 6) at rates (T, n, 8) that the second derivatives do not contain, Eq. (T14.5)."""
        slides, turns = np.moveaxis(self.columns, (3, 2), (0, 1)).reshape(8, 2, 3, *rates.shape[:2]).swapaxes(0, 1)
        v, w = np.zeros((2, 3, *rates.shape[:2]))
        swing, spin = np.zeros((2, 3, *rates.shape[:2]))
        tip = swing
        for k, rate in enumerate(np.moveaxis(rates, -1, 0)):
            spin = spin + rate * np.array(cross(w, turns[k]))
            if k < _BODY:  # rate of a screw that the twist (v, w) before it carries along
                swing = swing + rate * (np.array(cross(w, slides[k])) - np.array(cross(turns[k], v)))
                v = v + rate * slides[k]
            if k == _BODY - 1:
                tip = swing + np.array(cross(w, v))
            w = w + rate * turns[k]
        return np.moveaxis(np.concatenate([tip, spin]), 0, -1)


def screws(limbs: Limbs, q: Array) -> Screws:
    """Tips, joint frames and velocities of the legs at coordinates `q` (T, n, 8), Eqs. (T14.1)-(T14.4)."""
    chi, alpha, beta, spin, length, *gamma = time_last(q).swapaxes(0, 1)
    frame = [np.asarray(limbs.frames[:, :, k].T[..., None]) for k in range(3)]  # columns (3, n, 1)
    foot, axis, arm = (x.T[..., None] for x in (limbs.base, limbs.carriage_axis, limbs.carriage_arm))
    slides, turns = np.zeros((2, 8, 3, *chi.shape))
    if limbs.carriage == "slider":
        foot, slides[0] = foot + chi * axis, axis
    elif limbs.carriage == "crank":
        shaft, arm = foot - arm, _about(axis, arm, chi)
        foot, frame = shaft + arm, [_about(axis, x, chi) for x in frame]
        turns[0] = axis
    for k, (name, angle) in enumerate((("alpha", alpha), ("beta", beta), ("spin", spin))):
        turns[COORDINATES.index(name)] = frame[k]
        frame = _turned(frame, k, angle)
    slides[4] = frame[2]
    reach = length * frame[2]
    tip = foot + reach
    for k in (1, 2, 3):
        slides[k] = cross(turns[k], reach)
    if limbs.carriage == "crank":
        slides[0] = cross(axis, arm + reach)
    x, y, z = frame
    parts = limbs.leg_frames.transpose(2, 1, 0)[..., None]  # (3, 3, n, 1): of each axis of F_L its parts
    frame = [part[0] * x + part[1] * y + part[2] * z for part in parts]
    for k, angle in enumerate(gamma):
        turns[5 + k] = frame[k]
        frame = _turned(frame, k, angle)
    size = (3, *chi.shape)
    return Screws(
        tip=np.moveaxis(np.broadcast_to(tip, size), (0, 2), (2, 0)),
        frame=np.moveaxis(np.array([np.broadcast_to(x, size) for x in frame]), (0, 1, 3), (3, 2, 0)),
        columns=np.moveaxis(np.concatenate([slides, turns], axis=1), (0, 1, 3), (3, 2, 0)),
    )


def _turned(frame: list[Array], k: int, angle: Array) -> list[Array]:
    """Columns of a frame turned about its own column `k`."""
    if not angle.any():
        return frame
    i, j = (k + 1) % 3, (k + 2) % 3
    c, s = np.cos(angle), np.sin(angle)
    out = list(frame)
    out[i], out[j] = c * frame[i] + s * frame[j], c * frame[j] - s * frame[i]
    return out


def _about(axis: Vector, vector: Vector, angle: Array) -> Array:
    """Vector turned about a unit axis, (T2.40)."""
    c, s = np.cos(angle), np.sin(angle)
    along = (1 - c) * dot(axis, vector)
    return np.array([c * v + s * x + along * a for a, v, x in zip(axis, vector, cross(axis, vector), strict=True)])
