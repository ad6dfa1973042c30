"""`fx.modes` and `fx.stiffness`: a pose in, a Dataset out, against the forces and motions of simulations."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod.common.errors import ComputationError
from flexapod.model import AxisMotion, ForceDrive, ServoDrive

pytestmark = pytest.mark.unit

POSE = {"sway": 0.03, "heave": 0.02, "roll": 0.2}
TOOL = [0.1, 0.2, 0.3]


def still(tool=TOOL, **legs):
    study = paper_robot().replace(motion=AxisMotion(type="heave", amplitude=0.0, duration=1.0))
    payload = study.robot.payload.replace(tool=tool)
    study = study.replace(robot=study.robot.replace(payload=payload))
    return with_legs(study, **legs) if legs else study


def light(study):
    """Weightless legs but for a milligram of piston."""
    return with_legs(study, lambda leg: leg.replace(
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
        piston=leg.piston.replace(rhoA=1e-6, E=None, density=None)))  # fmt: skip


def compliance(study, fidelity, wrenches):
    """Displacement and turn of the tool per unit of wrench at rest, columns of (6, 6): central differences."""
    columns = []
    for wrench in wrenches:
        push, pull = (
            fx.simulate(study, load=side * wrench, fidelity=fidelity, duration=1e-3, step=1e-3).isel(time=0)
            for side in (1, -1)
        )
        turns = [Rotation.from_quat(data.platform_quaternion.values, scalar_first=True) for data in (push, pull)]
        step = (push.tool_position - pull.tool_position).values
        columns.append(np.concatenate([step, (turns[0] * turns[1].inv()).as_rotvec()]) / (2 * wrench.max()))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("drive", [{}, {"drive": ServoDrive(stiffness=4e7)}], ids=["prescribed", "servo"])
@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_stiffness_is_load_over_displacement(fidelity, drive):
    study = still(**drive)
    found = compliance(study, fidelity, np.diag([200.0, 200, 200, 50, 50, 50]))
    stiffness = fx.stiffness(study, fidelity=fidelity).stiffness.values
    size = np.sqrt(np.diag(stiffness))
    # In units in which all diagonals are 1. Condition about 1e3; positions round at 1e-10 of the steps of a micrometre,
    # and turns of 1e-6 rad about the sagged attitude leave out terms of their size.
    np.testing.assert_allclose(stiffness / np.outer(size, size) @ (found * np.outer(size, size)), np.eye(6), atol=2e-5)


def test_shares_add_up_and_the_stiffness_is_symmetric():
    data = fx.stiffness(still(), POSE)
    assert data.stiffness.dims == ("wrench", "component")
    assert data.wrench.values.tolist() == ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
    assert data.component.values.tolist() == ["x", "y", "z", "rx", "ry", "rz"]
    assert data.stiffness_share.dims == ("leg", "wrench", "component")
    whole = data.stiffness.values
    scale = np.sqrt(np.outer(np.diag(whole), np.diag(whole)))
    shares = data.stiffness_share.sum("leg") + data.stiffness_turning
    assert np.abs((shares.values - whole) / scale).max() < 1e-12
    assert np.abs((whole - whole.T) / scale).max() < 1e-9  # of an equilibrium without moments from outside
    assert np.linalg.eigvalsh(whole / scale)[0] > 0


def test_stiffness_without_load_is_that_of_springs():
    study = light(still())
    study = study.replace(robot=study.robot.replace(gravity=[0, 0, 0]))
    robot = study.robot
    pose = fx.kinematics.poses(robot, AxisMotion(type="roll", amplitude=0.3, duration=1.0), np.array([1.0]))
    J = fx.kinematics.length_jacobian(
        robot.base_joints, robot.platform_joints, pose.position[0], pose.rotation[0], robot.payload.tool
    )
    piston = robot.legs[0].piston
    expected = J.T @ J * piston.EA / piston.length
    found = fx.stiffness(study, {"roll": 0.3}, fidelity="lumped").stiffness.values
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_modes_of_light_legs_are_those_of_the_payload_on_its_stiffness():
    # Tool at the centre of mass, so that stiffness and mass are about one point, in world axes.
    study = light(still(tool=None))
    study = study.replace(robot=study.robot.replace(payload=study.robot.payload.replace(tool=study.robot.payload.com)))
    found = fx.modes(study, POSE, fidelity="lumped")
    K = fx.stiffness(study, POSE, fidelity="lumped").stiffness.values
    R = fx.kinematics.rotation_matrix(np.array([POSE["roll"], 0, 0]))
    payload = study.robot.payload
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = payload.mass * np.eye(3), R @ payload.inertia @ R.T
    omega2 = eigh((K + K.T) / 2, M, eigvals_only=True)
    # Six modes below those of the legs' own mass of a milligram.
    np.testing.assert_allclose(found.frequency[:6], np.sqrt(omega2) / (2 * np.pi), rtol=1e-6)
    assert set(found.kind[:6].values) == {"payload"}
    shapes = found.platform_shape.values[:6]
    np.testing.assert_allclose(shapes @ M @ shapes.T, np.eye(6), atol=1e-5)


def test_dataset_of_modes():
    study = paper_robot()
    data = fx.modes(study)
    m = data.sizes["mode"]
    assert data.mode.values.tolist() == list(range(1, m + 1))
    assert (np.diff(data.frequency) >= 0).all()
    for name, dims, unit in (
        ("frequency", ("mode",), "Hz"),
        ("damping_ratio", ("mode",), "1"),
        ("platform_shape", ("mode", "component"), "1"),
        ("leg_shape", ("mode", "leg", "direction", "station"), "1"),
        ("leg_stretch", ("mode", "leg"), "1"),
        ("com_sag", ("axis",), "m"),
    ):
        assert data[name].dims == dims
        assert data[name].attrs["units"] == unit
    assert fx.model.loads(data.attrs["study"]).robot == study.robot
    # Between a clamped-free and a clamped-pinned piston lie the first bending modes of the legs.
    kinds = data.kind.values.tolist()
    assert "leg" in " ".join(kinds)
    bending = data.frequency.values[["bending" in kind for kind in kinds]]
    assert 20 < bending[0] < 233
    # Shapes are off the line of the joints: nothing at either end.
    assert np.abs(data.leg_shape.isel(station=[0, -1])).max() < 1e-12
    assert np.abs(data.leg_shape).max() > 0.1


@pytest.mark.parametrize("roll", [0.0, np.radians(20)])
def test_modes_say_how_much_of_them_is_the_payload(roll):
    """One shape at 53 Hz, of payload and legs, was "payload" at home and "leg 3 bending" at the end of a roll."""
    # Shapes have unit mass: the payload's part is m v^2 + w J w of its own, whatever the legs do.
    study = paper_robot()
    data = fx.modes(study, {"roll": roll})
    payload, R = study.robot.payload, fx.kinematics.rotation_matrix(np.array([roll, 0, 0]))
    v, w = np.split(data.platform_shape.values, 2, axis=1)
    expected = payload.mass * (v**2).sum(axis=1) + np.einsum("mi,ij,mj->m", w, R @ payload.inertia @ R.T, w)
    # The platform sags by 2e-5 rad, and so turns its inertia by that.
    np.testing.assert_allclose(data.payload_share, expected, atol=1e-4)
    np.testing.assert_allclose(data.payload_share + data.leg_share.sum("leg"), 1.0, atol=1e-9)
    kinds, legs = data.kind.values, data.leg_share.values
    assert ((data.payload_share > 0.5) == (kinds == "payload")).all()
    single = np.flatnonzero([kind.startswith("leg ") for kind in kinds])
    assert (legs[single].max(axis=1) > data.payload_share.values[single]).all()
    assert 0.3 < data.payload_share[1] < 0.7  # the one at 53 Hz


def test_damping_ratio_of_leg_modes_is_near_that_of_the_piston():
    plain, double = (fx.modes(with_legs(paper_robot(), lambda leg, d=d: leg.replace(damping=d))) for d in (0.005, 0.01))
    np.testing.assert_allclose(double.damping_ratio[:12], 2 * plain.damping_ratio[:12], rtol=2e-3)  # small damping
    np.testing.assert_allclose(double.frequency, plain.frequency, rtol=1e-12)
    assert 1e-5 < float(plain.damping_ratio[0]) < 0.02


def test_modes_show_in_a_simulation():
    # A step of a wrench that drives the lowest mode alone: an undamped oscillation about the static answer.
    study = light(still(tool=[0, 0.373, 0]))
    study = study.replace(robot=study.robot.replace(gravity=[0, 0, 0]))
    study = with_legs(study, damping=0.0)
    found = fx.modes(study, fidelity="lumped")
    shape = found.platform_shape.values[0]
    M = np.diag([100.0] * 3 + [17.88] * 3)  # parallel to the world at home; the tool is the centre of mass
    period = 1 / float(found.frequency[0])
    step = {"law": "step", "amplitude": (1e-2 * M @ shape).tolist(), "time": 0.0}
    load = study.load.replace(wrench=step)
    data = fx.simulate(study, load=load, initial="straight", fidelity="lumped", duration=4 * period, step=period / 200,
                       output_step=period / 50)  # fmt: skip
    y = np.concatenate([data.com_deviation, data.rotation_deviation], axis=1) @ M @ shape
    # Step response of one mode, (1 - cos omega t) Q / omega^2.
    omega = 2 * np.pi / period
    expected = 1e-2 / omega**2 * (1 - np.cos(omega * data.time.values))
    np.testing.assert_allclose(y, expected, atol=2e-3 * np.abs(expected).max())  # (omega h)^2 / 12 a radian


def test_sag_is_the_deviation_at_the_start():
    study = paper_robot()
    sag = fx.modes(study).com_sag
    start = fx.simulate(study, duration=1e-3, step=1e-3).com_deviation.isel(time=0)
    np.testing.assert_allclose(sag, start, atol=1e-15)
    loaded = fx.modes(study, load=[0, 0, -5000, 0, 0, 0]).com_sag
    assert float(loaded[2]) < 3 * float(sag[2]) < 0


def test_forms_of_a_pose():
    robot = paper_robot().robot
    values = [0, 0.03, 0.02, 0.2, 0, 0]
    home = fx.kinematics.home_pose(robot)
    pose = fx.kinematics.Poses.at_rest(home.position + values[:3], fx.kinematics.rotation_matrix(np.array(values[3:])))
    by_name, by_numbers, by_pose = (fx.modes(robot, p, fidelity="lumped") for p in (POSE, values, pose))
    np.testing.assert_array_equal(by_name.frequency, by_numbers.frequency)
    np.testing.assert_array_equal(by_name.frequency, by_pose.frequency)
    at_home = fx.modes(robot, fidelity="lumped")
    np.testing.assert_array_equal(at_home.frequency, fx.modes(robot, {}, fidelity="lumped").frequency)
    assert not np.allclose(at_home.frequency, by_name.frequency, rtol=1e-3)
    # Position of the platform's origin: home plus the step plus the sag of the origin.
    np.testing.assert_allclose(by_name.platform_position, pose.position[0], atol=1e-4)


@pytest.mark.parametrize("call", [fx.modes, fx.stiffness])
@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ({"lift": 0.1}, "pose.lift"),
        ([0, 0, 0], "is not a pose"),
        ([0, 0, np.nan, 0, 0, 0], "is not a pose"),
        ({"heave": 0.3}, "leg 1 longer than its stroke allows"),
        ({"heave": -0.3}, "leg 1 shorter than its stroke allows"),
    ],
)
def test_poses_that_are_refused(call, pose, words):
    with pytest.raises(fx.InputError, match=words):
        call(paper_robot(), pose)


@pytest.mark.parametrize("call", [fx.modes, fx.stiffness])
def test_what_has_no_modes_is_refused_with_the_reason(call):
    with pytest.raises(fx.InputError):
        call(paper_robot(), fidelity="rigid")
    pure = paper_robot(leg={"drive": ForceDrive(law="rigid")})
    with pytest.raises(fx.InputError, match="holds no position"):
        call(pure)
    with pytest.raises(fx.ComputationError, match="no equilibrium"):
        call(paper_robot(), load=[0, 0, -1e6, 0, 0, 0])


def test_near_singular_pose_is_remarked_on():
    from flexapod.model import base_circle, platform_circle

    study, h = paper_robot(), np.deg2rad(28)
    study = study.replace(
        robot=study.robot.replace(base_joints=base_circle(0.25, h), platform_joints=platform_circle(0.15, h))
    )
    assert "near a singular pose" in fx.modes(study, {"roll": 0.4}).attrs["warnings"]


def test_a_piston_that_does_not_reach_its_joint_is_refused_in_words():
    study = with_legs(
        paper_robot(),
        lambda leg: leg.replace(cylinder=leg.cylinder.replace(mass=0.0, com=0.0, inertia=0.0, mouth=0.0)),
    )
    with pytest.raises(ComputationError, match="piston of leg 1 is shorter"):
        fx.modes(study)


def test_stretch_of_legs_in_a_mode_is_the_change_of_their_lengths():
    # By differences of the distances of the joints, the platform turned; of rotations of 1e-6 the square is left.
    found = fx.modes(paper_robot(), {"surge": 0.03, "roll": 0.2, "yaw": -0.3}, fidelity="lumped")
    robot, size = paper_robot().robot, 1e-6
    turn = Rotation.from_quat(np.roll(found.platform_quaternion.values, -1))
    com = found.platform_position.values + turn.as_matrix() @ robot.com

    def lengths(step):
        turned = Rotation.from_rotvec(step[3:]) * turn
        tips = com + step[:3] + (robot.platform_joints - robot.com) @ turned.as_matrix().T
        return np.linalg.norm(tips - robot.base_joints, axis=1)

    for shape, stretch in zip(found.platform_shape.values, found.leg_stretch.values, strict=True):
        unit = size / np.abs(shape).max()
        change = (lengths(unit * shape) - lengths(-unit * shape)) / (2 * unit)
        np.testing.assert_allclose(stretch, change, atol=1e-7 * np.abs(change).max() + 1e-9)
