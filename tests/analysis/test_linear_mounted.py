"""Sensors of a robot on a base plate that gives way: what is between them, what moves with the plate, other points."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.machines import BASE, light, machine, study

import flexapod as fx
from flexapod.kinematics.rotations import matrix
from flexapod.model.study.mount import BaseMotion
from flexapod.verification.cases.linear import stewart

pytestmark = pytest.mark.analytic

HZ = np.array([3.0, 40.0, 300.0])
S = 2j * np.pi * HZ


def cross(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def test_legs_without_mass_press_alike_on_plate_and_platform():
    """Between the sensors at both ends of a leg lies nothing; the plate's own inertia is behind the lower one."""
    robot = light(machine(), gravity=[0, 0, 0], base_mount=BASE)
    lin = fx.linearize(study(robot, fidelity="lumped"), inputs=["wrench", "floor"],
                       outputs=["force-sensor:base", "force-sensor:platform"])  # fmt: skip
    H = lin.at(HZ)
    # rounding, times the plate's inertia over the force that is left: below 1e3 each
    assert np.abs(H[:6] - H[6:]).max(axis=(0, 1)) == pytest.approx(0.0, abs=1e-8 * np.abs(H).max())
    assert (np.abs(H[:6] - H[6:]).max(axis=0) < 1e-6 * np.abs(H[:6]).max(axis=0)).all()


def test_a_stiff_robot_on_a_leaning_plate_does_not_leave_it():
    """Weight beside the middle leans the plate by some 0.05 rad; seen from it a stiff machine hardly moves."""
    robot = machine()
    legs = tuple(leg.replace(piston=leg.piston.replace(EA=1e13, EI=1e10)) for leg in robot.legs)
    payload = robot.payload.replace(com=[0.3, 0.2, 0.4], tool=[-0.4, 0.5, 0.9])
    stiff = np.diag([1e6, 1e6, 1e6, 5e4, 6e4, 7e4])
    stiff[[3, 5, 4, 5], [5, 3, 5, 4]] = [3e4, 3e4, -2e4, -2e4]  # moments about level axes turn it about the third, too
    soft = BASE.replace(stiffness=stiff)
    given = study(robot.replace(legs=legs, payload=payload, base_mount=soft), fidelity="lumped")
    lin = fx.linearize(given, inputs="wrench", outputs=["tool", "tool-base", "com", "com-base"])
    q = lin.quaternion / np.linalg.norm(lin.quaternion)
    assert (np.abs(2 * q[1:]) > 0.01).all() and 2 * np.linalg.norm(q[1:]) < 0.5
    H = lin.at([0.01])[:, :, 0]
    # springs of legs are 1e13 / 0.75 N/m over 1e6 of the mount: 1e-6, of arms and turns alike
    assert np.abs(H[6:12]).max() < 1e-4 * np.abs(H[:6]).max()
    assert np.abs(H[15:]).max() < 1e-4 * np.abs(H[12:15]).max()


POSE = {"surge": 0.01, "heave": 0.01, "roll": 0.03, "pitch": -0.02, "yaw": 0.05}


def test_a_floor_that_turns_about_another_point():
    """About p it turns as about the origin, and displaces the origin by -turn x p besides."""
    given = fx.preset("machine-hexapod")
    p = np.array([0.3, -0.4, 0.7])
    moved = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)), at=p)
    there = given.replace(robot=given.robot.replace(base_motion=moved))
    outputs = ["tool", "force-sensor:base", "accelerometer:(0.2, 0.1, 0.3)", "force-sensor:drive"]
    one, other = (fx.linearize(x, POSE, inputs="floor", outputs=outputs).at(HZ) for x in (given, there))
    carry = np.eye(6)
    carry[:3, 3:] = -cross(-p)  # turn x (0 - p)
    for rows in (slice(0, 6), slice(6, 12), slice(12, 15), slice(15, 21)):
        exact = np.einsum("ijf,jk->ikf", one[rows], carry)
        assert other[rows] == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_transmissibility_at_another_point_of_a_turned_platform():
    """T of a point is that of the tool between displacements carried rigidly from one to the other."""
    given = stewart()
    pose, at, hz = {"heave": -0.003, "roll": 0.02, "yaw": 0.04}, "(0.03, -0.05, 0.02)", [100.0, 850.0, 2000.0]
    T, P = (fx.transmissibility(given, hz, pose, at=x).transmissibility for x in ("tool", at))
    T, P = (x.sel(part="real").values + 1j * x.sel(part="imaginary").values for x in (T, P))
    lin = fx.linearize(given, pose, inputs="wrench", outputs="tool")
    carry = np.eye(6)
    carry[:3, 3:] = -cross(matrix(lin.quaternion[None])[0] @ (np.array([0.03, -0.05, 0.02]) - given.robot.tool))
    exact = np.einsum("ij,jkf,kl->ilf", carry, T, np.linalg.inv(carry))
    assert exact == pytest.approx(P, abs=1e-9 * np.abs(P).max())
    assert np.abs(T - P).max() > 0.05 * np.abs(P).max()
    # at the tool: what it does as seen from a floor that turns about that place, and the floor's own motion
    place = lin.position + matrix(lin.quaternion[None])[0] @ (given.robot.tool - given.robot.com)
    moved = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)), at=place)
    there = given.replace(robot=given.robot.replace(base_motion=moved))
    H = fx.linearize(there, pose, inputs="floor", outputs="tool").at(hz)
    own = np.eye(6)[:, :, None] + (2j * np.pi * np.array(hz)) ** 2 * H
    assert own == pytest.approx(T, abs=1e-9 * np.abs(T).max())


@pytest.mark.parametrize("at", ["(0.5 m, -300 mm, 1.2)", "joint-2", "platform", "com"])
def test_points_of_a_turned_platform_move_with_it(at):
    """Forces on a point, and accelerations there, are those of the rigid platform, whose tool is far from its mass."""
    given = fx.preset("machine-hexapod")
    payload = given.robot.payload.replace(tool=[0.4, -0.6, 1.0])
    given = given.replace(robot=given.robot.replace(payload=payload, gravity=np.zeros(3)))
    robot = given.robot
    place = {"joint-2": robot.platform_joints[1], "platform": np.zeros(3), "com": robot.com}
    point = place.get(at, np.array([0.5, -0.3, 1.2]))
    lin = fx.linearize(given, POSE, inputs=["wrench", f"force:{at}"], outputs=["tool", "com", f"accelerometer:{at}"])
    H, R = lin.at(HZ), matrix(lin.quaternion[None])[0]
    arm = R @ (point - robot.tool)
    moved = H[:3] - np.einsum("ij,jkf->ikf", cross(arm), H[3:6])
    assert H[9:] == pytest.approx(S**2 * moved, abs=1e-9 * np.abs(S**2 * moved).max())
    com = H[:3] - np.einsum("ij,jkf->ikf", cross(R @ (robot.com - robot.tool)), H[3:6])
    assert H[6:9] == pytest.approx(com, abs=1e-9 * np.abs(com).max())
    pushed = H[:, :3] + np.einsum("ikf,kj->ijf", H[:, 3:6], cross(arm))  # moment arm x f at the tool
    assert H[:, 6:] == pytest.approx(pushed, abs=1e-9 * np.abs(pushed).max(axis=(1, 2)).max())


def test_what_jumps_with_a_force_is_the_response_without_end():
    """Feed-through of accelerometers: what an impulse of a force does to the rates, far above all frequencies."""
    lin = fx.linearize(stewart(), inputs=["wrench", "force:com"], outputs="accelerometer:com")
    # the last mode is at 1.27 kHz, damped by springs' dampers whose share falls with 1 / f: c / (m w) = 20 / 6e9
    assert lin.at([1e9])[:, :, 0] == pytest.approx(lin.D, abs=1e-6 * np.abs(lin.D).max())
    assert np.abs(lin.D[:, 6:]).max() > 0.5  # 1 kg and some of the rods'


def test_a_floor_that_turns_shakes_an_uneven_payload_of_a_turned_robot():
    """Massless springs, Newton and Euler in floor axes: M x'' + J' k J x = -(m (a + alpha x r), R I R' alpha)."""
    rpy, place = {"roll": 0.3, "pitch": -0.2, "yaw": 0.4}, {"surge": 0.05, "sway": -0.03, "heave": 0.04}
    robot = light(machine(damping=0.0), gravity=[0, 0, 0])
    inertia = np.array([[120.0, 30.0, -20.0], [30.0, 90.0, 10.0], [-20.0, 10.0, 170.0]])
    robot = robot.replace(payload=robot.payload.replace(inertia=inertia, com=[0.1, -0.05, 0.15], tool=[0.2, 0.1, 0.5]))
    lin = fx.linearize(study(robot, fidelity="lumped"), {**place, **rpy}, inputs="floor", outputs=["tool", "com"])
    R = Rotation.from_euler("xyz", [*rpy.values()]).as_matrix()
    origin = robot.home_position + np.array([*place.values()])
    tips, r = origin + robot.platform_joints @ R.T, origin + R @ robot.com
    axes = tips - robot.base_joints
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    J = np.hstack([axes, np.cross(tips - r, axes)])
    k = np.array([x.piston.EA / x.piston.length for x in robot.legs])
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = robot.payload.mass * np.eye(3), R @ inertia @ R.T
    shaken = M @ np.block([[np.eye(3), -cross(r)], [np.zeros((3, 3)), np.eye(3)]])
    x = np.stack([np.linalg.solve(s**2 * M + J.T @ (k[:, None] * J), -shaken) for s in S], axis=2)
    tool = np.einsum("ij,jkf->ikf", np.block([[np.eye(3), -cross(R @ (robot.tool - robot.com))], [np.eye(6)[3:]]]), x)
    H = lin.at(HZ)
    # rounding, over the distance from the resonances
    assert H[:6] == pytest.approx(tool, abs=1e-7 * np.abs(tool).max())
    assert H[6:] == pytest.approx(x[:3], abs=1e-7 * np.abs(x).max())


def test_a_plate_that_cannot_move_is_not_felt_above_it():
    """Mass and weight of a plate of hard springs are below the sensors; the legs' are above, on a floor that tilts."""
    robot, load = machine(), fx.model.Load(wrench=fx.model.ConstantWrench(value=[2e3, -1e3, 0.0, 0.0, 300.0, 200.0]))
    hard = BASE.replace(stiffness=np.diag([1e14] * 3 + [1e14] * 3))
    outputs = ["force-sensor:base", "force-sensor:platform", "tool"]
    plain, mounted = (
        fx.linearize(study(x, fidelity="lumped").replace(load=load), POSE, inputs=["wrench", "floor"], outputs=outputs)
        for x in (robot, robot.replace(base_mount=hard))
    )
    slow = [0.01, 3.0]
    exact = plain.at(slow)
    for rows in (slice(0, 6), slice(6, 12), slice(12, 15), slice(15, 18)):
        # springs of the legs, 4e8 N/m, over those of the plate: 4e-6; of the largest of an input at a frequency
        apart = np.abs(mounted.at(slow)[rows] - exact[rows]).max(axis=0)
        assert (apart < 1e-4 * np.abs(exact[rows]).max(axis=0)).all()
