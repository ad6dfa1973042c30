"""Grids of poses: one to three of surge ... yaw vary, the others are fixed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics, model
from flexapod.analysis.checks.reachability import REACHED, rigid_codes
from flexapod.analysis.results.arguments import coordinate, pose_from_text
from flexapod.analysis.results.poses import poses_about_home
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError, check_known
from flexapod.common.units import quantities
from flexapod.model import AXES

COUNT = {1: 201, 2: 41, 3: 21}  # points of an axis by number of axes, where none are given
SLICES = 5  # of the third axis
LARGEST = 2_000_000  # poses: some ten minutes and a gigabyte
UNITS = {name: "m" if name in AXES[:3] else "rad" for name in AXES}
FARTHEST = {"m": 5.0, "rad": np.pi}  # how far `reach_from_home` looks, in shares of the home height and in rad
STEPS = 400
USUAL = ("surge", "heave", "sway", "roll", "pitch", "yaw")  # the first ones that a robot can do


@dataclass(frozen=True, kw_only=True)
class Range:
    """Part of an axis: ends [m, rad], both None for the whole reach; number of points, None for `COUNT`."""

    low: float | None = None
    high: float | None = None
    count: int | None = None


Axes = Mapping[str, ArrayLike | Range | None]


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Values of the varying coordinates by name, in the order of the axes, and the fixed coordinates ``at`` (6,)."""

    values: dict[str, Array]
    at: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along each axis."""
        return tuple(len(values) for values in self.values.values())

    @property
    def size(self) -> int:
        """Number of poses."""
        return int(np.prod(self.shape))

    def coordinates(self) -> Array:
        """Surge ... yaw of all poses, (P, 6), the last axis fastest."""
        table = np.tile(self.at, (self.size, 1))
        for name, column in zip(self.values, np.meshgrid(*self.values.values(), indexing="ij"), strict=True):
            table[:, AXES.index(name)] = column.ravel()
        return table


def build_grid(robot: model.Robot, axes: Axes | None, at: Mapping[str, float | str] | str | None) -> Grid:
    """A grid from what a user gives.

    Parameters
    ----------
    robot : Robot
    axes : mapping, optional
        Names of one to three of surge, sway, heave, roll, pitch, yaw with ascending values [m, rad], a `Range`, or None
        for as far as the robot reaches; default: `usual_axes`.
    at : mapping, optional
        Fixed coordinates by name, or in words as poses are; the others are those of home.

    Raises
    ------
    InputError
        Something else than names with values, unknown or too many names, no points, values that do not ascend, a
        coordinate both fixed and varying, or more than two million poses.
    """
    if robot.platform_fixed:
        raise InputError(
            "holds the platform where it is: there is nothing to map",
            key="robot.platform.fixed",
            value=True,
            next_step="Use `flexapod modes`, or `flexapod check`",
        )
    axes = dict.fromkeys(usual_axes(robot)) if axes is None else axes
    at = {} if at is None else (pose_from_text(at, "at") or {}) if isinstance(at, str) else at
    _check_names(axes, "axes", 'axes = {"surge": [-0.1, 0.0, 0.1], "heave": None}')
    _check_names(at, "at", 'at = {"roll": 0.1}')
    fixed = _fixed(at, axes)
    if not 1 <= len(axes) <= 3:
        raise InputError("has the wrong number of axes", key="axes", value=len(axes), allowed="1 to 3 axes")
    values = {}
    for place, (name, given) in enumerate(axes.items()):
        values[name] = _values(robot, name, given, fixed, slices=place == 2, axes=len(axes))
    size = int(np.prod([len(v) for v in values.values()], dtype=float))
    if size > LARGEST:
        raise InputError("are too many poses", key="axes", value=size, allowed=f"at most {LARGEST} poses")
    return Grid(values=values, at=fixed)


def usual_axes(robot: model.Robot) -> list[str]:
    """Coordinates that a map varies by default: surge and heave, or the first two that the robot can do."""
    limbs = kinematics.rigid_limbs(robot)
    free = kinematics.independent_axes(limbs, np.zeros(6, dtype=bool), np.zeros(3)) if limbs.guides else ~limbs.hub_held
    return [name for name in USUAL if free[AXES.index(name)]][:2]


def _fixed(at: Mapping[str, float | str], axes: Axes) -> Array:
    fixed = np.zeros(6)
    for name, value in at.items():
        if name in axes:
            raise InputError("varies in this map: it cannot be fixed, too", key=f"at.{name}", value=value)
        try:
            number = float(coordinate(name, value, f"at.{name}") if isinstance(value, str) else value)
        except (TypeError, ValueError, OverflowError):
            number = np.nan
        if not np.isfinite(number):
            raise InputError("is not a number", key=f"at.{name}", value=value, allowed=f"a number in {UNITS[name]}")
        fixed[AXES.index(name)] = number
    return fixed


def _check_names(given: object, key: str, example: str) -> None:
    if not isinstance(given, Mapping):
        raise InputError(
            "is not a set of coordinates by name", key=key, value=given, next_step=f"For example {example}"
        )
    for name in given:
        check_known(name, AXES, key, "is not a coordinate")


def _values(
    robot: model.Robot, name: str, given: ArrayLike | Range | None, fixed: Array, *, slices: bool, axes: int
) -> Array:
    if not (given is None or isinstance(given, Range)):
        return _given_values(name, given)
    wanted = given or Range()
    count = (SLICES if slices else COUNT[axes]) if wanted.count is None else wanted.count
    if count < 1:
        raise InputError("is not a number of points", key=f"axes.{name}", value=count, allowed="1 or more")
    low, high = (None if end is None else coordinate(name, end, f"axes.{name}") for end in (wanted.low, wanted.high))
    if low is None or high is None:
        return _as_far_as_reached(reach_from_home(robot, name, fixed), count, slices=slices)
    if high < low or (high == low and count > 1):
        raise InputError(
            "begins where it should end",
            key=f"axes.{name}",
            value=f"{low:g} to {high:g}",
            allowed="the lower end first",
        )
    return np.linspace(low, high, count)


def _given_values(name: str, given: ArrayLike) -> Array:
    given = quantities(given, "length" if UNITS[name] == "m" else "angle", key=f"axes.{name}")
    try:
        values = np.atleast_1d(floats(given))
    except ValueError:
        values = np.zeros(0)
    if values.ndim != 1 or not values.size or not np.isfinite(values).all() or (np.diff(values) <= 0).any():
        raise InputError(
            "are not points of an axis",
            key=f"axes.{name}",
            allowed=f"one or more finite numbers in {UNITS[name]}, ascending",
        )
    return values


def reach_from_home(robot: model.Robot, name: str, fixed: Array) -> tuple[float, float]:
    """Ends of the way along a coordinate that legs, joints and singularities allow from home.

    Raises
    ------
    InputError
        The fixed coordinates alone are out of reach.
    """
    column = AXES.index(name)
    largest = FARTHEST[UNITS[name]] * (robot.home_height if UNITS[name] == "m" else 1.0)
    steps = np.linspace(0.0, 1.0, STEPS) ** 2 * largest  # fine near home
    ends = []
    for side in (-1.0, 1.0):
        table = np.tile(fixed, (STEPS, 1))
        table[:, column] = side * steps
        bad = rigid_codes(kinematics.RigidPoses(robot, poses_about_home(robot, table)), from_home=True) != REACHED
        if bad[0]:
            raise InputError(
                f"is out of reach with the fixed coordinates, so that no range of {name} can be chosen",
                key="at",
                next_step=f"Give the range, for example {name} = -0.1 to 0.1, or other fixed coordinates",
            )
        ends.append(side * steps[int(np.argmax(bad)) if bad.any() else -1])
    return ends[0], ends[1]


def _as_far_as_reached(ends: tuple[float, float], count: int, *, slices: bool) -> Array:
    """Points that go a twentieth beyond both ends, or slices within them; home is one of them, if there are several."""
    low, high = ends
    margin = 0.05 * (high - low)
    if slices:
        values = low + (high - low) * (np.arange(count) + 0.5) / count
    else:
        values = np.linspace(low - margin, high + margin, count)
    step = (high - low + 2 * margin) / max(count - 1, 1)
    nearest = int(np.abs(values).argmin())
    if count == 1 or abs(values[nearest]) > step:
        return values if count > 1 else np.array([0.5 * (low + high)])
    return values - values[nearest]
