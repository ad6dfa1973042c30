"""A rotor that drives a stroke through springs in series: screw, nut, bearing, brackets, Eqs. (T15.5), (T15.11)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics, SeriesSprings
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.springs import Spring, series_stiffness, softening, springs_before_stroke

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg


@dataclass(frozen=True)
class DriveTrain(Physics):
    """The springs between the travel r of a rotor and the stroke l, and what turns with the rotor."""

    springs: Sequence[Spring]

    coordinates: ClassVar[Named] = (("r", 1),)
    follows: ClassVar[Mapping[str, str]] = {"r": "l"}
    parameters: ClassVar[Named] = (
        ("series_stiffness", 1),  # N/m, at home
        ("series_softening", 2),  # 1/m, 1/m^2: how the compliance grows with the length there
        ("series_home", 1),  # m, length at home
        ("series_damping", 1),  # N s/m
        ("rotor_mass", 1),  # kg, by the stroke
        ("rotor_stiffness", 1),  # N/m, between command and r
        ("rotor_damping", 1),  # N s/m
    )

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the drive train of a leg with springs between drive and piston; None of others."""
        return cls(springs_before_stroke(leg)) if leg.gives else None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Springs in series at home, and the rotor with its servo."""
        stiffness, damping = series_stiffness(self.springs, standing.length, standing.per_loss)
        found: dict[str, Any] = {"series_stiffness": stiffness, "series_damping": damping}
        found |= {"series_home": standing.length, "series_softening": softening(self.springs, standing.length)}
        if (screw := leg.screw) is not None:
            found["rotor_mass"] = screw.inertia / screw.per_turn**2  # (T15.12)
            found["rotor_stiffness"], found["rotor_damping"] = screw.loop_spring
        return found

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Travel r where it is prescribed: without a rotor, a servo's spring being in series, or of a held rotor."""
        return ("r",) if leg.drive.holds or leg.screw is None else ()

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of rotor, springs and servo; the springs' compliance is a polynomial in l, as a shaft's is."""
        p, q, v = x.p, x.q, x.v
        s = SeriesSprings(stretching(p, q.l), q.l, v.l)
        for element in x.elements:
            s = element.in_series(s, p, q, v)
        stiffness = p.series_stiffness / s.softer  # (T15.5)
        stretch, rate = q.r - s.nut, v.r - s.rate
        for element in x.elements:
            stretch, rate = element.gap_deflection(stretch, rate, p)
        return Energies(
            kinetic=0.5 * p.rotor_mass * v.r**2,  # (T15.12)
            strain=0.5 * stiffness * stretch**2,  # (T15.11)
            dissipation=0.5 * p.series_damping * rate**2,
        )


def stretching(p: SimpleNamespace, stroke: SX) -> SX:
    """Compliance of the springs before a stroke over that at home, without oil."""
    away = stroke - p.series_home
    return 1 + away * (p.series_softening[0] + away * p.series_softening[1])


def twisting(p: SimpleNamespace, stroke: SX) -> SX:
    """Share kappa of a shaft's twist in the compliance before the stroke, Eq. (T19.12)."""
    return (p.drive_friction_twist[0] + p.drive_friction_twist[1] * (stroke - p.series_home)) / stretching(p, stroke)
