"""Twist of the piston from its driven end to its tip, Eqs. (T13.7)-(T13.8)."""

from __future__ import annotations

from types import SimpleNamespace

from flexapod.elements.frame import Energies, Frame
from flexapod.symbolic.vocabulary import sqrt


def torsion(frame: Frame, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Energies of the twist t eta beside those of a piston that spins as a whole."""
    inertia, stiffness = p.piston_axial_inertia / 3, p.GJ / p.Lp
    spinning = 0.5 * p.piston_axial_inertia * frame.omega[2] * vs.t
    rate = 2 * p.zeta * sqrt(inertia * stiffness) + p.damping_time * stiffness
    return Energies(
        kinetic=spinning + 0.5 * inertia * vs.t**2,  # (T13.7)
        strain=0.5 * stiffness * qs.t**2,
        dissipation=0.5 * rate * vs.t**2,  # (T13.8)
    )
