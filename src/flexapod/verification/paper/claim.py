"""A claim of the paper and our verdict on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import InitVar, dataclass

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.results.attributes import motion_end, robot_study
from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text

HOLDS, IN_PART, NOT = "holds", "holds in part", "does not hold"  # of numbers, by `choose_verdict`
HERE = "holds here"  # of numbers that are those of one example
REACHES, MISSES, BREAKS = "reaches that size", "does not give it", "robot gives way"  # of variants, by `size_verdict`
DONE, USELESS = "done here", "brings nothing here"  # of what the paper asks for next
OPEN = "cannot be compared"  # of the text: the paper does not give what the preset marks as ours, `is_unspecified`
MISPRINT = "misprint"  # of the text: a printed formula or word that cannot be meant, in the last table of chapter T9
INCOMPLETE = "incomplete"  # of the text: a term that the derived formula has and the printed one has not

OWN, VARIANT, NEXT = "paper", "variant", "outlook"  # whose a claim is
#: Whose claims are, in the order in which they are told, and the words for them.
WHOSE = {
    OWN: "The paper's own claims",
    NEXT: "What the paper asks for next",
    VARIANT: "Variants of ours: what else might give the printed 5 mm and 10 mm",
}
COPY = "in the text that we have"  # made from pages: what a lost dot, power or letter can explain is said so
FIGURE = " The figure itself was not at hand."  # that text has none
PAPER_DEVIATION = {"y": 5e-3, "z": 10e-3}  # of the centre of mass, Fig. 9 [m]
ELASTIC_LENGTH = 0.6  # of a piston, Table 3 [m]
WIDTH, HEIGHT = 0.1524, 0.0095  # of the single actuator's beam, Table 2 [m]
AWAY = 0.05  # distance from the ends of the quintic at which its jump of jerk no longer shows in the forces [s]
EDGE = 1e-12  # of a number on the edge of its rounding: what arithmetic leaves of it
SIZE = 0.5  # "about 5 mm": from half to one and a half times the printed value counts as that size


@dataclass(frozen=True, kw_only=True)
class Claim:
    """Claim of the paper and where, what we get, the verdict, and its reason, which explains the `expected` one.

    `whose` it is, a key of `WHOSE`: the paper's own, a variant of ours, or what the paper asks for next. It, and
    `where` and `says` unless they hold numbers, are those of the row of the table.
    """

    whose: str = ""
    where: str = ""
    says: str = ""
    ours: str
    verdict: str
    reason: str
    expected: InitVar[str] = ""

    def __post_init__(self, expected: str) -> None:
        if expected and self.verdict != expected:
            object.__setattr__(self, "reason", f"Not explained: these results were expected to give '{expected}'.")


def choose_verdict(
    holds: bool | np.bool_, in_part: bool | np.bool_ = False, best: str = HOLDS, worst: str = NOT
) -> str:
    """Verdict of the first rule that is true of the numbers: `best`, holds in part, or `worst`."""
    return best if holds else IN_PART if in_part else worst


def round_up(value: float, digits: int = 2) -> float:
    """A positive number rounded up to some digits: what another one is at most, or is within."""
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits) if value > 0 else 1.0
    return math.ceil(value / unit * (1 - EDGE)) * unit


def is_similar(ours: float, paper: float) -> bool:
    """Test whether a value is of the size of the paper's: from half to one and a half times as large."""
    return abs(ours / paper - 1) <= SIZE


def printed_deviation(y: float, z: float) -> bool:
    """Test whether largest deviations [m] are both of the size that the paper prints."""
    return is_similar(y, PAPER_DEVIATION["y"]) and is_similar(z, PAPER_DEVIATION["z"])


def size_verdict(*peaks: Sequence[float] | np.ndarray) -> str:
    """Verdict on largest deviations along x, y, z [m] of one or several robots: whether one is of the printed size."""
    return choose_verdict(any(printed_deviation(y, z) for _, y, z in peaks), best=REACHES, worst=MISSES)


def is_unspecified(preset: str, *keys: str) -> bool:
    """Test whether a preset marks one of these values as ours, because the paper does not give it."""
    return not {value.key for value in model.open_values(preset)}.isdisjoint(keys)


def ratio_words(ours: float, paper: float) -> str:
    """Ratio of a value to the paper's as text: how many times smaller or larger it is."""
    if ours <= 0 or paper <= 0:
        return "not comparable"
    return f"{number(paper / ours, 2)} times smaller" if ours < paper else f"{number(ours / paper, 2)} times larger"


def roll_error(arm: float) -> float:
    """Error of the roll [rad] that moves a centre of mass `arm` [m] off the axis by the paper's deviation."""
    return math.hypot(*PAPER_DEVIATION.values()) / arm


def axis_words(values: np.ndarray, digits: int = 3) -> str:
    """Lengths along x, y, z as text."""
    return ", ".join(f"{axis} {text(float(value), 'm', digits)}" for axis, value in zip("xyz", values, strict=True))


def transverse_words(deviation: Sequence[float] | np.ndarray) -> str:
    """Lengths along y and z as text, of those along x, y, z."""
    _, y, z = (text(float(value), "m") for value in deviation)
    return f"y {y}, z {z}"


def largest_deviation(data: Dataset) -> np.ndarray:
    """Largest deviation of the centre of mass along x, y, z [m]."""
    return np.abs(data.com_deviation.values).max(axis=0)


def deviation_words(data: Dataset, digits: int = 3) -> str:
    """Largest deviation of the centre of mass along x, y, z as text."""
    return axis_words(largest_deviation(data), digits)


def residual_vibration(data: Dataset, name: str) -> float:
    """Residual vibration after the motion: largest peak to peak of a variable along one direction [its unit]."""
    rest = data[name].where(data.time >= (motion_end(data) or 0.0), drop=True)
    return float((rest.max("time") - rest.min("time")).max())


def force_gaps(rigid_legs: Dataset) -> tuple[float, float]:
    """Largest difference of our drive forces to Newton-Euler's [N], away from the ends of the roll, and anywhere."""
    gap = np.abs(rigid_legs.actuator_force - rigid_legs.actuator_force_rigid).max("leg")
    end = motion_end(rigid_legs) or np.inf
    near_ends = (rigid_legs.time < AWAY) | (np.abs(rigid_legs.time - end) < AWAY)
    return float(gap.where(~near_ends).max()), float(gap.max())


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
