"""A body fixed to the tip of a leg that carries no payload, Eqs. (T3.10), (T3.13) and (T13.11)."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from flexapod.elements.distribution import Distribution, PistonMotion, gravity_energy, kinetic_energy
from flexapod.elements.frame import Energies
from flexapod.elements.sliding_piston import tip_turn
from flexapod.symbolic.vocabulary import SX, constant, cross, dot, zeros


def tip_body(f: PistonMotion, p: SimpleNamespace, planar: bool) -> Energies:
    """Energies of a point mass at the tip with the piston's slope, in space also of its turn about the leg."""
    body, theta = _mass(f, p), tip_turn(f)
    if planar:
        turning = p.tip_inertia * (f.frame.omega[1] + f.rate(theta[1])) ** 2  # (T3.13)
    else:
        w, rate = f.frame.omega, f.rate(theta)
        w = w - cross(theta, w - 0.5 * cross(theta, w)) + rate - 0.5 * cross(theta, rate)  # (T13.11)
        turning = p.tip_inertia * dot(w[:2], w[:2]) + p.tip_axial_inertia * w[2] ** 2
    return Energies(kinetic=kinetic_energy(f, body) + 0.5 * turning, gravity=gravity_energy(f, body, p.gravity))


def _mass(f: PistonMotion, p: SimpleNamespace) -> Distribution:
    """Point mass at the tip: the same functions at zeta = eta = 1, Eq. (T3.10)."""
    basis, axial, l, k = f.a, f.axial, f.qs.l, f.a.count  # noqa: E741
    m, at_tip, stretch = p.tip_mass, basis.tip, np.eye(axial.count, 1)
    none, still = np.zeros((k, k)), zeros(k)
    phi = constant(at_tip).T if k else zeros(0)
    psi = SX(stretch) if axial.count else zeros(0)
    short = m * f.foreshortening("slope_tip") / f.s
    return Distribution(
        first=SimpleNamespace(one=m, X=m * l, phi=m * phi, sliding=still, psi=m * psi),
        moment=SimpleNamespace(one=m * l, X=m * l**2, phi=m * l * phi, sliding=still, psi=m * l * psi),
        lateral_mass=m,
        phi_phi=np.outer(at_tip, at_tip),
        phi_sliding=none,
        sliding_sliding=none,
        axial_mass=m,
        psi_psi=stretch @ stretch.T,
        phi_psi=m * constant(np.outer(at_tip, stretch)) if k and axial.count else zeros(k, axial.count),
        sliding_psi=zeros(k, axial.count),
        short=short,
        short_X=l * short,
    )
