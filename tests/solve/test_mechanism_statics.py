"""Statics of robots with any number of legs and any held coordinate against dense algebra of the whole system."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from tests.helpers.mechanisms import ROBOTS as KINDS
from tests.helpers.systems import (
    THIRDS,
    frequencies,
    hexapod,
    hold,
    octopod,
    of_robot,
    ring,
    robot,
    solved,
    tripod,
)

from flexapod import kinematics
from flexapod.kinematics.rotations import displace_pose
from flexapod.model.study.payload import Payload
from flexapod.solve.batch import residual_at_rest
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.statics.block_arrow import arrow_solve
from flexapod.solve.statics.equilibrium import _Acts, _loaded_slowly
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.reduction import independent_motions

pytestmark = pytest.mark.consistency


def planar(**more):
    """Three legs in a plane: the payload keeps its height and does not tilt."""
    system, x = robot(
        ring(0.9, THIRDS), ring(0.15, np.add(THIRDS, 40)), [[0, 0, 1]] * 3, height=0.0, com=(0, 0, 0), **more
    )
    return replace(system, hub_held=np.array([0, 0, 1, 1, 1, 0], dtype=bool)), x


ROBOTS = {
    "3-RPS": tripod,
    "3-RPS lumped": lambda: tripod(modes=0),
    "3-RPS bending only": lambda: tripod(axial=0),
    "6-UPS": hexapod,
    "8-UPS": octopod,
    "one hinge of six": lambda: hold(*hexapod(), "beta", 0),
    "a shape held": lambda: hold(*hexapod(), "a", slice(2, 4)),
    "planar 3-RPR": lambda: planar(gravity=0.0),
}


def of_kind(name, **simulation):
    """A robot of another kind, moved away from home a little, its payload light enough for soft joints."""
    model = KINDS[name]().replace(payload=Payload(mass=10.0, inertia=[0.4, 0.5, 0.6], com=[0.02, 0.01, 0.05]))
    system = of_robot(model, **{"fidelity": "assumed-modes", "modes": 2} | simulation)
    return system, rigid_rest(system, kinematics.RigidPoses(model, kinematics.home_pose(model)))


for kind in ("6-UCU", "6-FPF", "3-UPS+UP", "3-PUU", "6-RUS", "planar 3-PRR"):
    ROBOTS[kind] = partial(of_kind, kind)


def constraints(dense, system):
    return np.vstack([dense.G, np.eye(system.size)[system.fixed_mask]])


@pytest.mark.parametrize("name", ROBOTS)
def test_equilibrium_and_newton_step_are_those_of_the_whole_system(name):
    system, x = ROBOTS[name]()
    states, m, command, wrench = solved(system, x)
    one = states.state(0)
    table = np.zeros((system.legs, system.ports.size, 4))
    table[..., 0] = command[0]
    r, g, _ = system.residual(one, table, wrench)
    free = ~np.append(np.zeros(system.legs * system.n, dtype=bool), system.hub_held)
    assert np.abs(r[free]).max() < 1e-9 * np.abs(one.lam).max()  # held rows too: their multiplier is in the state
    assert np.abs(g).max() < 1e-14
    dense = system.matrices(one, wrench)
    rng, shape = np.random.default_rng(1), (1, system.legs, system.n)
    loads, on_payload, gaps = rng.normal(size=shape), rng.normal(size=(1, 6)), 1e-3 * rng.normal(size=g.shape)
    held_gap = np.where(system.held, 1e-3 * rng.normal(size=shape), 0.0)
    step = arrow_solve(system, m, loads, on_payload, gaps.reshape(1, system.legs, -1), held_gap)
    K, G = dense.K, constraints(dense, system)
    size = np.sqrt(np.abs(np.diag(K)))
    size = np.maximum(size, 1e-6 * size.max())
    full = np.block([[K / size / size[:, None], (G / size).T], [G / size, np.zeros((len(G),) * 2)]])
    given = np.concatenate([gaps.ravel(), held_gap[0][system.held], np.zeros(system.hub_held.sum())])
    right = -np.concatenate([np.append(loads, on_payload) / size, given])
    found = np.linalg.solve(full, right)
    dq = found[: system.size] / size
    # The dense matrix loses six digits or so, see `test_batch`.
    np.testing.assert_allclose(np.append(step.dq, step.dy), dq, atol=1e-6 * np.abs(dq).max())
    lam, drive = found[system.size :][: g.size], -found[system.size :][g.size : g.size + system.held.sum()]
    largest = np.abs(found[system.size :]).max()
    np.testing.assert_allclose(step.dlam.ravel(), lam, atol=1e-5 * largest)
    by_coordinate = np.zeros((system.legs, system.n))
    by_coordinate[:, system.ports] = step.drive[0]
    np.testing.assert_allclose(by_coordinate[system.held], drive, atol=1e-5 * largest)


@pytest.mark.parametrize("name", ROBOTS)
def test_independent_motions_are_the_null_space_of_all_constraints(name):
    system, x = ROBOTS[name]()
    states, m, _, wrench = solved(system, x)
    dense, found = system.matrices(states.state(0), wrench), independent_motions(with_substitutes(system, x), m)
    motions = found.flat(system, np.eye(found.columns.size)[None])[0]
    G = constraints(dense, system)
    assert np.linalg.matrix_rank(G) == system.size - motions.shape[1]
    assert np.abs(G @ motions).max() < 1e-12 * np.abs(motions).max()
    K = found.stiffness(system, m)[0]
    whole = motions.T @ (dense.K + dense.K.T) / 2 @ motions
    np.testing.assert_allclose(K, whole, atol=1e-10 * np.abs(whole).max())
    assert (found.N is None) == (name not in ("3-RPS lumped", "3-RPS bending only"))


@pytest.mark.parametrize("name", ["3-RPS", "6-UCU", "6-FPF", "3-UPS+UP", "6-RUS"])
def test_stiffness_is_the_derivative_of_the_balance(name):
    """Geometric stiffness of legs that carry forces and moments, with what couples them to the payload."""
    system, x = ROBOTS[name]()
    states, m, command, wrench = solved(system, x)
    rng, h = np.random.default_rng(2), 1e-5
    dq, dy = rng.normal(size=x.q.shape), rng.normal(size=(1, 6))
    none = np.zeros_like(command)
    ahead, behind = (residual_at_rest(system, states.displace(t * dq, t * dy), command, none, wrench) for t in (h, -h))
    of_legs, of_payload, closures = ((a - b) / (2 * h) for a, b in zip(ahead, behind, strict=True))
    X = np.zeros((*x.q.shape, 6)) if m.X is None else m.X
    expected = (m.K @ dq[..., None] + X @ dy[:, None, :, None])[..., 0]
    # Central differences: third derivatives times h^2, 1e-10 of the stiffness of shapes of 1e9 N/m at most.
    np.testing.assert_allclose(of_legs, expected, atol=1e-8 * np.abs(expected).max())
    on_payload = (m.payload_K @ dy[..., None])[..., 0] + (X.swapaxes(-1, -2) @ dq[..., None])[..., 0].sum(axis=1)
    np.testing.assert_allclose(of_payload, on_payload, atol=1e-6 * np.abs(states.lam).max())
    moved = (m.J @ dq[..., None] - m.P @ dy[:, None, :, None])[..., 0]
    np.testing.assert_allclose(closures, moved, atol=1e-8)


def test_modes_are_those_of_the_null_space_found_numerically():
    for make in (tripod, octopod):
        system, x = make()
        states, m, _, wrench = solved(system, x)
        dense = system.matrices(states.state(0), wrench)
        scale = 1 / np.sqrt(np.maximum(np.diag(dense.M), 1e-12))
        N = scale[:, None] * null_space(constraints(dense, system) * scale)
        K = N.T @ (dense.K + dense.K.T) / 2 @ N
        expected = np.sqrt(eigh(K, N.T @ dense.M @ N, eigvals_only=True))
        np.testing.assert_allclose(frequencies(system, x, m), expected, rtol=1e-9)


def test_permuted_and_mirrored_legs_give_the_same_robot():
    """Identity of names, not of numbers: groups of legs that hold different things are split differently."""
    system, x = hold(*hexapod(), "beta", [1, 3])
    states, m, _, _ = solved(system, x)
    order = np.array([3, 5, 0, 1, 4, 2])
    turned = replace(system, leg_p=system.leg_p[order], joint_p=system.joint_p[order], held=system.held[order])
    y = replace(x, q=x.q[:, order])
    again, other, _, _ = solved(turned, y)
    np.testing.assert_allclose(again.q, states.q[:, order], atol=1e-13)
    np.testing.assert_allclose(again.pose, states.pose, atol=1e-13)
    np.testing.assert_allclose(frequencies(turned, y, other), frequencies(system, x, m), rtol=1e-10)


def test_gaps_closed_in_ten_steps_lead_to_the_same_state():
    """Legs whose hinges are not where the rigid robot has them, and a payload off its place: all by bending."""
    system, x = hold(*hexapod(), "beta")
    x = replace(x, pose=displace_pose(x.pose, np.array([[0.01, -0.02, 0.01, 0.05, -0.03, 0.04]])))
    far = np.zeros((1, 6, system.ports.size))
    far[0, :, list(system.ports).index(1)] = 0.1 * np.array([1, -1, 1, 1, -1, -1])
    states, _, command, wrench = solved(system, x, gap=far)
    np.testing.assert_allclose(states.q[..., system.ports], command, atol=1e-15)
    acts = _Acts(command=command, force=np.zeros_like(command), wrench=wrench, kept=np.zeros_like(x.lam))
    slowly, code = _loaded_slowly(system, x, acts)
    assert code == 0
    assert np.abs(states.q[..., 4:]).max() > 0.05  # the legs do bend
    for name in ("q", "pose"):
        np.testing.assert_allclose(getattr(slowly, name), getattr(states, name), atol=1e-13)
