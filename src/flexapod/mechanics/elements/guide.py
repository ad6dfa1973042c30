"""A piston in two bushings: at the cylinder's mouth (gland) and at the piston's inner end (head), Eqs. (T25.1)-(T25.8).

Both parts of the piston are beams clamped to a line through the gland: the outer one as without a guide, the inner one
with shapes of its own towards the head.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from flexapod.mechanics.elements.distribution import (
    Distribution,
    PistonField,
    PistonMotion,
    bending_mass,
    bent_part,
    shortening_energy,
)
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.sliding_piston import coupling
from flexapod.mechanics.elements.stepped_piston import SteppedShapes
from flexapod.mechanics.shapes import LateralBasis
from flexapod.mechanics.symbolic.vocabulary import SX, bilinear, constant, dot, quadratic, reshape, sqrt, vertcat, zeros


def shortening(f: PistonMotion, p: SimpleNamespace, inner: LateralBasis | None, from_base: SX) -> tuple[SX, SX, SX]:
    """Foreshortening e by a line that leans, the inner part and the cylinder, Eq. (T25.5).

    ``from_base``: of the cylinder up to the head. Returns e of the tip, int e dm, int X e dm over the whole piston.
    """
    slope, s, m, l = f.line.slope, f.s, p.mouth, f.qs.l  # noqa: E741
    d, square = m - (l - p.Lp), dot(f.line.slope, f.line.slope)
    k = f.a.count
    tip, mean, first = (_both(f, slope, x) for x in (f.a.tip, f.a.first[:k], f.a.moment[:k]))
    at_tip = -0.5 * (square * s + 2 * tip)
    outer = -0.5 * (square * s**2 / 2 + 2 * s * mean)
    outer_X = m * outer - 0.5 * (square * s**3 / 3 + 2 * s**2 * first)
    at_gland, inside, below = -0.5 * square * d, -0.25 * square * d**2, -square * d**3 / 12
    if inner is not None and inner.count:
        n, D = inner.count, p.guide_reach - l
        tip, mean, first = (_along(f, slope, x) for x in (inner.tip, inner.first[:n], inner.moment[:n]))
        G, G1, G2 = (_bent(f, x) for x in (inner.slope_tip, inner.slope_first, inner.slope_moment))
        at_gland += tip - 0.5 * G / D
        inside += D * (tip - mean) - 0.5 * (G - G1)
        below += D**2 * (0.5 * tip - first) - 0.5 * D * (0.5 * G - G2)
    at_gland += from_base
    inside += from_base * d
    below += from_base * d**2 / 2
    whole = inside + at_gland * s + outer
    whole_X = m * inside - below + at_gland * (m * s + s**2 / 2) + outer_X
    return at_gland + at_tip, p.rhoA * whole, p.rhoA * whole_X


def stepped_shortening(
    f: PistonMotion, p: SimpleNamespace, inner: SteppedShapes | None, from_base: SX
) -> tuple[SX, SX, SX]:
    """`shortening` of a piston of several sections, by its moments and those of its shapes, Eq. (T25.18)."""
    slope, head, mass = f.line.slope, f.qs.l - p.Lp, p.rhoA * p.Lp
    first, second, square = mass * p.piston_moments[0], mass * p.piston_moments[1], dot(slope, slope)
    tip, short = from_base - 0.5 * square * p.Lp, from_base * mass - 0.5 * square * first
    along = head * mass + first
    short_X = from_base * along - 0.5 * square * (head * first + second)
    if f.a.count:
        tip -= _both(f, slope, f.a.tip)
        short, short_X = short - _both(f, slope, f.a.phi), short_X - _both(f, slope, f.a.phi_X)
    if inner is not None and inner.count:
        end = _along(f, slope, inner.tip) - 0.5 * _bent(f, inner.slope_tip) / (p.guide_reach - f.qs.l)
        tip += end
        short += mass * end - _along(f, slope, inner.phi) + 0.5 * _bent(f, inner.slope_first)
        short_X += along * end - _along(f, slope, inner.phi_X) + 0.5 * _bent(f, inner.slope_moment)
    return tip, short, short_X


def lean(f: PistonMotion, p: SimpleNamespace, short: SX, short_X: SX) -> Energies:
    """Energies of the foreshortening of `shortening`; the piston's mass on the line is with the piston."""
    return Energies(
        kinetic=shortening_energy(f, f.vs.l, short, short_X),
        gravity=f.frame.weight(p.gravity, zeros(1), vertcat(zeros(2), short)),
    )


def inner_part(f: PistonMotion, p: SimpleNamespace, basis: LateralBasis) -> Energies:
    """Energies of the bending of the piston between head and gland."""
    if not basis.count:
        return Energies()
    k, D, m = basis.count, p.guide_reach - f.qs.l, p.guide_rhoA
    phi_psi = zeros(2 * k, f.axial.count)
    if f.axial.count:
        phi_psi = m * D * coupling(f.axial.from_inside, basis.powers, D / p.Lp)
    body = bent_part(basis, m * D, p.mouth, -D, phi_psi[:k, :], phi_psi[k:, :])
    stiff, loss = p.guide_EI / D**3, 2 * p.zeta * sqrt(p.guide_EI * m) / D
    return _moving(f, p, body, D) + Energies(
        strain=0.5 * stiff * _bent(f, basis.stiffness),  # (T25.6)
        dissipation=0.5 * loss * _bent(f, basis.damping, rates=True)
        + 0.5 * p.damping_time * stiff * _bent(f, basis.stiffness, rates=True),
    )


def stepped_inner_part(f: PistonMotion, p: SimpleNamespace, shapes: SteppedShapes) -> Energies:
    """Energies of the bending between head and gland of a piston of several sections."""
    if not shapes.count:
        return Energies()
    D, k = p.guide_reach - f.qs.l, shapes.count
    return _moving(f, p, bending_mass(shapes, f.axial.count), D) + Energies(
        strain=0.5 / D**3 * _bent(f, shapes.stiffness),
        dissipation=0.5 / D * _bent(f, reshape(p.inner_damping, k, k), rates=True)
        + 0.5 * p.damping_time / D**3 * _bent(f, shapes.stiffness, rates=True),
    )


def _moving(f: PistonMotion, p: SimpleNamespace, body: Distribution, D: SX) -> Energies:
    q, v = f.qs, f.vs
    moving = f.bending(q.ha, q.hb, v.ha, v.hb, -v.l / D)  # (T25.3)
    sideways = vertcat(body.integral(PistonField(phi=q.ha)), body.integral(PistonField(phi=q.hb)), zeros(1))
    return Energies(
        kinetic=0.5 * sum((body.square(component) for component in moving), zeros(1)),
        gravity=f.frame.weight(p.gravity, zeros(1), sideways),
    )


def bushings(f: PistonMotion, p: SimpleNamespace, head: SX, head_rate: SX) -> Energies:
    """Springs and dampers of gland and head; ``head``: the piston's inner end from the cylinder there (a, b)."""
    gland, gland_rate = (vertcat(x.ga[0], x.gb[0]) for x in (f.qs, f.vs))
    k, c = p.guide_stiffness, p.guide_damping
    return Energies(
        strain=0.5 * (k[0] * dot(gland, gland) + k[1] * dot(head, head)),  # (T25.6)
        dissipation=0.5 * (c[0] * dot(gland_rate, gland_rate) + c[1] * dot(head_rate, head_rate)),
    )


def inner_end(f: PistonMotion, p: SimpleNamespace, basis: LateralBasis | SteppedShapes) -> SX:
    """Place of the piston's inner end across the leg (a, b), Eq. (T25.1)."""
    bent = [dot(constant(basis.tip).T, x) if basis.count else zeros(1) for x in (f.qs.ha, f.qs.hb)]
    return f.line.place - (p.guide_reach - f.qs.l) * f.line.slope + vertcat(*bent)


def inner_turn(f: PistonMotion, p: SimpleNamespace, basis: LateralBasis | SteppedShapes) -> SX:
    """Rotation of the tip about the leg by the inner part's bending in two planes, Eq. (T25.7)."""
    if not basis.count:
        return zeros(1)
    D, slope = p.guide_reach - f.qs.l, f.line.slope
    v, w = (dot(_column(basis.tip_slope), x) / D for x in (f.qs.ha, f.qs.hb))
    return 0.5 * (slope[0] * w - slope[1] * v) - bilinear(f.qs.ha, basis.turn, f.qs.hb) / (2 * D**2)


def _both(f: PistonMotion, slope: SX, values: Any) -> SX:
    return _dots(slope, values, f.qs.a, f.qs.b)


def _along(f: PistonMotion, slope: SX, values: Any) -> SX:
    return _dots(slope, values, f.qs.ha, f.qs.hb)


def _dots(slope: SX, values: Any, a: SX, b: SX) -> SX:
    """Slope times amplitudes in both directions."""
    column = _column(values)
    return sum((slope[i] * dot(column, x) for i, x in enumerate((a, b)) if x.numel()), zeros(1))


def _column(values: Any) -> SX:
    return values if isinstance(values, SX) else constant(values).T


def _bent(f: PistonMotion, matrix: object, rates: bool = False) -> SX:
    x = f.vs if rates else f.qs
    return quadratic(x.ha, matrix) + quadratic(x.hb, matrix)  # type: ignore[arg-type]
