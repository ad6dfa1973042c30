"""Home of a robot: the platform's pose, the positions of the carriages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.axes import normal_of, within_a_turn
from flexapod.common.tables.base import Quantity, Vec3
from flexapod.common.tables.table import Table
from flexapod.model.leg.joint import Carriage

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section


class Home(Table):
    """Pose of the platform frame at home: `position` (3,) [m], `rotation` (3,) [rad], world axes.

    `rotation`: roll, pitch, yaw about world x, y, z: R = Rz(yaw) Ry(pitch) Rx(roll).
    """

    placed: ClassVar[tuple[str, ...]] = ("rotation",)

    position: Annotated[Vec3, Quantity("length", why="of its origin")]
    rotation: Annotated[
        Vec3,
        Quantity(
            "angle",
            why="roll, pitch, yaw about world x, y, z: R = Rz(yaw) Ry(pitch) Rx(roll)",
            usual="parallel to the world",
            short="number",
        ),
    ] = Field(default=(0.0, 0.0, 0.0), validate_default=True)

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Rotation of a planar robot: a number, about the normal."""
        if section.plane is None or isinstance(section.data.get("rotation"), list):
            return {}
        angle = section.number("rotation", "angle")
        return {} if angle is None else {"rotation": angle * normal_of(section.plane)}

    @model_validator(mode="after")
    def _within_a_turn(self) -> Home:
        within_a_turn(self.rotation, "rotation")
        return self

    def raised(self, height: float) -> Home:
        """The same pose at another height [m]."""
        return self.replace(position=[*self.position[:2], height])

    @property
    def matrix(self) -> Array:
        """Platform to world, (3, 3)."""
        if not self.rotation.any():
            return np.eye(3)
        from scipy.spatial.transform import Rotation

        return Rotation.from_euler("xyz", self.rotation).as_matrix()


def foot(base: Array, carriage: Carriage | None, position: float) -> Array:
    """Base joint of a leg whose carriage is at a position [m, rad], (3,) [m], world axes; `base`: slider's 0, axis."""
    if carriage is None:
        return base
    if carriage.arm is None:
        return base + position * carriage.unit
    along, across, beside = _parts(carriage)
    return base + along + math.cos(position) * across + math.sin(position) * beside


def carriage_home(base: Array, carriage: Carriage, tip: Array, length: float) -> float | None:
    """Position [m, rad] at which a strut of a `length` [m] from the carriage ends in `tip` (3,); None if at none."""
    way = tip - base
    if carriage.arm is None:
        middle = float(way @ carriage.unit)
        square = middle**2 - float(way @ way) + length**2
        if square < 0:
            return None
        found = (middle - math.sqrt(square), middle + math.sqrt(square))
    else:
        along, across, beside = _parts(carriage)
        part = (way @ way + carriage.arm @ carriage.arm - length**2) / 2 - way @ along
        most = math.hypot(way @ across, way @ beside)
        if abs(part) > most:
            return None
        middle, apart = math.atan2(way @ beside, way @ across), math.acos(part / most)
        found = (_turn(middle - apart), _turn(middle + apart))
    if carriage.side is not None:
        return max(found) if carriage.side > 0 else min(found)
    return min(found, key=lambda position: abs(position - (carriage.home or 0.0)))


def _parts(carriage: Carriage) -> tuple[Array, Array, Array]:
    """Arm along the axis, across it, and the latter a quarter of a turn further."""
    arm, unit = np.asarray(carriage.arm), carriage.unit
    along = (arm @ unit) * unit
    return along, arm - along, np.cross(unit, arm)


def _turn(angle: float) -> float:
    """The angle within half a turn of 0."""
    return math.remainder(angle, 2 * math.pi)


def read_home(robot: Section, fixed: bool) -> Home:
    """Pose of the platform at home, of a table [robot]; `fixed`: at 0 unless that is given."""
    home = robot.section("home")
    if home is None:
        height = robot.number("home_height", "length")
        if height is None and not (robot.plane or fixed):
            robot.require_keys("home_height")
        try:
            return Home(position=np.array([0.0, 0.0, height or 0.0]))
        except InputError as error:
            raise robot.locate(InputError(error.what, key="home_height", allowed=error.allowed)) from None
    if "home_height" in robot:
        raise robot.error("is given together with home", "home_height", allowed="one of the two")
    return home.read(Home)
