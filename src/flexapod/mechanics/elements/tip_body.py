"""A body fixed to the tip of a leg that carries no payload, Eqs. (T3.10), (T3.13) and (T13.11)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from flexapod.mechanics.elements.distribution import Distribution, PistonMotion, gravity_energy, kinetic_energy
from flexapod.mechanics.elements.element import Along, Named, Physics
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.sliding_piston import tip_turn
from flexapod.mechanics.symbolic.vocabulary import constant, cross, dot, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


class PlanarTipBody(Physics):
    """Tip body of the single actuator in its plane: a mass and an inertia with the piston's slope."""

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of a point mass, and kinetic energy of its rotation."""
        body = _mass(x.piston, x.p)
        kinetic = kinetic_energy(x.piston, body) + 0.5 * cls.turning(x.piston, x.p)
        return Energies(kinetic=kinetic, gravity=gravity_energy(x.piston, body, x.p.gravity))

    @classmethod
    def turning(cls, f: PistonMotion, p: SimpleNamespace) -> SX:
        """Twice the kinetic energy of its turn about itself."""
        return p.tip_inertia * (f.frame.omega[1] + f.rate(tip_turn(f)[1])) ** 2  # (T3.13)


class TipBody(PlanarTipBody):
    """Tip body of a leg in space, which also turns about the leg."""

    parameters: ClassVar[Named] = (("tip_axial_inertia", 1),)  # kg m^2

    @classmethod
    def turning(cls, f: PistonMotion, p: SimpleNamespace) -> SX:
        """Twice the kinetic energy of its turn about itself."""
        theta = tip_turn(f)
        w, rate = f.frame.omega, f.rate(theta)
        w = w - cross(theta, w - 0.5 * cross(theta, w)) + rate - 0.5 * cross(theta, rate)  # (T13.11)
        return p.tip_inertia * dot(w[:2], w[:2]) + p.tip_axial_inertia * w[2] ** 2


def _mass(f: PistonMotion, p: SimpleNamespace) -> Distribution:
    """Point mass at the tip: the same functions at zeta = eta = 1, Eq. (T3.10)."""
    basis, axial, l, k = f.a, f.axial, f.qs.l, f.a.count  # noqa: E741
    m, at_tip, stretch = p.tip_mass, basis.tip, np.eye(axial.count, 1)
    none, still = np.zeros((k, k)), zeros(k)
    phi = constant(at_tip).T if k else zeros(0)
    psi = constant(stretch) if axial.count else zeros(0)
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
