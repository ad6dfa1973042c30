"""Shear of a thick piston and the rotary inertia of its sections (Timoshenko's beam), Eqs. (T3.23)-(T3.25)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

from flexapod.elements.distribution import PistonMotion
from flexapod.symbolic.vocabulary import dot, quadratic

if TYPE_CHECKING:
    from flexapod.symbolic.vocabulary import SX


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
