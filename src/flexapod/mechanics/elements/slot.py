"""A place for an element in a kernel: its names beside those of the others, and of two alike which of them it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from flexapod.mechanics.elements.element import Along, Moving, Named, Physics, SeriesSprings, Standing
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.trial import asking, refused

if TYPE_CHECKING:
    from flexapod.mechanics.elements.frames import Frame
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg

T = TypeVar("T", Along, Moving)


@dataclass(frozen=True)
class Slot:
    """The ``number``-th element of a kind in each leg, from 1. What it has is what its `kind` has, see `Physics`."""

    kind: type[Physics]
    number: int = 1

    @property
    def prefix(self) -> str:
        """What stands before its names: nothing of an element without a table of its own."""
        at = self.kind.at
        return at and f"{at}{'' if self.number == 1 else f'_{self.number}'}_"

    @property
    def rubs_at(self) -> str:
        """Where it rubs, as results name it."""
        return self.kind.rubs_at or self.prefix[:-1]

    def of(self, leg: Leg) -> Physics | None:
        """The element in one leg; None of a leg without it."""
        found = self.kind.all_of(leg)
        return found[self.number - 1] if len(found) >= self.number else None

    @property
    def coordinates(self) -> Named:
        """By name, with their sizes."""
        return self._named(self.kind.coordinates)

    @property
    def parameters(self) -> Named:
        """By name, with their sizes."""
        return self._named(self.kind.parameters)

    @property
    def follows(self) -> Mapping[str, str]:
        """Own coordinates that are as others are in an undeformed leg."""
        return self._prefixed(self.kind.follows)

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Parameters of one leg, whether or not the element is there."""
        own = self.of(leg)
        absent = {name: self.kind.absent.get(name, np.zeros(size)) for name, size in self.kind.parameters}
        if own is None:
            return self._prefixed(absent)
        with asking(self.kind, "numbers"):
            return self._prefixed(absent | dict(own.numbers(leg, standing)))

    def held(self, leg: Leg, standing: Standing) -> list[str]:
        """Coordinates that follow a table in one leg."""
        return list(self._prefixed(dict.fromkeys(self.kind.held(self.of(leg), leg, standing))))

    def energy(self, x: Along) -> Energies:
        """Energies where it stands in a leg."""
        with asking(self.kind, "energy"):
            found = self.kind.energy_along(self._seen_in(x))
        if not isinstance(found, Energies):
            raise refused(self.kind, "energy", "gives no flexapod.Energies", value=type(found).__name__)
        return found

    def damping_force(self, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> dict[str, SX]:
        """Forces against the rates of coordinates."""
        with asking(self.kind, "damping_force"):
            return self._prefixed(self.kind.damping_force(self.seen(p), self.seen(q), self.seen(v)))

    def slides(self, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """How fast it slides where it has friction."""
        with asking(self.kind, "slides"):
            return self.kind.slides(self.seen(p), self.seen(q), self.seen(v))

    def carries(self, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Frame | None:
        """Frame of the base as it carries it."""
        return self.kind.carries(base, self.seen(p), self.seen(q), self.seen(v))

    def in_series(self, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """Springs between rotor and stroke with what the element changes in them."""
        return self.kind.in_series(s, self.seen(p), self.seen(q), self.seen(v))

    def past(self, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """How far these are stretched, and how fast."""
        return self.kind.past(x, rate, self.seen(p))

    def asked(self, p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
        """Force that a loop about a rotor asks for because of the element."""
        return self.kind.asked(self.seen(p), self.seen(q))

    def pushes(self, x: Moving) -> dict[str, SX]:
        """What is added to the balance without an energy."""
        with asking(self.kind, "pushes"):
            return self._prefixed(self.kind.pushes(self._seen_in(x)))

    def inertia(self, p: SimpleNamespace) -> dict[str, tuple[SX | float, SX | float]]:
        """Mass and damper without an energy."""
        return self._prefixed(self.kind.inertia(self.seen(p)))

    def given(self, x: Moving) -> SX | None:
        """Power that comes in."""
        with asking(self.kind, "given"):
            return self.kind.given(self._seen_in(x))

    def seen(self, names: SimpleNamespace) -> SimpleNamespace:
        """Names as the element has them: its own without what stands before them."""
        if not self.prefix:
            return names
        own = {name: getattr(names, f"{self.prefix}{name}", None) for name in self._own}
        return SimpleNamespace(**vars(names) | {name: value for name, value in own.items() if value is not None})

    def _seen_in(self, x: T) -> T:
        return replace(x, p=self.seen(x.p), q=self.seen(x.q), v=self.seen(x.v)) if self.prefix else x

    @property
    def _own(self) -> set[str]:
        return {name for name, _ in (*self.kind.coordinates, *self.kind.parameters)}

    def _named(self, names: Named) -> Named:
        return tuple((f"{self.prefix}{name}", size) for name, size in names)

    def _prefixed(self, found: Mapping[str, Any]) -> dict[str, Any]:
        own = self._own if self.prefix else ()
        return {f"{self.prefix}{name}" if name in own else name: value for name, value in found.items()}
