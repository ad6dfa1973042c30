"""Friction of drives away from home: parts and the budget's row say the same, Eq. (T19.15)."""

import numpy as np
import pytest
from tests.helpers.machines import BEARING, SCREW, machine, study

import flexapod as fx
from flexapod.model import MATERIALS, Feedback, Motor, ScrewFriction, ServoDrive, StrokeFriction
from flexapod.model.leg.friction import TurningStribeck
from flexapod.model.leg.motor import Encoder

pytestmark = pytest.mark.consistency

RUBS = SCREW.replace(friction=ScrewFriction(torque=0.8, stribeck=TurningStribeck(moment=1.1, rate=5.0)))
LOOP = Feedback(stiffness=5e3, damping=20.0)
POSES = (
    {"heave": -0.08},
    {"heave": 0.08},
    {"surge": 0.06, "sway": -0.04, "heave": 0.05, "roll": 0.08, "pitch": -0.05, "yaw": 0.1},
)
DRIVES = {
    "held rotor": RUBS,
    "loop": RUBS.replace(command="servo", loop=LOOP),
    "fixed at both ends": RUBS.replace(mounting="fixed-fixed", bearing=BEARING.replace(position=0.02)),
    "loop about the stroke": RUBS.replace(command="servo", loop=LOOP, encoder=Encoder(at="stroke")),
    "motor that lags": RUBS.replace(command="servo", loop=LOOP, motor=Motor(bandwidth=500.0)),
    "servo": ServoDrive(stiffness=2e7, damping=1e4, friction=StrokeFriction(force=60.0)),
}


def placed(robot, pose):
    """Lengths of straight legs (6,), of a pose [m, rad] from home about the origin of the platform."""
    x, turn = np.add(pose[:3], [0.0, 0.0, robot.home_height]), pose[3:]
    (cr, cp, cy), (sr, sp, sy) = np.cos(turn), np.sin(turn)
    R = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    R = R @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return np.linalg.norm(x + robot.platform_joints @ R.T - robot.base_joints, axis=1), R


def moved(robot, pose, lengths):
    """Sizes by which the tool's place gives way to lengths of six legs (6,), each by itself, (3, 6) [m]."""
    six = np.array([pose.get(name, 0.0) for name in ("surge", "sway", "heave", "roll", "pitch", "yaw")])
    steps = 1e-6 * np.eye(6)
    by_pose = np.array([(placed(robot, six + h)[0] - placed(robot, six - h)[0]) / 2e-6 for h in steps]).T

    def tool(at):
        return at[:3] + placed(robot, at)[1] @ robot.payload.tool

    of_tool = np.array([(tool(six + h) - tool(six - h)) / 2e-6 for h in steps]).T
    return np.abs(of_tool @ np.linalg.inv(by_pose) * lengths)


def row(found):
    return found.budget.sel(part="drive friction", kind="hysteretic").values[:3]


@pytest.mark.parametrize("pose", POSES, ids=["down", "up", "anywhere"])
@pytest.mark.parametrize("drive", DRIVES, ids=[name.replace(" ", "-") for name in DRIVES])
def test_the_row_of_the_budget_is_the_lost_motion_of_the_legs(drive, pose):
    # Legs of given lengths place the platform: what each lags by, times how the tool follows its length, in rigid
    # geometry. Elastic legs under a ton are some 1e-4 of a metre away from it, and so are the factors.
    one = study(machine(drive=DRIVES[drive]), fidelity="lumped")
    lag = fx.parts(one, pose).lost_motion.values
    np.testing.assert_allclose(row(fx.budget(one, pose)), moved(one.robot, pose, lag).sum(axis=1), rtol=2e-3)


@pytest.mark.parametrize("heave", [-0.08, 0.0, 0.08])
def test_the_lost_motion_of_a_twisted_shaft_by_hand(heave):
    # Six legs on circles of 0.6 and 0.35 m, joints of a leg 44 deg apart, 0.8 m high, bearing 60 mm from the joint and
    # pistons of 0.6 m. The motor's 0.5 N m wind the free shaft up by M x / GJ, the nut lags by P / 2 pi of it; each leg
    # carries a sixth of the heave, l / H of its own. First order of a robot whose legs give way by 3e-5 m.
    H = 0.8 + heave
    length = np.sqrt(H**2 + 0.6**2 + 0.35**2 - 2 * 0.6 * 0.35 * np.cos(np.radians(44)))
    steel = MATERIALS["steel"]
    GJ = steel.E / (2 * (1 + steel.poisson)) * np.pi / 32 * 0.028744**4
    lag = 0.01 / (2 * np.pi) * 0.5 * (length - 0.66) / GJ
    robot = fx.preset("machine-hexapod")
    np.testing.assert_allclose(fx.parts(robot, {"heave": heave}).lost_motion.values, lag, rtol=1e-9)
    found = fx.budget(robot, {"heave": heave})
    assert row(found)[2] == pytest.approx(lag * length / H, rel=1e-3)
    assert row(found)[2] * 1e6 == pytest.approx({-0.08: 0.03153, 0.0: 0.04295, 0.08: 0.05436}[heave], abs=1e-5)
