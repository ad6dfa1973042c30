"""Wrenches with which legs hold the platform while their drives are locked, and rates of drives, (T14.19)-(T14.21)."""

from __future__ import annotations

import numpy as np

from flexapod.rigid.limbs import DRIVEN, FREE, HELD, Limbs
from flexapod.rigid.screws import screws
from flexapod.rigid.trajectory import Poses
from flexapod.typing import Array

CLEAR = 0.1  # share of a driven coordinate's screw that the free ones must leave for it to name a wrench


def holding(limbs: Limbs, q: Array, path: Poses, point: Array) -> Array:
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
    """From a twist of the platform at `point` to the motion of its joints, (T, n, 6, 6)."""
    arms = (limbs.platform - point) @ path.rotation.swapaxes(-1, -2)
    joints = np.zeros((*arms.shape[:2], 6, 6))
    joints[..., :, :] = np.eye(6)
    joints[..., :3, 3:] = np.cross(np.eye(3), arms[..., None], axis=-2)
    return joints


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
