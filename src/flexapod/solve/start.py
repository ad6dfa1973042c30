"""Consistent starts: impact, accelerations and multipliers, the integrator's start values, Eqs. (T6.10)-(T6.14)."""

from dataclasses import dataclass, replace

import numpy as np

from flexapod.integration import GeneralizedAlpha
from flexapod.solve.equilibrium import saddle_solve
from flexapod.solve.many import RestStates, matrices_at_rest
from flexapod.solve.system import Matrices, RobotSystem, State
from flexapod.solve.tables import Commands
from flexapod.typing import Array

FOLLOWED = 0.03  # of a step, 1 over a rate: what vibrates five times in a step is not followed at all, slower parts are


@dataclass(frozen=True, kw_only=True)
class Start:
    """Consistent initial state, its auxiliary acceleration ``a`` (N,), and the energy step of the impact [J]."""

    state: State
    a: Array
    impact: float


def consistent_start(
    system: RobotSystem, state: State, commands: Commands, method: GeneralizedAlpha, h: float
) -> Start:
    """Make a configuration that satisfies the closures a start of the time integration with step ``h`` [s].

    Velocities are projected on the constraints in the mass metric (an impact, if the command jumps in rate);
    accelerations and multipliers solve the equations of motion; the integrator's start values follow Arnold, Bruls &
    Cardona (2015).
    """
    m = system.matrices(state, commands.wrench[0])
    moving, impact = _impact(system, state, m, commands)
    now = accelerations(system, moving, commands, 0)
    jerk = _resolved(m, _jerk(system, now, commands, h), h)
    a = now.v_dot + method.delta * h * jerk  # (T6.13)
    v = now.v + method.velocity_defect * h**2 * normal_velocity(system, m, jerk)  # (T6.14)
    a[system.strokes] = now.v_dot[system.strokes]
    return Start(state=replace(now, v=v), a=a, impact=impact)


def _impact(system: RobotSystem, x: State, m: Matrices, commands: Commands) -> tuple[State, float]:
    """Velocities after the projection, Eq. (T6.10), and the step of kinetic energy [J]."""
    target = np.concatenate([np.zeros(18), commands.rate[0][system.held]])
    gap = target - m.G @ x.v
    if np.abs(gap).max() < 1e-12:
        return x, 0.0
    step, _ = saddle_solve(m.M, m.G, np.zeros(system.size), gap)
    v = x.v + step
    v[system.strokes] = commands.rate[0][system.held]
    return replace(x, v=v), float(0.5 * v @ m.M @ v - 0.5 * x.v @ m.M @ x.v)


def accelerations(system: RobotSystem, x: State, commands: Commands, k: int) -> State:
    """Accelerations, joint forces and drive forces at a consistent state, Eq. (T6.11); ``k`` is the table row."""
    rest = replace(x, v_dot=np.zeros(system.size), lam=np.zeros((6, 3)), drive=np.zeros(6))
    rows = system.command(rest, commands.length[k], commands.rate[k], commands.force[k])
    r, _ = system.residual(rest, rows, commands.wrench[k])
    m = system.matrices(x, commands.wrench[k])
    curvature = np.concatenate([_constraint_curvature(system, x), commands.accel[k][system.held]])
    v_dot, multipliers = saddle_solve(m.M, m.G, -r, curvature)
    v_dot[system.strokes] = commands.accel[k][system.held]
    drive = np.zeros(6)
    drive[system.held] = -multipliers[18:]
    return replace(x, v_dot=v_dot, lam=multipliers[:18].reshape(6, 3), drive=drive)


def _constraint_curvature(system: RobotSystem, x: State, step: float = 1e-4) -> Array:
    """- d(G)/dt v of the closures, (18,), by a fourth-order central difference of the exact Jacobian."""
    if not x.v.any():
        return np.zeros(18)

    t, k = step * np.array([1.0, -1.0, 2.0, -2.0]), 6 * system.n
    legs, payload = x.v[:k].reshape(6, -1), x.v[k:]
    here = RestStates(**{name: np.repeat(getattr(x, name)[None], 4, axis=0) for name in ("q", "pose", "lam", "drive")})
    m = matrices_at_rest(system, here.moved(t[:, None, None] * legs, t[:, None] * payload), np.zeros(6))
    rate = ((m.J @ legs[..., None])[..., 0] - m.P @ payload).reshape(4, 18)
    return -(8 * (rate[0] - rate[1]) - (rate[2] - rate[3])) / (12 * step)


def _jerk(system: RobotSystem, x: State, commands: Commands, h: float) -> Array:
    """Time derivative of the accelerations at the start, (N,), by a one-sided difference over a small time."""
    t = min(1e-3 * h, 1e-6)
    ahead = system.moved(x, t * x.v + 0.5 * t**2 * x.v_dot)
    ahead = replace(ahead, v=x.v + t * x.v_dot)
    later = accelerations(system, ahead, commands.at(t), 0)
    return (later.v_dot - x.v_dot) / t


def _resolved(m: Matrices, jerk: Array, h: float) -> Array:
    """The jerk without what steps of ``h`` cannot follow, Eq. (T6.25): light parts are quasi-static to them."""
    left, t = jerk, FOLLOWED * h
    for _ in range(2):
        left = left - saddle_solve(m.M + t * m.D + t**2 * m.K, m.G, m.M @ left, m.G @ left)[0]
    return jerk - left


def normal_velocity(system: RobotSystem, m: Matrices, vector: Array) -> Array:
    """Part of a rate (N,) normal to the closures in the mass metric, over the integrated coordinates, Eq. (T6.14).

    For a velocity this is the part that violates the closures' rates, prescribed strokes included.
    """
    free = np.setdiff1d(np.arange(system.size), system.strokes)
    part, _ = saddle_solve(m.M[np.ix_(free, free)], m.G[:18, free], np.zeros(len(free)), m.G[:18] @ vector)
    normal = np.zeros_like(vector)
    normal[free] = part
    return normal
