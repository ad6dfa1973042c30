"""Start of lagging motors, and of loops closed elsewhere than at the rotor, Eq. (T23.54)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.solve.system import State, System
from flexapod.solve.time.start import solve_constrained

SETTLED, ROUNDING = 1e-13, 1e-10  # largest step of a coordinate [m, rad]; below it a step may stop shrinking
ROUNDS = 20


def settle_motors(system: System, x: State, table: Array, wrench: Array, *, rests: bool) -> State:
    """State whose motors have the requested forces; with ``rests`` the equilibrium next to it, Eq. (T23.54).

    Raises
    ------
    ComputationError
        There is none.
    """
    shapes, before = system.kernel.shapes, np.inf
    x, j = _at_force(system, x, table, wrench), _flat(system, "j")
    w = _flat(system, "w") if shapes.has("w") else np.zeros_like(j)
    for _ in range(ROUNDS if rests else 0):
        r, g, _ = system.residual(x, table, wrench)
        m = system.matrices(x, wrench)
        A, places = m.K - m.D[:, j] @ m.K[j], system.loops(x)[2][:, 0]  # forces without their lag
        A[j] = A[:, j] = r[j] = 0.0
        A[j, j] = 1.0
        A[w] = m.D[w]
        error = places - table[:, system.ports == shapes.index("r"), 0][:, 0]
        r[w] = error[w[: system.legs * system.n].reshape(system.legs, -1).any(axis=1)]
        step, lam = solve_constrained(system, A, m.G, -r, -g)
        x = replace(system.displace(x, step), lam=x.lam + lam.reshape(x.lam.shape))
        x, largest = _at_force(system, x, table, wrench), float(np.abs(step[~w]).max())
        if largest < SETTLED or (largest < ROUNDING and largest >= before):
            return x
        before = largest
    if rests:
        raise ComputationError(
            "the robot cannot start at rest: its loops find none",
            next_step='Check drive.loop and drive.encoder, or take [initial] start = "moving"',
        )
    return x


def _flat(system: System, name: str) -> Mask:
    """Free coordinates of a name among all, (size,)."""
    found = np.zeros(system.size, dtype=bool)
    system.by_leg(found)[:, system.kernel.shapes.index(name)] = True
    return found & ~system.fixed_mask


def _at_force(system: System, x: State, table: Array, wrench: Array) -> State:
    """State whose lagging motors have the requested forces."""
    v, j = x.v.copy(), _flat(system, "j")
    v[j] = 0.0
    v[j] = -system.residual(replace(x, v=v, v_dot=np.zeros_like(v)), table, wrench)[0][j]
    return replace(x, v=v)
