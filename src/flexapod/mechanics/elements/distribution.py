"""Mass along a sliding flexible leg: kinetic energy, weight, shear, Eqs. (T3.7)-(T3.10), (T3.14), (T3.23)-(T3.25).

Displacements and velocities of material points are fields: linear combinations of the functions 1, X, phi,
(1 - zeta) phi' and psi. X is the distance along the axis from the U joint; (1 - zeta) phi' carries the sliding,
because zeta_dot = (1 - zeta) l_dot / s at a fixed material point; psi are the axial shapes. A mass distribution
knows the inner products of these functions, so that the kinetic energy is a sum of quadratic forms of closed
integrals; foreshortening multiplies zero-order velocities and is added to second order. Thick pistons shear,
and their sections have rotary inertia (Timoshenko's beam).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics
from flexapod.mechanics.elements.frames import Energies, Frame
from flexapod.mechanics.shapes import AxialBasis, LateralBasis
from flexapod.mechanics.symbolic.vocabulary import bilinear, constant, dot, quadratic, time_derivative, vertcat, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation


def _none() -> SX:
    return zeros(0)


@dataclass(frozen=True, kw_only=True)
class PistonField:
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
    psi_psi: np.ndarray | SX
    phi_psi: SX
    sliding_psi: SX
    short: SX
    short_X: SX

    def integral(self, f: PistonField) -> SX:
        """Integral of a field over the mass, int f dm."""
        return _combine(self.first, f)

    def square(self, f: PistonField) -> SX:
        """Integral of the square of a field over the mass, int f^2 dm."""
        total = zeros(1)
        if f.one.numel():
            rest = PistonField(X=f.X, phi=f.phi, sliding=f.sliding, psi=f.psi)
            total += f.one * (f.one * self.first.one + 2 * _combine(self.first, rest))
        if f.X.numel():
            rest = PistonField(phi=f.phi, sliding=f.sliding, psi=f.psi)
            total += f.X * (f.X * self.moment.X + 2 * _combine(self.moment, rest))
        total += self.lateral_mass * (
            quadratic(f.phi, self.phi_phi)
            + 2 * bilinear(f.phi, self.phi_sliding, f.sliding)
            + quadratic(f.sliding, self.sliding_sliding)
        )
        total += self.axial_mass * quadratic(f.psi, self.psi_psi)
        return total + 2 * (bilinear(f.phi, self.phi_psi, f.psi) + bilinear(f.sliding, self.sliding_psi, f.psi))


def _combine(moments: SimpleNamespace, f: PistonField) -> SX:
    pairs = (
        (moments.one, f.one),
        (moments.X, f.X),
        (moments.phi, f.phi),
        (moments.sliding, f.sliding),
        (moments.psi, f.psi),
    )
    return sum((c.T @ m for m, c in pairs if c.numel()), zeros(1))


def bent_part(basis: LateralBasis, mass: SX, start: SX, step: SX, phi_psi: SX, sliding_psi: SX) -> Distribution:
    """Mass distribution added by bending of a straight uniform part, from X = start by step zeta, Eq. (T25.4).

    ``mass`` [kg] of the part; the last two as in `Distribution`. Its foreshortening is left to the caller.
    """
    k, none = basis.count, zeros(1)
    first, moment = mass * constant(basis.first).T, mass * constant(basis.moment).T
    along, still = start * first + step * moment, zeros(phi_psi.shape[1])
    return Distribution(
        first=SimpleNamespace(one=none, X=none, phi=first[:k], sliding=first[k:], psi=still),
        moment=SimpleNamespace(one=none, X=none, phi=along[:k], sliding=along[k:], psi=still),
        lateral_mass=mass,
        phi_phi=basis.mass[:k, :k],
        phi_sliding=basis.mass[:k, k:],
        sliding_sliding=basis.mass[k:, k:],
        axial_mass=none,
        psi_psi=np.zeros((phi_psi.shape[1],) * 2),
        phi_psi=phi_psi,
        sliding_psi=sliding_psi,
        short=none,
        short_X=none,
    )


def bending_mass(b: Any, axial: int) -> Distribution:
    """Mass distribution of a part of several sections from its integrals (`stepped_piston.SteppedShapes`)."""
    none, still = zeros(1), zeros(axial)
    return Distribution(
        first=SimpleNamespace(one=none, X=none, phi=b.phi, sliding=b.sliding, psi=still),
        moment=SimpleNamespace(one=none, X=none, phi=b.phi_X, sliding=b.sliding_X, psi=still),
        lateral_mass=constant(1.0),
        phi_phi=b.phi_phi,
        phi_sliding=b.phi_sliding,
        sliding_sliding=b.sliding_sliding,
        axial_mass=none,
        psi_psi=np.zeros((axial, axial)),
        phi_psi=b.phi_psi,
        sliding_psi=b.sliding_psi,
        short=none,
        short_X=none,
    )


@dataclass(frozen=True, kw_only=True)
class Line:
    """Straight line to which a piston's bending adds: displacement and slope (a, b) at the mouth, and their rates.

    ``mouth`` [m] from the base joint. Where nothing gives way there, it is the leg's axis.
    """

    mouth: SX
    place: SX = field(default_factory=lambda: zeros(2))
    slope: SX = field(default_factory=lambda: zeros(2))
    place_rate: SX = field(default_factory=lambda: zeros(2))
    slope_rate: SX = field(default_factory=lambda: zeros(2))

    def foot(self) -> SX:
        """Point (a, b) at which the line meets the plane of the base joint."""
        return self.place - self.mouth * self.slope

    def foot_rate(self, l_dot: SX) -> SX:
        """Velocity of points at the line's foot that move out with the piston, Eq. (T25.2)."""
        return self.place_rate - self.mouth * self.slope_rate + self.slope * l_dot


@dataclass(frozen=True, kw_only=True)
class PistonMotion:
    """A bending leg: its bases, the frame of its cylinder, free length s and coordinates, and the fields they make.

    ``a``, ``b``: `LateralBasis`, or what has its names for the present length (`stepped_piston.SteppedShapes`).
    """

    a: Any
    b: Any
    axial: AxialBasis
    frame: Frame
    line: Line
    s: SX
    q: SX
    v: SX
    qs: SimpleNamespace
    vs: SimpleNamespace

    def rate(self, expression: SX) -> SX:
        """Time derivative of an expression of coordinates."""
        return time_derivative(expression, (self.q, self.v))

    def velocity(self) -> tuple[PistonField, PistonField, PistonField]:
        """Velocity r_dot + omega x r in leg coordinates, without foreshortening, Eqs. (T3.7)-(T3.8), (T13.5)."""
        return self.bending(self.qs.a, self.qs.b, self.vs.a, self.vs.b, self.vs.l / self.s)

    def bending(self, a: SX, b: SX, a_rate: SX, b_rate: SX, r: SX) -> tuple[PistonField, PistonField, PistonField]:
        """Velocity of a part of the piston with amplitudes of its own, whose length grows at the rate ``r`` [1/s]."""
        q, v, u, line = self.qs, self.vs, self.frame.velocity, self.line
        w1, w2, w3 = self.frame.omega[0], self.frame.omega[1], self.frame.omega[2]
        foot, slope, tilt = line.foot(), line.slope, line.slope_rate
        moved, has_b = line.foot_rate(v.l), bool(b.numel())
        return (
            PistonField(
                one=u[0] + moved[0] - w3 * foot[1],
                X=w2 + tilt[0] - w3 * slope[1],
                phi=a_rate - w3 * b if has_b else a_rate,
                sliding=r * a,
                psi=w2 * q.c,
            ),
            PistonField(
                one=u[1] + moved[1] + w3 * foot[0],
                X=-w1 + tilt[1] + w3 * slope[0],
                phi=b_rate + w3 * a if has_b else b_rate,
                sliding=r * b,
                psi=-w1 * q.c,
            ),
            PistonField(
                one=v.l + u[2] + w1 * foot[1] - w2 * foot[0],
                X=w1 * slope[1] - w2 * slope[0],
                phi=w1 * b - w2 * a if has_b else -w2 * a,
                psi=v.c,
            ),
        )

    def foreshortening(self, kind: str) -> SX:
        """-1/2 (a^T G a + b^T G b) with the named slope integral, Eq. (T3.9)."""
        return -0.5 * (quadratic(self.qs.a, getattr(self.a, kind)) + quadratic(self.qs.b, getattr(self.b, kind)))


def kinetic_energy(f: PistonMotion, body: Distribution) -> SX:
    """Kinetic energy to second order in the amplitudes, Eqs. (T3.10) and (T13.5)."""
    square = sum((body.square(component) for component in f.velocity()), zeros(1))
    return 0.5 * square + shortening_energy(f, f.vs.l, body.short, body.short_X)


def shortening_energy(f: PistonMotion, along: SX, short: SX, short_X: SX) -> SX:
    """Part of a foreshortening, int e dm and int X e dm, in the kinetic energy of mass that slides out at a rate."""
    w, u = f.frame.omega, f.frame.velocity
    turning = (w[0] ** 2 + w[1] ** 2) * short_X + (w[1] * u[0] - w[0] * u[1]) * short
    return turning + (along + u[2]) * f.rate(short)


def gravity_energy(f: PistonMotion, body: Distribution, gravity: SX) -> SX:
    """- int g . r dm with the foreshortening's fall, Eq. (T3.14)."""
    height = body.integral(PistonField(X=constant(1), psi=f.qs.c)) + body.short
    foot, slope = f.line.foot(), f.line.slope
    moment = vertcat(
        body.integral(PistonField(one=foot[0], X=slope[0], phi=f.qs.a)),
        body.integral(PistonField(one=foot[1], X=slope[1], phi=f.qs.b)),
        height,
    )
    return f.frame.weight(gravity, body.first.one, moment)


class RotaryInertia(Physics):
    """Sections of a piston that stays straight, as they turn with the leg; of one that bends it is `rotary_energy`."""

    parameters: ClassVar[Named] = (("piston_turning", 2),)  # kg m^2

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of a leg whose piston is modelled with shear; None of others."""
        return cls() if leg.piston.shear else None

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether pistons have no shapes of bending, and some leg has the element."""
        return not simulation.lateral_shapes and super().in_kernel(robot, simulation)

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Rotary inertia of the whole piston."""
        return {"piston_turning": leg.piston.rotary_inertia}

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Kinetic energy of rotation about leg y and x, Eq. (T3.25) without a slope."""
        w, whole = x.cylinder.omega, x.p.piston_turning
        return Energies(kinetic=0.5 * whole[0] * w[1] ** 2 + 0.5 * whole[1] * w[0] ** 2)


def shear_energy(f: PistonMotion, qs: SimpleNamespace) -> SX:
    """Strain energy of the slopes by shear, Eq. (T3.24)."""
    return 0.5 / f.s * (quadratic(qs.a, f.a.shear_stiffness) + quadratic(qs.b, f.a.shear_stiffness))


def rotary_energy(f: PistonMotion, p: SimpleNamespace) -> SX:
    """Kinetic energy of sections that turn with the leg and with the slope of bending, Eq. (T3.25)."""
    w, slide = f.frame.omega, f.vs.l / f.s
    return _turning(f, f.vs.a, slide * f.qs.a, w[1], p.piston_turning[0]) + _turning(
        f, f.vs.b, slide * f.qs.b, -w[0], p.piston_turning[1]
    )


def _turning(f: PistonMotion, rate: SX, slid: SX, spin: SX, whole: SX) -> SX:
    """Rotary energy of one direction, half of int rho I (spin + d/dt dv/dX)^2 dX."""
    b, by = f.a, 1 / f.s  # dv/dX = - turn^T a / s
    along = dot(b.turned, rate) + dot(b.turned_slid, slid)
    square = quadratic(rate, b.turn_turn) + 2 * dot(rate, b.turn_slid @ slid) + quadratic(slid, b.slid_slid)
    return 0.5 * whole * spin**2 - by * spin * along + 0.5 * by**2 * square
