"""Shear of a thick piston and the rotary inertia of its sections (Timoshenko's beam), Eqs. (T3.23)-(T3.25)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.distribution import PistonMotion
from flexapod.mechanics.elements.element import Along, Named, Physics, Standing
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.symbolic.vocabulary import dot, quadratic

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation


class RotaryInertia(Physics):
    """Sections of a piston that stays straight, as they turn with the leg; of one that bends it is `rotary_energy`."""

    parameters: ClassVar[Named] = (("piston_turning", 2),)  # kg m^2

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a piston that would shear."""
        return cls() if leg.piston.shear else None

    @classmethod
    def among(cls, robot: Robot, simulation: Simulation) -> bool:
        """Where pistons have no shapes of bending."""
        return not simulation.lateral_shapes and super().among(robot, simulation)

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Inertia of the whole."""
        return {"piston_turning": leg.piston.rotary_inertia}

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energy of a turn about leg y and x, Eq. (T3.25) of no slope."""
        w, whole = x.cylinder.omega, x.p.piston_turning
        return Energies(kinetic=0.5 * whole[0] * w[1] ** 2 + 0.5 * whole[1] * w[0] ** 2)


def shear_energy(f: PistonMotion, qs: SimpleNamespace) -> SX:
    """Of the slopes by shear, Eq. (T3.24)."""
    return 0.5 / f.s * (quadratic(qs.a, f.a.shear_stiffness) + quadratic(qs.b, f.a.shear_stiffness))


def rotary_energy(f: PistonMotion, p: SimpleNamespace) -> SX:
    """Kinetic energy of sections that turn with the leg and with the slope of bending, Eq. (T3.25)."""
    w, slide = f.frame.omega, f.vs.l / f.s
    return _turning(f, f.vs.a, slide * f.qs.a, w[1], p.piston_turning[0]) + _turning(
        f, f.vs.b, slide * f.qs.b, -w[0], p.piston_turning[1]
    )


def _turning(f: PistonMotion, rate: SX, slid: SX, spin: SX, whole: SX) -> SX:
    """Of one direction: half of int rho I (spin + d/dt dv/dX)^2 dX."""
    b, by = f.a, 1 / f.s  # dv/dX = - turn^T a / s
    along = dot(b.turned, rate) + dot(b.turned_slid, slid)
    square = quadratic(rate, b.turn_turn) + 2 * dot(rate, b.turn_slid @ slid) + quadratic(slid, b.slid_slid)
    return 0.5 * whole * spin**2 - by * spin * along + 0.5 * by**2 * square
