"""A cylinder that bends: a uniform beam from base joint to mouth, with what is mounted on it, Eqs. (T25.9)-(T25.13).

The leg's frame follows its tangent at the base joint. Its mass as a straight body is with the rigid cylinder.
"""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
from numpy.polynomial import Polynomial

from flexapod.bases import LateralBasis, axial_basis
from flexapod.elements.distribution import (
    Line,
    Motion,
    bent_part,
    gravity_energy,
    kinetic_energy,
    shortening_energy,
)
from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import SX, constant, cross, dot, quadratic, sqrt, vertcat, zeros


@dataclass(frozen=True, kw_only=True)
class Bend:
    """Bending of a cylinder of some length as polynomials of the distance from the base joint.

    ``along`` (2): coefficients of the slopes times the length in powers of X / length, by direction a, b; ``mouth``,
    ``tangent`` (2): displacement and slope at the mouth.
    """

    length: SX
    along: tuple[SX, SX]
    mouth: SX
    tangent: SX

    def place(self, X: SX) -> SX:
        """Displacement (a, b)."""
        u = X / self.length
        return vertcat(*(u * _horner([c[i] / (i + 1) for i in range(c.numel())], u) for c in self.along))

    def slope(self, X: SX) -> SX:
        """Slope (a, b)."""
        u = X / self.length
        return vertcat(*(_horner([c[i] for i in range(c.numel())], u) for c in self.along)) / self.length

    def shortening(self, X: SX) -> SX:
        """-1/2 int (y_a'^2 + y_b'^2) dX from the base joint, Eq. (T25.11)."""
        u, count = X / self.length, self.along[0].numel()
        powers = [zeros(1) for _ in range(2 * count - 1)]
        for c in self.along:
            for i in range(count):
                for j in range(count):
                    powers[i + j] += c[i] * c[j] / (i + j + 1)
        return -0.5 * u * _horner(powers, u) / self.length


def _horner(coefficients: list[SX], u: SX) -> SX:
    total = zeros(1)
    for c in coefficients[::-1]:
        total = total * u + c
    return total


def bend(basis: LateralBasis, p: SimpleNamespace, qs: SimpleNamespace) -> Bend:
    """Bending from the amplitudes, or its rate from theirs."""
    slopes = [shape.series.deriv().convert(kind=Polynomial).coef for shape in basis.shapes]  # type: ignore[attr-defined]
    table = np.zeros((basis.count, max(len(c) for c in slopes)))
    for row, c in zip(table, slopes, strict=True):
        row[: len(c)] = np.where(np.abs(c) < 1e-12 * np.abs(c).max(), 0.0, c)
    mouth, tangent = (vertcat(*(constant(x) @ k for k in (qs.ka, qs.kb))) for x in (basis.tip, basis.tip_slope))
    return Bend(
        length=p.cylinder_length,
        along=(constant(table).T @ qs.ka, constant(table).T @ qs.kb),
        mouth=mouth,
        tangent=tangent / p.cylinder_length,
    )


def flexible_cylinder(f: Motion, basis: LateralBasis, p: SimpleNamespace, now: Bend, rate: Bend) -> Energies:
    """Energies of the bending and of its masses; ``f``: motion of the piston, ``now`` and ``rate`` as of `bend`."""
    still = SimpleNamespace(l=zeros(1), c=zeros(0))
    qs, vs = (SimpleNamespace(**vars(still) | {"a": x.ka, "b": x.kb}) for x in (f.qs, f.vs))
    L, m = p.cylinder_length, p.cylinder_rhoA
    own = replace(f, a=basis, b=basis, axial=axial_basis(0), line=Line(mouth=zeros(1)), s=L, qs=qs, vs=vs)
    short = m * own.foreshortening("slope_first")
    none = zeros(basis.count, 0)
    body = replace(
        bent_part(basis, m * L, zeros(1), L, none, none),
        short=short,
        short_X=m * L * own.foreshortening("slope_moment"),
    )
    stiff, loss = p.cylinder_EI / L**3, 2 * p.zeta * sqrt(p.cylinder_EI * m) / L
    return _mounted(own, p, now, rate) + Energies(
        kinetic=kinetic_energy(own, body),
        gravity=gravity_energy(own, body, p.gravity),
        strain=0.5 * stiff * _both(qs, basis.stiffness),  # (T25.9)
        dissipation=0.5 * loss * _both(vs, basis.damping) + 0.5 * p.damping_time * stiff * _both(vs, basis.stiffness),
    )


def _both(x: SimpleNamespace, matrix: np.ndarray) -> SX:
    return quadratic(x.a, matrix) + quadratic(x.b, matrix)


def _mounted(f: Motion, p: SimpleNamespace, now: Bend, rate: Bend) -> Energies:
    """What the bending adds to a body on the cylinder: its centre is displaced, and it turns with the slope there."""
    m, J, X = p.mounted_mass, p.mounted_inertia, p.mounted_com
    w, u = f.frame.omega, f.frame.velocity
    y, y_dot, slope, tilt = now.place(X), rate.place(X), now.slope(X), rate.slope(X)
    straight = vertcat(u[0] + w[1] * X, u[1] - w[0] * X, u[2])
    more = vertcat(y_dot[0] - w[2] * y[1], y_dot[1] + w[2] * y[0], w[0] * y[1] - w[1] * y[0])
    short = m * now.shortening(X)
    theta, turn = vertcat(-slope[1], slope[0], zeros(1)), vertcat(-tilt[1], tilt[0], zeros(1))
    spin = w - cross(theta, w - 0.5 * cross(theta, w)) + turn - 0.5 * cross(theta, turn)  # (T13.11)
    turning = 0.5 * J * (dot(spin[:2], spin[:2]) - dot(w[:2], w[:2]))
    return Energies(
        kinetic=m * (dot(straight, more) + 0.5 * dot(more, more))
        + turning
        + shortening_energy(f, zeros(1), short, X * short),
        gravity=f.frame.weight(p.gravity, zeros(1), vertcat(m * y, short)),
    )
