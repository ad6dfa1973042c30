"""The deviation of the payload by cause, Eqs. (T8.1)-(T8.8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.errors import ComputationError
from flexapod.model import Robot
from flexapod.typing import Array

__all__ = ["LengthErrors", "deviation_by_cause", "length_errors"]


@dataclass(frozen=True, kw_only=True)
class LengthErrors:
    """Length errors of the legs by cause, each (T, legs) [m]; they add up to ``length - command`` exactly."""

    axial: Array
    bending: Array
    drive: Array

    @property
    def total(self) -> Array:
        """Joint-to-joint length minus commanded length, (T, legs) [m], Eq. (T8.5)."""
        return self.axial + self.bending + self.drive

    @property
    def stacked(self) -> Array:
        """The causes in the order of `names.CAUSES`, (T, 3, legs) [m]."""
        return np.stack([self.axial, self.bending, self.drive], axis=1)


def length_errors(length: Array, command: Array, stroke: Array, stretch: Array) -> LengthErrors:
    """Length errors of the legs by cause, Eqs. (T8.2)-(T8.4).

    Parameters
    ----------
    length, command : ndarray, shape (T, legs)
        Joint-to-joint lengths of the flexible and of the rigid robot [m].
    stroke : ndarray, shape (T, legs)
        Reference length l [m].
    stretch : ndarray, shape (T, legs)
        Amplitude of the static axial shape c_0 [m]: stretch of the piston at its tip.
    """
    return LengthErrors(
        axial=stretch,  # (T8.2)
        bending=length - (stroke + stretch),  # (T8.3)
        drive=stroke - command,  # (T8.4)
    )


def deviation_by_cause(robot: Robot, path: rigid.Poses, errors: LengthErrors) -> Array:
    """Displacement of the payload's centre of mass by cause and leg, to first order, Eqs. (T8.6)-(T8.7).

    Parameters
    ----------
    robot : Robot
    path : Poses
        The rigid path at T instants.
    errors : LengthErrors

    Returns
    -------
    ndarray, shape (T, 3, legs, 3)
        Time, cause, leg, world axis [m].

    Raises
    ------
    ComputationError
        If a pose is exactly singular.
    """
    jacobian = rigid.length_jacobian(
        robot.base_joints, robot.platform_joints, path.position, path.rotation, robot.payload.com
    )
    try:
        inverse = np.linalg.solve(jacobian.swapaxes(1, 2), np.eye(6, 3))  # (T8.6), (T, 6, 3): leg, axis
    except np.linalg.LinAlgError:
        raise ComputationError(
            "a pose on the path is singular: lengths do not determine it", next_step="See `flexapod check`."
        ) from None
    return errors.stacked[..., None] * inverse[:, None]  # (T8.7)
