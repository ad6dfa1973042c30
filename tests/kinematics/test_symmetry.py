"""Symmetry of the standard layout: a mirrored or turned problem has the mirrored or turned answer."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.kinematics.dynamics import LegBodies, PayloadBody, inverse_dynamics
from flexapod.kinematics.inverse import leg_frames, leg_state
from flexapod.kinematics.trajectory import Poses, rotation_matrix

pytestmark = pytest.mark.property

BASE, PLATFORM, HOME = base_circle(0.25, 10), platform_circle(0.15, 10), 0.9
FRAMES = leg_frames(BASE, PLATFORM + np.array([0, 0, HOME]))
BODIES = LegBodies(
    cylinder_mass=np.full(6, 3.0),
    cylinder_com=np.full(6, 0.1575),
    cylinder_inertia=np.full(6, 0.0248),
    cylinder_axial=np.full(6, 0.01),
    piston_mass=np.full(6, 3.35),
    piston_length=np.full(6, 0.75),
    piston_axial=np.full(6, 0.02),
)
SAMPLES = 40


def random_problem(seed):
    rng = np.random.default_rng(seed)
    v, w, a, alpha = rng.normal(size=(4, SAMPLES, 3))
    poses = Poses(
        position=rng.uniform([-0.1, -0.1, 0.8], [0.1, 0.1, 1.0], (SAMPLES, 3)),
        rotation=rotation_matrix(rng.uniform(-0.4, 0.4, (SAMPLES, 3))),
        velocity=v,
        omega=2 * w,
        acceleration=5 * a,
        alpha=10 * alpha,
    )
    root = rng.normal(size=(3, 3))
    com, tool = rng.normal(0, 0.2, (2, 3))
    payload = PayloadBody(mass=80.0, inertia=5 * np.eye(3) + root @ root.T, com=com, tool=tool)
    return poses, payload, rng.normal(0, 5, 3), rng.normal(0, 100, (SAMPLES, 6))


def transformed(q, sign, poses, payload, gravity, wrench):
    """The same problem seen through the orthogonal map q; axial vectors take its determinant `sign`."""
    turned = Poses(
        position=poses.position @ q.T,
        rotation=q @ poses.rotation @ q.T,
        velocity=poses.velocity @ q.T,
        omega=sign * poses.omega @ q.T,
        acceleration=poses.acceleration @ q.T,
        alpha=sign * poses.alpha @ q.T,
    )
    body = PayloadBody(mass=payload.mass, inertia=q @ payload.inertia @ q.T, com=q @ payload.com, tool=q @ payload.tool)
    return turned, body, q @ gravity, np.concatenate([wrench[:, :3] @ q.T, sign * wrench[:, 3:] @ q.T], axis=1)


def answer(poses, payload, gravity, wrench):
    state = leg_state(BASE, PLATFORM, FRAMES, poses)
    return state, inverse_dynamics(FRAMES, PLATFORM, BODIES, payload, gravity, poses, state, wrench)


MIRROR = np.diag([1.0, -1.0, 1.0])
TURN = rotation_matrix([0, 0, 2 * np.pi / 3])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("q", "sign", "legs"),
    [
        (MIRROR, -1, [1, 0, 5, 4, 3, 2]),  # legs 1-2, 3-6, 4-5 change places
        (TURN, 1, [4, 5, 0, 1, 2, 3]),  # leg 3 takes the part of leg 1
    ],
    ids=["mirror", "120 degrees"],
)
def test_symmetric_problem_has_the_symmetric_answer(q, sign, legs, seed):
    """Round-off only: 1e-11 of the largest force, for Jacobians with a condition below 1e3."""
    problem = random_problem(seed)
    state, force = answer(*problem)
    other_state, other = answer(*transformed(q, sign, *problem))
    scale = np.max(np.abs(force.actuator_force))
    np.testing.assert_allclose(other_state.length, state.length[:, legs], rtol=1e-13)
    np.testing.assert_allclose(other_state.accel, state.accel[:, legs], atol=1e-11)
    np.testing.assert_allclose(other.actuator_force, force.actuator_force[:, legs], atol=1e-11 * scale)
    np.testing.assert_allclose(other.joint_force, force.joint_force[:, legs] @ q.T, atol=1e-11 * scale)
    np.testing.assert_allclose(other.base_force, force.base_force[:, legs] @ q.T, atol=1e-11 * scale)
    np.testing.assert_allclose(other.base_moment, sign * force.base_moment[:, legs] @ q.T, atol=1e-11 * scale)
