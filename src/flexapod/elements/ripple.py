"""Cogging and ripple of a motor: a torque that returns with its turns, as a potential of the rotor, Eq. (T23.21)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from flexapod.elements.element import Contribution, Named, Physics, Standing
from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import cos, dot, vertcat
from flexapod.typing import Array

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flexapod.model import Leg

HARMONICS = 4  # at most


@dataclass(frozen=True)
class Rippling(Physics):
    """The ripple of a motor by the travel that it drives: angle of the first harmonic [rad/m], amplitudes (4,) [N]."""

    wave: float
    amplitudes: Array

    parameters: ClassVar[Named] = (("ripple_wave", 1), ("ripple", HARMONICS))

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a leg with a screw whose motor has a ripple."""
        screw = leg.screw
        return None if screw is None or not screw.wave else cls(screw.wave, screw.rippling)

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Its wave, and the energies [J] of its harmonics."""
        return {"ripple_wave": self.wave, "ripple": self.amplitudes / (self.wave * np.arange(1, HARMONICS + 1))}

    @classmethod
    def energy(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Energies:
        """Energy of the harmonics of the torque, of mean 0."""
        angle = p.ripple_wave * q.r
        return Energies(strain=dot(p.ripple, vertcat(*(1 - cos(k * angle) for k in range(1, HARMONICS + 1)))))

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """What it moves the rotor by at rest, against the spring of its loop, Eq. (T23.22)."""
        screw = leg.screw
        if screw is None or not screw.rippled:
            return ()
        how = "standard deviation over a period, against the loop's stiffness, legs independent"
        return (Contribution("ripple", "random", screw.rippled, how, stands=True),)
