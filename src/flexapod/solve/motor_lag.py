"""Motors that lag, and loops closed elsewhere than at the rotor: start and modes, Eqs. (T23.54), (T23.58)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.arrays import Array, Mask
from flexapod.errors import ComputationError
from flexapod.mechanics.layout import columns, leg_parameters
from flexapod.model import Robot, Simulation
from flexapod.solve.batch import RestStates
from flexapod.solve.kernel import evaluate
from flexapod.solve.modal_loops import ModalLoops
from flexapod.solve.robot_system import robot_system
from flexapod.solve.start import constrained
from flexapod.solve.system import State, System

__all__ = ["at_rotors", "modal_loops", "settled"]

SETTLED, ROUNDING = 1e-13, 1e-10  # largest step of a coordinate [m, rad]; below it a step may stop shrinking
ROUNDS = 20


def settled(system: System, x: State, table: Array, wrench: Array, *, rests: bool) -> State:
    """A state whose motors give what is asked of them; with ``rests`` the equilibrium next to it, Eq. (T23.54).

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
        step, lam = constrained(system, A, m.G, -r, -g)
        x = replace(system.moved(x, step), lam=x.lam + lam.reshape(x.lam.shape))
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
    return found & ~system.fixed


def _at_force(system: System, x: State, table: Array, wrench: Array) -> State:
    """State whose motors that lag give what is asked of them."""
    v, j = x.v.copy(), _flat(system, "j")
    v[j] = 0.0
    v[j] = -system.residual(replace(x, v=v, v_dot=np.zeros_like(v)), table, wrench)[0][j]
    return replace(x, v=v)


def at_rotors(robot: Robot, simulation: Simulation, per_loss: float) -> System:
    """The robot's equations in motion with loops as springs and dampers on their rotors, which act at once.

    ``per_loss``: as of `robot_system`.
    """
    system = robot_system(robot, simulation, per_loss, evaluated=True)
    layout, leg_p, held = leg_parameters(system.kernel.shapes), system.leg_p.copy(), system.held.copy()
    for i, leg in enumerate(robot.legs):
        if leg.screw is not None and leg.screw.loops:
            for name, value in zip(("rotor_stiffness", "rotor_damping"), leg.screw.loop_spring, strict=True):
                leg_p[i, columns(layout, name)] = value
    for name in ("j", "w"):
        if system.kernel.shapes.has(name):
            held[:, system.kernel.shapes.index(name)] = True
    return replace(system, leg_p=leg_p, held=held)


def modal_loops(robot: Robot, system: System, x: RestStates, flat: Array) -> list[ModalLoops]:
    """The loops of a robot at each of p states, by its modes there in flat coordinates (p, N, r)."""
    n, legs, r = system.n, system.legs, system.kernel.shapes.index("r")
    sizes = [(n, n), (n, n), (1,), (n,)]
    *_, slope = evaluate(system.kernel, "leg_loop", len(x) * legs, [x.q, system.leg_p], sizes)
    which = [i for i, leg in enumerate(robot.legs) if leg.screw is not None and leg.screw.loops]
    screws = [leg.screw for leg in robot.legs if leg.screw is not None and leg.screw.loops]
    by_leg = flat[:, : legs * n].reshape(len(x), legs, n, -1)
    measured = (slope.reshape(len(x), legs, n, 1) * by_leg).sum(axis=2)[:, which]
    rotor = by_leg[:, which, r]
    turns = np.array([screw.encoder.rate == "rotor" for screw in screws])[:, None]
    damped = np.where(turns, rotor, measured)
    gains = np.array([(*screw.loop_spring, screw.integral, screw.lag) for screw in screws]).T
    names = dict(zip(("stiffness", "damping", "integral", "lag"), gains, strict=True))
    parts = zip(rotor, measured, damped, strict=True)
    return [ModalLoops(rotor=b.T, measured=mu.T, damped=nu.T, **names) for b, mu, nu in parts]
