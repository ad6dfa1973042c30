"""Many poses in one call against dense algebra pose by pose, and against the readable matrices of one state."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.results.poses import poses_about_home
from flexapod.model import ConstantWrench, Cylinder, Load, ServoDrive, Waypoint, WaypointMotion, override
from flexapod.solve.batch import RestStates, matrices_at_rest, residual_at_rest
from flexapod.solve.kernel import interpreted_kernel
from flexapod.solve.modal.at_poses import locked_poses, robot_modes, robot_stiffness
from flexapod.solve.modal.modes import modes_of
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.saddle_point import saddle_solve, solve_each
from flexapod.solve.statics.block_arrow import arrow_solve
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.solve.statics.static_loads import rest_commands
from flexapod.solve.statics.stiffness import stiffness_of, tool_motion

pytestmark = pytest.mark.consistency

WRENCH = np.array([50.0, -30.0, -200.0, 5.0, 4.0, -3.0])
LOAD = Load(wrench=ConstantWrench(value=WRENCH))
POSES = np.array([
    [0, 0, 0, 0, 0, 0], [0.03, -0.02, 0.04, 0.1, -0.05, 0.2], [-0.02, 0.03, -0.05, -0.2, 0.1, -0.3],
    [0, 0, 0.08, 0.0, 0.2, 0.0], [0.01, 0, 0, 0.3, 0, 0.1],
])  # fmt: skip


def servos(study, which=range(1, 7)):
    legs = [
        leg.replace(drive=ServoDrive(stiffness=4e7, damping=1e4)) if i in which else leg
        for i, leg in enumerate(study.robot.legs, start=1)
    ]
    return study.replace(robot=study.robot.replace(legs=tuple(legs)))


def no_stretch(study):
    return with_legs(study, axial_modes=0)


@cache
def robot(name):
    study = paper_robot()
    return {
        "prescribed": study,
        "servo": servos(study),
        "mixed": servos(study, (2, 5)),
        "no stretch": no_stretch(study),
        "mixed, no stretch": servos(no_stretch(study), (1, 2, 3)),
        "lumped": override(study, fidelity="lumped"),
        "rigid servo": servos(override(study, fidelity="rigid")),
    }[name]


KINDS = ["prescribed", "servo", "mixed", "no stretch", "mixed, no stretch", "lumped", "rigid servo"]


@pytest.mark.parametrize("kind", KINDS)
def test_equilibria_balance_and_modes_are_those_of_dense_matrices(kind):
    study = robot(kind)
    path = poses_about_home(study.robot, POSES)
    locked = locked_poses(study.robot, study.simulation, path, LOAD)
    modes = modes_of(locked, shapes=True)
    system = locked.system
    assert locked.at.tolist() == list(range(len(POSES)))
    for k in range(len(POSES)):
        x = locked.equilibria.states.state(k)
        table = np.zeros((6, 1, 4))
        table[..., 0] = locked.command[k]
        r, g, _ = system.residual(x, table, WRENCH)
        size = np.abs(x.lam).max()
        assert np.abs(r).max() < 1e-9 * size  # 1e8 N/m on steps of 1e-16 m: 1e-8 N on a kilonewton
        assert np.abs(g).max() < 1e-14
        assert np.abs((x.q - locked.command[k])[system.held]).max(initial=0) == 0
        m = system.matrices(x, WRENCH)
        scale = 1 / np.sqrt(np.maximum(np.diag(m.M), 1e-12))
        N = scale[:, None] * null_space(np.vstack([m.G, np.eye(system.size)[system.fixed_mask]]) * scale)
        M, K = N.T @ m.M @ N, N.T @ m.K @ N
        frequency = np.sqrt(eigh((K + K.T) / 2, M, eigvals_only=True)) / (2 * np.pi)
        # Squares of the frequencies are right to rounding times the square of the highest over the lowest, 200 here.
        np.testing.assert_allclose(modes.frequency[k], frequency, rtol=1e-10)
        shapes = modes.shapes[k]
        assert np.abs(m.G @ shapes.T).max() < 1e-10
        np.testing.assert_allclose(shapes @ m.M @ shapes.T, np.eye(len(shapes)), atol=1e-9)
        K_modal = shapes @ (m.K + m.K.T) / 2 @ shapes.T
        omega2 = (2 * np.pi * frequency) ** 2
        np.testing.assert_allclose(K_modal, np.diag(omega2), atol=1e-10 * omega2.max())


@pytest.mark.parametrize("kind", KINDS)
def test_a_newton_step_is_that_of_the_saddle_matrix(kind):
    study = robot(kind)
    locked = locked_poses(study.robot, study.simulation, poses_about_home(study.robot, POSES), LOAD)
    system, rng = locked.system, np.random.default_rng(5)
    r, payload, g = rng.normal(size=(5, 6, system.n)), rng.normal(size=(5, 6)), 1e-3 * rng.normal(size=(5, 6, 3))
    gap = np.where(system.held, 1e-3 * rng.normal(size=(5, 6, system.n)), 0.0)
    step = arrow_solve(system, locked.m, r, payload, g, gap)
    for k in range(5):
        m = system.matrices(locked.equilibria.states.state(k), WRENCH)
        given = -np.concatenate([g[k].ravel(), gap[k][system.held]])
        G = np.vstack([m.G, np.eye(system.size)[system.fixed_mask]])
        dq, multipliers = saddle_solve(m.K, G, -np.concatenate([r[k].ravel(), payload[k]]), given)
        # The saddle matrix loses six digits or so: forces of 1e8 N/m springs balance within millinewtons.
        np.testing.assert_allclose(step.dq[k].ravel(), dq[:-6], atol=1e-6 * np.abs(dq).max())
        np.testing.assert_allclose(step.dy[k], dq[-6:], atol=1e-6 * np.abs(dq).max())
        size = np.abs(multipliers).max()
        np.testing.assert_allclose(step.dlam[k].ravel(), multipliers[:18], atol=1e-4 * size)
        held = system.held[:, system.ports]
        np.testing.assert_allclose(step.drive[k][held], -multipliers[18:], atol=1e-4 * size)
        assert (step.drive[k][~held] == 0).all()


@pytest.mark.parametrize("kind", ["prescribed", "mixed", "lumped"])
def test_many_poses_are_the_single_ones(kind):
    study = robot(kind)
    path = poses_about_home(study.robot, POSES)
    locked = locked_poses(study.robot, study.simulation, path, LOAD)
    modes, stiffness = modes_of(locked), stiffness_of(study.robot, locked)
    for k in range(len(POSES)):
        one = poses_about_home(study.robot, POSES[k : k + 1])
        single = robot_modes(study.robot, study.simulation, one, LOAD)
        # The same operations, blocked differently: rounding of the least eigenvalue, as above.
        np.testing.assert_allclose(modes.frequency[k], single.frequency, rtol=1e-10)
        np.testing.assert_allclose(locked.equilibria.states.pose[k], single.equilibrium.state.pose, atol=1e-14)
        alone = robot_stiffness(study.robot, study.simulation, one, LOAD).total
        np.testing.assert_allclose(stiffness.total[k], alone, atol=1e-11 * np.abs(alone).max())


def test_stiffness_is_the_saddle_matrix_solved():
    """Shares of the legs by Eq. (T7.6) as it stands; scaled, so that rounding stays small."""
    study = robot("prescribed")
    locked = locked_poses(study.robot, study.simulation, poses_about_home(study.robot, POSES), LOAD)
    found, m, n = stiffness_of(study.robot, locked), locked.m, locked.system.n
    back = np.linalg.inv(tool_motion(study.robot, locked.equilibria.states.pose))
    for k in range(len(POSES)):
        for i in range(6):
            G = np.vstack([m.J[k, i], np.eye(n)[2]])
            # Adding G^T G times a large number changes no solution, and makes the block regular.
            K = m.K[k, i] + 1e8 * G.T @ G
            full = np.block([[K, 1e8 * G.T], [1e8 * G, np.zeros((4, 4))]])
            right = np.vstack([1e8 * G.T @ np.vstack([m.P[k, i], np.zeros((1, 6))]), 1e8 * m.P[k, i], np.zeros((1, 6))])
            share = -m.P[k, i].T @ (1e8 * np.linalg.solve(full, right)[n : n + 3])
            expected = back[k].T @ share @ back[k]
            np.testing.assert_allclose(found.legs[k, i], expected, atol=1e-7 * np.abs(expected).max())


def test_interpreted_kernels_give_the_same():
    study = override(paper_robot(), modes=1)
    locked = locked_poses(study.robot, study.simulation, poses_about_home(study.robot, POSES[:2]), LOAD)
    system = replace(locked.system, kernel=interpreted_kernel(locked.system.kernel.shapes))
    states = locked.equilibria.states
    for name, array in vars(matrices_at_rest(system, states, WRENCH)).items():
        other = getattr(locked.m, name)
        if array is None:
            continue
        np.testing.assert_allclose(array, other, atol=1e-13 * np.abs(other).max(), err_msg=name)
    systems, none = (system, locked.system), np.zeros((2, 6, 1))
    residuals = [residual_at_rest(s, states, locked.command, none, WRENCH) for s in systems]
    for a, b in zip(*residuals, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)


def test_lost_poses_do_not_disturb_their_neighbours():
    study = robot("prescribed")
    heavy = np.array([0, 0, -1.2e5, 0, 0, 0])
    system = locked_poses(study.robot, study.simulation, poses_about_home(study.robot, POSES)).system
    start = rigid_rest(system, kinematics.RigidPoses(study.robot, poses_about_home(study.robot, POSES)))
    none, length = np.zeros((5, 6, 1)), rest_commands(system, study.robot, start.q)
    length[2, 0] += 0.4  # a leg that no pose fits: the first step is not an elastic deformation
    found = equilibria(system, start, length, none, WRENCH)
    assert (found.code != 0).tolist() == [False, False, True, False, False]
    alone = equilibria(system, start[slice(3, 4)], length[3:4], none[:1], WRENCH)
    np.testing.assert_allclose(found.states.pose[3], alone.states.pose[0], atol=1e-14)
    assert found.one(2).reason.startswith("no equilibrium: ")
    assert (equilibria(system, start, length, none, 10 * heavy).code != 0).all()


def test_a_singular_matrix_of_a_stack_is_marked_alone():
    A = np.stack([np.eye(2), np.zeros((2, 2)), 2 * np.eye(2)])
    found = solve_each(A, np.ones((3, 2, 1)))[..., 0]
    np.testing.assert_array_equal(found, [[1, 1], [np.nan, np.nan], [0.5, 0.5]])


def test_states_of_a_batch():
    study = robot("lumped")
    locked = locked_poses(study.robot, study.simulation, poses_about_home(study.robot, POSES))
    states = locked.equilibria.states
    assert len(states) == 5
    assert len(states[np.array([1, 3])]) == 2
    again = RestStates.from_state(states.state(3))
    np.testing.assert_array_equal(again.q[0], states.q[3])


def test_public_call_takes_many_poses():
    study = paper_robot()
    poses = np.vstack([POSES, [[0, 0, 0.3, 0, 0, 0], [0, 0, -0.3, 0, 0, 0]]])
    data = fx.modes(study, poses)
    assert data.frequency.dims == ("pose", "mode")
    assert data.reason.values.tolist() == [0] * 5 + [2, 1]
    assert data.reason.attrs["flag_meanings"].split()[2] == "leg_too_long"
    assert np.isnan(data.frequency[5:]).all()
    np.testing.assert_allclose(data.pose_from_home, poses, atol=1e-15)
    named = fx.modes(study, {"heave": [0.0, 0.08], "pitch": [0.0, 0.2]})
    np.testing.assert_allclose(named.frequency, data.frequency[[0, 3]], rtol=1e-12)
    given = kinematics.Poses.at_rest(
        *(x[:5] for x in (poses_about_home(study.robot, poses).position, poses_about_home(study.robot, poses).rotation))
    )
    np.testing.assert_array_equal(fx.modes(study, given).frequency, data.frequency[:5])
    full, one = fx.modes(study, poses[[1, 6]], shapes=True), fx.modes(study, poses[1])
    for name in ("frequency", "damping_ratio", "com_sag", "platform_position", "platform_quaternion"):
        np.testing.assert_allclose(full[name][0], one[name], rtol=1e-9, atol=1e-14)
        assert np.isnan(full[name][1]).all()
    assert full.kind[0].values.tolist() == one.kind.values.tolist()
    assert full.leg_shape.dims == ("pose", "mode", "leg", "direction", "station")


@pytest.mark.parametrize("shapes", [False, True])
def test_no_pose_in_reach_and_no_pose_at_all(shapes, tmp_path):
    """Where no pose was reached, damping ratios, kinds and shapes were once missing."""
    near = fx.modes(paper_robot(), [[0, 0, 0, 0, 0, 0]], shapes=shapes)
    far = fx.modes(paper_robot(), [[0, 0, 1, 0, 0, 0]], shapes=shapes)
    none = fx.modes(paper_robot(), np.zeros((0, 6)), shapes=shapes)
    assert far.reason.values.tolist() == [2]
    assert none.sizes["pose"] == 0
    for data in (far, none):
        assert set(data.variables) == set(near.variables)
        for name, variable in near.variables.items():
            assert (data[name].dims, data[name].dtype.kind) == (variable.dims, variable.dtype.kind), name
            assert {**data[name].sizes, "pose": 1} == {**near[name].sizes, "pose": 1}, name
            assert data[name].attrs.get("units") == variable.attrs.get("units"), name
    for name in set(near.data_vars) - {"reason", "cut_off", "pose_from_home", "kind"}:
        assert np.isnan(far[name]).all(), name
    if shapes:
        assert set(far.kind.values.ravel()) == {""}
    assert fx.study.open_results(fx.study.save(far, tmp_path / "far.nc")).equals(far)


ACROSS = {"roll": np.deg2rad([-40.0, -20.0, 0.0]), "yaw": np.deg2rad([-100.0, -92, -88, -87, -84, 0, 84, 87, 89, 100])}


def test_a_map_and_modes_at_its_poses_say_the_same():
    """A map asks whether a pose is reached from home; modes ask the pose alone, and name those that are cut off."""
    study = robot("prescribed")
    seen = fx.workspace_map(study, ACROSS)
    roll, yaw = (x.ravel() for x in np.meshgrid(*ACROSS.values(), indexing="ij"))
    data = fx.modes(study, {"roll": roll, "yaw": yaw})
    flags, code = seen.reason.attrs["flag_meanings"].split(), seen.reason.values.ravel()
    cut_off = code == flags.index("singular")
    assert cut_off.any()
    np.testing.assert_array_equal(data.cut_off, cut_off)
    np.testing.assert_array_equal(data.reason.values[~cut_off], code[~cut_off])
    assert {"reached", "falls_through"} <= {flags[k] for k in code}
    reached = code == 0
    np.testing.assert_allclose(data.frequency[reached, :6], seen.frequency.values.reshape(-1, 6)[reached], rtol=1e-10)
    assert np.isnan(data.frequency[~reached & ~cut_off]).all()
    some = int(np.flatnonzero(cut_off & (data.reason.values == 0))[0])
    alone = fx.modes(study, {"roll": roll[some], "yaw": yaw[some]})
    np.testing.assert_allclose(data.frequency[some], alone.frequency, rtol=1e-10)


def test_an_equilibrium_across_a_singularity_is_none_of_the_pose():
    """At 89 deg of yaw the robot sags through its singularity at 90; the modes beyond it were once given."""
    data = fx.modes(robot("prescribed"), {"yaw": np.deg2rad([84.0, 89.0, 93.0])}, shapes=True)
    assert [data.reason.attrs["flag_meanings"].split()[k] for k in data.reason.values] == [
        "reached", "falls_through", "reached",
    ]  # fmt: skip
    assert data.cut_off.values.tolist() == [False, False, True]
    assert np.isnan(data.com_sag[1]).all()
    assert set(data.kind[1].values) == {""}
    assert np.isfinite(data.com_sag[[0, 2]]).all()


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        (np.zeros((2, 5)), "are not poses"),
        (np.full((2, 6), np.nan), "are not poses"),
        ([[0, 1], [1]], "are not poses"),
        ({"heave": [0, 1], "roll": [0, 1, 2]}, "do not fit each other"),
        ({"lift": [0, 1]}, "is not an axis"),
    ],
)
def test_poses_that_are_none(pose, words):
    with pytest.raises(fx.InputError, match=words):
        fx.modes(paper_robot(), pose)


def test_poses_without_mass_are_marked():
    study = paper_robot(leg={"cylinder": Cylinder(mass=0, com=0, inertia=0, mouth=0)})
    data = fx.modes(study, POSES[:3])
    assert set(data.reason.values.tolist()) <= {0, 12}
    assert 12 in data.reason.values
    assert np.isnan(data.frequency.values[data.reason.values == 12]).all()


def test_one_such_pose_is_refused():
    """Modes, stiffness and a simulation alike: what the lengths hold there is another assembly."""
    study = robot("prescribed")
    for compute in (fx.modes, fx.stiffness):
        with pytest.raises(fx.ComputationError, match="sags through a singularity"):
            compute(study, {"yaw": np.deg2rad(89.0)})
    there = {"yaw": np.deg2rad(89.0)}
    held = WaypointMotion(points=(Waypoint(time=0.0, **there), Waypoint(time=1.0, **there)))
    with pytest.raises(fx.ComputationError, match="sags through a singularity"):
        fx.simulate(study.replace(motion=held), duration=0.01, step=1e-3)
