"""The platform and all it carries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import field_validator, model_validator

from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.quantities import number
from flexapod.common.tables.axes import diagonal, normal_of
from flexapod.common.tables.base import Matrix3, Quantity, Vec3
from flexapod.common.tables.table import Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section


class Payload(Table):
    """Platform and everything on it, as one rigid body.

    `mass` [kg]; `inertia` (3, 3) [kg m^2] about the centre of mass in platform axes, products with tensor sign;
    `com` and `tool` (3,) [m] from the platform frame's origin in platform axes (`tool` defaults to `com`).
    """

    mass: Annotated[float, Quantity("mass", above=0, why="mass, the platform included")]
    inertia: Annotated[
        Matrix3,
        Quantity(
            "inertia",
            why="principal moments, or three rows, about the centre of mass in platform axes; a body's: "
            "positive, none above the sum of the others",
            short="number",
        ),
    ]
    com: Annotated[Vec3, Quantity("length", why="centre of mass, from the platform frame's origin")]
    tool: Annotated[
        Vec3,
        Quantity(
            "length", why="the point you care about, from the platform frame's origin", usual="the centre of mass"
        ),
    ]

    if TYPE_CHECKING:  # what follows need not be given

        def __init__(self, **fields: Any) -> None: ...

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The tool is the centre of mass unless another one is given."""
        return {"tool": fields["com"]} if fields.get("tool") is None and "com" in fields else {}

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Inertia by principal moments, by rows, or in a plane by a number."""
        if section.plane is None or isinstance(section.data.get("inertia"), list):
            return {"inertia": section.matrix("inertia", "inertia")}
        number = section.number("inertia", "inertia")  # of a flat plate in that plane
        return {} if number is None else {"inertia": number * (1 + normal_of(section.plane)) / 2}

    @field_validator("inertia", mode="before")
    @classmethod
    def _from_principal(cls, value: object) -> object:
        try:
            moments = floats(value)
        except ValueError:
            return value  # refused as a matrix
        return np.diag(moments) if moments.shape == (3,) else value

    def _shown(self) -> dict[str, str]:
        tool = {} if np.array_equal(self.com, self.tool) else {"tool": f"at {millimetres(self.tool)}"}
        moments = ", ".join(number(moment, 4) for moment in np.diag(self.inertia))
        return {
            "mass": f"{number(self.mass, 4)} kg",
            "com": f"at {millimetres(self.com)}",
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

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file: principal moments, where the axes are those of the platform."""
        return super().si_values() | {"inertia": diagonal(self.inertia)}


def millimetres(point: Array) -> str:
    """A point in words."""
    return f"[{', '.join(number(1e3 * part + 0.0, 4) for part in point)}] mm"


def _no_body(inertia: Array, allowed: str) -> InputError:
    return InputError(
        "is an inertia that no body can have",
        key="inertia",
        value=inertia.tolist(),
        allowed=allowed,
        next_step="It is about the centre of mass, in platform axes, products of inertia with tensor sign",
    )
