"""A claim of the paper and our verdict on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.errors import InputError
from flexapod.study.scene import robot_study
from flexapod.study.words import number, text

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
    "SIZE",
    "Claim",
    "axis_motion",
    "by_axis",
    "explained",
    "judged",
    "left_open",
    "peaks",
    "roll_and_arm",
    "roll_error",
    "size",
    "times",
]

HOLDS, IN_PART, NOT = "holds", "holds in part", "does not hold"  # of numbers, by `judged`
REACHES, BREAKS = "reaches that size", "robot gives way"  # of numbers, too
OPEN = "cannot be compared"  # of the text: the paper does not give what the preset marks as ours, `left_open`
MISPRINT = "misprint"  # of the text: a printed formula against the derived one, in the last table of chapter T9
PAPER_DEVIATION = {"y": 5e-3, "z": 10e-3}  # of the centre of mass, Fig. 9 [m]
ELASTIC_LENGTH = 0.6  # of a piston, Table 3 [m]
SIZE = 0.5  # "about 5 mm": a deviation within this share of the printed one counts as that size


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What the paper says and where, what we get, the verdict, and its reason."""

    where: str
    says: str
    ours: str
    verdict: str
    reason: str


def judged(holds: bool | np.bool_, in_part: bool | np.bool_ = False, best: str = HOLDS) -> str:
    """Verdict of the first rule that is true of the numbers: `best`, holds in part, or does not hold."""
    return best if holds else IN_PART if in_part else NOT


def size(y: float, z: float) -> str:
    """Verdict on largest deviations [m]: whether both are at least half of the paper's."""
    share = min(y / PAPER_DEVIATION["y"], z / PAPER_DEVIATION["z"])
    return judged(share >= 1 - SIZE, best=REACHES)


def explained(verdict: str, expected: str, reason: str) -> str:
    """The reason, as long as the verdict is the one that it explains."""
    return reason if verdict == expected else f"Not explained: these results were expected to give '{expected}'."


def left_open(preset: str, *keys: str) -> bool:
    """Whether a preset marks one of these values as ours, because the paper does not give it."""
    return not {value.key for value in model.open_values(preset)}.isdisjoint(keys)


def times(ours: float, paper: float) -> str:
    """How many times smaller or larger than the paper's a value is, in words."""
    if ours <= 0 or paper <= 0:
        return "not comparable"
    return f"{number(paper / ours, 2)} times smaller" if ours < paper else f"{number(ours / paper, 2)} times larger"


def roll_error(arm: float) -> float:
    """Error of the roll [rad] that moves a centre of mass `arm` [m] off the axis by the paper's deviation."""
    return math.hypot(*PAPER_DEVIATION.values()) / arm


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
