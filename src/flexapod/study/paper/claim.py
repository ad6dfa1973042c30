"""A claim of the paper and our verdict on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.errors import InputError
from flexapod.study.scene import robot_study
from flexapod.study.words import text

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "BREAKS",
    "ELASTIC_LENGTH",
    "HOLDS",
    "IN_PART",
    "MISPRINT",
    "NOT",
    "OPEN",
    "PAPER_DEVIATION",
    "REACHES",
    "Claim",
    "axis_motion",
    "by_axis",
    "peaks",
    "roll_and_arm",
]

HOLDS, IN_PART, NOT, OPEN, MISPRINT = "holds", "holds in part", "does not hold", "cannot be compared", "misprint"
REACHES, BREAKS = "reaches that size", "robot gives way"
PAPER_DEVIATION = {"y": 5e-3, "z": 10e-3}  # of the centre of mass, Fig. 9 [m]
ELASTIC_LENGTH = 0.6  # of a piston, Table 3 [m]


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What the paper says and where, what we get, the verdict, and its reason."""

    where: str
    says: str
    ours: str
    verdict: str
    reason: str


def by_axis(values: np.ndarray, digits: int = 3) -> str:
    """Lengths along x, y, z in words."""
    return ", ".join(f"{axis} {text(float(value), 'm', digits)}" for axis, value in zip("xyz", values, strict=True))


def peaks(data: Dataset, digits: int = 3) -> str:
    """Largest deviation of the centre of mass by axis, in words."""
    return by_axis(np.abs(data.com_deviation.values).max(axis=0), digits)


def roll_and_arm(data: Dataset) -> tuple[float, float]:
    """Roll reached [rad] and distance of the centre of mass from the platform's centre [m]."""
    study = robot_study(data)
    return float(axis_motion(study).target[3]), float(np.linalg.norm(study.robot.payload.com))


def axis_motion(study: model.Study) -> model.AxisMotion:
    """The motion of a study, along or about one axis as in all of the paper's.

    Raises
    ------
    InputError
        Another kind of motion.
    """
    if isinstance(study.motion, model.AxisMotion):
        return study.motion
    raise InputError("is not along or about one axis", key="motion.type", allowed=", ".join(model.AXES))
