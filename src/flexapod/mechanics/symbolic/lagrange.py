"""Lagrange's equations by differentiation, Eqs. (T3.1)-(T3.3)."""

from dataclasses import dataclass

from flexapod.mechanics.symbolic.vocabulary import SX, gradient, jacobian, time_derivative


@dataclass(frozen=True, kw_only=True)
class Lagrangian:
    """Energies of a body in coordinates q and rates v."""

    q: SX
    v: SX
    kinetic: SX
    potential: SX
    dissipation: SX


def inverse_dynamics(e: Lagrangian, v_dot: SX) -> SX:
    """Residual M v_dot + h of the free body, without forces, Eq. (T3.2)."""
    p = gradient(e.kinetic, e.v)  # (T3.1)  p = dT/dv
    return (
        time_derivative(p, (e.q, e.v), (e.v, v_dot))  # (T3.2)  dp/dt
        - gradient(e.kinetic - e.potential, e.q)  #                - dL/dq
        + gradient(e.dissipation, e.v)  #                          + dR/dv
    )


def mass_matrix(e: Lagrangian) -> SX:
    """M = d2T/dv2, Eq. (T3.3)."""
    return jacobian(gradient(e.kinetic, e.v), e.v)
