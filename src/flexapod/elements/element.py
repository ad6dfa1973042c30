"""What an element of a leg is: coordinates, parameters, energies and numbers of one physical part, in one class.

The class stands in the layout of a kernel: its equations hold for all legs. Its objects are the part in one leg.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np

from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import dot, sqrt

if TYPE_CHECKING:
    from flexapod.model import Leg, Simulation
    from flexapod.symbolic.vocabulary import SX

__all__ = ["Element", "Moving", "Named", "Series", "Standing", "asked_beside", "numbers_of"]

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


@dataclass(frozen=True, kw_only=True)
class Moving:
    """A leg in motion, for those that need more than its coordinates.

    ``p``, ``q``, ``v``: its parameters, coordinates and rates by name; ``q_cmd`` and ``v_cmd``: what is commanded to
    its rotor, if it has one; ``foot`` and ``tip``: places of its joints in the world; ``elements``: all those of the
    kernel; ``rate``: gives the rate of an expression.
    """

    p: SimpleNamespace
    q: SimpleNamespace
    v: SimpleNamespace
    q_cmd: SX
    v_cmd: SX
    foot: SX
    tip: SX
    elements: Sequence[type[Element]]
    rate: Callable[[SX], SX]

    @property
    def distance(self) -> SX:
        """Of the joints."""
        along = self.tip - self.foot
        return sqrt(dot(along, along))


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

    @classmethod
    def pushes(cls, x: Moving) -> Mapping[str, SX]:
        """What it adds to the balance of coordinates, by name, without an energy; forces on them are negative here."""
        return {}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """Mass and damper of coordinates of its own that have them without an energy, by name."""
        return {}

    @classmethod
    def given(cls, x: Moving) -> SX | None:
        """Power that comes in by what it pushes."""
        return None


def numbers_of(element: type[Element], leg: Leg, standing: Standing) -> dict[str, Any]:
    """Parameters of an element in a leg, whether or not it is there."""
    own = element.of(leg)
    found = {name: element.absent.get(name, np.zeros(size)) for name, size in element.parameters}
    return found if own is None else found | dict(own.numbers(leg, standing))


def asked_beside(elements: Sequence[type[Element]], p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
    """What elements ask of a motor beside spring and damper of its loop; None of nothing."""
    found = [x for element in elements if (x := element.asked(p, q)) is not None]
    return sum(found[1:], found[0]) if found else None
