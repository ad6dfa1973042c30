"""The time loop in NumPy with dense linear algebra: readable twin of ``native/march.c``, used without a compiler."""

from dataclasses import replace

import numpy as np

from flexapod.errors import ComputationError
from flexapod.integration import GeneralizedAlpha
from flexapod.rigid.rotations import turned
from flexapod.solve.equilibrium import saddle_solve
from flexapod.solve.native import MAX_ITERATIONS, TOL_CLOSURE, TOL_FORCE, Advance
from flexapod.solve.plant import TABLE, Counters, Flow, Plant
from flexapod.typing import Array


def _commands(plant: Plant, drive: Array, row: Array) -> Array:
    table = row.reshape(plant.legs, TABLE)
    return np.stack([table[:, 0], table[:, 1], table[:, 3] + drive[:, 0], table[:, 7] + drive[:, 1]], axis=1)


def _residual(plant: Plant, x: Flow, row: Array, wrench: Array) -> tuple[Array, Array, Array]:
    """Balance of every coordinate, closures, and the three powers."""
    k, n = plant.legs * plant.n, plant.n
    commands = _commands(plant, x.drive, row)
    parts = [
        plant.kernel.leg_residual(
            x.q[i], x.v[i * n : i * n + n], x.v_dot[i * n : i * n + n], x.lam[i], commands[i], plant.leg_p[i]
        )
        for i in range(plant.legs)
    ]
    r, powers = np.concatenate([p[0] for p in parts]), np.append(sum(p[2] for p in parts), 0.0)
    if not plant.robot:
        return r, np.zeros(0), powers
    rp, points, power = plant.kernel.payload_residual(x.pose, x.v[k:], x.v_dot[k:], x.lam, wrench, plant.payload_p)
    powers[2] = power[0]
    return np.concatenate([r, rp]), np.concatenate([p[1] for p in parts]) - points, powers


def _matrices(plant: Plant, x: Flow, wrench: Array, c_v: float, c_a: float, c_q: float) -> tuple[Array, Array]:
    """c_a M + c_v D + c_q K and closure Jacobian, Eq. (T6.5)."""
    N, n, k = plant.size, plant.n, plant.legs * plant.n
    A, G = np.zeros((N, N)), np.zeros((18 if plant.robot else 0, N))
    for i in range(plant.legs):
        M, D, K, J = plant.kernel.leg_matrices(x.q[i], x.lam[i], plant.leg_p[i])
        at = slice(i * n, i * n + n)
        A[at, at] = c_a * M + c_v * D + c_q * K
        if plant.robot:
            G[3 * i : 3 * i + 3, at] = J
    if plant.robot:
        M, K, P = plant.kernel.payload_matrices(x.pose, x.lam, wrench, plant.payload_p)
        A[k:, k:], G[:, k:] = c_a * M + c_q * K, -P
    return A, G


def _row(plant: Plant, x: Flow, row: Array, closure: float) -> Array:
    k, n = plant.legs * plant.n, plant.n
    commands = _commands(plant, x.drive, row)
    energy = sum(
        plant.kernel.leg_energies(x.q[i], x.v[i * n : i * n + n], commands[i], plant.leg_p[i])[0]
        for i in range(plant.legs)
    )
    if plant.robot:
        energy = energy + plant.kernel.payload_energies(x.pose, x.v[k:], plant.payload_p)[0]
    parts = [x.q, x.v, x.v_dot, x.lam, x.drive, x.pose, np.asarray(energy), x.sums, np.array([closure])]
    return np.concatenate([p.ravel() for p in parts])


def first_record(plant: Plant, flow: Flow, table: Array, wrench: Array) -> tuple[Flow, Array]:
    """Output row of the start, and the flow with its powers set."""
    _, g, powers = _residual(plant, flow, table[0], wrench[0])
    flow = replace(flow, powers=powers)
    return flow, _row(plant, flow, table[0], float(np.abs(g).max(initial=0.0)))[None, :]


def advance(
    plant: Plant,
    method: GeneralizedAlpha,
    flow: Flow,
    h: float,
    tables: tuple[Array, Array],
    every: int,
    counters: Counters,
) -> Advance:
    """Advance by the rows of ``tables``, recording each ``every`` steps; see `native.advance`."""
    rows, x = [], flow.copy()
    for t in range(1, len(tables[0])):
        new, closure = _step(plant, method, x, h, tables[0][t], tables[1][t], counters)
        if new is None:
            return Advance(flow=x, rows=np.array(rows), status=1, step=t - 1, leg=-1)
        x = new
        if t % every == 0:
            rows.append(_row(plant, x, tables[0][t], closure))
    return Advance(flow=x, rows=np.array(rows), status=0, step=len(tables[0]) - 1, leg=-1)


def _predict(plant: Plant, method: GeneralizedAlpha, x: Flow, h: float, row: Array) -> tuple[Flow, Array]:
    """Predictor with the old acceleration, Eqs. (T6.1)-(T6.3); held coordinates follow their table."""
    k = plant.legs * plant.n
    a = (x.v_dot - method.alpha_m * x.a) / (1 - method.alpha_m)
    step = h * x.v + h**2 * ((0.5 - method.beta) * x.a + method.beta * a)
    v, v_dot = x.v + h * ((1 - method.gamma) * x.a + method.gamma * a), x.v_dot.copy()
    q = x.q + step[:k].reshape(x.q.shape)
    l_index = plant.kernel.shapes.l_index
    for i, t in enumerate(row.reshape(plant.legs, TABLE)):
        for held, column, at in ((plant.held_l, l_index, 0), (plant.held_beta, l_index - 1, 4)):
            if held[i]:
                j = i * plant.n + column
                q[i, column], v[j], v_dot[j], a[j] = t[at], t[at + 1], t[at + 2], t[at + 2]
    pose = turned(x.pose, step[k:]) if plant.robot else x.pose
    return replace(x, q=q, v=v, v_dot=v_dot, a=a, pose=pose), step[k:]


def _step(
    plant: Plant, method: GeneralizedAlpha, old: Flow, h: float, row: Array, wrench: Array, counters: Counters
) -> tuple[Flow | None, float]:
    k, c_q, c_v = plant.legs * plant.n, 1 / (method.beta * h**2), method.gamma / (method.beta * h)
    c_a = (1 - method.alpha_m) / (1 - method.alpha_f) * c_q
    x, turn = _predict(plant, method, old, h, row)
    held = np.eye(plant.size)[plant.held]
    for iteration in range(MAX_ITERATIONS + 1):
        r, g, powers = _residual(plant, x, row, wrench)
        force = max(1.0, np.abs(x.lam).max(initial=0.0), np.abs(x.drive).max(initial=0.0))
        worst = max(np.abs(r).max() / (TOL_FORCE * force + plant.force_floor), np.abs(g).max(initial=0.0) / TOL_CLOSURE)
        done = worst <= 1 or (iteration == MAX_ITERATIONS and worst < 100)
        if not np.isfinite(worst) or (iteration == MAX_ITERATIONS and not done):
            break
        A, G = _matrices(plant, x, wrench, c_v, c_a, 1.0)
        counters.iterations += 1
        counters.factorisations += 1
        try:
            dq, dm = saddle_solve(A, np.vstack([G, held]), -r, np.concatenate([-g, np.zeros(len(held))]))
        except ComputationError:
            break
        turn = turn + dq[k:]
        drive, force_held = x.drive.copy(), -dm[len(g) :]
        order = np.flatnonzero(plant.held)
        for j, f in zip(order, force_held, strict=True):
            drive[j // plant.n, 0 if j % plant.n == plant.kernel.shapes.l_index else 1] += f
        x = replace(
            x,
            q=x.q + dq[:k].reshape(x.q.shape),
            v=x.v + c_v * dq,
            v_dot=x.v_dot + c_a * dq,
            a=x.a + c_q * dq,
            lam=x.lam + dm[: len(g)].reshape(x.lam.shape) if plant.robot else x.lam,
            drive=drive,
            pose=turned(old.pose, turn) if plant.robot else x.pose,
        )
        if done:  # after a last correction: index 3 magnifies what is left
            counters.steps += 1
            sums = x.sums + 0.5 * h * (old.powers + powers)
            return replace(x, sums=sums, powers=powers), float(np.abs(g).max(initial=0.0))
    return None, 0.0


def scaled_defect(plant: Plant, flow: Flow, ratio: float) -> Flow:
    """Flow of a robot whose velocities normal to the closures are ``ratio`` times those of ``flow``, Eq. (T6.14)."""
    M, J = _matrices(plant, flow, np.zeros(6), 0.0, 1.0, 0.0)
    free = ~plant.held
    v = flow.v.copy()
    v[free] += (ratio - 1) * saddle_solve(M[np.ix_(free, free)], J[:, free], np.zeros(free.sum()), J @ flow.v)[0]
    return replace(flow, v=v)
