"""Requirements on a robot: a box of poses, loads, and what the tool must keep there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import BeforeValidator, Field, PlainSerializer, PlainValidator, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity, Vec3, array_of
from flexapod.common.tables.table import Table
from flexapod.model.motion import AXES

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section
    from flexapod.model.study.robot import Robot

TOOL, PLATFORM = "tool", "platform"
BAND = 1e-6  # of settling [m]
_TWO = array_of((2,))


def _plus_minus(value: object) -> Array:
    """Low and high end; of one number the same on either side."""
    return _TWO([-value, value] if _is_number(value) else value)  # type: ignore[operator]


def _low_high(value: object) -> Array:
    """Least and largest; one number is both."""
    return _TWO([value, value] if _is_number(value) else value)


def _place(value: object) -> Array | str:
    if isinstance(value, str):
        if value not in (TOOL, PLATFORM):
            raise InputError("is not known", key="pivot", value=value, allowed="tool, platform, or a point")
        return value
    return array_of((3,))(value)


for _converter, _count in ((_plus_minus, 2), (_low_high, 2), (_place, 3)):
    _converter.shape = (_count,)  # type: ignore[attr-defined]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _as_list(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


Ends = Annotated[Array, PlainValidator(_plus_minus), PlainSerializer(_as_list)]
LowHigh = Annotated[Array, PlainValidator(_low_high), PlainSerializer(_as_list)]
PivotPlace = Annotated[Array | str, PlainValidator(_place), PlainSerializer(_as_list)]


def _range(dimension: str, why: str, usual: str) -> Quantity:
    return Quantity(dimension, why=f"{why}: on either side of home, or [low, high]", usual=usual, short="number")


class Ranges(Table):
    """Ranges by axis about home; `each`: of all axes of the robot that are not named."""

    dimension: ClassVar[str] = "length"

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Ends as two numbers, or one number on either side."""
        return {name: _one_or_two(section, name, cls.dimension) for name in cls.model_fields}

    @model_validator(mode="after")
    def _about_home(self) -> Ranges:
        given = {name: getattr(self, name) for name in type(self).model_fields}
        given = {name: ends for name, ends in given.items() if ends is not None}
        if not given:
            raise InputError("names no range", key="each", allowed=", ".join(type(self).model_fields))
        for name, (low, high) in given.items():
            if low > high:
                raise InputError(
                    "begins where it should end", key=name, value=[low, high], allowed="the lower end first"
                )
            if low == high:
                raise InputError("has no width", key=name, value=[low, high], allowed="ends on either side of home")
            if low > 0 or high < 0:
                raise InputError(
                    "does not hold home",
                    key=name,
                    value=[low, high],
                    allowed="a range about home: a low end of at most 0, a high end of at least 0",
                    next_step="Ranges count from home: move robot.home into the middle of the box",
                )
        return self

    def ends(self, axis: str) -> Array | None:
        """Low and high end of an axis, (2,); None where no range is given."""
        found = getattr(self, axis, None)
        return self.each if found is None else found  # type: ignore[attr-defined]


class TravelRanges(Ranges):
    """Ranges of travel along world axes [m]."""

    each: Annotated[Ends | None, _range("length", "along each axis that is not named", "none")] = None
    surge: Annotated[Ends | None, _range("length", "along x", "as each")] = None
    sway: Annotated[Ends | None, _range("length", "along y", "as each")] = None
    heave: Annotated[Ends | None, _range("length", "along z", "as each")] = None


class RotationRanges(Ranges):
    """Ranges of turns [rad]: roll, pitch, yaw about world x, y, z."""

    dimension: ClassVar[str] = "angle"

    each: Annotated[Ends | None, _range("angle", "about each axis that is not named", "none")] = None
    roll: Annotated[Ends | None, _range("angle", "about x", "as each")] = None
    pitch: Annotated[Ends | None, _range("angle", "about y", "as each")] = None
    yaw: Annotated[Ends | None, _range("angle", "about z", "as each")] = None

    @model_validator(mode="after")
    def _below_half_a_turn(self) -> RotationRanges:
        for name in type(self).model_fields:
            ends, most = getattr(self, name), math.pi / 2 if name == "pitch" else math.pi
            if ends is not None and np.abs(ends).max() >= most:
                words = f"below {math.degrees(most):g} deg on either side"
                raise InputError("turns too far", key=name, value=ends.tolist(), allowed=words)
        return self


class LeastStiffness(Table):
    """Least stiffness at the tool: `each` in whichever direction, against a force; others along and about an axis."""

    each: Annotated[float | None, Quantity("stiffness", above=0, why="in its weakest direction", usual="none")] = None
    surge: Annotated[float | None, Quantity("stiffness", above=0, why="along x", usual="none")] = None
    sway: Annotated[float | None, Quantity("stiffness", above=0, why="along y", usual="none")] = None
    heave: Annotated[float | None, Quantity("stiffness", above=0, why="along z", usual="none")] = None
    roll: Annotated[float | None, Quantity("rotational stiffness", above=0, why="about x", usual="none")] = None
    pitch: Annotated[float | None, Quantity("rotational stiffness", above=0, why="about y", usual="none")] = None
    yaw: Annotated[float | None, Quantity("rotational stiffness", above=0, why="about z", usual="none")] = None

    @model_validator(mode="after")
    def _some(self) -> LeastStiffness:
        if not self.by_axis:
            raise InputError("names no stiffness", key="each", allowed=", ".join(type(self).model_fields))
        return self

    @property
    def by_axis(self) -> dict[str, float]:
        """Bounds that are given, by name."""
        found = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in found.items() if value is not None}


def _for_each(value: Any) -> Any:
    """A number, or a pair of them, holds for each axis."""
    return {"each": value} if _is_number(value) or isinstance(value, list | tuple | np.ndarray | str) else value


def _length(why: str) -> Quantity:
    return Quantity("length", above=0, why=why, usual="not asked")


class Requirement(Table):
    """Requirement on the tool, all of it optional; errors with the coverage of the error budget.

    `travel`, `rotation`: a box about home, all axes at once, or with `alone` each with the others at home, turns about
    `pivot`. `payload` (2,) [kg]: least and most, its inertia in proportion, its centre of mass at `payload_com`. The
    others are bounds: at most of errors and `settling_time`, at least of all else.
    """

    placed: ClassVar[tuple[str, ...]] = ("payload_com", "pivot")
    silent: ClassVar[tuple[str, ...]] = ("settling_band", "alone")

    travel: Annotated[
        TravelRanges | None,
        BeforeValidator(_for_each),
        Key("on either side of home along each axis, [low, high], or a table by axis", usual="none", short="number"),
    ] = None
    rotation: Annotated[
        RotationRanges | None,
        BeforeValidator(_for_each),
        Key("about each axis, together with travel one box; as travel", usual="none", short="number"),
    ] = None
    alone: Annotated[bool, Key("each axis of the box with the others at home, not all at once")] = False
    pivot: Annotated[
        PivotPlace,
        Quantity("length", why="what turns of the box are about: tool, platform, or a point in its frame",
                 usual="the tool", short="text"),
    ] = Field(default=TOOL, validate_default=True)  # fmt: skip
    payload: Annotated[
        LowHigh | None,
        Quantity(
            "mass", why="least and most that it carries, the platform included; inertia in proportion",
            usual="that of payload", short="number",
        ),
    ] = None  # fmt: skip
    payload_com: Annotated[
        Vec3 | None, Quantity("length", why="centre of mass of these payloads", usual="that of payload")
    ] = None
    pose_accuracy: Annotated[float | None, _length("AP of ISO 9283, uncalibrated")] = None
    pose_accuracy_calibrated: Annotated[float | None, _length("AP with what is constant in a machine taken out")] = None
    pose_accuracy_corrected: Annotated[
        float | None, _length("AP calibrated, sag under the nominal payload taken out by the controller")
    ] = None
    repeatability: Annotated[float | None, _length("of both directions, ISO 230-2")] = None
    minimum_incremental_motion: Annotated[float | None, _length("smallest step that surely shows after a reversal")] = (
        None
    )
    first_frequency: Annotated[
        float | None, Quantity("frequency", above=0, why="least natural frequency, drives held", usual="not asked")
    ] = None
    stiffness: Annotated[
        LeastStiffness | None,
        BeforeValidator(_for_each),
        Key("least at the tool, in its weakest direction, or a table by axis", usual="not asked", short="number"),
    ] = None
    velocity: Annotated[
        float | None, Quantity("velocity", above=0, why="of the tool in any direction", usual="not asked")
    ] = None
    angular_velocity: Annotated[
        float | None, Quantity("angular rate", above=0, why="about the tool and any axis", usual="not asked")
    ] = None
    acceleration: Annotated[
        float | None, Quantity("acceleration", above=0, why="from rest, in any direction", usual="not asked")
    ] = None
    settling_time: Annotated[
        float | None, Quantity("time", above=0, why="after the motion, drives held (ISO 9283)", usual="not asked")
    ] = None
    settling_band: Annotated[float, Quantity("length", above=0, why="amplitude at which it counts as settled")] = BAND
    force_margin: Annotated[
        float | None, Quantity("number", above=0, why="limits of the drives over what they need", usual="not asked")
    ] = None
    buckling_factor: Annotated[
        float | None, Quantity("number", above=0, why="Euler load over thrust", usual="not asked")
    ] = None
    stress_factor: Annotated[
        float | None, Quantity("number", above=0, why="yield stress over stress", usual="not asked")
    ] = None
    life: Annotated[
        float | None, Quantity("time", above=0, why="of the screws, the motion repeated: 20000 h", usual="not asked")
    ] = None
    clearance: Annotated[
        float | None, Quantity("length", least=0, why="least distance between two legs", usual="not asked")
    ] = None
    singularity: Annotated[
        float | None,
        Quantity("number", above=0, most=1, why="least singular value, 0.1 as a rule", usual="not asked"),
    ] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Boxes, stiffness, payload and pivot, each in several ways."""
        pivot = section.data.get("pivot")
        return {
            "travel": _ranges(section, "travel", TravelRanges),
            "rotation": _ranges(section, "rotation", RotationRanges),
            "stiffness": _stiffness(section),
            "payload": _one_or_two(section, "payload", "mass"),
            "pivot": section.text("pivot", (TOOL, PLATFORM))
            if isinstance(pivot, str)
            else section.vector("pivot", *("length",) * 3),
        }

    @model_validator(mode="after")
    def _sensible(self) -> Requirement:
        if self.payload is not None:
            low, high = self.payload.tolist()
            if low <= 0:
                raise InputError("is out of range", key="payload", value=low, allowed="masses above 0 kg")
            if low > high:
                raise InputError(
                    "begins where it should end", key="payload", value=[low, high], allowed="the least first"
                )
        if not self.names:
            raise InputError(
                "requires nothing", key="pose_accuracy_calibrated", allowed=", ".join((*BOX, *BOUNDS)),
                next_step='For example travel = "15 mm" and pose_accuracy_calibrated = "10 um"',
            )  # fmt: skip
        for name, of, there in (
            ("alone", "travel or rotation", self.has_box), ("pivot", "rotation", self.rotation is not None),
            ("settling_band", "settling_time", self.settling_time is not None),
        ):  # fmt: skip
            value = _as_list(getattr(self, name))
            if not there and value not in (False, TOOL, BAND):
                raise InputError(
                    f"has no effect without {of}", key=name, value=value, next_step=f"Give {of}, or leave {name} out"
                )
        return self

    @property
    def has_box(self) -> bool:
        """Test whether there is a box of poses."""
        return self.travel is not None or self.rotation is not None

    @property
    def names(self) -> tuple[str, ...]:
        """Keys that are judged."""
        return tuple(name for name in (*BOX, *BOUNDS) if getattr(self, name) is not None)

    def ends(self, axis: str) -> Array | None:
        """Low and high end of an axis, surge to yaw, (2,) [m, rad]; None where it is not asked."""
        ranges = self.travel if axis in AXES[:3] else self.rotation
        return None if ranges is None else ranges.ends(axis)

    def check(self, robot: Robot) -> None:
        """Raise InputError if a robot has not what is asked of it.

        Raises
        ------
        InputError
            The platform is fixed.
        """
        if robot.platform_fixed:
            raise InputError(
                "is asked of a platform that is fixed: its tool does not move", key="requirement",
                allowed="a platform that the legs carry", next_step="Leave [requirement] out",
            )  # fmt: skip


BOX = ("travel", "rotation")
#: Keys that bound a quantity, in the order in which they are judged.
BOUNDS = (
    "pose_accuracy", "pose_accuracy_calibrated", "pose_accuracy_corrected", "repeatability",
    "minimum_incremental_motion", "first_frequency", "stiffness", "velocity", "angular_velocity", "acceleration",
    "settling_time", "force_margin", "buckling_factor", "stress_factor", "life", "clearance", "singularity",
)  # fmt: skip


def _one_or_two(section: Section, name: str, dimension: str) -> object:
    """A number, or two in a row."""
    if isinstance(section.data.get(name), list):
        return section.vector(name, dimension, dimension)
    return section.number(name, dimension)


def _ranges(section: Section, name: str, model: type[Ranges]) -> object:
    """A table by axis, or one range for each."""
    if isinstance(section.data.get(name), Mapping):
        return section.child(section.data[name], name).read(model)
    found = _one_or_two(section, name, model.dimension)
    if _is_number(found) and found < 0:  # type: ignore[operator]
        raise section.error("is below 0", name, allowed="a size on either side of home, or [low, high]")
    try:
        return None if found is None else model(**{"each": found})
    except InputError as error:
        raise section.error(error.what, name, allowed=error.allowed, next_step=error.next_step) from None


def _stiffness(section: Section) -> object:
    """A table by axis, or one number for the weakest direction."""
    if isinstance(section.data.get("stiffness"), Mapping):
        return section.child(section.data["stiffness"], "stiffness").read(LeastStiffness)
    found = section.number("stiffness", "stiffness")
    try:
        return None if found is None else LeastStiffness(each=found)
    except InputError as error:
        raise section.error(error.what, "stiffness", allowed=error.allowed) from None
