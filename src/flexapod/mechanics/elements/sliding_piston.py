"""The flexible piston that slides out of its cylinder, Eqs. (T3.6)-(T3.15) and (T5.1)-(T5.6)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np

from flexapod.mechanics.elements.distribution import Distribution, PistonMotion, gravity_energy, kinetic_energy
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.symbolic.vocabulary import bilinear, constant, dot, quadratic, sqrt, vertcat, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


def sliding_piston(f: PistonMotion, p: SimpleNamespace) -> Energies:
    """Energies of the piston: its mass, its spin about the leg, bending and stretch."""
    body = _mass(f, p)
    spin = 0.5 * p.piston_axial_inertia * f.frame.omega[2] ** 2  # (T3.12)
    loss = _modal_damping(f, p) + p.damping_time * _strain_energy(f, p, f.vs)  # (T5.6)
    return Energies(
        kinetic=kinetic_energy(f, body) + spin,
        gravity=gravity_energy(f, body, p.gravity),
        strain=_strain_energy(f, p, f.qs),
        dissipation=loss,
    )


def _strain_energy(f: PistonMotion, p: SimpleNamespace, qs: SimpleNamespace) -> SX:
    """Bending of the free length and stretch of the whole piston, Eq. (T3.15); quadratic in the amplitudes ``qs``."""
    bending = quadratic(qs.a, f.a.stiffness) + quadratic(qs.b, f.b.stiffness)
    return 0.5 * p.EI / f.s**3 * bending + 0.5 * p.EA / p.Lp * quadratic(qs.c, f.axial.stiffness)


def _modal_damping(f: PistonMotion, p: SimpleNamespace) -> SX:
    """Equal damping ratio for every mode of the bare piston: Rayleigh function at fixed zeta, Eq. (T5.1)."""
    lateral = 2 * p.zeta * sqrt(p.EI * p.rhoA) / f.s  # (T5.3)
    axial = 2 * p.zeta * sqrt(p.EA * p.rhoA)  # (T5.3)
    bending = quadratic(f.vs.a, f.a.damping) + quadratic(f.vs.b, f.b.damping)
    return 0.5 * lateral * bending + 0.5 * axial * quadratic(f.vs.c, f.axial.damping)


def tip_place(f: PistonMotion) -> SX:
    """Tip (v(1), w(1), l + c_0 + e(1)) in leg coordinates, Eqs. (T3.11), (T25.1)."""
    straight = f.line.place + f.s * f.line.slope
    v, w = straight[0] + _at_tip(f.a.tip, f.qs.a), straight[1] + _at_tip(f.b.tip, f.qs.b)
    stretch = f.qs.c[0] if f.axial.count else zeros(1)
    return vertcat(v, w, f.qs.l + stretch + f.foreshortening("slope_tip") / f.s)


def tip_turn(f: PistonMotion) -> SX:
    """Rotation vector of the tip in leg coordinates to second order in the amplitudes, Eqs. (T13.10), (T25.7)."""
    v, w = _at_tip(f.a.tip_slope, f.qs.a) / f.s, _at_tip(f.b.tip_slope, f.qs.b) / f.s
    twist = f.qs.t if hasattr(f.qs, "t") else zeros(1)
    slope = f.line.slope
    carried = bilinear(f.qs.a, f.a.turn, f.qs.b) / (2 * f.s**2) + 0.5 * (slope[0] * w - slope[1] * v)
    v, w = slope[0] + v, slope[1] + w
    return vertcat(-w + 0.5 * twist * v, v + 0.5 * twist * w, twist + carried)


def _at_tip(values: np.ndarray | SX, amplitudes: SX) -> SX:
    if not isinstance(values, np.ndarray):
        return dot(values, amplitudes)
    return dot(constant(values).T, amplitudes) if len(values) else zeros(1)


def _mass(f: PistonMotion, p: SimpleNamespace) -> Distribution:
    """Uniform piston of length Lp whose outer part s bends, Eqs. (T3.9)-(T3.10)."""
    basis, axial, s, l, k = f.a, f.axial, f.s, f.qs.l, f.a.count  # noqa: E741
    inner, m = l - p.Lp, p.rhoA
    first, moment = constant(basis.first).T, constant(basis.moment).T
    p0, p1 = constant(axial.first).T, constant(axial.moment).T
    along = m * s * (p.mouth * first + s * moment) if k else zeros(0)
    bent = coupling(axial.series, basis.powers, s / p.Lp) if k and axial.count else zeros(2 * k, axial.count)
    short = m * f.foreshortening("slope_first")
    return Distribution(
        first=SimpleNamespace(
            one=m * p.Lp,
            X=m * (l**2 - inner**2) / 2,
            phi=m * s * first[:k] if k else zeros(0),
            sliding=m * s * first[k:] if k else zeros(0),
            psi=m * p.Lp * p0 if axial.count else zeros(0),
        ),
        moment=SimpleNamespace(
            one=m * (l**2 - inner**2) / 2,
            X=m * (l**3 - inner**3) / 3,
            phi=along[:k],
            sliding=along[k:],
            psi=m * p.Lp * (inner * p0 + p.Lp * p1) if axial.count else zeros(0),
        ),
        lateral_mass=m * s,
        phi_phi=basis.mass[:k, :k],
        phi_sliding=basis.mass[:k, k:],
        sliding_sliding=basis.mass[k:, k:],
        axial_mass=m * p.Lp,
        psi_psi=axial.mass,
        phi_psi=m * s * bent[:k, :],
        sliding_psi=m * s * bent[k:, :],
        short=short,
        short_X=p.mouth * short + m * s * f.foreshortening("slope_moment"),
    )


def coupling(series: np.ndarray, powers: np.ndarray, sigma: SX) -> SX:
    """Int Phi psi dzeta as polynomials in sigma = s/Lp: psi_n = sum_j c_nj (sigma (1 - zeta))^j, Eq. (T1.12)."""
    total = zeros(powers.shape[1], series.shape[0])
    for n, coefficients in enumerate(series):
        used = np.flatnonzero(np.abs(coefficients) > 1e-12)
        column, last = zeros(powers.shape[1], 1), used[-1] if used.size else 0
        for j in used[::-1]:  # Horner's scheme over the powers that occur
            column = column * sigma ** int(last - j) + constant(coefficients[j] * powers[j]).T
            last = j
        total[:, n] = column * sigma ** int(last)
    return total
