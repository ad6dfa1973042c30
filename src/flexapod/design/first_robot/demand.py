"""Demands on a first robot that stand in the table [requirement] of its file, and the box of poses among them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexapod.common.errors import InputError
from flexapod.common.units import number_and_unit, quantity
from flexapod.kinematics.envelope import Box
from flexapod.model import AXES

RANGE = ".."  # between the ends of a range
ALIASES = {"tilt": "rotation", "accuracy": "pose_accuracy_calibrated"}
PIVOTS = ("tool", "platform")
MOST_TILT = np.deg2rad(80)  # beyond it joints fold
_BOX = {"travel": "length", "rotation": "angle"} | {axis: "length" if k < 3 else "angle" for k, axis in enumerate(AXES)}
_BOUNDS = {
    "pose_accuracy": "length",
    "pose_accuracy_calibrated": "length",
    "pose_accuracy_corrected": "length",
    "repeatability": "length",
    "minimum_incremental_motion": "length",
    "first_frequency": "frequency",
    "stiffness": "stiffness",
    "velocity": "velocity",
    "angular_velocity": "angular rate",
    "acceleration": "acceleration",
    "settling_time": "time",
    "settling_band": "length",
    "force_margin": "number",
    "buckling_factor": "number",
    "stress_factor": "number",
    "life": "time",
    "clearance": "length",
    "singularity": "number",
}
DEMANDS = (*_BOX, "alone", "pivot", *_BOUNDS)
"""Keys of a demand, but for `ALIASES`."""


@dataclass(frozen=True, kw_only=True)
class Demand:
    """Demands as the table says them, and as numbers.

    `ranges`: ends (low, high) [m, rad] of axes of the box, none without one; `pivot`: "tool" or "platform"; `alone`:
    each axis with the others at home; `lines`: of the table [requirement].
    """

    ranges: Mapping[str, tuple[float, float]]
    pivot: str
    alone: bool
    lines: tuple[str, ...]

    def box(self, tool: float) -> Box:
        """Box about a tool at a height above the platform [m], or about the platform."""
        place = (0.0, 0.0, tool if self.pivot == "tool" else 0.0)
        return Box.from_ranges(self.ranges, pivot=place, alone=self.alone)


def parse_demand(given: Mapping[str, str], option: str) -> Demand | None:
    """Demand of what was typed, by key; None without any of its keys.

    Raises
    ------
    InputError
        A key that is given by two names, a value that is no such quantity, a range without home.
    """
    asked: dict[str, str] = {}
    typed = {}
    for key, value in given.items():
        name = ALIASES.get(key, key)
        if name in asked:
            raise InputError("is given twice", key=f"{option} {key}", next_step=f"It is another name of {name}")
        if name in DEMANDS:
            asked[name], typed[name] = value, f"{option} {key}"
    if not asked:
        return None
    ranges = {key: _ends(_BOX[key], asked[key], typed[key]) for key in _BOX if key in asked}
    for key in _BOUNDS:
        if key in asked:
            _check_positive(key, asked[key], typed[key])
    alone, pivot = (
        _choice(asked.get(key, allowed[0]), allowed, f"{option} {key}")
        for key, allowed in (("alone", ("false", "true")), ("pivot", PIVOTS))
    )
    return Demand(ranges=_by_axis(ranges), pivot=pivot, alone=alone == "true", lines=_table(asked, given))


def _ends(dimension: str, value: str, key: str) -> tuple[float, float]:
    """Ends of a range: one number is on either side."""
    parts = [part.strip() for part in value.split(RANGE)]
    units = [read[1] for part in parts if (read := number_and_unit(part)) is not None and float(read[0])]
    if any(units) and not all(units):
        raise InputError(
            "has a unit at one end alone", key=key, value=value, allowed="a unit at both ends, or SI numbers",
            next_step="For example -5 mm..15 mm",
        )  # fmt: skip
    ends = [quantity(part, dimension, key=key) for part in parts]
    low, high = (-ends[0], ends[0]) if len(ends) == 1 else (ends[0], ends[-1])
    if len(ends) > 2 or not low <= 0 <= high or low == high:
        raise InputError(
            "is not a range about home", key=key, value=value,
            allowed="one value above 0 on either side, or a low end of at most 0 .. a high end of at least 0",
            next_step="For example " + ("-5 mm..15 mm" if dimension == "length" else "-2 deg..3 deg"),
        )  # fmt: skip
    if dimension == "angle" and max(-low, high) > MOST_TILT:
        raise InputError("turns too far", key=key, value=value, allowed="at most 80 deg on either side")
    return low, high


def _by_axis(ranges: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    found = {}
    for k, axis in enumerate(AXES):
        ends = ranges.get(axis, ranges.get("travel" if k < 3 else "rotation"))
        if ends is not None:
            found[axis] = ends
    return found


def _check_positive(name: str, value: str, key: str) -> None:
    if quantity(value, _BOUNDS[name], key=key) <= 0 and name != "clearance":
        raise InputError("is out of range", key=key, value=value, allowed="above 0")


def _choice(value: str, allowed: tuple[str, ...], key: str) -> str:
    if value not in allowed:
        raise InputError("is not known", key=key, value=value, allowed=", ".join(allowed))
    return value


def _table(asked: Mapping[str, str], given: Mapping[str, str]) -> tuple[str, ...]:
    """Lines of the table [requirement], in the order of its keys."""
    lines = ["[requirement]"]
    for key, axes in (("travel", AXES[:3]), ("rotation", AXES[3:])):
        each = {"each": asked[key]} if key in asked else {}
        parts = {**each, **{axis: asked[axis] for axis in axes if axis in asked}}
        if list(parts) == ["each"]:
            lines.append(f"{key} = {_value(asked[key])}")
        elif parts:
            lines.append(f"{key} = {{ {', '.join(f'{name} = {_value(value)}' for name, value in parts.items())} }}")
    if asked.get("alone") == "true":
        lines.append("alone = true")
    if "pivot" in asked:
        lines.append(f'pivot = "{asked["pivot"]}"')
    if "payload" in given:
        lines.append(f"payload = {_value(given['payload'])}")
    return (*lines, *(f"{key} = {_value(asked[key])}" for key in _BOUNDS if key in asked))


def _value(text: str) -> str:
    """A quantity, or the ends of a range, as a value of a study file, which wants numbers without a unit as numbers."""
    parts = []
    for part in text.split(RANGE):
        read = number_and_unit(part.strip())
        parts.append(f"{float(read[0]):.15g}" if read is not None and not read[1] else f'"{part.strip()}"')
    return parts[0] if len(parts) == 1 else f"[{', '.join(parts)}]"
