"""Vibration along a path that turns a robot far, against Newton and Euler of its payload on six springs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from tests.helpers.six_springs import AFTER, MOVING, lengths, turning

import flexapod as fx
from flexapod.commissioning.feedforward.modal_path import path_vibration

pytestmark = pytest.mark.analytic


def commanded(robot: fx.model.Robot, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Place and attitude of the quintic path, R = Rz Ry Rx with no pitch."""
    x = min(max(t / MOVING, 0.0), 1.0)
    s = x**3 * (10 - 15 * x + 6 * x**2)
    (a, b), (c, d) = ((np.cos(y), np.sin(y)) for y in (0.3 * s, 0.5 * s))
    R = np.array([[c, -d, 0], [d, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, a, -b], [0, b, a]])
    return robot.home_position + s * np.array([0.05, 0, 0]), R


def tool_beside_its_path(robot: fx.model.Robot, times: np.ndarray) -> np.ndarray:
    """Tool less where the path has it (T, 3) [m], by centre of mass, quaternion, velocity, spin in payload axes."""
    payload, piston = robot.payload, robot.legs[0].piston
    stiffness, com = piston.EA / piston.length, payload.com

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        centre, q, v, w = y[:3], y[3:7], y[7:10], y[10:]
        R = Rotation.from_quat(q).as_matrix()
        wanted = np.linalg.norm(lengths(robot, *commanded(robot, t)), axis=1)
        legs = lengths(robot, centre - R @ com, R)
        long = np.linalg.norm(legs, axis=1)
        push = (stiffness * (wanted - long) / long)[:, None] * legs
        moment = R.T @ np.cross((robot.platform_joints - com) @ R.T, push).sum(axis=0)
        spin = np.linalg.solve(payload.inertia, moment - np.cross(w, payload.inertia @ w))
        turn = 0.5 * np.append(q[3] * w + np.cross(q[:3], w), -q[:3] @ w)
        return np.concatenate([v, turn, push.sum(axis=0) / payload.mass, spin])

    p, R = commanded(robot, 0.0)
    start = np.concatenate([p + R @ com, [0, 0, 0, 1], np.zeros(6)])
    # places to 1e-6 of a step's change, that of the path with it: 1e-8 m, of deviations of 1e-3
    found = solve_ivp(rate, (0, times[-1]), start, method="DOP853", rtol=1e-6, atol=1e-11, t_eval=times)
    arm = Rotation.from_quat(found.y[3:7].T).apply(payload.tool - com)
    there = [p + R @ payload.tool for p, R in (commanded(robot, t) for t in times)]
    return found.y[:3].T + arm - there


def test_a_path_that_turns_far_shakes_the_tool_as_newton_says() -> None:
    """Linear about each pose; left out are gyroscopic terms, 2 x 5 rad/s over 500 rad/s at most, of what vibrates."""
    study = turning()
    found = path_vibration(study, MOVING, MOVING + AFTER)
    exact = tool_beside_its_path(study.robot, found.time)
    assert found.time[-1] >= MOVING + AFTER - 1e-12
    moving = found.time <= MOVING
    for part in (moving, ~moving):
        size = np.abs(exact[part]).max()
        assert size > 1e-4
        np.testing.assert_allclose(found.tool[part], exact[part], rtol=0, atol=0.01 * size)
