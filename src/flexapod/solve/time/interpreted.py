"""The time loop in NumPy with dense linear algebra: readable twin of ``native/march.c``, used without a compiler."""

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.kinematics.rotations import displace_pose
from flexapod.solve.system import Flow, System
from flexapod.solve.time.native import MAX_ITERATIONS, TOL_CLOSURE, TOL_FORCE, Advance
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.start import normal_velocity, solve_constrained


def _row(system: System, x: Flow, table: Array, wrench: Array) -> Array:
    """Output row of the present state; see `recording.Recording`."""
    r, gaps, _ = system.residual(x, table, wrench)
    energy, force = system.energies(x, table)
    reaction = np.where(system.hub_held, r[-6:], 0.0) if system.hub else np.zeros(6)
    closure, rubs, stored = np.array([np.abs(gaps).max(initial=0.0)]), np.zeros(0), 0.0
    if system.kernel.shapes.bristles:
        friction = system.friction(x)
        rubs, stored = friction.force, friction.energies[:, 1].sum()
    energy, sums = energy + np.array([0.0, 0.0, stored]), x.sums - np.array([stored, 0.0, 0.0, 0.0])
    parts = [x.q, x.v, x.v_dot, x.lam, force, x.pose, reaction, energy, sums, closure, rubs]
    return np.concatenate([p.ravel() for p in parts])


def first_record(system: System, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Output row of the start, and the flow with its powers set."""
    flow = replace(flow, powers=system.residual(flow, table[0], wrench[0])[2])
    if system.kernel.shapes.bristles:
        flow = replace(flow, bristles=system.friction(flow).state)
    return flow, _row(system, flow, table[0], wrench[0])[None, :]


def advance(
    system: System,
    method: GeneralizedAlpha,
    flow: Flow,
    h: float,
    tables: tuple[Array, Array],
    every: int,
    counters: Counters,
    before: Advance | None = None,
) -> Advance:
    """Advance by the rows of ``tables``, recording each ``every`` steps; see `native.advance`."""
    rows, x, steps = [], flow.copy(), list(zip(*tables, strict=True))
    for t, (table, wrench) in enumerate(steps[1:], start=1):
        new = _step(system, method, x, h, table, wrench, counters)
        if new is None:
            return Advance(flow=x, rows=np.array(rows), status=1, step=t - 1, leg=-1)
        x = new
        if t % every == 0:
            rows.append(_row(system, x, table, wrench))
    return Advance(flow=x, rows=np.array(rows), status=0, step=len(steps) - 1, leg=-1)


def _predict(system: System, method: GeneralizedAlpha, x: Flow, h: float, table: Array) -> tuple[Flow, Array]:
    """Predictor with the old acceleration, Eqs. (T6.1)-(T6.3); held coordinates follow their table."""
    a = (x.v_dot - method.alpha_m * x.a) / (1 - method.alpha_m)
    step = h * x.v + h**2 * ((0.5 - method.beta) * x.a + method.beta * a)
    v, v_dot = x.v + h * ((1 - method.gamma) * x.a + method.gamma * a), x.v_dot.copy()
    q, held = x.q + system.by_leg(step), system.enforced_mask[:, system.ports]
    for part, column in ((q, 0), (v, 1), (v_dot, 2), (a, 2)):
        legs = part if part is q else system.by_leg(part)
        legs[:, system.ports] = np.where(held, table[:, :, column], legs[:, system.ports])
    step = step[system.legs * system.n :]
    return replace(x, q=q, v=v, v_dot=v_dot, a=a, pose=displace_pose(x.pose, step) if system.hub else x.pose), step


def _step(
    system: System, method: GeneralizedAlpha, old: Flow, h: float, table: Array, wrench: Array, counters: Counters
) -> Flow | None:
    k, c_q, c_v = system.legs * system.n, 1 / (method.beta * h**2), method.gamma / (method.beta * h)
    c_a = (1 - method.alpha_m) / (1 - method.alpha_f) * c_q
    x, turn = _predict(system, method, old, h, table)
    for iteration in range(MAX_ITERATIONS + 1):
        r, g, powers = system.residual(x, table, wrench, h)
        r[k:][system.fixed_mask[k:]] = 0.0
        force = max(1.0, np.abs(x.lam).max(initial=0.0), np.abs(x.drive).max(initial=0.0))
        tolerable = TOL_FORCE * force + system.force_floor
        balance = r if system.tie is None else system.tie.T @ r
        worst = max(np.abs(balance).max() / tolerable, np.abs(g).max(initial=0.0) / TOL_CLOSURE)
        done = worst <= 1 or (iteration == MAX_ITERATIONS and worst < 100)
        if not np.isfinite(worst) or (iteration == MAX_ITERATIONS and not done):
            break
        m = system.matrices(x, wrench)
        A = c_a * m.M + c_v * m.D + m.K
        if system.kernel.shapes.bristles:
            for i, D in enumerate(system.friction_matrix(x, h)):
                A[i * system.n : (i + 1) * system.n, i * system.n : (i + 1) * system.n] += c_v * D
        counters.iterations += 1
        counters.factorisations += 1
        try:
            dq, dlam = solve_constrained(system, A, m.G, -r, -g)
        except ComputationError:
            break
        own = system.by_leg(r + A @ dq + m.G.T @ dlam)
        turn = turn + dq[k:]
        x = replace(
            x,
            q=x.q + system.by_leg(dq),
            v=x.v + c_v * dq,
            v_dot=x.v_dot + c_a * dq,
            a=x.a + c_q * dq,
            lam=x.lam + dlam.reshape(x.lam.shape),
            drive=x.drive + np.where(system.enforced_mask, own, 0.0)[:, system.ports],
            pose=displace_pose(old.pose, turn) if system.hub else x.pose,
        )
        if done:  # after a last correction: index 3 magnifies what is left
            counters.steps += 1
            bent = system.friction(x, h).state if system.kernel.shapes.bristles else x.bristles
            return replace(x, sums=x.sums + 0.5 * h * (old.powers + powers), powers=powers, bristles=bent)
    return None


def scaled_defect(system: System, flow: Flow, ratio: float) -> Flow:
    """Flow of a robot whose velocities normal to the closures are ``ratio`` times those of ``flow``, Eq. (T6.14)."""
    m = system.matrices(flow, np.zeros(system.load_size))
    return replace(flow, v=flow.v + (ratio - 1) * normal_velocity(system, m, flow.v))
