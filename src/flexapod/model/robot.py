"""The parallel robot: payload, joints, legs."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import field_validator, model_validator

from flexapod.errors import InputError
from flexapod.model.base import Frozen, Joints, Matrix3, Measure, NonNegative, Number, Positive, Vec3
from flexapod.model.leg import Leg
from flexapod.typing import Array
from flexapod.units import DIMENSIONS
from flexapod.words import number, text

__all__ = ["Circle", "Payload", "Robot", "base_circle", "platform_circle"]

_LOWER = ((0, -1), (0, 1), (120, -1), (120, 1), (240, -1), (240, 1))
_UPPER = ((-60, 1), (60, -1), (60, 1), (180, -1), (180, 1), (300, -1))


class Payload(Frozen):
    """Platform and everything on it, as one rigid body.

    `mass` [kg]; `inertia` (3, 3) [kg m^2] about the centre of mass in platform axes, products with tensor sign;
    `com` and `tool` (3,) [m] from the platform frame's origin in platform axes (`tool` defaults to `com`).
    """

    mass: Annotated[Positive, Measure("mass")]
    inertia: Annotated[Matrix3, Measure("inertia")]
    com: Annotated[Vec3, Measure("length")]
    tool: Annotated[Vec3, Measure("length")]

    def __init__(self, **fields: object) -> None:
        if fields.get("tool") is None and "com" in fields:
            fields = fields | {"tool": fields["com"]}
        super().__init__(**fields)

    @field_validator("inertia", mode="before")
    @classmethod
    def _from_principal(cls, value: object) -> object:
        if np.shape(value) == (3,):  # type: ignore[arg-type]
            return np.diag(np.asarray(value, dtype=np.float64))
        return value

    def _shown(self) -> dict[str, str]:
        tool = {} if np.array_equal(self.com, self.tool) else {"tool": f"at {_millimetres(self.tool)}"}
        moments = ", ".join(number(moment, 4) for moment in np.diag(self.inertia))
        return {
            "mass": f"{number(self.mass, 4)} kg",
            "com": f"at {_millimetres(self.com)}",
            **tool,
            "inertia": f"{moments} kg m^2 (xx, yy, zz)",
        }

    @model_validator(mode="after")
    def _real_body(self) -> Payload:
        inertia = self.inertia
        if not np.allclose(inertia, inertia.T, rtol=0, atol=1e-9 * np.abs(inertia).max()):
            raise _no_body(inertia, "a symmetric tensor: Ixy = Iyx, Ixz = Izx, Iyz = Izy")
        small, middle, large = np.linalg.eigvalsh(inertia)
        if small <= 1e-12 * abs(large):
            raise _no_body(inertia, f"principal moments above 0 (the smallest is {small:.6g} kg m^2)")
        if large > (small + middle) * (1 + 1e-9):
            raise _no_body(
                inertia,
                "no principal moment above the sum of the other two "
                f"(these are {small:.6g}, {middle:.6g}, {large:.6g} kg m^2)",
            )
        return self


class Circle(Frozen):
    """Joints in pairs on a circle: `radius` [m]; `half_angle` [rad], half the angle between the joints of a pair."""

    radius: Annotated[Positive, Measure("length")]
    half_angle: Annotated[NonNegative, Measure("angle")]

    @model_validator(mode="after")
    def _pairs_apart(self) -> Circle:
        if self.half_angle > math.pi / 3:
            raise InputError(
                "is out of range",
                key="half_angle",
                value=self.half_angle,
                allowed="0 to 60 deg",
                next_step='Write degrees as "10 deg"',
            )
        return self


class Robot(Frozen):
    """A 6-UPS robot.

    `base_joints` (6, 3) [m] in world axes; `platform_joints` (6, 3) [m] in the platform frame, which is at
    [0, 0, home_height] and parallel to the world at home; `gravity` (3,) [m/s^2] in world axes.
    """

    type: Literal["6-UPS"] = "6-UPS"
    base_joints: Annotated[Joints, Measure("length")]
    platform_joints: Annotated[Joints, Measure("length")]
    home_height: Annotated[Number, Measure("length")]
    gravity: Annotated[Vec3, Measure("acceleration")]
    payload: Payload
    legs: tuple[Leg, Leg, Leg, Leg, Leg, Leg]

    @model_validator(mode="after")
    def _legs_fit(self) -> Robot:
        for name, joints in (("base", self.base_joints), ("platform", self.platform_joints)):
            if np.ptp(joints, axis=0).max() < DIMENSIONS["length"].least:
                raise InputError(
                    f"all {name} joints lie at one point: the legs cannot hold the platform against turning",
                    key=f"robot.{name}",
                    value=joints[0].tolist(),
                    next_step=f"Give robot.{name} a radius, or six places apart from each other",
                )
        for i, (leg, length) in enumerate(zip(self.legs, self.home_lengths, strict=True), start=1):
            _check_home(i, leg, float(length))
        axial = {leg.axial_modes for leg in self.legs}
        if len(axial) > 1:
            raise InputError(
                "differs between legs",
                key="leg.axial_modes",
                value=sorted(axial),
                allowed="one number for all six legs",
            )
        return self

    def _shown(self) -> dict[str, str]:
        lengths, first = self.home_lengths, self.legs[0]
        alike = all(leg == first for leg in self.legs)
        span = text(lengths.min(), "m", 4) + (f" to {text(lengths.max(), 'm', 4)}" if np.ptp(lengths) > 1e-9 else "")
        drives = ", ".join(dict.fromkeys(leg.drive.type for leg in self.legs))
        return {
            "type": self.type,
            "home height": text(self.home_height, "m", 4),
            "legs": f"{'six alike' if alike else 'of several kinds'}, {span} long at home, drives {drives}",
            "payload": f"{number(self.payload.mass, 4)} kg, centre of mass at {_millimetres(self.payload.com)}",
        }

    @property
    def home_vectors(self) -> Array:
        """From base to platform joint of every leg at home, (6, 3) [m], world axes."""
        return self.platform_joints + np.array([0.0, 0.0, self.home_height]) - self.base_joints

    @property
    def home_lengths(self) -> Array:
        """Joint-to-joint lengths at home, (6,) [m]."""
        return np.linalg.norm(self.home_vectors, axis=1)


def _millimetres(point: Array) -> str:
    return f"[{', '.join(number(1e3 * part + 0.0, 4) for part in point)}] mm"


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


def _check_home(number: int, leg: Leg, length: float) -> None:
    where = f"leg {number}"
    if length < 1e-9:
        raise InputError(
            f"{where}: base and platform joint coincide at home",
            key="robot.home_height",
            next_step="Check the joints of this leg and home_height",
        )
    if leg.cylinder.mouth >= length:
        raise InputError(
            f"{where}: no piston is left outside the cylinder at home, where the leg is {length:.6g} m long",
            key="leg.cylinder.mouth",
            value=leg.cylinder.mouth,
            allowed=f"below {length:.6g} m",
        )
    if abs(leg.cylinder.com) > length:
        raise InputError(
            f"{where}: the cylinder's centre of mass lies beyond the leg's ends at home",
            key="leg.cylinder.com",
            value=leg.cylinder.com,
            allowed=f"between the universal joint (0) and the mouth ({leg.cylinder.mouth:.6g} m)",
        )


def _no_body(inertia: Array, allowed: str) -> InputError:
    return InputError(
        "is an inertia that no body can have",
        key="inertia",
        value=inertia.tolist(),
        allowed=allowed,
        next_step="It is about the centre of mass, in platform axes, products of inertia with tensor sign",
    )
