"""Motions of the platform: one axis, several axes, waypoints, table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text
from flexapod.common.tables.base import FileKey, Key, Quantity, Series, Series6, Vec3
from flexapod.common.tables.csv_tables import POSE, stack_columns, wrong_instant
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table
from flexapod.common.units import DIMENSIONS, quantities

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

Axis = Literal["surge", "sway", "heave", "roll", "pitch", "yaw"]
Profile = Literal["quintic", "cycloidal", "s-curve", "trapezoid", "smooth", "linear"]
AXES: tuple[Axis, ...] = get_args(Axis)
PROFILES: tuple[Profile, ...] = get_args(Profile)
_ORIGIN = (0.0, 0.0, 0.0)


def _poses_in_si(given: Mapping[Any, Any], key: str) -> dict[Any, Any]:
    """Coordinates by axis with texts as SI numbers."""
    return {axis: quantities(x, POSE[axis], key=key) if axis in POSE else x for axis, x in given.items()}


def _distinct(axes: tuple[str, ...]) -> tuple[str, ...]:
    if not axes or len({*axes}) < len(axes):
        raise ValueError("must name each axis once, and one at least")
    return axes


#: Coordinates that are commanded where a robot has fewer than six motions; the others follow.
Independent = Annotated[
    Annotated[tuple[Axis, ...], AfterValidator(_distinct)] | None,
    Key("axes that are commanded, of a robot with fewer than six motions", usual="all that the robot has"),
]
Pivot = Annotated[Vec3, Quantity("length", why="point that turns are about, in the platform frame")]
Hold = Annotated[float, Quantity("time", least=0, why="rest after it")]


class AxisMotion(Table):
    """Motion from home to `amplitude` [m or rad] along or about one world axis, in `duration` [s], then `hold` [s].

    Turns are about `pivot` (3,) [m], a point given in the platform frame.
    """

    placed: ClassVar[tuple[str, ...]] = ("pivot",)
    type: Annotated[Axis, Key("kind of motion: an axis, several, points, a table")]
    amplitude: Annotated[
        float,
        Quantity(
            "length",
            "angle",
            why="pose reached, in m for surge, sway, heave and in rad for roll, pitch, yaw (up to half a turn)",
        ),
    ]
    duration: Annotated[float, Quantity("time", above=0, why="time to get there")]
    hold: Hold = 0.0
    profile: Annotated[Profile, Key("law of the way over time")] = "quintic"
    pivot: Pivot = Field(default=_ORIGIN, validate_default=True)
    independent: Independent = None

    @classmethod
    def measuring(cls, section: Section, among: tuple[str, ...]) -> tuple[str, ...]:
        """Lengths along an axis, angles about one."""
        return (POSE[str(section.text("type"))],)

    @model_validator(mode="before")
    @classmethod
    def _in_si(cls, given: dict[str, Any]) -> dict[str, Any]:
        axis = given.get("type")
        if "amplitude" not in given or not isinstance(axis, str):
            return given
        return {**given, "amplitude": _poses_in_si({axis: given["amplitude"]}, "amplitude")[axis]}

    def _shown(self) -> dict[str, str]:
        return _in_words(self.target, self.duration, self.hold, self.profile)

    @model_validator(mode="after")
    def _angle(self) -> AxisMotion:
        _check_pose({self.type: self.amplitude}, "amplitude")
        return self

    @property
    def target(self) -> Array:
        """Pose reached: surge, sway, heave [m], roll, pitch, yaw [rad] relative to home, (6,)."""
        return _pose({self.type: self.amplitude})

    @property
    def end_time(self) -> float:
        """End of the motion with its hold [s]."""
        return self.duration + self.hold

    @property
    def rate_jumps(self) -> tuple[float, ...]:
        """Instants after t = 0 at which the command's rate jumps [s]."""
        return (self.duration,) if self.profile == "linear" else ()


class CombinedMotion(Table):
    """Several axes at once with one profile: `amplitudes` by axis name [m or rad]."""

    placed: ClassVar[tuple[str, ...]] = ("pivot",)
    type: Annotated[Literal["combined"], Key("kind of motion: an axis, several, points, a table")] = "combined"
    amplitudes: Annotated[
        dict[Axis, Annotated[float, Quantity("length", "angle")]], Key("table: poses reached, by axis")
    ]
    duration: Annotated[float, Quantity("time", above=0, why="time to get there")]
    hold: Hold = 0.0
    profile: Annotated[Profile, Key("law of the way over time")] = "quintic"
    pivot: Pivot = Field(default=_ORIGIN, validate_default=True)
    independent: Independent = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Amplitudes by axis."""
        inner = section.section("amplitudes")
        if inner is None:
            return {}
        inner.check_keys(*AXES)
        return {"amplitudes": {axis: inner.number(axis, POSE[axis]) for axis in AXES if axis in inner}}

    def _shown(self) -> dict[str, str]:
        return _in_words(self.target, self.duration, self.hold, self.profile)

    @model_validator(mode="before")
    @classmethod
    def _in_si(cls, given: dict[str, Any]) -> dict[str, Any]:
        named = given.get("amplitudes")
        return {**given, "amplitudes": _poses_in_si(named, "amplitudes")} if isinstance(named, Mapping) else given

    @model_validator(mode="after")
    def _angles(self) -> CombinedMotion:
        if not self.amplitudes:
            raise InputError("names no axis", key="amplitudes", allowed=", ".join(AXES))
        _check_pose(dict(self.amplitudes), "amplitudes")
        return self

    @property
    def target(self) -> Array:
        """Pose reached: surge, sway, heave [m], roll, pitch, yaw [rad] relative to home, (6,)."""
        return _pose(dict(self.amplitudes))

    @property
    def end_time(self) -> float:
        """End of the motion with its hold [s]."""
        return self.duration + self.hold

    @property
    def rate_jumps(self) -> tuple[float, ...]:
        """Instants after t = 0 at which the command's rate jumps [s]."""
        return (self.duration,) if self.profile == "linear" else ()


class Waypoint(Table):
    """A pose relative to home at `time` [s]: surge, sway, heave [m], roll, pitch, yaw [rad]."""

    time: Annotated[float, Quantity("time", least=0, why="instant, above that of the point before")]
    surge: Annotated[float, Quantity("length", why="along x")] = 0.0
    sway: Annotated[float, Quantity("length", why="along y")] = 0.0
    heave: Annotated[float, Quantity("length", why="along z")] = 0.0
    roll: Annotated[float, Quantity("angle", why="about x")] = 0.0
    pitch: Annotated[float, Quantity("angle", why="about y")] = 0.0
    yaw: Annotated[float, Quantity("angle", why="about z")] = 0.0

    @model_validator(mode="after")
    def _angles(self) -> Waypoint:
        for axis in AXES:
            _check_pose({axis: getattr(self, axis)}, axis)
        return self

    @property
    def pose(self) -> Array:
        """Surge, sway, heave [m], roll, pitch, yaw [rad] relative to home, (6,)."""
        return np.array([getattr(self, axis) for axis in AXES])


class WaypointMotion(Table):
    """Motion from point to point, at rest at each; from home at t = 0 if the first point is later."""

    placed: ClassVar[tuple[str, ...]] = ("pivot",)
    type: Annotated[Literal["waypoints"], Key("kind of motion: an axis, several, points, a table")] = "waypoints"
    points: Annotated[tuple[Waypoint, ...], Key("list of tables: the poses")]
    hold: Hold = 0.0
    profile: Annotated[Profile, Key("law of the way over time")] = "quintic"
    pivot: Pivot = Field(default=_ORIGIN, validate_default=True)
    independent: Independent = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Points of the motion."""
        value = section.data.get("points")
        if value is not None and (not isinstance(value, list) or not value):
            raise section.error("is not a list of points", "points", allowed="[{ time = .., roll = .. }, ...]")
        points = (section.child(item, f"points[{i}]") for i, item in enumerate(value or (), start=1))
        return {} if value is None else {"points": tuple(point.read(Waypoint) for point in points)}

    def _shown(self) -> dict[str, str]:
        return {"to": f"{len(self.points)} points", "in": f"{number(self.end_time, 4)} s", "profile": self.profile}

    @model_validator(mode="after")
    def _in_order(self) -> WaypointMotion:
        if len(self.times) < 2:
            raise InputError("has no point after t = 0", key="points", next_step="Add a point with a later time")
        for i, (before, after) in enumerate(zip(self.points, self.points[1:], strict=False), start=2):
            if after.time <= before.time:
                raise InputError(
                    "is not later than the point before it",
                    key=f"points[{i}].time",
                    value=after.time,
                    allowed=f"above {before.time:g} s",
                )
        return self

    @property
    def times(self) -> Array:
        """Instants of the points, starting at 0, (n,) [s]."""
        later = [point.time for point in self.points]
        return np.array(later if later and later[0] == 0 else [0.0, *later])

    @property
    def poses(self) -> Array:
        """Poses at `times`, (n, 6): surge, sway, heave [m], roll, pitch, yaw [rad] relative to home."""
        given = [point.pose for point in self.points]
        return np.array(given if self.points[0].time == 0 else [np.zeros(6), *given])

    @property
    def end_time(self) -> float:
        """End of the motion with its hold [s]."""
        return self.points[-1].time + self.hold

    @property
    def rate_jumps(self) -> tuple[float, ...]:
        """Instants after t = 0 at which the command's rate jumps [s]."""
        return tuple(self.times[1:].tolist()) if self.profile == "linear" else ()


class CsvMotion(Table):
    """A table of poses: `time` (n,) [s], from 0, and `pose` (n, 6) relative to home, read from `file`.

    Columns of `pose`: surge, sway, heave [m], roll, pitch, yaw [rad].
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "pose")
    placed: ClassVar[tuple[str, ...]] = ("pivot",)
    type: Annotated[Literal["csv"], Key("kind of motion: an axis, several, points, a table")] = "csv"
    file: Annotated[str | None, FileKey("CSV file of the poses")] = None
    time: Annotated[Series, Quantity("time")]
    pose: Annotated[Series6, Quantity("length", "angle")]
    hold: Hold = 0.0
    pivot: Pivot = Field(default=_ORIGIN, validate_default=True)
    independent: Independent = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Columns of its table."""
        table = section.table(POSE)
        return {"time": table["time"], "pose": stack_columns(table, AXES)}

    def file_content(self, place: Place) -> Content:
        """Poses over time."""
        return columns_of_table(POSE, self.time, self.pose)

    def _shown(self) -> dict[str, str]:
        return {"table": f"{self.file or 'given'}, {len(self.time)} rows", "in": f"{number(self.end_time, 4)} s"}

    @model_validator(mode="after")
    def _table(self) -> CsvMotion:
        check_times(self.time, len(self.pose))
        return self

    @property
    def end_time(self) -> float:
        """End of the table with its hold [s]."""
        return float(self.time[-1]) + self.hold

    @property
    def rate_jumps(self) -> tuple[float, ...]:
        """A table is followed smoothly: no jumps."""
        return ()


Motion = Annotated[AxisMotion | CombinedMotion | WaypointMotion | CsvMotion, Field(discriminator="type")]


def moved_axes(motion: Motion) -> tuple[Axis, ...]:
    """Axes along or about which a motion leads away from home."""
    if isinstance(motion, WaypointMotion):
        poses = motion.poses
    else:
        poses = motion.pose if isinstance(motion, CsvMotion) else motion.target
    columns = np.atleast_2d(poses).T
    return tuple(axis for axis, column in zip(AXES, columns, strict=True) if column.any())


def check_times(time: Array, rows: int, *, key: str = "time", jumps: bool = False) -> None:
    """Refuse a time column that does not start at 0, does not increase, or has another length than the data.

    With `jumps` two rows may stand at one instant: before and after a jump.
    """
    if len(time) != rows:
        raise InputError(f"has {len(time)} instants for {rows} rows of values", key=key)
    if len(time) < 2:
        raise InputError("has fewer than two rows", key=key, next_step="A table needs two instants at least")
    if time[0] != 0:
        raise InputError("does not start at 0", key=key, value=float(time[0]), next_step="Subtract the first instant")
    row = wrong_instant(time, jumps)
    if row is not None:
        raise InputError(
            f"does not increase at row {row + 1}",
            key=key,
            value=float(time[row]),
            allowed=f"at least {DIMENSIONS['time'].least:g} s above {time[row - 1]:g} s",
        )


def _in_words(target: Array, duration: float, hold: float, profile: str) -> dict[str, str]:
    """Words that a motion from home to `target` (6,) [m, rad] shows."""
    units = ("m",) * 3 + ("rad",) * 3
    parts = [f"{axis} {text(v, unit, 4)}" for axis, v, unit in zip(AXES, target, units, strict=True) if v]
    rest = {"hold": f"{number(hold, 4)} s"} if hold else {}
    return {"to": " and ".join(parts) or "home", "in": f"{number(duration, 4)} s", **rest, "profile": profile}


def _pose(amplitudes: dict[Axis, float]) -> Array:
    return np.array([amplitudes.get(axis, 0.0) for axis in AXES])


def _check_pose(amplitudes: dict[Axis, float], key: str) -> None:
    for axis, value in amplitudes.items():
        if axis in ("roll", "pitch", "yaw") and abs(value) > math.pi:
            raise InputError(
                f"turns the platform ({axis}) by more than half a turn",
                key=key,
                value=value,
                allowed="between -pi and pi rad",
                next_step='A number without a unit is in rad; write degrees as "26.6 deg"',
            )
