"""Springs at both ends of rigid legs against MuJoCo: small vibrations, and the equilibrium of a leaning robot."""

from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from tests.helpers.machines import SOFT, machine, study

import flexapod as fx
from flexapod.analysis.results.arguments import as_pose
from flexapod.kinematics.rotations import matrix
from flexapod.model import AxialSpring
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.verification.engines.mujoco_forces import LEAST, mjcf

pytestmark = pytest.mark.consistency

mujoco = pytest.importorskip("mujoco")

HEAD = AxialSpring(name="head", at="platform", stiffness=90e6)
#: Joints at the base that give way along and across the leg, another spring along it at the platform.
ROBOT = machine(base_joint=SOFT, springs=(HEAD,))
COORDINATES = ("alpha", "beta", "u1", "u2", "u3", "l", "e3")


def on_springs(robot):
    """Open chains of the rigid robot with slides on springs after the base joints and before the platform's."""
    tree = ElementTree.fromstring(mjcf(robot))
    across, along = (float(SOFT.stiffness[k, k]) for k in (0, 2))
    for i in range(1, robot.count + 1):
        cylinder, piston = (tree.find(f".//body[@name='{name}_{i}']") for name in ("cylinder", "piston"))
        slides = [slide(f"u{k}_{i}", k, stiffness) for k, stiffness in ((1, across), (2, across), (3, along))]
        for place, joint in enumerate(slides, start=len(cylinder.findall("joint"))):
            cylinder.insert(place, joint)
        head = ElementTree.SubElement(piston, "body", name=f"head_{i}")
        head.append(slide(f"e3_{i}", 3, HEAD.stiffness))
        ElementTree.SubElement(
            head, "inertial", pos="0 0 0", mass=str(LEAST), diaginertia=" ".join([str(LEAST)] * 3)
        )  # fmt: skip
    return mujoco.MjModel.from_xml_string(ElementTree.tostring(tree, encoding="unicode"))


def slide(name, axis, stiffness):
    axes = " ".join(map(str, np.eye(3)[axis - 1]))
    return ElementTree.Element("joint", name=name, type="slide", axis=axes, stiffness=repr(stiffness))


def placed(model, found, states):
    """MuJoCo's data at one of our resting states, and the Jacobian of tips less joints of the payload, (18, any)."""
    data, robot = mujoco.MjData(model), ROBOT
    shapes, n = found.kernel.shapes, robot.count
    for i in range(n):
        for name in COORDINATES:
            data.joint(f"{name}_{i + 1}").qpos[0] = states.q[0, i, shapes.index(name)]
        data.joint(f"beta_{i + 1}").qpos[0] -= fx.kinematics.rigid_limbs(robot).home[i, 2]
    R = matrix(states.pose[:, 3:])[0]
    data.joint("payload").qpos[:] = [*(states.pose[0, :3] - R @ robot.payload.com), *states.pose[0, 3:]]
    mujoco.mj_forward(model, data)
    rows, payload = [], model.body("payload").id
    joints = data.xpos[payload] + robot.platform_joints @ R.T
    tips = [model.body(f"head_{i}").id for i in range(1, n + 1)]
    np.testing.assert_allclose(data.xpos[tips], joints, rtol=0, atol=1e-12)  # our closure is theirs
    for tip, joint in zip(tips, joints, strict=True):
        one, other = np.zeros((2, 3, model.nv))
        mujoco.mj_jac(model, data, one, None, data.xpos[tip], tip)
        mujoco.mj_jac(model, data, other, None, joint, payload)
        rows.append(one - other)
    return data, np.concatenate(rows)


def at_rest(robot, pose=None):
    given = study(robot, fidelity="rigid")
    found = locked_poses(robot, given.simulation, as_pose(robot, pose), None)
    return found.system, found.equilibria.states


def held(model):
    """The coordinates of the drives."""
    return np.array([model.joint(f"l_{i}").dofadr[0] for i in range(1, ROBOT.count + 1)])


def test_small_vibrations():
    # At rest without gravity: the stiffness is that of the springs alone, masses and closures are MuJoCo's.
    robot = ROBOT.replace(gravity=[0, 0, 0])
    model = on_springs(robot)
    data, G = placed(model, *at_rest(robot))
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    K = np.zeros(model.nv)
    K[model.jnt_dofadr] = model.jnt_stiffness[:, 0] if model.jnt_stiffness.ndim > 1 else model.jnt_stiffness
    free = np.setdiff1d(np.arange(model.nv), held(model))
    Z = null_space(G[:, free])
    theirs = np.sqrt(eigh(Z.T @ (K[free, None] * Z), Z.T @ M[np.ix_(free, free)] @ Z, eigvals_only=True)) / (2 * np.pi)
    assert len(theirs) == 24
    np.testing.assert_allclose(fx.modes(robot, fidelity="rigid").frequency, theirs, rtol=1e-9)


def test_the_equilibrium_of_a_leaning_robot():
    # Gravity, springs and geometry of the displaced robot are MuJoCo's: our state leaves nothing that moves it.
    model = on_springs(ROBOT)
    data, G = placed(model, *at_rest(ROBOT, {"surge": 0.03, "heave": -0.02, "roll": 0.1, "yaw": 0.05}))
    assert np.abs(data.qpos[[model.joint(f"e3_{i}").qposadr[0] for i in range(1, 7)]]).max() > 1e-5
    data.qacc[:] = 0.0
    mujoco.mj_inverse(model, data)
    free = np.setdiff1d(np.arange(model.nv), held(model))
    needed, Z = data.qfrc_inverse[free], null_space(G[:, free])
    assert np.abs(Z.T @ needed).max() < 1e-9 * np.abs(needed).max()
