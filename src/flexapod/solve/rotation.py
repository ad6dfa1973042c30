"""Quaternions (w x y z, platform to world) for the numeric side."""

import numpy as np
from scipy.spatial.transform import Rotation

from flexapod.typing import Array


def quaternion(R: Array) -> Array:
    """Unit quaternions (..., 4) with w >= 0 of rotation matrices (..., 3, 3)."""
    return Rotation.from_matrix(R).as_quat(canonical=True, scalar_first=True)


def matrix(e: Array) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    return Rotation.from_quat(e, scalar_first=True).as_matrix()


def turned(pose: Array, step: Array) -> Array:
    """Pose (7,) moved by step (6,): x + dx, R exp(theta^), Eq. (T4.3)."""
    e = Rotation.from_quat(pose[3:], scalar_first=True) * Rotation.from_rotvec(step[3:])
    return np.concatenate([pose[:3] + step[:3], e.as_quat(scalar_first=True)])
