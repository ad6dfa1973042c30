"""Joints on a circle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.axes import plane_order, within_a_turn
from flexapod.common.tables.base import Quantity, Series
from flexapod.common.tables.table import Table
from flexapod.common.units import to_si

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

_LOWER = ((0, -1), (0, 1), (120, -1), (120, 1), (240, -1), (240, 1))
_UPPER = ((-60, 1), (60, -1), (60, 1), (180, -1), (180, 1), (300, -1))


class Circle(Table):
    """Joints on a circle of a `radius` [m]: at `angles` (n,) [rad], or in pairs.

    `half_angle` [rad]: half the angle between the joints of a pair.
    """

    radius: Annotated[float, Quantity("length", above=0, why="radius of the joints' circle")]
    half_angle: Annotated[
        float | None,
        Quantity(
            "angle",
            least=0,
            why="half the angle between the two joints of a pair, up to 60 deg; six legs",
            usual="given by angles",
        ),
    ] = None
    angles: Annotated[
        Series | None,
        Quantity("angle", why="of the joints on the circle, one for each leg", usual="given by half_angle"),
    ] = None

    @model_validator(mode="after")
    def _pairs_apart(self) -> Circle:
        if self.angles is not None:
            within_a_turn(self.angles, "angles")
        if self.half_angle is not None and self.half_angle > math.pi / 3:
            raise InputError(
                "is out of range",
                key="half_angle",
                value=self.half_angle,
                allowed="0 to 60 deg",
                next_step='Write degrees as "10 deg"',
            )
        return self

    def joints(self, end: str, plane: str | None) -> Array:
        """The joints at an end of the legs, "base" or "platform", (n, 3) [m]; angles count in the plane, or in xy."""
        if self.half_angle is not None:
            return (base_circle if end == "base" else platform_circle)(self.radius, self.half_angle)
        angles = np.asarray(self.angles)
        flat = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
        return self.radius * np.roll(flat, plane_order(plane)[0], axis=1)


def base_circle(radius: float, half_angle: float) -> Array:
    """Base joints of legs 1 to 6 on a circle: pairs centred at 0, 120 and 240 deg, z = 0.

    Parameters
    ----------
    radius : float
        Radius of the circle [m].
    half_angle : float
        Half the angle between the two joints of a pair [rad].

    Returns
    -------
    Array
        (6, 3) [m], world axes.
    """
    return _circle(radius, half_angle, _LOWER)


def platform_circle(radius: float, half_angle: float) -> Array:
    """Platform joints of legs 1 to 6 on a circle: pairs centred at 60, 180 and 300 deg.

    Parameters and result as for `base_circle`, in the platform frame.
    """
    return _circle(radius, half_angle, _UPPER)


def _circle(radius: float, half_angle: float, places: tuple[tuple[int, int], ...]) -> Array:
    radius, half_angle = to_si(radius, "length", key="radius"), to_si(half_angle, "angle", key="half_angle")
    angles = np.array([np.deg2rad(centre) + side * half_angle for centre, side in places])
    return radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(6)])


def read_places(robot: Section, end: str, tables: list[Section], kind: str) -> Array:
    """Joints of all legs at one end, (n, 3); a leg may have its own place, the others share a circle or rows."""
    joints = [table.section(f"{end}_joint") for table in tables]
    own = [None if joint is None else joint.vector("at", *("length",) * 3) for joint in joints]
    shared = iter(_shared(robot.child(robot.data[end], end), end, own.count(None), kind))
    return np.array([next(shared) if place is None else place for place in own])


def _shared(section: Section, end: str, count: int, kind: str) -> Array | list[list[float]]:
    fixed = ("fixed",) if end == "platform" else ()
    for name, what in (("joints", "rows"), ("angles", "angles")):
        given = section.data.get(name)
        if isinstance(given, list) and len(given) != count:
            raise section.malformed_error(
                f"places {len(given)} joint{'s' * (len(given) != 1)}",
                name,
                allowed=f"{count} {what}, one for each leg of {kind} that has no {end}_joint.at",
            )
    if "joints" in section:
        section.check_keys("joints", *fixed)
        return section.rows("joints", *(("length",) * 3,) * count)
    circle = section.read(Circle, also=("joints", *fixed), then=lambda s: _angles(s, count))
    return circle.joints(end, section.plane)


def _angles(section: Section, count: int) -> dict[str, object]:
    if "half_angle" in section and (count != 6 or section.plane):
        odd = "an odd number of joints has no pairs" if count % 2 else "pairs at 0, 120 and 240 deg are six joints"
        raise section.error(
            f"does not place {count} joints{f' in the plane {section.plane}' if section.plane else ''}: {odd}",
            "half_angle",
            allowed=f"angles, a list of {count}",
            next_step=f"For example: angles = {[f'{360 * i // max(count, 1)} deg' for i in range(count)]}",
        )
    if "angles" not in section:
        section.require_keys("radius", "half_angle" if count == 6 and not section.plane else "angles")
        return {"angles": None}
    if "half_angle" in section:
        raise section.error("is given together with angles", "half_angle", allowed="one of the two")
    return {"angles": section.vector("angles", *("angle",) * count)}
