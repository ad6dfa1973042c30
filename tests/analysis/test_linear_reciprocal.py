"""Static laws of the linear model: Betti's between drives and forces, and slopes of loaded equilibria."""

import numpy as np
import pytest
from tests.helpers.machines import study
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.samples import MECHANISMS, sample_study

import flexapod as fx
from flexapod.kinematics.rotations import matrix

pytestmark = pytest.mark.analytic


def robot_of(name):
    return sample_study(name) if (MECHANISMS / f"{name}.toml").exists() else study(ROBOTS[name]())


@pytest.mark.parametrize("name", ["6-RUS", "hexaglide", "tripod", "delta", "tricept"])
def test_forces_that_hold_a_drive_are_ways_of_the_tool_by_it(name):
    """Betti: what a unit wrench adds to a drive's force is what the tool moves against it by a unit of the drive."""
    given = robot_of(name)
    hz = 1e-3
    lin = fx.linearize(given, inputs=["wrench", "command"], outputs=["tool", "drive-force"])
    H = lin.at([hz])[:, :, 0]
    held, moved = H[6:, :6].real, ((2j * np.pi * hz) ** 2 * H[:6, 6:]).real
    # at 1 mHz inertia is 1e-8 of it and less
    assert held == pytest.approx(-moved.T, abs=1e-6 * np.abs(moved).max())


def test_cranks_have_angles_and_torques():
    lin = fx.linearize(robot_of("6-RUS"), inputs=["command", "wrench"], outputs=["stroke", "drive-force", "encoder"])
    units = [lin.units[name] for name in ("command:2", "stroke:2", "drive-force:2", "encoder:2")]
    assert units == ["rad/s^2", "rad", "N m", "rad"]
    # told to turn by 1 it turns by 1
    s = 2j * np.pi * 1e-3
    assert s**2 * lin.at([1e-3])[:6, :6, 0] == pytest.approx(np.eye(6), abs=1e-9)


LOAD = np.array([40.0, -30.0, 60.0, 2.0, 3.0, -1.0])


def tool_at(given, load, pose):
    """Place and attitude of the tool of the loaded robot."""
    lin = fx.linearize(given, pose, inputs="wrench", outputs="tool", load=load)
    R = matrix(lin.quaternion[None])[0]
    return lin.position + R @ (given.robot.tool - given.robot.com), R


@pytest.mark.parametrize(("name", "pose"), [("tripod", {"heave": 0.005}), ("tricept", {"heave": 0.004})])
def test_compliance_is_the_slope_of_loaded_equilibria(name, pose):
    """Robots of fewer motions under a load: central differences of the nonlinear equilibrium, all six directions."""
    given = robot_of(name)
    found = fx.compliance(given, [0.0], pose, load=LOAD).compliance.sel(part="real").values[..., 0]
    steps = np.diag([10.0, 10.0, 10.0, 1.0, 1.0, 1.0])
    columns = []
    for step in steps:
        (after, R), (before, Q) = (tool_at(given, LOAD + way * step, pose) for way in (1, -1))
        turn = 0.5 * (R @ Q.T - Q @ R.T)[[2, 0, 1], [1, 2, 0]]
        columns.append(np.concatenate([after - before, turn]) / (2 * step.max()))
    # displacements are 1e-5 of the robot: the third order is 1e-9, equilibria are found to 1e-10 of the step
    for rows in (slice(0, 3), slice(3, 6)):
        assert np.array(columns).T[rows] == pytest.approx(found[rows], abs=1e-6 * np.abs(found[rows]).max())
