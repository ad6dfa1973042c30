"""The energies of the paper's section 2 as derived, (T9.2), a function each, and the equation that follows from them.

In amplitudes a of the eigenfunctions, u = phi^T a.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.mechanics import shapes
from flexapod.mechanics.symbolic.functions import Lagrangian, NamedFunction, inverse_dynamics
from flexapod.mechanics.symbolic.vocabulary import (
    constant,
    cos,
    jacobian,
    mtimes,
    quadratic,
    sin,
    substitute,
    symbol,
    vertcat,
    zeros,
)

SHAPES = 3  # of the paper
TIP_MASS = 0.5  # kg, ours: with Table 2's beam alone the lines about the tip mass would cost nothing


@dataclass(frozen=True, kw_only=True)
class BeamState:
    """Amplitudes, angle, length and their rates as symbols, with the beam's constants."""

    a: Any
    length: Any
    angle: Any
    a_dot: Any
    length_dot: Any
    angle_dot: Any
    basis: shapes.LateralBasis
    rho: float
    EI: float
    gravity: float

    @property
    def tip(self) -> Any:
        """Deflection of the tip, u(L)."""
        return weighted_sum(self.basis.tip, self.a)

    @property
    def tip_dot(self) -> Any:
        """Rate of the deflection of the tip, d/dt u(L(t), t)."""
        return weighted_sum(self.basis.tip, self.a_dot)


Line = Callable[[BeamState], Any]
Change = Callable[[BeamState], dict[str, Any]]


def beam_kinetic(p: BeamState) -> Any:
    """Eq. 4: 1/2 rho int (L' - u theta')^2 + (Du/Dt + x theta')^2 dx, with Du/Dt = u_t + L' u_x."""
    return modified_beam_kinetic(p, p.basis.mass, sliding=1.0)


def modified_beam_kinetic(p: BeamState, mass: Array, sliding: float) -> Any:
    """Energy of Eq. 4 with other integrals of the shapes, and with a share of what sliding adds."""
    rate = vertcat(p.a_dot, sliding * p.length_dot / p.length * p.a)
    k, turn = p.basis.count, p.angle_dot
    squares = quadratic_form(rate, mass) + turn**2 * quadratic_form(p.a, mass[:k, :k])
    mixed = turn * p.length * weighted_sum(p.basis.moment, rate) - turn * p.length_dot * weighted_sum(
        p.basis.first[:k], p.a
    )
    return 0.5 * p.rho * p.length * (squares + 2 * mixed)


def tip_kinetic(p: BeamState) -> Any:
    """Eq. 5: 1/2 m_e [(L^2 + u^2) theta'^2 + L'^2 + u'^2 + 2 theta' (L u' - L' u)]."""
    coupled = 2 * p.angle_dot * (p.length * p.tip_dot - p.length_dot * p.tip)
    return 0.5 * TIP_MASS * (p.tip**2 * p.angle_dot**2 + p.tip_dot**2 + coupled)


def strain(p: BeamState) -> Any:
    """Eq. 6: 1/2 EI int u_xx^2 dx."""
    return 0.5 * p.EI / p.length**3 * quadratic_form(p.a, p.basis.stiffness)


def weight(p: BeamState) -> Any:
    """Eq. 7, its elastic part: g cos(theta) [rho int u dx + m_e u_L]; the rest does not bend the beam."""
    first = weighted_sum(p.basis.first[: p.basis.count], p.a)
    return p.gravity * cos(p.angle) * (p.rho * p.length * first + TIP_MASS * p.tip)


def tension_of_beam(p: BeamState) -> Any:
    """Eq. 8, first part, with F_p of Eq. 9: 1/2 int F_p u_x^2 dx."""
    return 0.5 * p.angle_dot**2 * p.rho * p.length * quadratic_form(p.a, p.basis.slope_moment)


def tension_of_tip(p: BeamState) -> Any:
    """Eq. 8, second part, with F_e of Eq. 10: 1/2 F_e int u_x^2 dx."""
    return 0.5 * p.angle_dot**2 * TIP_MASS * quadratic_form(p.a, p.basis.slope_tip)


def thrust(p: BeamState) -> Any:
    """Axial loads of the weight: - g sin(theta) S; those of the feed vanish where L'' does, as in section 2.2."""
    shortening = p.rho * quadratic_form(p.a, p.basis.slope_first) + TIP_MASS / p.length * quadratic_form(
        p.a, p.basis.slope_tip
    )
    return -0.5 * p.gravity * sin(p.angle) * shortening


def weighted_sum(values: Array, x: Any) -> Any:
    """Sum of values times amplitudes."""
    return mtimes(constant(values), x)


def quadratic_form(x: Any, matrix: Array) -> Any:
    """Quadratic form x^T matrix x."""
    return quadratic(x, matrix)


KINETIC: dict[str, Line] = {"4": beam_kinetic, "5": tip_kinetic}
POTENTIAL: dict[str, Line] = {
    "6": strain, "7": weight, "8, beam": tension_of_beam, "8, tip": tension_of_tip, "9-10": thrust,
}  # fmt: skip


def matrices(change: Change, gravity: float) -> Any:
    """M, C, K and rest of the equation of the amplitudes by Eq. (T3.2), with some of the energies changed.

    A function of casadi's own, from L, L', theta, theta'.
    """
    beam, basis = model.preset("paper-actuator").actuator, shapes.lateral_basis("clamped-free", SHAPES)
    q, v, a_ddot = symbol("q", SHAPES + 2), symbol("v", SHAPES + 2), symbol("a_ddot", SHAPES)
    p = BeamState(a=q[:SHAPES], length=q[SHAPES], angle=q[SHAPES + 1], a_dot=v[:SHAPES], length_dot=v[SHAPES],
              angle_dot=v[SHAPES + 1], basis=basis, rho=beam.rhoA, EI=beam.EI, gravity=gravity)  # fmt: skip
    energies = {name: make(p) for name, make in (KINETIC | POTENTIAL).items()}
    energies |= change(p)
    found = Lagrangian(
        q=q, v=v, kinetic=sum((energies[name] for name in KINETIC), zeros(1)), dissipation=zeros(1),
        potential=sum((energies[name] for name in POTENTIAL), zeros(1)),
    )  # fmt: skip
    r = inverse_dynamics(found, vertcat(a_ddot, 0, 0))[:SHAPES]
    none = zeros(SHAPES)
    rest = substitute(r, (p.a, p.a_dot, a_ddot), (none, none, none))
    outputs = [("M", jacobian(r, a_ddot)), ("C", jacobian(r, p.a_dot)), ("K", jacobian(r, p.a)), ("rest", rest)]
    motion = [("L", p.length), ("L_dot", p.length_dot), ("angle", p.angle), ("angle_dot", p.angle_dot)]
    return NamedFunction("printed_line", motion, outputs).build()
