"""Eight legs of which one is too long: what the legs do to each other, far from home, against minimised energy.

Legs between universal joint and ball bear no moment, so without weight they stay straight and are springs. Their
energy and that of the payload's weight, written down with Euler angles and minimised by scipy, knows nothing of
closures, multipliers or shapes.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.helpers.systems import EIGHT, ring, robot, tangents

from flexapod.kinematics.rotations import quaternion
from flexapod.solve.statics.equilibrium import equilibria

pytestmark = pytest.mark.analytic

TOO_LONG, AT, LEG = 1e-4, np.array([0.06, -0.04, 0.97, 0.35, -0.2, 0.5]), 2  # leg 3; displaced and turned far
LIGHT = {name: 0.0 for name in ("rhoA", "piston_axial_inertia", "cylinder_mass", "cylinder_inertia")}
BASE, JOINTS = ring(0.45, EIGHT), ring(0.3, EIGHT + np.tile([25.0, -25.0], 4))
STIFF = 4e7 / 0.9 * (1 + 0.1 * np.arange(8))  # N/m, a different one each


def turn(angles):
    """R = Rz Ry Rx and its derivatives by the three angles."""
    parts, rates = [], []
    for axis, angle in zip((2, 1, 0), angles[::-1], strict=True):
        generator = np.cross(np.eye(3)[axis], np.eye(3)).T
        part = np.eye(3) + np.sin(angle) * generator + (1 - np.cos(angle)) * generator @ generator
        parts.append(part)
        rates.append(generator @ part)
    z, y, x = parts
    return z @ y @ x, [z @ y @ rates[2], z @ rates[1] @ x, rates[0] @ y @ x]


def lengths(x):
    R, rates = turn(x[3:])
    legs = x[:3] + JOINTS @ R.T - BASE
    length = np.linalg.norm(legs, axis=1)
    along = legs / length[:, None]
    return length, np.concatenate(
        [along, np.stack([(along * (JOINTS @ d.T)).sum(axis=1) for d in rates], axis=1)], axis=1
    )


def least_energy(command, weight):
    """Place and angles at which springs and weight have the least energy; in units in which that is easy."""
    unit = np.array([1e-5] * 3 + [1e-4] * 3)

    def energy(u):
        length, rate = lengths(AT + unit * u)
        stretch = length - command
        value = 0.5 * (STIFF * stretch**2).sum() + weight * (AT + unit * u)[2]
        gradient = rate.T @ (STIFF * stretch) + weight * np.eye(6)[2]
        return value - weight * AT[2], unit * gradient

    found = minimize(energy, np.zeros(6), jac=True, method="BFGS", options={"gtol": 1e-12, "maxiter": 500})
    length, _ = lengths(AT + unit * found.x)
    return AT + unit * found.x, STIFF * (length - command)


@pytest.mark.parametrize("modes", [0, 2])
def test_one_leg_too_long_far_from_home(modes):
    own = [LIGHT | {"EA": k * 0.9, "Lp": 0.9} for k in STIFF]
    weight = 20.0 * 9.81
    system, x = robot(BASE, JOINTS, tangents(EIGHT), modes=modes, com=(0, 0, 0), legs=own)
    R, _ = turn(AT[3:])
    q = x.q.copy()
    q[..., 2] = lengths(AT)[0]
    q[0, :, :2] = [angles(p, AT[:3] + R @ d - b) for p, d, b in zip(system.leg_p, JOINTS, BASE, strict=True)]
    x = replace(x, q=q, pose=np.append(AT[:3], quaternion(R))[None])
    command = q[..., system.ports].copy()
    command[0, LEG, 0] += TOO_LONG
    found = equilibria(system, x, command, np.zeros_like(command), np.zeros(6))
    assert found.code == 0
    place, force = least_energy(command[0, :, 0], weight)
    states = found.states
    assert np.abs(force).max() > 500  # a tenth of a millimetre is worth kilonewtons, the weight 200 N
    # The energy is flat at its least: its gradient, forces of 1e3 N, is right to 1e-16 m times 5e7 N/m = 5e-9 N.
    np.testing.assert_allclose(-states.drive[0, :, 0], force, atol=1e-6 * np.abs(force).max())
    np.testing.assert_allclose(states.pose[0, :3], place[:3], atol=1e-6 * TOO_LONG)


def angles(p, leg):
    """Of the universal joint, so that the leg points along a vector of the world."""
    from flexapod.mechanics.leg.layout import LEG_PARAMETERS, columns

    x, y, z = p[columns(LEG_PARAMETERS, "R0")].reshape(3, 3) @ leg / np.linalg.norm(leg)
    return np.arctan2(-y, z), np.arcsin(x)
