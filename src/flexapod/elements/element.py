"""What an element of a leg is: coordinates, parameters, energies and numbers of one physical part, in one class.

The class stands in the layout of a kernel: its equations hold for all legs. Its objects are the part in one leg.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np

from flexapod.elements.frame import Energies

if TYPE_CHECKING:
    from flexapod.model import Leg, Simulation
    from flexapod.symbolic.vocabulary import SX

__all__ = ["Element", "Named", "Series", "Standing", "numbers_of"]

Named = tuple[tuple[str, int], ...]


class Standing(NamedTuple):
    """How a leg stands whose numbers are asked for.

    ``length`` [m]: joint to joint, at home; ``per_loss`` [s]: viscous damping over stiffness of a spring of loss factor
    1; ``at_rest``: loops that sum their errors have left none.
    """

    length: float
    per_loss: float
    at_rest: bool


@dataclass(frozen=True)
class Series:
    """Springs in series between a rotor and a stroke, as elements change them.

    ``softer``: their compliance over that at home; ``nut`` and ``rate``: where they end, and how fast that moves.
    """

    softer: SX
    nut: SX
    rate: SX


class Element:
    """A physical part of a leg.

    Attributes
    ----------
    coordinates, parameters : tuple of (name, size)
        What it adds to the coordinates of a leg, and to the numbers that its equations read, in SI.
    absent : mapping
        Its parameters in a leg without it, beside one that has it; 0 if they are not named here.
    follows : mapping
        Its coordinates that are as others are in a leg that carries nothing: own name -> the other's.
    """

    coordinates: ClassVar[Named] = ()
    parameters: ClassVar[Named] = ()
    absent: ClassVar[Mapping[str, Any]] = {}
    follows: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """The part in one leg; None of a leg without it."""
        raise NotImplementedError

    @classmethod
    def among(cls, legs: Sequence[Leg], simulation: Simulation) -> bool:
        """Whether it is in a kernel for these legs."""
        return any(cls.of(leg) is not None for leg in legs)

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        """Its parameters in one leg, by name."""
        return {}

    @classmethod
    def held(cls, leg: Leg, *, at_rest: bool) -> Sequence[str]:
        """Coordinates that follow a table in one leg: by default its own where the leg does not have it."""
        return () if cls.of(leg) is not None else tuple(name for name, _ in cls.coordinates)

    @classmethod
    def energy(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace, elements: Sequence[type]) -> Energies:
        """Its energies by parameters, coordinates and rates; ``elements``: all those of the kernel."""
        return Energies()

    @classmethod
    def in_series(cls, s: Series, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Series:
        """What it changes in the springs between rotor and stroke."""
        return s

    @classmethod
    def past(cls, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """How far these springs are stretched, and how fast, by how far their ends are apart."""
        return x, rate

    @classmethod
    def asked(cls, p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
        """What a loop about a rotor asks of its motor because of it [N], beside what its spring and damper ask."""
        return None


def numbers_of(element: type[Element], leg: Leg, standing: Standing) -> dict[str, Any]:
    """Parameters of an element in a leg, whether or not it is there."""
    own = element.of(leg)
    found = {name: element.absent.get(name, np.zeros(size)) for name, size in element.parameters}
    return found if own is None else found | dict(own.numbers(leg, standing))
