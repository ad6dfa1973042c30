"""What stands for held pivots: the same motions at every pose, whose modes are those of a dense null space."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.systems import of_robot

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.model import Simulation
from flexapod.model.study.payload import Payload
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modes import modes_of
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.statics.equilibrium import TOO_FAR, equilibria
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.locked_robot import single_equilibrium

pytestmark = pytest.mark.consistency

MOVES = {"3-PUU": slice(0, 3), "3-RPS": slice(2, 5), "6-FPF": slice(0, 6), "3-UPS+UP": slice(2, 5)}
SHAPES = Simulation(fidelity="assumed-modes", modes=2)


def light(kind):
    """A robot whose payload does not buckle it anywhere here."""
    return ROBOTS[kind]().replace(payload=Payload(mass=10.0, inertia=[0.4, 0.5, 0.6], com=[0.02, 0.01, 0.05]))


def poses(robot, kind, values):
    """Poses (P, 6) of which the robot's own three or six count."""
    of = np.zeros_like(values)
    of[:, MOVES[kind]] = values[:, MOVES[kind]]
    named = np.zeros(6, dtype=bool)
    named[MOVES[kind]] = True
    return kinematics.poses_from_home(robot, of, named)


def scattered(count=12):
    values = np.random.default_rng(3).uniform(-1, 1, (count, 6)) * [0.15, 0.15, 0.15, 0.3, 0.3, 0.3]
    values[0] = 0.0
    return values


def names(locked):
    """Names of the states, from the layout of a leg alone."""
    system = locked.system
    of_leg = [f"{name}{k + 1}" for name, size in system.kernel.shapes.layout for k in range(size)]
    every = [f"leg {i + 1} {name}" for i in range(system.legs) for name in of_leg]
    every += [f"payload {name}" for name in ("x", "y", "z", "turn x", "turn y", "turn z")]
    return [every[k] for k in locked.motions.columns]


def dense_frequencies(system, state, wrench):
    """By a null space of all constraints that knows nothing of legs [Hz]."""
    dense = system.matrices(state, wrench)
    constraints = np.vstack([dense.G, np.eye(system.size)[system.fixed_mask]])
    scale = 1 / np.sqrt(np.maximum(np.diag(dense.M), 1e-12))
    N = scale[:, None] * null_space(constraints * scale)
    K = N.T @ (dense.K + dense.K.T) / 2 @ N
    return np.sqrt(eigh(K, N.T @ dense.M @ N, eigvals_only=True)) / (2 * np.pi)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("fidelity", ["assumed-modes", "lumped"])
@pytest.mark.parametrize("kind", MOVES)
def test_states_have_the_same_names_at_all_poses_and_the_modes_of_a_dense_null_space(kind, fidelity):
    """At each pose by itself, at all of them together; a 3-PUU had four choices within 0.15 m of home."""
    if (kind, fidelity) == ("6-FPF", "lumped"):
        pytest.skip("nothing of it can move")
    robot, shapes = light(kind), SHAPES.replace(fidelity=fidelity)
    path = poses(robot, kind, scattered())
    together = locked_poses(robot, shapes, path)
    found, system = modes_of(together), together.system
    assert len(together.at) == len(path)
    assert not np.ptp(np.linalg.matrix_rank(together.motions.stiffness(system, together.m)))
    for k in range(len(path)):
        alone = locked_poses(robot, shapes, path.part(slice(k, k + 1)))
        assert names(alone) == names(together)
        expected = dense_frequencies(system, together.equilibria.states.state(k), together.acts.wrench)
        ours = found.frequency[k][np.isfinite(found.frequency[k])]
        # The dense problem is right to rounding of its largest eigenvalue, some hundred sums of it.
        np.testing.assert_allclose(ours**2, expected**2, rtol=1e-9, atol=1e-13 * expected[-1] ** 2)
    assert any(name.startswith("payload") for name in names(together))


def test_motions_change_little_from_one_pose_to_the_next():
    """The largest change of the stiffness between neighbours halves with the spacing: nothing jumps on the way."""
    robot, change = light("3-PUU"), []
    for count in (41, 81):
        values = np.linspace(-0.15, 0.15, count)[:, None] * [1.0, 0.6, -0.4, 0, 0, 0]
        locked = locked_poses(robot, SHAPES, poses(robot, "3-PUU", values))
        K = locked.motions.stiffness(locked.system, locked.m)
        size = np.sqrt(np.diagonal(K, axis1=1, axis2=2)).max(axis=0)
        change.append(np.abs(np.diff(K / size / size[:, None], axis=0)).max())
    # Of first order in the spacing, 0.01 of the way: what is left of the second order is a few per cent.
    assert change[0] / change[1] == pytest.approx(2.0, rel=0.1)


def test_a_pose_too_far_from_where_motions_were_chosen_is_refused_with_its_numbers():
    robot = light("3-PUU")
    system = of_robot(robot, fidelity="assumed-modes", modes=2)
    home = rigid_rest(system, kinematics.RigidPoses(robot, kinematics.home_pose(robot)))
    system = with_substitutes(system, home)
    shapes, of_leg = system.kernel.shapes, system.substitutes.copy()
    pivot, first = shapes.index("gamma3"), np.arange(system.legs) * system.n
    assert (of_leg[:, pivot] == first + shapes.index("t")).all()
    of_leg[:, pivot] = first + shapes.index("a")  # at home bending does not turn the platform's second axis
    command = home.q[..., system.ports]
    weak = replace(system, substitutes=of_leg)
    found = equilibria(weak, home, command, np.zeros_like(command), np.zeros(6))
    assert found.code.tolist() == [TOO_FAR] and found.most[0] > 100
    assert f"moves by {found.most[0]:.3g} here" in found.one(0).reason and "at most 100" in found.one(0).reason
    locked = replace(locked_poses(robot, SHAPES, kinematics.home_pose(robot)), equilibria=found)
    with pytest.raises(ComputationError, match=r"too far from home.*nearer to the pose"):
        single_equilibrium(locked)
