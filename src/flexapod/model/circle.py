"""Joints on a circle."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import model_validator

from flexapod.errors import InputError
from flexapod.schema.axes import plane_order, within_a_turn
from flexapod.schema.base import Quantity, Series
from flexapod.schema.table import Table
from flexapod.typing import Array

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
    angles = np.array([np.deg2rad(centre) + side * half_angle for centre, side in places])
    return radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(6)])
