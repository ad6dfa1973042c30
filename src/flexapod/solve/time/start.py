"""Consistent starts: impact, accelerations and multipliers, the integrator's start values, Eqs. (T6.10)-(T6.14)."""

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.saddle_point import saddle_solve
from flexapod.solve.system import Flow, Matrices, State, System
from flexapod.solve.time.command_tables import Law

FOLLOWED = 0.03  # of a step, 1 over a rate: what vibrates five times in a step is not followed at all, slower parts are


def consistent_start(
    system: System, state: State, law: Law, now: float, method: GeneralizedAlpha, h: float
) -> tuple[Flow, float]:
    """Make a configuration that satisfies the closures a start of the time integration with step ``h`` [s].

    Velocities are projected on the constraints in the mass metric (an impact, if the command jumps in rate);
    accelerations and multipliers solve the equations of motion; the integrator's start values follow Arnold, Bruls &
    Cardona (2015). Returned with the step of kinetic energy [J] of the impact.
    """
    table, wrench = (part[0] for part in law(np.array([now])))
    m = system.matrices(state, wrench)
    moving, impact = _impact(system, state, m, table)
    x = accelerations(system, moving, table, wrench)
    parts = {name: getattr(x, name) for name in ("q", "pose", "v_dot", "lam", "drive", "bristles")}
    if not x.bristles.size:
        parts["bristles"] = np.zeros((system.legs, 2 * system.kernel.shapes.bristles))
    if h == 0:
        return Flow(v=x.v, a=x.v_dot, **parts), impact
    jerk = _jerk(system, x, law, now, h)
    if system.hub:
        jerk = _resolved(system, m, jerk, h)
    a = np.where(system.fixed_mask, x.v_dot, x.v_dot + method.delta * h * jerk)  # (T6.13)
    v = x.v + method.velocity_defect * h**2 * normal_velocity(system, m, jerk)  # (T6.14)
    return Flow(v=v, a=a, **parts), impact


def _given(system: System, table: Array, column: int) -> Array:
    """Rates (column 1) or accelerations (2) of the coordinates that are held, (size,); zero elsewhere."""
    given = np.zeros(system.size)
    system.by_leg(given)[:, system.ports] = table[:, :, column]
    return np.where(system.fixed_mask, given, 0.0)


def solve_constrained(system: System, A: Array, G: Array, r: Array, g: Array) -> tuple[Array, Array]:
    """Solve A x + G^T lam = r, G x = g for the coordinates that are not fixed; x is zero for those that are."""
    free, x, tie = ~system.fixed_mask, np.zeros(system.size), system.independent
    if tie is not None:  # what legs share is one coordinate
        y, lam = saddle_solve(tie.T @ A @ tie, G @ tie, tie.T @ r, g)
        return tie @ y, lam
    x[free], lam = saddle_solve(A[np.ix_(free, free)], G[:, free], r[free], g)
    return x, lam


def _impact(system: System, x: State, m: Matrices, table: Array) -> tuple[State, float]:
    """Velocities after the projection, Eq. (T6.10), and the step of kinetic energy [J]."""
    jump = np.where(system.fixed_mask, _given(system, table, 1) - x.v, 0.0)
    gap = -m.G @ (x.v + jump)
    if np.abs(np.concatenate([jump, gap])).max() < 1e-12:
        return x, 0.0
    step, _ = solve_constrained(system, m.M, m.G, -m.M @ jump, gap)
    v = np.where(system.fixed_mask, _given(system, table, 1), x.v + step)
    return replace(x, v=v), float(0.5 * v @ m.M @ v - 0.5 * x.v @ m.M @ x.v)


def accelerations(system: System, x: State, table: Array, wrench: Array, h: float = 0.0) -> State:
    """Accelerations, closure forces and forces of held coordinates at a consistent state, Eq. (T6.11).

    ``h`` [s]: time since the bristles of its friction were as they are said to be.
    """
    given = _given(system, table, 2)
    rest = replace(x, v_dot=given, lam=np.zeros_like(x.lam), drive=np.zeros_like(x.drive))
    r, _, _ = system.residual(rest, table, wrench, h)
    m = system.matrices(x, wrench)
    step, lam = solve_constrained(system, m.M, m.G, -r, _constraint_curvature(system, x) - m.G @ given)
    found = replace(rest, v_dot=given + step, lam=lam.reshape(x.lam.shape))
    own = system.by_leg(system.residual(found, table, wrench, h)[0])
    return replace(found, drive=np.where(system.enforced_mask, own, 0.0)[:, system.ports])


def _constraint_curvature(system: System, x: State) -> Array:
    """- d(G)/dt v of the closures, (legs * rows,), by a fourth-order central difference of the exact Jacobian."""
    if not x.v.any() or not system.rows:
        return np.zeros(x.lam.size)

    step, legs = 1e-4, system.by_leg(x.v)
    t, payload = step * np.array([1.0, -1.0, 2.0, -2.0]), x.v[legs.size :]
    here = RestStates(**{name: np.repeat(getattr(x, name)[None], 4, axis=0) for name in ("q", "pose", "lam", "drive")})
    m = matrices_at_rest(system, here.displace(t[:, None, None] * legs, t[:, None] * payload), np.zeros(6))
    rate = ((m.J @ legs[..., None])[..., 0] - m.P @ payload).reshape(4, -1)
    return -(8 * (rate[0] - rate[1]) - (rate[2] - rate[3])) / (12 * step)


def _jerk(system: System, x: State, law: Law, now: float, h: float) -> Array:
    """Time derivative of the accelerations at the start, (size,), by a one-sided difference over a small time."""
    t = min(1e-3 * h, 1e-6)
    ahead = system.displace(x, t * x.v + 0.5 * t**2 * x.v_dot)
    table, wrench = (part[0] for part in law(np.array([now + t])))
    later = accelerations(system, replace(ahead, v=x.v + t * x.v_dot), table, wrench, t)
    return (later.v_dot - x.v_dot) / t


def _resolved(system: System, m: Matrices, jerk: Array, h: float) -> Array:
    """The jerk without what steps of ``h`` cannot follow, Eq. (T6.25): light parts are quasi-static to them."""
    left, t = jerk, FOLLOWED * h
    A = m.M + t * m.D + t**2 * m.K
    for _ in range(2):
        given = np.where(system.fixed_mask, left, 0.0)
        rest = left - given
        part, _ = solve_constrained(system, A, m.G, m.M @ left - A @ given, m.G @ rest)
        left = rest - part
    return jerk - left


def normal_velocity(system: System, m: Matrices, vector: Array) -> Array:
    """Part of a rate (size,) normal to the closures in the mass metric, over the integrated coordinates, Eq. (T6.14).

    For a velocity this is the part that violates the closures' rates, held coordinates included.
    """
    return solve_constrained(system, m.M, m.G, np.zeros(system.size), m.G @ vector)[0]
