"""Robots written for MuJoCo: their loops are closed, their stiffness and the forces of their drives are ours.

MuJoCo alone loads the file and finds equilibria and forces; of the product come the file and the numbers compared.
"""

from xml.etree import ElementTree

import numpy as np
import pytest
from tests.helpers.samples import known, sample_study

import flexapod as fx
from flexapod.analysis.results.variables import VARIABLES
from flexapod.kinematics import poses, rigid_limbs
from flexapod.model import (
    AxisMotion,
    CombinedMotion,
    ConstantWrench,
    ForceDrive,
    Guide,
    Load,
    ServoDrive,
    override,
)  # fmt: skip
from flexapod.model.leg.joint import Joint
from flexapod.verification.engines import mujoco_forces
from flexapod.verification.engines.mujoco_rest import MujocoStatics

pytestmark = pytest.mark.consistency

mujoco = pytest.importorskip("mujoco")

PRESETS = ("paper-robot", "machine-hexapod", "tripod", "flight-simulator", "nano-hexapod", "small-hexapod")
FILES = ("delta", "eight-legs", "flexures", "hexaglide", "planar", "tricept")
GUIDE = Guide(gland=2e8, head=2e8)


def model_of(found):
    return MujocoStatics(found.path.read_text(encoding="ascii"))


def test_lumped_legs_only_stretch(tmp_path):
    """Along the legs alone, in one piece: the stiffness of `lumped` to 1e-4, by steps of some 10 us."""
    study = override(fx.preset("paper-robot"), fidelity="lumped")
    model = model_of(fx.export(study, "mjcf", tmp_path / "robot.xml"))
    ours = fx.stiffness(study).stiffness.values
    theirs = np.linalg.inv(model.compliance(np.diag(np.linalg.inv(ours))))
    scale = np.sqrt(np.diag(ours))
    assert np.abs((theirs - ours) / np.outer(scale, scale)).max() < 1e-4
    assert model.model.opt.timestep > 1e-5 and "bend_1" not in (tmp_path / "robot.xml").read_text()


@pytest.mark.parametrize("name", [*PRESETS, *FILES])
def test_static_stiffness_is_that_of_the_study(name, tmp_path):
    """Each entry to 1e-3 of the geometric mean of its diagonal ones; without load, gravity included.

    Loops are springs in MuJoCo, 2 steps fast, 1e-4 of them lost (its hardest): parts in 1e5 of a leg; a prescribed
    carriage adds 1e-4 of a strut's. Springs stand at home, the equilibrium is micrometres away: 1e-5 of a free part.
    """
    study = known(name)
    free = ~rigid_limbs(study.robot).hub_held
    ours = fx.stiffness(study, load=np.zeros(6)).stiffness.values[np.ix_(free, free)]
    expected = np.zeros(6)
    expected[free] = np.diag(np.linalg.inv(ours))
    model = model_of(fx.export(study, "mjcf", tmp_path / "robot.xml"))
    theirs = np.linalg.inv(model.compliance(expected)[free])
    scale = np.sqrt(np.diag(ours))
    assert np.abs((theirs - ours) / np.outer(scale, scale)).max() < 1e-3


@pytest.mark.parametrize("name", ["paper-robot", "tripod", "flight-simulator", "delta", "hexaglide", "tricept"])
def test_rigid_robots_come_to_rest_on_the_forces_of_inverse_dynamics(name, tmp_path):
    """MuJoCo's equilibrium, which its own steps then keep, with commands that bring the sag back; forces to 1e-6.

    Without that servos give by micrometres of a metre, which turns legs and moves forces by as much.
    """
    study = known(name)
    model = model_of(fx.export(study, "mjcf", tmp_path / "robot.xml", fidelity="rigid"))
    data, slopes, q = model.data, model.force_gradient(model.home), model.home
    joints = model.model.jnt_qposadr[model.model.actuator_trnid[:, 0]]
    for _ in range(2):
        q = model.equilibrium(q, np.zeros(6), slopes)
        data.ctrl += model.home[joints] - q[joints]
    data.qpos[:], data.qvel[:] = model.equilibrium(q, np.zeros(6), slopes), 0.0
    for _ in range(50):
        mujoco.mj_step(model.model, data)
    driven = np.array([bool(leg.driven) for leg in study.robot.legs])
    found = fx.inverse_dynamics(study.robot, AxisMotion(type="heave", amplitude=0.0, duration=1.0))
    ours = (found.drive_force_rigid if "drive_force_rigid" in found else found.actuator_force_rigid).values[0, driven]
    stroke = {True: "actuator_force", False: "drive_force"}
    theirs = [
        data.sensor(f"{stroke[leg.driven == 'stroke']}_{i}").data[0]
        for i, leg in enumerate(study.robot.legs, start=1)
        if leg.driven
    ]
    assert theirs == pytest.approx(ours, abs=1e-6 * np.abs(ours).max())
    assert np.abs(data.efc_pos).max() < 1e-9 and np.abs(data.qvel).max() < 1e-6


def leaning_hinges():
    """A tripod whose legs do not stand square on their hinges: they go round on cones."""
    study = sample_study("tripod")
    axes = np.array([[0.2, 1.0, 0.15], [-0.866, -0.5, 0.2], [0.9, -0.5, -0.15]])
    legs = [
        leg.replace(base_joint=leg.base_joint.replace(axis=x)) for leg, x in zip(study.robot.legs, axes, strict=True)
    ]
    return study.replace(robot=study.robot.replace(legs=tuple(legs)))


@pytest.mark.parametrize("name", ["paper-robot", "tripod", "flight-simulator", "leaning"])
def test_rigid_trees_need_the_forces_of_inverse_dynamics_in_motion(name, tmp_path):
    """MuJoCo's inverse dynamics of the trees in the file, to 1e-6 of the largest force.

    What turns between pistons and platform without mass has a ten-millionth of the payload's inertia there.
    """
    study = leaning_hinges() if name == "leaning" else known(name)
    motion = CombinedMotion(
        amplitudes={"heave": 0.02, "roll": 0.1, "pitch": -0.08}, duration=0.4, independent=study.motion.independent
    )
    text = fx.export(study, "mjcf", tmp_path / "robot.xml", fidelity="rigid").path.read_text(encoding="ascii")
    ours = fx.inverse_dynamics(study.robot, motion, output_step=0.02)
    theirs = mujoco_forces.inverse_dynamics(study.robot, poses(study.robot, motion, ours.time.values), text=text)
    largest = np.abs(ours.drive_force_rigid.values).max()
    assert theirs.actuator_force == pytest.approx(ours.drive_force_rigid.values, abs=1e-6 * largest)


def test_a_run_of_steps_stays_closed_and_sags_as_the_study_does(tmp_path):
    """Half a second of steps, the payload in syrup: the sag of `modes` to 1e-3, loops closed to 10 nm.

    The weight of a piston stretches it by half of what it would at the tip: the cut in its middle is made for that.
    """
    study = fx.preset("paper-robot")
    model = model_of(fx.export(study, "mjcf", tmp_path / "robot.xml"))
    model.model.opt.tolerance = 1e-10
    mujoco.mj_forward(model.model, model.data)
    start = model.data.site("com").xpos.copy()
    model.model.dof_damping[-6:] = 3e4  # N s/m, N m s/rad
    for _ in range(int(0.5 / model.model.opt.timestep)):
        mujoco.mj_step(model.model, model.data)
    sag = fx.modes(study, load=np.zeros(6)).com_sag.values
    assert model.data.site("com").xpos - start == pytest.approx(sag, abs=1e-3 * np.abs(sag).max())
    assert np.abs(model.data.efc_pos).max() < 1e-8


@pytest.mark.parametrize("name", ["paper-robot", "tripod", "nano-hexapod", "flexures", "delta", "hexaglide"])
def test_lowest_mode_is_that_of_the_study(name, tmp_path):
    """Of MuJoCo's masses and slopes at rest; the lowest mode, of payload on legs, to 2e-3.

    A piston's mass, some per cent of what a leg carries, stands in two pieces in place of a beam.
    """
    study = known(name)
    model = model_of(fx.export(study, "mjcf", tmp_path / "robot.xml"))
    q = model.equilibrium(model.home, np.zeros(6), model.force_gradient(model.home))
    slopes, M = model.force_gradient(q), np.zeros((model.model.nv, model.model.nv))
    mujoco.mj_fullM(model.model, model.data, M)
    squared = np.linalg.eigvals(np.linalg.solve(M, -slopes)).real
    lowest = np.sqrt(squared[squared > 1.0].min()) / (2 * np.pi)
    assert lowest == pytest.approx(fx.modes(study, load=np.zeros(6)).frequency.values[0], rel=2e-3)


def test_names_are_those_of_results_and_nothing_else_is_told(tmp_path):
    found = fx.export(fx.preset("paper-robot"), "mjcf", tmp_path / "robot.xml")
    text = found.path.read_text(encoding="ascii")
    tree = ElementTree.fromstring(text)
    named = [part.get("name") for part in (*tree.find("sensor"), *tree.find("actuator"))]
    assert {name.rstrip("0123456789").rstrip("_") for name in named} <= set(VARIABLES)
    assert "leg_length_command_6" in named and "com_position" in named
    assert str(tmp_path) not in text and "/" not in text.replace("</", "").replace("/>", "")


def test_what_is_lost_is_said(tmp_path):
    robot = fx.preset("paper-robot").robot
    lost = fx.export(robot, "mjcf", tmp_path / "a.xml").left_out
    assert any("motion" in words for words in lost) and not any("[load]" in words for words in lost)
    loaded = fx.preset("paper-robot").replace(load=Load(wrench=ConstantWrench(value=[1, 0, 0, 0, 0, 0])))
    assert any("[load]" in words for words in fx.export(loaded, "mjcf", tmp_path / "m.xml").left_out)
    guided = robot.replace(legs=tuple(leg.replace(guide=GUIDE) for leg in robot.legs))
    with pytest.raises(fx.InputError, match=r"leg.guide.*not written to MJCF.*rigid"):
        fx.export(guided, "mjcf", tmp_path / "g.xml")
    assert "all that gives way" in fx.export(guided, "mjcf", tmp_path / "g.xml", fidelity="rigid").left_out[1]
    pushed = robot.replace(legs=tuple(leg.replace(drive=ForceDrive(law="rigid")) for leg in robot.legs))
    model = model_of(fx.export(pushed, "mjcf", tmp_path / "b.xml"))
    ours = fx.inverse_dynamics(robot, AxisMotion(type="heave", amplitude=0.0, duration=1.0)).actuator_force_rigid
    assert model.data.ctrl == pytest.approx(ours.values[0], rel=1e-12)  # motors hold the robot at home


def test_dampers_of_drives_and_joints_are_there(tmp_path):
    """As MuJoCo has read them: force = kp (command - stroke) - kv rate, moments of joints that hold their angles."""
    robot = fx.preset("paper-robot").robot
    below = Joint(bending=200.0, damping=0.7)
    legs = tuple(leg.replace(drive=ServoDrive(stiffness=2e6, damping=4e3), base_joint=below) for leg in robot.legs)
    robot = robot.replace(legs=legs)
    rigid = model_of(fx.export(robot, "mjcf", tmp_path / "r.xml", fidelity="rigid")).model
    assert rigid.actuator_biasprm[:, 1:3] == pytest.approx(np.tile([-2e6, -4e3], (6, 1)))
    assert rigid.actuator_gainprm[:, 0] == pytest.approx(np.full(6, 2e6))
    soft = model_of(fx.export(robot, "mjcf", tmp_path / "s.xml")).model
    # in series with the piston: softer than both, and damped as the drive is
    assert (soft.actuator_gainprm[:, 0] < 2e6).all()
    assert soft.actuator_biasprm[:, 2] == pytest.approx(np.full(6, -4e3))
    for i in range(1, 7):
        for name in ("alpha", "beta"):
            one = soft.joint(f"{name}_{i}")
            assert (one.stiffness[0], one.damping[0]) == pytest.approx((200.0, 0.7))


def test_joints_that_give_way_differently_across_and_along(tmp_path):
    """The leg without a drive that holds a tricept's platform upright, on springs at both ends; to 1e-3.

    It carries forces across, so that what gives way there counts: twice as stiff below is 2 % of a stiffness.
    """
    study = known("tricept")
    legs = tuple(
        leg if leg.driven else leg.replace(
            base_joint=leg.base_joint.replace(stiffness=np.diag([2e6, 2e6, 2e7, 0, 0, 0]), leg_axes=True),
            platform_joint=leg.platform_joint.replace(stiffness=np.diag([3e6, 3e6, 1e8, 0, 0, 0]), leg_axes=True),
        )
        for leg in study.robot.legs
    )  # fmt: skip
    soft = study.replace(robot=study.robot.replace(legs=legs))
    free = ~rigid_limbs(soft.robot).hub_held
    ours = fx.stiffness(soft, load=np.zeros(6)).stiffness.values[np.ix_(free, free)]
    expected, scale = np.zeros(6), np.sqrt(np.diag(ours))
    expected[free] = np.diag(np.linalg.inv(ours))
    model = model_of(fx.export(soft, "mjcf", tmp_path / "robot.xml"))
    theirs = np.linalg.inv(model.compliance(expected)[free])
    assert np.abs((theirs - ours) / np.outer(scale, scale)).max() < 1e-3
