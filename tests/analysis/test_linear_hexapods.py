"""All channels of rigid hexapods against Newton and Euler by hand: turned, loaded, sagged, on a floor that turns."""

import numpy as np
import pytest
from tests.helpers.mechanisms import LOWER, UPPER, built, ring
from tests.oracles.ups import Hexapod

import flexapod as fx
from flexapod.kinematics.rotations import matrix
from flexapod.model import ConstantWrench, Load, ServoDrive, Simulation, Study
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston
from flexapod.model.motion import AxisMotion
from flexapod.model.study.mount import BaseMotion
from flexapod.model.study.payload import Payload

pytestmark = pytest.mark.analytic

HZ = np.array([0.01, 0.5, 6.0, 40.0])
POSE = {"surge": 0.03, "sway": -0.02, "heave": 0.02, "roll": 0.12, "pitch": -0.08, "yaw": 0.15}
UNEVEN = np.array([[1.3, 0.2, -0.15], [0.2, 0.9, 0.3], [-0.15, 0.3, 1.7]])
LOAD = np.array([230.0, -60.0, -90.0, 12.0, -7.0, 9.0])
CORNERS = np.repeat(np.arange(4) * 90.0, 2)
LEGS = {
    "six": (LOWER, UPPER),
    "eight": (CORNERS + np.tile([-12, 12], 4), CORNERS + np.tile([-35, 35], 4) + 8.0),
}  # fmt: skip
CYLINDER, PISTON, SERVO = (6.0, 0.21, 0.11), (3.0, 0.55), (4e5, 900.0)


def study(which, gravity):
    """Soft servos, on which 20 kg and 230 N sag by 0.4 mm, legs of 9 kg."""
    lower, upper = LEGS[which]
    drive = ServoDrive(stiffness=SERVO[0], damping=SERVO[1])
    leg = Leg(
        cylinder=Cylinder(mass=CYLINDER[0], com=CYLINDER[1], inertia=CYLINDER[2], mouth=0.4),
        piston=Piston(length=PISTON[1], EA=1e8, EI=1e4, rhoA=PISTON[0] / PISTON[1]), drive=drive,
    )  # fmt: skip
    payload = Payload(mass=20.0, inertia=UNEVEN, com=[0.03, -0.02, 0.08], tool=[-0.1, 0.15, 0.25])
    robot = built(
        f"{len(lower)}-UPS", ring(0.35, lower), ring(0.2, upper), 0.8, [leg] * len(lower), payload=payload,
    ).replace(gravity=gravity)  # fmt: skip
    moved = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)), at=[0.2, -0.3, 0.15])
    return Study(
        robot=robot.replace(base_motion=moved), motion=AxisMotion(type="heave", amplitude=0.01, duration=0.1),
        simulation=Simulation(fidelity="rigid"), load=Load(wrench=ConstantWrench(value=LOAD)),
    )  # fmt: skip


def by_hand(given):
    """The same by hand, at rest."""
    robot = given.robot
    path = fx.kinematics.poses_from_home(robot, np.array([list(POSE.values())]))
    attitude = path.rotation[0]
    place = path.position[0] + attitude @ robot.com
    joints = robot.platform_joints - robot.com
    length = np.linalg.norm(place + joints @ attitude.T - robot.base_joints, axis=1)
    found = Hexapod(
        base=robot.base_joints, joints=joints, tool=robot.tool - robot.com, mass=20.0, inertia=UNEVEN,
        cylinder=CYLINDER, piston=PISTON, stiffness=SERVO[0], damping=SERVO[1], gravity=robot.gravity, load=LOAD,
        about=np.array([0.2, -0.3, 0.15]), place=place, attitude=attitude, command=length,
    )  # fmt: skip
    found.rest()
    return found


@pytest.mark.parametrize(
    "gravity", [[0.0, 0.0, -9.81], [1.2, -2.5, -9.0], [0.0, 0.0, 0.0]], ids=["down", "aslope", "no"]
)
@pytest.mark.parametrize("which", LEGS)
def test_all_channels_as_by_hand(which, gravity):
    given = study(which, gravity)
    hand = by_hand(given)
    R = hand.attitude
    outputs = [
        "tool", "com", "stroke", "encoder", "drive-force", "force-sensor:drive", "joint-force", "force-sensor:platform",
        "force-sensor:base", "accelerometer:joint-2",
    ]  # fmt: skip
    lin = fx.linearize(given, POSE, inputs=["wrench", "command", "floor"], outputs=outputs)
    assert lin.position == pytest.approx(hand.place, abs=1e-10)
    assert matrix(lin.quaternion[None])[0] == pytest.approx(R, abs=1e-9)
    H = hand.response(HZ, hand.joints[1])
    for name, exact in H.items():
        rows = [
            i for i, x in enumerate(lin.outputs) if x.startswith(f"{name}:") and x.count(":") <= name.count(":") + 2
        ]
        found = lin.at(HZ)[rows]
        # rounding, 1e-16, times the ratio of the fastest mode to 0.01 Hz, squared, 1e7, and some ten; of the largest of
        # an input at a frequency, and of accelerations at slow ones, which are what is left of much, of all frequencies
        scale = np.abs(exact).max(axis=0)
        close = 1e-7 * scale + 1e-10 * scale.max(axis=1, keepdims=True)
        assert (np.abs(found - exact).max(axis=0) <= close).all(), name


def test_sensors_of_a_bent_robot_sit_on_the_line_of_its_joints():
    """What a leg presses with at rest is felt as its line turns, legs bend."""
    given = fx.preset("paper-robot")
    pose = {"surge": 0.02, "roll": 0.06, "pitch": -0.05, "yaw": 0.08}
    lin = fx.linearize(given, pose, inputs="wrench", outputs=["com", "tool", "joint-force", "force-sensor:platform"])
    H, R, robot = lin.at(HZ), matrix(lin.quaternion[None])[0], given.robot
    arm = (robot.platform_joints - robot.com) @ R.T
    line = lin.position + arm - robot.base_joints
    length = np.linalg.norm(line, axis=1)
    e = line / length[:, None]
    moved = H[:3] + np.einsum("iba,bmf->iamf", np.array([np.cross(np.eye(3), x) for x in arm]), H[6:9])  # turn x arm
    rest = lin.plant.x.lam[0, :, :3]
    across = rest - e * (e * rest).sum(axis=1)[:, None]
    turned = np.einsum("ia,iamf->imf", across / length[:, None], moved)
    exact = np.einsum("ia,iamf->imf", e, H[9:27].reshape(6, 3, *H.shape[1:])) + turned
    assert np.abs(H[27:] - exact).max() < 1e-10 * np.abs(exact).max()  # rounding of the equilibrium, 1e-12
    assert np.abs(turned).max() > 1e-7 * np.abs(exact).max()  # 100 N over 20 N/um and a metre
