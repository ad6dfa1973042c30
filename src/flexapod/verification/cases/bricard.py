"""Bricard's mechanism, a loop of six hinges that moves although it is overconstrained, by the robot's time integration.

Cut at a hinge, the loop has five angles and as many equations, of which one follows from the others: with all of them
the matrix of a step is singular. So rods 4 and 5 are there twice, each copy with half of their mass: one copy ends at
the hinge between rods 3 and 4, the other at a second point of its axis. These two times three equations on seven angles
are independent, and the copies must move as one.
"""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.symbolic.vocabulary import SX, constant, cos, dot, mtimes, sin, time_derivative, vertcat, zeros
from flexapod.solve.time.recording import Recording
from flexapod.verification.case import Check, case, checks
from flexapod.verification.mechanism import Mechanism, extrapolate_second_order, rest_motion, run_mechanism

LENGTH, SIDE, MASS, GRAVITY = 1.0, 0.1, 1.0, 9.81  # m, m, kg, m/s^2
HINGES = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]]) * LENGTH
AXES = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]])
OFFSET = 0.5  # m, of the second point; at a rod's length the closure of its copy is singular at the start
DURATION, STEPS = 10.0, 16_000
# Instant [s], its number among the stored ones, angles of hinges 1 and 2 [rad]
TABLE = (
    (1.0, 2, 1.035028459515, -0.480621104177),
    (5.5, 11, 0.261171091159, -0.206689962384),
    (9.5, 19, 0.235697968389, -0.190462461326),
)


def _turn(axis: int, angle: SX) -> SX:
    """Rotation about a coordinate axis."""
    n = np.eye(3)[axis]
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return constant(np.eye(3)) + sin(angle) * constant(cross) + (1 - cos(angle)) * constant(cross @ cross)


def _chain(start: int, step: int, angles: list[SX], q: SX, v: SX) -> tuple[SX, SX, SX, SX]:
    """Rods from hinge ``start`` on: kinetic and potential energy, place of the last hinge, rotation of the last rod."""
    place, R = constant(HINGES[start][:, None]), constant(np.eye(3))
    kinetic, potential = zeros(1), zeros(1)
    for k, angle in enumerate(angles):
        i = start + step * k
        rod = HINGES[i + step] - HINGES[i]
        R = mtimes(R, _turn(int(np.argmax(AXES[i])), angle))
        along = mtimes(R, constant(rod[:, None]))
        centre = time_derivative(place + 0.5 * along, (q, v))
        # A uniform cuboid: (L^2 + a^2) / 12 across, a^2 / 6 along; by the rates of three unit vectors in it
        kinetic += 0.5 * MASS * dot(centre, centre)
        for j in range(3):
            second = (LENGTH**2 if rod[j] else SIDE**2) / 12
            edge = time_derivative(R[:, j], (q, v))
            kinetic += 0.5 * MASS * second * dot(edge, edge)
        potential += MASS * GRAVITY * (place + 0.5 * along)[1]
        place = place + along
    return kinetic, potential, place, R


def _branch(q: SX, v: SX, p: SX) -> tuple[SX, SX, SX]:
    """Half of rods 5 and 4 from the last hinge to a point of the fourth hinge's axis (p: its distance).

    The third coordinate is a slide along rod 4, which the drive holds.
    """
    kinetic, potential, place, R = _chain(5, -1, [q[0], q[1]], q, v)
    rod = (HINGES[3] - HINGES[4]) / LENGTH
    point = place + mtimes(R, constant(rod[:, None]) * q[2] + constant(AXES[3][:, None]) * p[0])
    return 0.5 * (kinetic + v[2] ** 2), 0.5 * potential, point


def _hub(x: SX, u: SX) -> tuple[SX, SX, SX]:
    """Rods 1 to 3 and the two points of the fourth hinge's axis."""
    kinetic, potential, place, R = _chain(0, 1, [x[0], x[1], x[2]], x, u)
    axis = mtimes(R, constant(AXES[3][:, None]))
    return kinetic, potential, vertcat(place, place + OFFSET * axis)


def run(steps: int) -> list[Recording]:
    """The mechanism from rest over 10 s in so many steps: the start, and what follows."""
    loop = Mechanism(
        branch=_branch,
        hub=_hub,
        drive=rest_motion,
        shapes=0,
        parameters=np.array([[0.0], [OFFSET]]),
        file=__file__,
        driven=(0, 1),
    )
    none = np.zeros((2, 3))
    return run_mechanism(loop, none, np.zeros(3), none, np.zeros(3), DURATION, steps)


def motion(steps: int) -> tuple[Array, Array, Array]:
    """Every half second: angles (T, 3) of hinges 1 to 3, (T, 2, 2) of 6 and 5 in both copies, energy (T,) [J]."""
    chunks = run(steps)
    first = np.concatenate([chunk.pose[:, :3] for chunk in chunks])
    copies = np.concatenate([chunk.q[:, :2, :2] for chunk in chunks])
    return first, copies, np.concatenate([chunk.energy.sum(axis=1) for chunk in chunks])


@case(
    "Bricard's mechanism, five rods of 1 m and an overconstrained loop of six hinges, from rest over 10 s, "
    "in the compiled time integration of the robot with the equations that are independent; two step sizes "
    "extrapolated",
    source="IFToMM library of computational benchmark problems, A04 (Gonzalez et al. 2006), whose reference is "
    "constant energy; motion by the one degree of freedom left: hinges 1, 3, 5 alike, 2, 4, 6 alike, sin a + sin b + "
    "sin a sin b = 0",
    argument="of two steps of a method of order two the error of order four: 2e-11 rad, 3e-12 J; what the equations "
    "leave out, the second set of hinges and the equality of the copies, to rounding over lengths of a metre",
)
def _bricard() -> list[Check]:
    coarse, fine = motion(STEPS), motion(2 * STEPS)
    angles, energy = (extrapolate_second_order(coarse[i], fine[i]) for i in (0, 2))
    first, copies = fine[0], fine[1]
    one, two = np.sin(first[:, 0]), np.sin(first[:, 1])
    rows = [
        Check(f"hinge {hinge + 1} at {time} s", value, float(angles[k, hinge]), 1e-9, "rad")
        for time, k, *values in TABLE
        for hinge, value in enumerate(values)
    ]
    rows += checks(
        ["energy, largest change in 10 s"], [0], [np.abs(energy - energy[0]).max()], 1e-9, "J", absolute=True
    )
    gaps = {
        "copies of rods 4 and 5": copies[:, 0] - copies[:, 1],
        "hinges 1 and 3": first[:, 0] - first[:, 2],
        "hinges 2 and 6": first[:, 1] + copies[:, 0, 0],  # counted from the other end
        "closure of hinges 1 and 2": one + two + one * two,
    }
    return rows + checks(list(gaps), [0] * 4, [np.abs(gap).max() for gap in gaps.values()], 1e-12, "rad", absolute=True)
