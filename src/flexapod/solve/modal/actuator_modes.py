"""Modes of a single actuator whose hub is held or turns steadily, Eqs. (T9.6)-(T9.7), (T9.10)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.mechanics.leg.layout import COMMAND_SIZE, LOAD_SIZE, Shapes, columns
from flexapod.mechanics.shapes.beam_functions import eigh
from flexapod.model import Actuator, Simulation
from flexapod.solve.kernel import Function
from flexapod.solve.modal.eigenproblem import damping_ratios
from flexapod.solve.parameters import actuator_parameters
from flexapod.solve.shapes import actuator_shapes, home, places

STEPS = 3  # of Newton to the steady stretch: the equations of the straight beam are linear in it
#: What amplitudes of an actuator in space are called where they vibrate by themselves.
SPACE_KINDS = {"b": "bending (rotation)", "a": "bending (elevation)", "c": "axial", "t": "twisting"}


@dataclass(frozen=True, kw_only=True)
class ActuatorModes:
    """Modes of a clamped beam about its straight line, ascending.

    ``frequency`` (m,) [Hz] undamped; ``damping_ratio`` (m,) of the damped modes; ``kind`` (m,): what moves;
    ``shapes`` (m, k), one row of amplitudes per mode [m, rad], mass-normalised, in the order of the kernel.
    """

    frequency: Array
    shapes: Array
    damping_ratio: Array
    kind: tuple[str, ...]


def actuator_modes(
    actuator: Actuator, simulation: Simulation, *, rate: float = 0.0, free_length: float | None = None
) -> ActuatorModes:
    """Modes about the straight beam with hub and extension held, Eqs. (T9.6)-(T9.7).

    At rest a straight beam in space bends in each of its planes, stretches and twists by itself, so that each mode is
    of one kind; what couples stretch and lag of a turning one is in `stretching_lag`.

    Parameters
    ----------
    actuator : Actuator
        Its ``gravity`` acts along the beam at ``actuator.angle`` when nothing turns. On a turning hub that load changes
        sign every half turn, so steady modes leave it out.
    simulation : Simulation
        ``fidelity``, ``basis`` and ``modes`` of the beam.
    rate : float
        Steady rate of rotation [rad/s]: centrifugal stiffening less the centrifugal field across the beam (lag).
    free_length : float, optional
        Length outside the hub [m]; default that of the actuator.

    Raises
    ------
    InputError
        Rigid beam, or a free length that the beam does not have.
    ComputationError
        The straight beam is unstable: it has buckled.
    """
    if free_length is not None:
        actuator = actuator.replace(free_length=free_length)
    if rate:
        actuator = actuator.replace(gravity=0.0)
    groups = amplitude_groups(actuator_shapes(actuator, simulation, rate))
    if not groups:
        raise InputError(
            "leaves nothing that could vibrate with hub and extension held",
            key="simulation.fidelity",
            value=simulation.fidelity,
            allowed=("lumped, " if actuator.EA else "") + "finite-segment, assumed-modes, beam-fem, solid-fem",
        )
    M, D, K = turning_matrices(actuator, simulation, rate)
    omega, shapes, ratio, kinds = [np.zeros(0)], [np.zeros((0, len(M)))], [np.zeros(0)], []
    for name, at in groups.items():
        squared, vectors = eigh(K[at, at], M[at, at])  # (T9.7)
        if squared[0] <= 0:
            raise ComputationError(
                f"the straight beam of {actuator.free_length:g} m is unstable: its own load along the axis buckles it",
                next_step="Shorten actuator.free_length, or reduce gravity or tip_mass.",
            )
        omega.append(np.sqrt(squared))
        ratio.append(damping_ratios(omega[-1], (vectors / omega[-1]).T @ D[at, at] @ (vectors / omega[-1])))
        shapes.append(np.zeros((len(squared), len(M))))
        shapes[-1][:, at] = vectors.T
        kinds += [SPACE_KINDS[name] if actuator.space else "bending"] * len(squared)
    order = np.argsort(np.concatenate(omega).astype(np.float32), kind="stable")  # both planes alike but for rounding
    return ActuatorModes(
        frequency=np.concatenate(omega)[order] / (2 * np.pi),
        shapes=np.vstack(shapes)[order],
        damping_ratio=np.concatenate(ratio)[order],
        kind=tuple(kinds[i] for i in order),
    )


def amplitude_groups(shapes: Shapes) -> dict[str, slice]:
    """Amplitudes that vibrate by themselves, by name, among those that follow the coordinates of `places`."""
    first, sizes = len(places(shapes)), dict(shapes.layout)
    columns_of = {name: columns(shapes.layout, name) for name in SPACE_KINDS if sizes.get(name)}
    return {name: slice(at.start - first, at.stop - first) for name, at in columns_of.items()}


def turning_matrices(actuator: Actuator, simulation: Simulation, rate: float) -> tuple[Array, Array, Array]:
    """M, D, K (k, k) of the amplitudes of the beam in steady rotation, Eq. (T9.6); in space at its steady stretch."""
    shapes = actuator_shapes(actuator, simulation, rate)
    residual, matrices, tangents = interpreted_functions(shapes)
    q, arguments, at_rest = straight_state(actuator, shapes, rate)
    c = columns(shapes.layout, "c")
    for _ in range(STEPS if shapes.beam.axial.count else 0):
        q[c] -= np.linalg.solve(tangents(q, *arguments)[0][c, c], residual(q, *arguments)[0][c])
    M = matrices(q, *at_rest)[0]
    K, D = tangents(q, *arguments)  # (T9.6)
    moving = slice(len(places(shapes)), None)
    return M[moving, moving], D[moving, moving], 0.5 * (K + K.T)[moving, moving]


def straight_state(
    actuator: Actuator, shapes: Shapes, rate: float
) -> tuple[Array, tuple[Array, ...], tuple[Array, ...]]:
    """Coordinates of the straight beam on a hub that turns, and what else `functions` ask for: in motion, and at rest.

    In motion rates, accelerations, no forces of a closure, commands, parameters and loads; at rest no rates.
    """
    p, at, none = actuator_parameters(actuator, shapes)[0], places(shapes), np.zeros(0)
    (q, v), still = np.zeros((2, shapes.size)), np.zeros(shapes.size)
    for name, value in home(actuator).items():
        q[at[name]] = value
    v[at["rotation"]] = rate
    constant = p, *[np.zeros(LOAD_SIZE)] * shapes.has_tip_load
    return q, (v, still, none, np.zeros(COMMAND_SIZE), *constant), (none, *constant)


def stretching_lag(actuator: Actuator, simulation: Simulation, rate: float) -> Array:
    """Frequencies [rad/s], ascending, of an actuator in space whose hub turns steadily about Z, Eq. (T9.10).

    Stretch and lag vibrate together by Coriolis forces about the straight beam in its steady stretch.
    """
    groups = amplitude_groups(actuator_shapes(actuator, simulation, rate))
    moving = np.r_[groups["c"], groups["b"]]
    M, D, K = (x[np.ix_(moving, moving)] for x in turning_matrices(actuator, simulation, rate))
    first = np.block([[np.zeros_like(M), np.eye(len(M))], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    return np.unique(np.abs(np.linalg.eigvals(first).imag).round(12))


@lru_cache(maxsize=16)
def interpreted_functions(shapes: Shapes) -> tuple[Function, Function, Function]:
    """Residual, matrices at rest and tangents in motion of the leg, interpreted: each is called once per analysis."""
    from flexapod.mechanics.leg.kernel_functions import leg_functions, leg_tangents
    from flexapod.mechanics.symbolic.functions import Interpreted

    residual, matrices = leg_functions(shapes)[:2]
    return Interpreted(residual), Interpreted(matrices), Interpreted(leg_tangents(shapes))
