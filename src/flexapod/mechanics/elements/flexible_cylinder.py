"""A cylinder that bends: a uniform beam from base joint to mouth, with what is mounted on it, Eqs. (T25.9)-(T25.13).

The leg's frame follows its tangent at the base joint. Its mass as a straight body is with the rigid cylinder. The force
of a piston's head makes a kink in its curvature, Eqs. (T25.19)-(T25.21).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from flexapod.mechanics.elements.distribution import (
    Distribution,
    Line,
    PistonField,
    PistonMotion,
    bending_mass,
    gravity_energy,
    shortening_energy,
)
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.kink import LEAST, kink, polynomials
from flexapod.mechanics.elements.steps import law
from flexapod.mechanics.shapes import LateralBasis, axial_basis
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    constant,
    cross,
    diagcat,
    dot,
    horzcat,
    quadratic,
    sqrt,
    taylor_series,
    vertcat,
    zeros,
)

_TINY = 1e-18  # under the root of |x|: its derivative is not 0 / 0


@dataclass(frozen=True, kw_only=True)
class Bend:
    """Smooth bending of a cylinder of some length as polynomials of the distance from the base joint.

    ``along`` (2): coefficients of the slopes times the length in powers of X / length, by direction a, b.
    """

    length: SX
    along: tuple[list[SX], list[SX]]

    def place(self, X: SX) -> SX:
        """Displacement of the cylinder's axis at X (a, b)."""
        u = X / self.length
        return vertcat(*(u * law([c / (i + 1) for i, c in enumerate(row)], u) for row in self.along))

    def slope(self, X: SX) -> SX:
        """Slope of the cylinder's axis at X (a, b)."""
        return vertcat(*(law(row, X / self.length) for row in self.along)) / self.length

    def shortening(self, X: SX) -> SX:
        """-1/2 int (y_a'^2 + y_b'^2) dX from the base joint, Eq. (T25.11)."""
        u, count = X / self.length, len(self.along[0])
        powers = [zeros(1) for _ in range(2 * count - 1)]
        for row in self.along:
            for i in range(count):
                for j in range(count):
                    powers[i + j] += row[i] * row[j] / (i + j + 1)
        return -0.5 * u * law(powers, u) / self.length


@dataclass(frozen=True, kw_only=True)
class Kinked:
    """Bending of a cylinder on which the piston's head presses: smooth up to there, and a cubic more from there on.

    ``eta``: place of the head over the length; ``rise`` (a, b): amplitude of the cubic.
    """

    smooth: Bend
    eta: SX
    rise: SX

    def place(self, X: SX) -> SX:
        """Sum of the smooth part as of `Bend` and of the cubic beyond the head (a, b)."""
        return self.smooth.place(X) + self.rise * self._past(X) ** 3 / 6

    def slope(self, X: SX) -> SX:
        """Sum of the smooth part as of `Bend` and of the cubic beyond the head (a, b)."""
        return self.smooth.slope(X) + self.rise * self._past(X) ** 2 / (2 * self.smooth.length)

    def shortening(self, X: SX) -> SX:
        """Foreshortening as of `Bend`; terms of the cubic by parts, with derivatives of the smooth slope at X."""
        u, z = X / self.smooth.length, self._past(X)
        more = dot(self.rise, self.rise) * z**5 / 20
        for rise, row in zip((self.rise[0], self.rise[1]), self.smooth.along, strict=True):
            weight = z**3 / 3
            for n in range(len(row)):
                more += rise * weight * law(row, u)
                row, weight = [i * c for i, c in enumerate(row)][1:], -weight * z / (4 + n)
        return self.smooth.shortening(X) - 0.5 * more / self.smooth.length

    def _past(self, X: SX) -> SX:
        return _positive(X / self.smooth.length - self.eta)


@dataclass(frozen=True, kw_only=True)
class Head:
    """Contact of the piston's head with the cylinder, and the shape with a kink there, Eqs. (T25.19)-(T25.20).

    ``eta``: place of the kink over the length; ``table``: what depends on it, by the names of `kink`; ``stiffness`` is
    that of the kinked shape, ``share`` and ``rise`` are what it has of the others and of the cubic.
    ``present``: symbols for what depends on the stroke alone, and what to put for them, as of `symbolic.expanded`.
    """

    eta: SX
    table: SimpleNamespace
    present: tuple[SX, SX]


def mouth(basis: LateralBasis, p: SimpleNamespace, qs: SimpleNamespace) -> tuple[SX, SX]:
    """Displacement and slope (a, b) at the mouth from the amplitudes, or their rates; the kinked shape has neither."""
    smooth = [k[: basis.count] for k in (qs.ka, qs.kb)]
    place, tangent = (vertcat(*(constant(x) @ k for k in smooth)) for x in (basis.tip, basis.tip_slope))
    return place, tangent / p.cylinder_length


def head(basis: LateralBasis, p: SimpleNamespace, l: SX) -> Head:  # noqa: E741
    """Contact of the head at the present length of the leg; behind the base joint a cylinder is straight."""
    place, polys = (l - p.Lp) / p.cylinder_length, kink(basis)
    eta = 1 - LEAST - _positive(1 - 2 * LEAST - _positive(place - LEAST))
    between, x = eta * (1 - eta), 2 * eta - 1
    at = {name: vertcat(*(law(row, x) if row else zeros(1) for row in rows)) for name, rows in polys.items()}
    at |= {"rise": between**-2, "share": between**-2 * at["share"], "stiffness": at["stiffness"] / between}
    at["turn_slid_slid"] /= between
    near, present = taylor_series([eta, *at.values()], l)
    return Head(eta=near[0], table=SimpleNamespace(**dict(zip(at, near[1:], strict=True))), present=present)


def hole(basis: LateralBasis, p: SimpleNamespace, f: PistonMotion, at: Head) -> SX:
    """Displacement of the cylinder at the head (a, b)."""
    n = basis.count
    smooth = _bend(basis, p, f.qs.ka[:n], f.qs.kb[:n]).place(at.eta * p.cylinder_length)
    return smooth + at.table.seat * vertcat(f.qs.ka[n], f.qs.kb[n])


def _bend(basis: LateralBasis, p: SimpleNamespace, ka: SX, kb: SX) -> Bend:
    """Bending from the amplitudes of the shapes."""
    slopes = [shape.deriv().coef for shape in polynomials(basis)]
    table = np.zeros((basis.count, max(len(c) for c in slopes)))
    for row, c in zip(table, slopes, strict=True):
        row[: len(c)] = c
    along = (constant(table).T @ k for k in (ka, kb))
    return Bend(length=p.cylinder_length, along=tuple([c[i] for i in range(c.numel())] for c in along))  # type: ignore[arg-type]


def _positive(x: SX) -> SX:
    """Positive part of a number, smooth at 0."""
    return (x + sqrt(x**2 + _TINY)) / 2


def flexible_cylinder(f: PistonMotion, basis: LateralBasis, p: SimpleNamespace, at: Head | None) -> tuple[Energies, SX]:
    """Energies of the bending and of its masses, and how far the cylinder is drawn back at the head.

    ``f``: motion of the piston; ``at``: where its head presses, if it has one.
    """
    L, m, n = p.cylinder_length, p.cylinder_rhoA, basis.count
    still = SimpleNamespace(l=zeros(1), c=zeros(0))
    qs, vs = (SimpleNamespace(**vars(still) | {"a": x.ka, "b": x.kb}) for x in (f.qs, f.vs))
    body, turning = _sections(basis, p, at)
    own = replace(f, a=body, b=body, axial=axial_basis(0), line=Line(mouth=zeros(1)), s=L, qs=qs, vs=vs)
    short, short_X = m * own.foreshortening("slope_first"), m * L * own.foreshortening("slope_moment")
    mass, rate = replace(bending_mass(body, 0), short=short, short_X=short_X), zeros(1)
    bent = smooth = _bend(basis, p, qs.a[:n], qs.b[:n])
    stiffness, damping = constant(basis.stiffness), constant(basis.damping)
    if at is not None:
        rate, rise = f.rate(at.eta), at.table.rise * vertcat(qs.a[n], qs.b[n])
        smooth = _bend(basis, p, *(x[:n] - at.table.share * x[n] for x in (qs.a, qs.b)))
        bent = Kinked(smooth=smooth, eta=at.eta, rise=rise)
        stiffness = diagcat(stiffness, at.table.stiffness)
        damping = diagcat(damping, sqrt(at.table.stiffness * at.table.own[n]))  # of the kinked shape alone
    inside = _positive(f.qs.l - p.Lp) if at is None else at.eta * L
    moving = own.bending(qs.a, qs.b, vs.a, vs.b, rate)
    stiff, loss = p.cylinder_EI / L**3, 2 * p.zeta * sqrt(p.cylinder_EI * m) / L
    e = Energies(
        kinetic=0.5 * sum((mass.square(component) for component in moving), zeros(1))
        + shortening_energy(own, zeros(1), short, short_X)
        + _turning(own, turning, rate),
        gravity=gravity_energy(own, mass, p.gravity),
        strain=0.5 * stiff * _both(qs, stiffness),  # (T25.9)
        dissipation=0.5 * loss * _both(vs, damping) + 0.5 * p.damping_time * stiff * _both(vs, stiffness),
    )
    return e + _mounted(own, p, bent), smooth.shortening(inside)


def _sections(basis: LateralBasis, p: SimpleNamespace, at: Head | None) -> tuple[SimpleNamespace, Distribution]:
    """Integrals of the shapes' displacements by mass, and of their slopes by rotary inertia; a kink's last."""
    k, L, m = basis.count, p.cylinder_length, p.cylinder_rhoA
    body = {"phi": m * L * _column(basis.first[:k]), "phi_X": m * L**2 * _column(basis.moment[:k])}
    body |= {"phi_phi": m * L * constant(basis.mass[:k, :k])}
    turned = {"phi": p.cylinder_turning * _column(basis.tip), "phi_X": SX(k, 1)}
    turned |= {"phi_phi": p.cylinder_turning / L * constant(basis.slope_tip)}
    slopes = {name: constant(getattr(basis, name)) for name in ("slope_first", "slope_moment")}
    if at is not None:
        t = vars(at.table)
        slopes = {name: _bordered(value, t[name]) for name, value in slopes.items()}
        for of, name, first, square in (
            (body, "", m * L, m * L),
            (turned, "turn_", p.cylinder_turning, p.cylinder_turning / L),
        ):
            of["phi"] = vertcat(of["phi"], first * t[f"{name}first"])
            of["phi_X"] = vertcat(of["phi_X"], first * L * t[f"{name}moment"])
            of["sliding"] = vertcat(SX(k, 1), first * t[f"{name}slid_first"])
            of["sliding_X"] = vertcat(SX(k, 1), first * L * t[f"{name}slid_moment"])
            of["phi_phi"] = _bordered(of["phi_phi"], square * t[f"{name}own"])
            of["phi_sliding"] = horzcat(SX(k + 1, k), square * t[f"{name}slid"])
            of["sliding_sliding"] = diagcat(SX(k, k), square * t[f"{name}slid_slid"])
    still = {"sliding": SX(k, 1), "sliding_X": SX(k, 1), "phi_sliding": SX(k, k), "sliding_sliding": SX(k, k)}
    size = body["phi"].numel()
    along = {"phi_psi": zeros(size, 0), "sliding_psi": zeros(size, 0)}
    shown, turning = (SimpleNamespace(**still | along | of) for of in (body | slopes, turned))
    return shown, bending_mass(turning, 0)


def _column(values: np.ndarray) -> SX:
    return constant(values).T


def _bordered(matrix: SX, last: SX) -> SX:
    """Symmetric matrix with a last row and column."""
    return horzcat(vertcat(matrix, last[:-1].T), last)


def _both(x: SimpleNamespace, matrix: SX) -> SX:
    return quadratic(x.a, matrix) + quadratic(x.b, matrix)


def _turning(f: PistonMotion, turning: Distribution, rate: SX) -> SX:
    """Rotary energy of sections that turn with the slope, beyond that of a straight body, Eq. (T25.21)."""
    w, q, v = f.frame.omega, f.qs, f.vs
    about_a = PistonField(one=w[0], phi=-v.b - w[2] * q.a, sliding=-rate * q.b)
    about_b = PistonField(one=w[1], phi=v.a - w[2] * q.b, sliding=rate * q.a)
    along = PistonField(phi=w[0] * q.a + w[1] * q.b)
    return 0.5 * (turning.square(about_a) + turning.square(about_b) - turning.square(along))


def _mounted(f: PistonMotion, p: SimpleNamespace, now: Bend | Kinked) -> Energies:
    """Energies that bending adds to a body on the cylinder, which is displaced and turns with the slope."""
    m, J, X = p.mounted_mass, p.mounted_inertia, p.mounted_com
    w, u = f.frame.omega, f.frame.velocity
    y, slope = now.place(X), now.slope(X)
    y_dot, tilt = f.rate(y), f.rate(slope)
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
