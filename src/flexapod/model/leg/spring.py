"""A spring along a leg, in series with its other parts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Loss, Quantity
from flexapod.common.tables.table import Table
from flexapod.model.heat import HEAT_PARTS

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

LEAST = 1e-9  # N/m, as of other springs

#: Names of other parts, and of other causes and rows of a budget.
RESERVED = (
    "axial-strain", "bending", "drive", "base_joint", "platform_joint", "screw", "twist", "nut", "bearing", "oil",
    "friction", "cylinder", "guide", "unkeyed", "piston", "base_mount", "platform_mount", "geometry", "base_joints",
    "platform_joints", "leg_offset", "lead", "bent_legs", "encoder", "ripple",
    *(f"heat_{part}" for part in HEAT_PARTS),
)  # fmt: skip


class AxialSpring(Table):
    """A named spring [N/m] along a leg, with a damper [N s/m] or a loss factor.

    `at`: where it is, between base joint and cylinder ("base"), between nut or drive and piston ("nut"), or between
    the piston's tip and the platform joint ("platform").
    """

    derived: ClassVar[tuple[str, ...]] = ("name",)

    name: str
    stiffness: Annotated[float, Quantity("stiffness", above=0, why="along the leg")]
    at: Annotated[
        Literal["nut", "base", "platform"],
        Key("between base joint and cylinder, drive and piston, or piston and platform joint"),
    ] = "nut"
    damping: Annotated[float | None, Quantity("damping", least=0, why="damper beside it")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of damping")] = None

    @model_validator(mode="after")
    def _sensible(self) -> AxialSpring:
        check_lossy(self)
        if self.name in RESERVED or not re.fullmatch(r"[A-Za-z][\w-]*", self.name):
            raise InputError(
                "is not a name for a spring",
                value=self.name,
                allowed="letters, digits, _ and -, and not " + ", ".join(RESERVED),
            )
        return self


def check_lossy(spring: Any) -> None:
    """Raise InputError if a spring has a damper and a loss factor."""
    if spring.damping is not None and spring.loss is not None:
        raise InputError("is given together with damping", key="loss", value=spring.loss, allowed="either of the two")


def read_spring(section: Section, name: str) -> float:
    """A stiffness [N/m], refused in words where it is none."""
    value = section.number(name, "stiffness")
    if value is None or not value > 0:
        raise section.error(
            "is not above zero: such a spring holds nothing", name, allowed="above 0 N/m; a joint without it is rigid"
        )
    if value < LEAST:
        raise section.error("is out of range", name, allowed=f"{LEAST:g} to 1e+18 N/m")
    return value


def read_springs(section: Section | None) -> tuple[AxialSpring, ...] | None:
    """Springs along a leg by name: a number, or a table."""
    if section is None:
        return None
    section.accept_any_keys()
    found = []
    for name, value in section.data.items():
        spring = section.child(value if isinstance(value, Mapping) else {}, name)
        if isinstance(value, Mapping):
            found.append(spring.read(AxialSpring, then=lambda _, name=name: {"name": name}))
        else:
            found.append(spring.build(AxialSpring, name=name, stiffness=read_spring(section, name)))
    return tuple(found)
