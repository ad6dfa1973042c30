"""What a solid beam does and an Euler-Bernoulli beam leaves out: rotary inertia and shear, to first order.

Both are far below the rest: with the mode's displacement v, slope v' and v''' they add ``rho I int v'^2 dx`` to the
kinetic energy and ``(EI)^2 / (k G A) int v'''^2 dx`` to the complementary energy (Rayleigh's quotient; S. Timoshenko,
"Vibration Problems in Engineering", 3rd ed. 1955, art. 55). The second order is of the size of their square.
"""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.mechanics.shapes import lateral_basis
from flexapod.mechanics.shapes.beam_functions import gauss_unit
from flexapod.solve.modal.actuator_modes import actuator_modes
from flexapod.solve.modal.modes import RobotModes

ONE_ELEMENT = 2.0
"""E / k G of solid elements at Poisson's ratio 0, one across the height: their section stays plane, so k = 1."""


def clamped_thick(beam: model.Actuator, gyration: float, shear: float, count: int) -> Array:
    """Frequencies [Hz] of a clamped beam with rotary inertia and shear.

    Parameters
    ----------
    beam : Actuator
        All of it outside the hub.
    gyration : float
        Radius of gyration of the section, sqrt(I / A) [m].
    shear : float
        E / k G.
    count : int
    """
    found = actuator_modes(beam, model.Simulation(basis="clamped-free", modes=count))
    shapes, (zeta, weight) = lateral_basis("clamped-free", count), gauss_unit()
    s = beam.free_length
    slope, third = (found.shapes @ shapes.values(zeta, n) / s**n for n in (1, 3))
    return _thick(
        found.frequency,
        beam.rhoA * gyration**2 * s * (slope**2 @ weight),
        beam.EI * gyration**2 * shear * s * (third**2 @ weight),
    )


def robot_thick(robot: model.Robot, found: RobotModes, shear: float) -> Array:
    """Frequencies [Hz] of a robot whose free pistons have rotary inertia and shear, E / k G."""
    shapes, n = found.system.kernel.shapes, found.system.n
    zeta, weight = gauss_unit()
    state = found.equilibrium.state
    legs = found.shapes[:, : 6 * n].reshape(-1, 6, n)
    first, k = 3 + shapes.beam.axial.count, shapes.beam.a.count
    inertia, give = np.zeros(len(legs)), np.zeros(len(legs))
    for i, leg in enumerate(robot.legs):
        s, piston = state.q[i, shapes.l_index] - leg.cylinder.mouth, leg.piston
        square = piston.EI / piston.EA
        turns = (legs[:, i, 1], -legs[:, i, 0] * np.cos(state.q[i, 1]))  # of the cylinder, in directions a and b
        for turn, start in zip(turns, (first, first + k), strict=True):
            amplitudes = legs[:, i, start : start + k]
            slope = turn[:, None] + amplitudes @ shapes.beam.a.values(zeta, 1) / s
            third = amplitudes @ shapes.beam.a.values(zeta, 3) / s**3
            inertia += piston.rhoA * square * s * (slope**2 @ weight)
            give += piston.EI * square * shear * s * (third**2 @ weight)
    return _thick(found.frequency, inertia, give)


def _thick(frequency: Array, inertia: Array, give: Array) -> Array:
    """Of mass-normalised modes: what is added to their kinetic energy, and taken from their squared frequency.

    Written as one quotient, which for a pinned beam leaves only the product of both out.
    """
    return frequency / np.sqrt(1 + inertia + give / (2 * np.pi * frequency) ** 2)
