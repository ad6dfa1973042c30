"""Modes of the planar actuator with rotation and extension held, at rest or turning steadily, Eqs. (T9.6)-(T9.7)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from flexapod.bases.eigen import eigh
from flexapod.bases.lateral import LateralBasis
from flexapod.errors import ComputationError, InputError
from flexapod.mechanics.layout import COMMAND_SIZE, LOAD_SIZE, columns
from flexapod.model import Actuator, Simulation
from flexapod.model.actuator import IN_SPACE
from flexapod.solve.damped import damping_ratios
from flexapod.solve.kernel import Function
from flexapod.solve.parameters import actuator_parameters
from flexapod.solve.shapes import actuator_shapes, beam_shapes, planar_shapes
from flexapod.typing import Array

STEPS = 3  # of Newton to the steady stretch: the equations of the straight beam are linear in it


@dataclass(frozen=True, kw_only=True)
class ActuatorModes:
    """Modes of a clamped beam in the plane in which its hub turns, ascending.

    ``frequency`` (k,) [Hz] undamped; ``damping_ratio`` (k,) of the damped modes; ``shapes`` (k, k), one row of
    amplitudes of the lateral basis [m] per mode, mass-normalised.
    """

    frequency: Array
    shapes: Array
    damping_ratio: Array


def actuator_modes(
    actuator: Actuator, simulation: Simulation, *, rate: float = 0.0, free_length: float | None = None
) -> ActuatorModes:
    """Modes about the straight beam with rotation and extension held, Eqs. (T9.6)-(T9.7).

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
    if not simulation.lateral_shapes:
        raise InputError(
            "leaves nothing that could vibrate with rotation and extension held",
            key="simulation.fidelity",
            value=simulation.fidelity,
            allowed="finite-segment, assumed-modes, beam-fem, solid-fem",
        )
    if free_length is not None:
        actuator = actuator.replace(free_length=free_length)
    actuator = _in_a_plane(actuator)
    if rate:
        actuator = actuator.replace(gravity=0.0)
    M, D, K = turning_matrices(actuator, simulation, rate)
    squared, vectors = eigh(K, M)  # (T9.7)
    if squared[0] <= 0:
        raise ComputationError(
            f"the straight beam of {actuator.free_length:g} m is unstable: its own load along the axis buckles it",
            next_step="Shorten actuator.free_length, or reduce gravity or tip_mass.",
        )
    omega = np.sqrt(squared)
    ratio = damping_ratios(omega, (vectors / omega).T @ D @ (vectors / omega))
    return ActuatorModes(frequency=omega / (2 * np.pi), shapes=vectors.T, damping_ratio=ratio)


def _in_a_plane(actuator: Actuator) -> Actuator:
    """The planar actuator with the same bending: of one in space both planes are alike, and gravity meets elevation."""
    if not actuator.space:
        return actuator
    fields = type(actuator).model_fields
    return actuator.replace(space=False, angle=actuator.elevation, **{name: fields[name].default for name in IN_SPACE})


def turning_matrices(actuator: Actuator, simulation: Simulation, rate: float) -> tuple[Array, Array, Array]:
    """M, D, K (k, k) of the amplitudes of the beam in steady rotation, Eq. (T9.6)."""
    lateral = beam_shapes(actuator, simulation, rate)
    matrices, tangents = _functions(lateral)
    p, size = actuator_parameters(actuator, planar_shapes(lateral))[0], 2 + simulation.lateral_shapes
    q, v, none = np.zeros(size), np.zeros(size), np.zeros(0)
    q[:2], v[0] = (actuator.angle, actuator.hub_radius + actuator.free_length), rate
    M = matrices(q, none, p)[0]
    K, D = tangents(q, v, np.zeros(size), none, np.zeros(COMMAND_SIZE), p)  # (T9.6)
    return M[2:, 2:], D[2:, 2:], 0.5 * (K + K.T)[2:, 2:]


def stretching_lag(actuator: Actuator, simulation: Simulation, rate: float) -> Array:
    """Frequencies [rad/s], ascending, of an actuator in space whose hub turns steadily about Z, Eq. (T9.10).

    Stretch and lag vibrate together by Coriolis forces about the straight beam in its steady stretch.
    """
    from flexapod.mechanics.assembly import leg_functions, leg_tangents
    from flexapod.symbolic.functions import Interpreted

    shapes = actuator_shapes(actuator, simulation, rate)
    residual, matrices = (Interpreted(f) for f in leg_functions(shapes)[:2])
    tangents = Interpreted(leg_tangents(shapes))
    p, none, load = actuator_parameters(actuator, shapes)[0], np.zeros(0), np.zeros(LOAD_SIZE)
    (q, v), still = np.zeros((2, shapes.size)), np.zeros(shapes.size)
    q[shapes.l_index], v[shapes.index("alpha")] = actuator.hub_radius + actuator.free_length, rate
    c = columns(shapes.layout, "c")
    moving = np.r_[c, columns(shapes.layout, "b")]
    arguments = (v, still, none, np.zeros(COMMAND_SIZE), p, load)
    for _ in range(STEPS):
        stiffness = tangents(q, *arguments)[0]
        q[c] -= np.linalg.solve(stiffness[c, c], residual(q, *arguments)[0][c])
    at = np.ix_(moving, moving)
    (K, D), M = (x[at] for x in tangents(q, *arguments)), matrices(q, none, p, load)[0][at]
    first = np.block([[np.zeros_like(M), np.eye(len(M))], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    return np.unique(np.abs(np.linalg.eigvals(first).imag).round(12))


@lru_cache(maxsize=16)
def _functions(lateral: LateralBasis) -> tuple[Function, Function]:
    """Matrices at rest and tangents in motion of the planar leg, interpreted: each is called once per analysis."""
    from flexapod.mechanics.assembly import leg_functions, leg_tangents
    from flexapod.symbolic.functions import Interpreted

    shapes = planar_shapes(lateral)
    matrices = next(f for f in leg_functions(shapes) if f.name == "leg_matrices")
    return Interpreted(matrices), Interpreted(leg_tangents(shapes))
