"""Twist of the piston from its driven end to its tip, Eqs. (T13.7)-(T13.8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.symbolic.vocabulary import sqrt

if TYPE_CHECKING:
    from flexapod.model import Leg, Robot, Simulation


class Torsion(Physics):
    """Twist t of the piston along its length, as it stretches."""

    coordinates: ClassVar[Named] = (("t", 1),)
    parameters: ClassVar[Named] = (("GJ", 1),)  # N m^2

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Return False: `solve.shapes` adds it where a leg's chain meets the payload's attitude."""
        return False

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Twist t of a leg that closes no attitude: a ball does not twist it."""
        return () if standing.attitude else ("t",)

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Stiffness of a section."""
        return {"GJ": leg.piston.torsional_stiffness}

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of the twist t eta beside those of a piston that spins as a whole."""
        p, inertia, stiffness = x.p, x.p.piston_axial_inertia / 3, x.p.GJ / x.p.Lp
        spinning = 0.5 * p.piston_axial_inertia * x.cylinder.omega[2] * x.v.t
        rate = 2 * p.zeta * sqrt(inertia * stiffness) + p.damping_time * stiffness
        return Energies(
            kinetic=spinning + 0.5 * inertia * x.v.t**2,  # (T13.7)
            strain=0.5 * stiffness * x.q.t**2,
            dissipation=0.5 * rate * x.v.t**2,  # (T13.8)
        )
