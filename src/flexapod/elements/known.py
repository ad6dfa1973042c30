"""The elements that a leg may have, in the order of their coordinates, parameters and energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexapod.elements.drive_train import DriveTrain
from flexapod.elements.element import Element
from flexapod.elements.gap import Gap
from flexapod.elements.motor_loop import MotorLoop
from flexapod.elements.oil import Oil
from flexapod.elements.ripple import Rippling
from flexapod.elements.soft_joint import SoftBase, SoftPlatform
from flexapod.elements.summed_error import SummedError
from flexapod.elements.turning_nut import TurningNut

if TYPE_CHECKING:
    from flexapod.model import Leg, Simulation

__all__ = ["elements_of", "known"]

OURS: tuple[type[Element], ...] = (
    SoftBase, SoftPlatform, DriveTrain, TurningNut, Gap, Rippling, SummedError, MotorLoop, Oil,
)  # fmt: skip


def known() -> tuple[type[Element], ...]:
    """All of them."""
    return OURS


def elements_of(legs: Sequence[Leg], simulation: Simulation) -> tuple[type[Element], ...]:
    """Those that any of some legs has."""
    return tuple(element for element in known() if element.among(legs, simulation))
