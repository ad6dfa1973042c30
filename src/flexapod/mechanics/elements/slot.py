"""Slot of an element in a kernel: its names beside those of others, and its number among several of one kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from flexapod.mechanics.elements.element import Along, LegContext, MovingLeg, Named, Physics, SeriesSprings
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.trial import hook_error, wrap_hook_errors

if TYPE_CHECKING:
    from flexapod.mechanics.elements.frames import Frame
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg

T = TypeVar("T", Along, MovingLeg)


@dataclass(frozen=True)
class Slot:
    """The ``number``-th element of a kind in each leg, from 1. What it has is what its `kind` has, see `Physics`."""

    kind: type[Physics]
    number: int = 1

    @property
    def prefix(self) -> str:
        """Prefix of the element's names in a kernel; empty of an element without a table of its own."""
        at = self.kind.at
        return at and f"{at}{'' if self.number == 1 else f'_{self.number}'}_"

    @property
    def rubs_at(self) -> str:
        """Place of the element's friction, as results name it."""
        return self.kind.rubs_at or self.prefix[:-1]

    def of(self, leg: Leg) -> Physics | None:
        """Element of this slot in one leg; None of a leg without it."""
        found = self.kind.all_of(leg)
        return found[self.number - 1] if len(found) >= self.number else None

    @property
    def coordinates(self) -> Named:
        """Names in the kernel with their sizes."""
        return self._named(self.kind.coordinates)

    @property
    def parameters(self) -> Named:
        """Names in the kernel with their sizes."""
        return self._named(self.kind.parameters)

    @property
    def follows(self) -> Mapping[str, str]:
        """Own coordinates that are as others are in an undeformed leg."""
        return self._prefixed(self.kind.follows)

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Parameters of one leg, whether or not the element is there."""
        own = self.of(leg)
        absent = {name: self.kind.absent.get(name, np.zeros(size)) for name, size in self.kind.parameters}
        if own is None:
            return self._prefixed(absent)
        with wrap_hook_errors(self.kind, "numbers"):
            return self._prefixed(absent | dict(own.numbers(leg, standing)))

    def prescribed(self, leg: Leg, standing: LegContext) -> list[str]:
        """Coordinates that follow a table in one leg."""
        return list(self._prefixed(dict.fromkeys(self.kind.prescribed(self.of(leg), leg, standing))))

    def energy(self, x: Along) -> Energies:
        """Energies of the element in a leg."""
        with wrap_hook_errors(self.kind, "energy"):
            found = self.kind.energy_along(self._seen_in(x))
        if not isinstance(found, Energies):
            raise hook_error(self.kind, "energy", "gives no flexapod.Energies", value=type(found).__name__)
        return found

    def damping_force(self, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> dict[str, SX]:
        """Forces against the rates of coordinates."""
        with wrap_hook_errors(self.kind, "damping_force"):
            return self._prefixed(
                self.kind.damping_force(self.strip_prefix(p), self.strip_prefix(q), self.strip_prefix(v))
            )

    def sliding_speed(self, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """Sliding speeds of the element's friction."""
        with wrap_hook_errors(self.kind, "slides"):
            return self.kind.sliding_speed(self.strip_prefix(p), self.strip_prefix(q), self.strip_prefix(v))

    def base_frame(
        self, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace
    ) -> Frame | None:
        """Frame of the base as it carries it."""
        return self.kind.base_frame(base, self.strip_prefix(p), self.strip_prefix(q), self.strip_prefix(v))

    def in_series(self, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """Springs between rotor and stroke with what the element changes in them."""
        return self.kind.in_series(s, self.strip_prefix(p), self.strip_prefix(q), self.strip_prefix(v))

    def gap_deflection(self, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """Stretch of the springs before a stroke, and its rate, from the displacement of their ends."""
        return self.kind.gap_deflection(x, rate, self.strip_prefix(p))

    def loop_force(self, p: SimpleNamespace, q: SimpleNamespace) -> SX | None:
        """Force that a rotor's loop requests because of the element; None if none."""
        return self.kind.loop_force(self.strip_prefix(p), self.strip_prefix(q))

    def nonpotential_force(self, x: MovingLeg) -> dict[str, SX]:
        """Nonpotential terms of the element in the balance of coordinates, by name."""
        with wrap_hook_errors(self.kind, "pushes"):
            return self._prefixed(self.kind.nonpotential_force(self._seen_in(x)))

    def inertia(self, p: SimpleNamespace) -> dict[str, tuple[SX | float, SX | float]]:
        """Mass and damper without an energy."""
        return self._prefixed(self.kind.inertia(self.strip_prefix(p)))

    def input_power(self, x: MovingLeg) -> SX | None:
        """Power that enters by the element's nonpotential forces."""
        with wrap_hook_errors(self.kind, "given"):
            return self.kind.input_power(self._seen_in(x))

    def strip_prefix(self, names: SimpleNamespace) -> SimpleNamespace:
        """Names as the element uses them: its own without their prefix."""
        if not self.prefix:
            return names
        own = {name: getattr(names, f"{self.prefix}{name}", None) for name in self._own}
        return SimpleNamespace(**vars(names) | {name: value for name, value in own.items() if value is not None})

    def _seen_in(self, x: T) -> T:
        return (
            replace(x, p=self.strip_prefix(x.p), q=self.strip_prefix(x.q), v=self.strip_prefix(x.v))
            if self.prefix
            else x
        )

    @property
    def _own(self) -> set[str]:
        return {name for name, _ in (*self.kind.coordinates, *self.kind.parameters)}

    def _named(self, names: Named) -> Named:
        return tuple((f"{self.prefix}{name}", size) for name, size in names)

    def _prefixed(self, found: Mapping[str, Any]) -> dict[str, Any]:
        own = self._own if self.prefix else ()
        return {f"{self.prefix}{name}" if name in own else name: value for name, value in found.items()}
