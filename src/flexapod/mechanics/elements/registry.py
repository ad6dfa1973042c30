"""The elements that a leg may have, in the order of their coordinates, parameters and energies."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

from flexapod.common.errors import InputError
from flexapod.mechanics.elements.clearance import Clearance
from flexapod.mechanics.elements.distribution import RotaryInertia
from flexapod.mechanics.elements.drive_train import DriveTrain
from flexapod.mechanics.elements.element import Element, Physics, registered
from flexapod.mechanics.elements.encoder import Resolution
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.friction import BaseFriction, DriveFriction, PlatformFriction
from flexapod.mechanics.elements.gap import Gap
from flexapod.mechanics.elements.motor_loop import MotorLoop, SummedError
from flexapod.mechanics.elements.mount import BaseMounting, MovedBase, PlatformMounting
from flexapod.mechanics.elements.oil import Oil
from flexapod.mechanics.elements.ripple import Ripple
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.soft_joint import SoftBase, SoftPlatform
from flexapod.mechanics.elements.turning_nut import TurningNut

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section
    from flexapod.model import Leg, Robot, Simulation

GROUP = "flexapod.elements"
OURS: tuple[type[Physics], ...] = (
    Flexures, SoftBase, SoftPlatform, DriveTrain, TurningNut, Gap, Ripple, SummedError, MotorLoop, Oil, Resolution,
    BaseFriction, PlatformFriction, DriveFriction, MovedBase, BaseMounting, PlatformMounting,
    Clearance, RotaryInertia,
)  # fmt: skip


def kinds_of(legs: Sequence[Leg]) -> tuple[type[Physics], ...]:
    """Kinds of elements that legs may have: the built-in ones, then those with tables of their own, by name."""
    tables = {type(element) for leg in legs for element in leg.elements}
    return (*OURS, *sorted(tables - {*OURS}, key=lambda kind: kind.at))


def elements_of(robot: Robot, simulation: Simulation) -> tuple[Slot, ...]:
    """Slots of the elements in a kernel for the legs of a robot; several of one kind follow each other."""
    there = (kind for kind in kinds_of(robot.legs) if kind.in_kernel(robot, simulation))
    return tuple(slot for kind in there for slot in slots_of(kind, robot.legs))


def slots_of(kind: type[Physics], legs: Sequence[Leg]) -> tuple[Slot, ...]:
    """Slots of one kind of element, as many as the leg with the most of them has."""
    most = max(len(kind.all_of(leg)) for leg in legs)
    return tuple(Slot(kind, number) for number in range(1, most + 1))


def refuse_tables(legs: Sequence[Leg], reader: str) -> None:
    """Raise InputError if legs have elements with tables of their own, which a reader of legs does not know."""
    for leg in legs:
        for element in leg.elements:
            raise InputError(
                f"is not known to {reader}",
                key=f"leg.{element.at}",
                allowed="legs without it",
                next_step=f"Leave [leg.{element.at}] out for this",
            )


def read_elements(section: Section, own: Collection[str]) -> tuple[Element, ...]:
    """Elements in the table of a leg; keys but its ``own`` may be names of theirs, with one table or a list of them."""
    found: list[Element] = []
    for name in section.data:
        kind = None if name in own else element_at(name)
        if kind is not None:
            given = section.data[name]
            tables = [(name, given)] if not isinstance(given, list) else _numbered(name, given)
            found += [section.child(table, path).read(kind) for path, table in tables]
    return tuple(found)


def _numbered(name: str, tables: list[Any]) -> list[tuple[str, Any]]:
    return [(f"{name}[{number}]", table) for number, table in enumerate(tables, start=1)]


def element_values(elements: Sequence[Element]) -> dict[str, object]:
    """Values of elements as written in the table of their leg: by name, a list where there are several."""
    found: dict[str, list[Element]] = {}
    for element in elements:
        found.setdefault(element.at, []).append(element)
    return {name: tables[0] if len(tables) == 1 else tables for name, tables in found.items()}


def element_at(name: str) -> type[Element] | None:
    """The class with a table of this name, of a module that was imported or of a package that names it; None of none.

    Raises
    ------
    InputError
        The package's entry point in the group ``flexapod.elements`` gives no such class.
    """
    from importlib.metadata import entry_points  # most studies have no such table

    for point in () if name in registered else entry_points(group=GROUP, name=name):
        found = point.load()
        if registered.get(name) is not found:
            raise InputError(
                "is no element of this name",
                value=f"{point.name} = {point.value!r}",
                allowed=f'a class of flexapod.Element with at = "{name}"',
                next_step=f"See the entry point of the package in the group {GROUP}",
            )
    return registered.get(name)
