"""Kinetic energy of mass along a sliding flexible leg from closed integrals, Eqs. (T3.7)-(T3.10).

Displacements and velocities of material points are fields: linear combinations of the functions 1, X, phi,
(1 - zeta) phi' and psi. X is the distance along the axis from the U joint; (1 - zeta) phi' carries the sliding, because
zeta_dot = (1 - zeta) l_dot / s at a fixed material point; psi are the axial shapes. A mass distribution knows the inner
products of these functions, so that the kinetic energy is a sum of quadratic forms; foreshortening multiplies
zero-order velocities and is added to second order.
"""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from flexapod.mechanics.layout import Shapes
from flexapod.symbolic.vocabulary import SX, bilinear, constant, quadratic, time_derivative, zeros


def _none() -> SX:
    return zeros(0)


@dataclass(frozen=True, kw_only=True)
class Field:
    """Coefficients of a field on (1, X, phi, (1 - zeta) phi', psi); empty where absent."""

    one: SX = field(default_factory=_none)
    X: SX = field(default_factory=_none)
    phi: SX = field(default_factory=_none)
    sliding: SX = field(default_factory=_none)
    psi: SX = field(default_factory=_none)


@dataclass(frozen=True, kw_only=True)
class Distribution:
    """Inner products int f g dm of the field functions and the mass moments of the foreshortening e, Eq. (T3.9).

    ``first`` and ``moment`` hold int f dm and int X f dm by function; ``phi_phi``, ``phi_sliding``, ``sliding_sliding``
    are numeric matrices to be multiplied by ``lateral_mass``, ``psi_psi`` by ``axial_mass``; ``phi_psi`` gives the
    coupling matrices (phi, psi) and (sliding, psi). ``short`` = int e dm, ``short_X`` = int X e dm.
    """

    first: SimpleNamespace
    moment: SimpleNamespace
    lateral_mass: SX
    phi_phi: np.ndarray
    phi_sliding: np.ndarray
    sliding_sliding: np.ndarray
    axial_mass: SX
    psi_psi: np.ndarray
    phi_psi: SX
    sliding_psi: SX
    short: SX
    short_X: SX

    def integral(self, f: Field) -> SX:
        """Int f dm."""
        return _combine(self.first, f)

    def square(self, f: Field) -> SX:
        """Int f^2 dm."""
        total = zeros(1)
        if f.one.numel():
            rest = Field(X=f.X, phi=f.phi, sliding=f.sliding, psi=f.psi)
            total += f.one * (f.one * self.first.one + 2 * _combine(self.first, rest))
        if f.X.numel():
            rest = Field(phi=f.phi, sliding=f.sliding, psi=f.psi)
            total += f.X * (f.X * self.moment.X + 2 * _combine(self.moment, rest))
        total += self.lateral_mass * (
            quadratic(f.phi, self.phi_phi)
            + 2 * bilinear(f.phi, self.phi_sliding, f.sliding)
            + quadratic(f.sliding, self.sliding_sliding)
        )
        total += self.axial_mass * quadratic(f.psi, self.psi_psi)
        return total + 2 * (bilinear(f.phi, self.phi_psi, f.psi) + bilinear(f.sliding, self.sliding_psi, f.psi))


def _combine(moments: SimpleNamespace, f: Field) -> SX:
    pairs = (
        (moments.one, f.one),
        (moments.X, f.X),
        (moments.phi, f.phi),
        (moments.sliding, f.sliding),
        (moments.psi, f.psi),
    )
    return sum((c.T @ m for m, c in pairs if c.numel()), zeros(1))


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Coordinates of a leg, its angular velocity in leg coordinates, and the fields they make."""

    shapes: Shapes
    s: SX
    q: SX
    v: SX
    qs: SimpleNamespace
    vs: SimpleNamespace
    omega: SX

    def velocity(self) -> tuple[Field, Field, Field]:
        """Velocity r_dot + omega x r in leg coordinates, without foreshortening, Eqs. (T3.7)-(T3.8)."""
        q, v, r = self.qs, self.vs, self.vs.l / self.s
        w1, w2, w3 = self.omega[0], self.omega[1], self.omega[2]
        has_b = bool(q.b.numel())
        return (
            Field(X=w2, phi=v.a - w3 * q.b if has_b else v.a, sliding=r * q.a, psi=w2 * q.c),
            Field(X=-w1, phi=v.b + w3 * q.a if has_b else v.b, sliding=r * q.b, psi=-w1 * q.c),
            Field(one=v.l, phi=w1 * q.b - w2 * q.a if has_b else -w2 * q.a, psi=v.c),
        )

    def foreshortening(self, kind: str) -> SX:
        """-1/2 (a^T G a + b^T G b) with the named slope integral, Eq. (T3.9)."""
        a, b = self.shapes.a, self.shapes.b
        return -0.5 * (quadratic(self.qs.a, getattr(a, kind)) + quadratic(self.qs.b, getattr(b, kind)))


def kinetic_energy(f: Motion, body: Distribution) -> SX:
    """Kinetic energy to second order in the amplitudes, Eq. (T3.10)."""
    square = sum((body.square(component) for component in f.velocity()), zeros(1))
    spin = f.omega[0] ** 2 + f.omega[1] ** 2
    return 0.5 * square + spin * body.short_X + f.vs.l * time_derivative(body.short, (f.q, f.v))


def piston(f: Motion, p: SimpleNamespace) -> Distribution:
    """Uniform piston of length Lp whose outer part s bends, Eqs. (T3.9)-(T3.10)."""
    basis, axial, s, l, k = f.shapes.a, f.shapes.axial, f.s, f.qs.l, f.shapes.a.count  # noqa: E741
    inner, m = l - p.Lp, p.rhoA
    first, moment = constant(basis.first).T, constant(basis.moment).T
    p0, p1 = constant(axial.first).T, constant(axial.moment).T
    along = m * s * (p.mouth * first + s * moment) if k else zeros(0)
    coupling = _coupling(axial.series, basis.powers, s / p.Lp) if k and axial.count else zeros(2 * k, axial.count)
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
        phi_psi=m * s * coupling[:k, :],
        sliding_psi=m * s * coupling[k:, :],
        short=short,
        short_X=p.mouth * short + m * s * f.foreshortening("slope_moment"),
    )


def tip_body(f: Motion, p: SimpleNamespace) -> Distribution:
    """Point mass at the tip: the same functions at zeta = eta = 1, Eq. (T3.10)."""
    basis, axial, l, k = f.shapes.a, f.shapes.axial, f.qs.l, f.shapes.a.count  # noqa: E741
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


def _coupling(series: np.ndarray, powers: np.ndarray, sigma: SX) -> SX:
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
