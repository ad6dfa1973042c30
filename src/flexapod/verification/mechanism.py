"""Mechanisms of the literature in the time integration of the robot: same start, same compiled loop, other equations.

The loop knows legs of n coordinates, each closed by three equations to a body that carries them, and strokes that
may follow a table. Any mechanism of that structure can take their place: `Branch` for the leg, `Hub` for the body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.mechanics.leg.layout import COMMAND_SIZE, LEG_PARAMETERS, Shapes, columns
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.leg.leg_chain import LegChain
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.mechanics.symbolic import functions, vocabulary
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.mechanics.symbolic.functions import Lagrangian, NamedFunction, inverse_dynamics, mass_matrix
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    dot,
    gradient,
    hessian,
    jacobian,
    reshape,
    substitute,
    symbol,
    vertcat,
    zeros,
)
from flexapod.solve.kernel import Kernel, loaded_kernel
from flexapod.solve.system import COLUMNS, State, System
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.march import march
from flexapod.solve.time.problem import Problem
from flexapod.solve.time.recording import Counters, Recording
from flexapod.solve.time.start import consistent_start
from flexapod.solve.time.time_events import Stops

#: branch(q, v, p) -> kinetic energy, potential energy, the point (3,) that is closed; p: the branch's own parameters
Branch = Callable[[SX, SX, SX], tuple[SX, SX, SX]]
#: hub(x, u) -> kinetic and potential energy, the points of all branches, stacked; x: three coordinates, u: their rates
Hub = Callable[[SX, SX], tuple[SX, SX, SX]]
#: drive(t) -> value, rate and acceleration of the third coordinate of the driven branches, which follows them
Drive = Callable[[Array], tuple[Array, Array, Array]]

OUTPUTS = 20


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """Branches on a hub.

    ``shapes``: lateral shapes a direction, which set the number of coordinates of a branch, 3 + 2 ``shapes``; the
    first three follow from the closed point and the others. ``parameters`` (b, m): those of each branch. ``file``:
    where the equations are written; compiled code is kept as long as it stays the same. ``driven``: branches whose
    third coordinate follows the drive.
    """

    branch: Branch
    hub: Hub
    drive: Drive
    shapes: int
    parameters: Array
    file: str
    driven: tuple[int, ...] = (0,)


def rest_motion(t: Array) -> tuple[Array, Array, Array]:
    """A drive that rests at zero."""
    return np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)


def extrapolate_second_order(coarse: Array, fine: Array) -> Array:
    """Extrapolate a method of order two from steps h and h / 2 to order four (Richardson)."""
    return (4 * fine - coarse) / 3


def run_mechanism(
    mechanism: Mechanism, q: Array, x: Array, v: Array, u: Array, duration: float, steps: int
) -> list[Recording]:
    """The start, and what follows in `steps` equal steps of the time integration with spectral radius 0.9.

    Parameters
    ----------
    mechanism : Mechanism
    q, v : ndarray, shape (b, n)
        Coordinates of the branches at the start, closed, and their rates.
    x, u : ndarray, shape (3,)
        Of the hub.
    duration : float
        [s]
    steps : int
        A multiple of 20, the number of stored instants.

    Returns
    -------
    list of Recording
        The start alone, then pieces in the order of time.

    Raises
    ------
    ComputationError
        There is no C compiler, or the integration stopped.
    """
    system, h, method = _system(mechanism), duration / steps, GeneralizedAlpha(0.9)
    law = _law(mechanism.drive, len(q))
    at = State(
        q=q,
        pose=np.concatenate([x, [1.0, 0.0, 0.0, 0.0]]),
        v=np.concatenate([v.ravel(), u, np.zeros(3)]),
        v_dot=np.zeros(system.size),
        lam=np.zeros((len(q), 3)),
        drive=np.zeros((len(q), system.ports.size)),
    )
    start, _ = consistent_start(system, at, law, 0.0, method, h)
    problem = _problem(system, method, law, duration)
    return [chunk.recording for chunk in march(problem, start, h, Counters())]


def _problem(system: System, method: GeneralizedAlpha, law: Law, duration: float) -> Problem:
    """A fixed step, nothing that jumps, nothing to check."""
    return Problem(
        system=system,
        method=method,
        tables=law,
        output_step=duration / OUTPUTS,
        outputs=OUTPUTS,
        measure=lambda recording: [recording.pose],
        restart=lambda flow, t, h: flow,
        stops=Stops(output_step=duration / OUTPUTS),
        check=lambda recording: None,
        tolerance=None,
    )


def _law(drive: Drive, branches: int) -> Law:
    def law(t: Array) -> tuple[Array, Array]:
        table = np.zeros((len(t), branches, 1, COLUMNS))
        table[:, :, 0, :3] = np.stack(drive(t), axis=-1)[:, None]
        return table, np.zeros((len(t), 6))  # no wrench

    return law


def _system(mechanism: Mechanism) -> System:
    lateral = lateral_basis("tip-load", mechanism.shapes)  # for its number of shapes only
    shapes = Shapes(beam=LegBeam(a=lateral, b=lateral, axial=axial_basis(0)), chain=LegChain())
    general = np.zeros(
        (len(mechanism.parameters), sum(size for _, size in LEG_PARAMETERS))
    )  # what the loop itself asks of a leg
    general[:, columns(LEG_PARAMETERS, "Lp")] = 1.0
    held = np.zeros((len(general), shapes.size), dtype=bool)
    held[list(mechanism.driven), shapes.l_index] = True
    return System(
        kernel=_kernel(mechanism, shapes, general.shape[1]),
        leg_p=np.ascontiguousarray(np.concatenate([general, mechanism.parameters], axis=1)),
        joint_p=np.eye(len(general)),  # each branch reads its own of the hub's points
        payload_p=np.ones(1),
        held=held,
    )


def _kernel(mechanism: Mechanism, shapes: Shapes, general: int) -> Kernel:
    command = compiler()
    if not command:
        raise ComputationError(
            "there is no C compiler, and interpreted equations would take hours",
            next_step="Install gcc or clang, or `pip install ziglang`.",
        )
    texts = [
        Path(str(file)).read_bytes() for file in (__file__, mechanism.file, functions.__file__, vocabulary.__file__)
    ]
    return loaded_kernel(
        shapes,
        command,
        [*texts, shapes.size, general],
        lambda: [*_branch_functions(mechanism, shapes, general), *_hub_functions(mechanism)],
        general + mechanism.parameters.shape[1],
        joint=len(mechanism.parameters),
    )


def _branch_functions(mechanism: Mechanism, shapes: Shapes, general: int) -> list[NamedFunction]:
    """Residual, matrices and energies of a branch by Lagrange's equations, as of a leg in `mechanics.assembly`."""
    n = shapes.size
    q, v, v_dot, lam = (symbol(name, size) for name, size in (("q", n), ("v", n), ("v_dot", n), ("lam", 3)))
    command, p = symbol("command", COMMAND_SIZE), symbol("p", general + mechanism.parameters.shape[1])
    kinetic, potential, point = mechanism.branch(q, v, p[general:])
    e = Lagrangian(q=q, v=v, kinetic=kinetic, potential=potential, dissipation=zeros(1))
    r = inverse_dynamics(e, v_dot) + gradient(dot(point, lam), q)
    parameters = [("command", command), ("p", p)]
    matrices = [
        ("M", mass_matrix(e)),
        ("D", zeros(n, n)),
        ("K", hessian(potential + dot(point, lam), q)),
        ("J", jacobian(point, q)),
    ]
    energies = [("energies", vertcat(kinetic, zeros(1), potential)), ("drive", zeros(1))]
    return [
        NamedFunction(
            "leg_residual",
            [("q", q), ("v", v), ("v_dot", v_dot), ("lam", lam), *parameters],
            [("r", r), ("tip", point), ("powers", zeros(2)), ("drive", zeros(1))],
        ),
        NamedFunction("leg_matrices", [("q", q), ("lam", lam), ("p", p)], matrices),
        NamedFunction("leg_energies", [("q", q), ("v", v), *parameters], energies),
    ]


def _hub_functions(mechanism: Mechanism) -> list[NamedFunction]:
    """Functions of the hub for the kernel: three coordinates, and a turn of unit inertia that nothing moves."""
    pose, u, u_dot = symbol("pose", 7), symbol("u", 6), symbol("u_dot", 6)
    net, wrench, p = symbol("net", 6), symbol("wrench", 6), symbol("p", 1)
    branches = len(mechanism.parameters)
    lam, joint = symbol("lam", 3), symbol("joint", branches)
    x, rate, push = symbol("x", 3), symbol("rate", 3), symbol("push", 3)
    kinetic, potential, points = mechanism.hub(x, rate)
    point = reshape(points, 3, branches) @ joint
    e = Lagrangian(q=x, v=rate, kinetic=kinetic, potential=potential, dissipation=zeros(1))

    def here(expression: SX) -> SX:
        return substitute(expression, (x, rate, push), (pose[:3], u[:3], u_dot[:3]))

    r = inverse_dynamics(e, push) - net[:3]
    M, K, P, H = zeros(6, 6), zeros(6, 6), zeros(3, 6), zeros(6, 6)
    for i in (3, 4, 5):
        M[i, i] = 1
    M[:3, :3], K[:3, :3] = mass_matrix(e), hessian(potential, x)
    P[:, :3], H[:3, :3] = jacobian(point, x), -hessian(dot(point, lam), x)
    motion = [("pose", pose), ("u", u), ("u_dot", u_dot), ("net", net), ("wrench", wrench), ("p", p)]
    of_joint = [("pose", pose), ("lam", lam), ("joint", joint)]
    push_of_joint = vertcat(gradient(dot(point, lam), x), zeros(3))
    energies = vertcat(here(kinetic), zeros(1), here(potential))
    return [
        NamedFunction("joint_residual", of_joint, [("point", here(point)), ("wrench", here(push_of_joint))]),
        NamedFunction("joint_matrices", of_joint, [("P", here(P)), ("H", here(H))]),
        NamedFunction(
            "payload_residual", motion, [("r", vertcat(here(r), u_dot[3:])), ("power", zeros(1))], alone=True
        ),
        NamedFunction(
            "payload_matrices",
            [("pose", pose), ("wrench", wrench), ("p", p)],
            [("M", here(M)), ("K", here(K))],
            alone=True,
        ),
        NamedFunction("payload_energies", [("pose", pose), ("u", u), ("p", p)], [("energies", energies)], alone=True),
    ]
