"""A tripod with flexible pistons in MuJoCo falls onto the exact frequencies of beams with the second order."""

from dataclasses import replace

import numpy as np
import pytest
from tests.oracles import frames
from tests.oracles.mechanism_cases import three_rps
from tests.oracles.mechanisms import unit

pytestmark = pytest.mark.literature

STEEL = {"EI": 200e9 * np.pi * 0.027**4 / 64, "EA": 200e9 * np.pi * 0.027**2 / 4, "rhoA": 7800 * np.pi * 0.027**2 / 4}
GUIDE = {"mouth": 0.25, "length": 0.6}


def exact(robot, count):
    legs = []
    for leg in robot.legs:
        z, x, cylinder = unit(leg.tip - leg.base), leg.joints[0].axis, leg.bodies[0]
        arm = cylinder.com - leg.base
        inertia = x @ cylinder.inertia @ x + cylinder.mass * (arm @ arm)
        axial = z @ cylinder.inertia @ z
        ends = {"base_axes": x[None], "tip_axes": np.array([x, np.cross(z, x)])}
        parts = {"base": leg.base, "tip": leg.tip, "inertia": inertia, "axial_inertia": axial}
        legs.append(frames.Leg(**parts, **ends, **GUIDE, **STEEL))
    body = robot.platform.bodies[0]
    return frames.frequencies(legs, frames.Body(mass=body.mass, inertia=body.inertia, com=body.com), count)


def pieces(robot, n):
    from tests.oracles import mujoco_beams

    chains = [mujoco_beams.with_beam(leg, GJ=np.inf, n=n, **GUIDE, **STEEL) for leg in robot.legs]
    mechanism = replace(robot, legs=tuple(chain for chain, _ in chains), gravity=np.zeros(3))
    return mujoco_beams.Flexible(mechanism, [stiffness for _, stiffness in chains]).frequencies(9)[0]


def test_pieces_fall_onto_beams():
    pytest.importorskip("mujoco")
    robot = three_rps()
    reference = exact(robot, 9)
    errors = [pieces(robot, n) / reference - 1 for n in (8, 16)]
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2, atol=0.25)  # and a part of the fourth order
    extrapolated = (4 * errors[1] - errors[0]) / 3
    assert np.abs(extrapolated[:6]).max() < 1e-5  # the fourth order: (pi / 8)^4 / 1440 = 2e-5, over 3
