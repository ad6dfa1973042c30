"""Decoupling of a planar gravimeter on three struts, by Jacobians, modes and singular vectors: closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import flexapod as fx
import flexapod.control as fc
from flexapod.common.errors import ComputationError, InputError

pytestmark = pytest.mark.analytic

M, INERTIA, K, C = 400.0, 115.0, 15e3, 20.0
HA, HB, LA, LB = 1.7 / 2, 0.91, 1.0 / 2, 1.7  # struts below the centre of mass, beside it


def jacobian(below=HA):
    """Strokes of a strut along x, `below` the point, and of two along y on both sides, by its x, y and turn."""
    return np.array([[1.0, 0.0, below], [0.0, 1.0, -LA], [0.0, 1.0, LA]])


def gravimeter(c=C):
    J, mass = jacobian(), np.diag([M, M, INERTIA])
    stiff = J.T @ (K * J)
    inv = np.linalg.inv(mass)
    return fc.StateSpace(
        A=np.block([[np.zeros((3, 3)), np.eye(3)], [-inv @ stiff, -inv @ (J.T @ (c * J))]]),
        B=np.vstack([np.zeros((3, 3)), inv @ J.T]),
        C=np.hstack([J, np.zeros((3, 3))]),
        D=np.zeros((3, 3)),
        inputs=("drive:1", "drive:2", "drive:3"),
        outputs=("stroke:1", "stroke:2", "stroke:3"),
        states=("x", "y", "turn", "x rate", "y rate", "turn rate"),
        units={},
    )


def through(system, matrices, hz):
    return np.einsum("ij,jkf,kl->ilf", matrices.into, system.at(hz), matrices.out)


def coupling(G):
    """Largest number beside the diagonal over the geometric mean of the two on it."""
    d = np.sqrt(np.abs(np.einsum("iif->if", G)))
    scaled = np.abs(G) / d[:, None] / d[None]
    return (scaled - np.eye(len(G))[:, :, None] * scaled).max(axis=(0, 1))


def test_poles_of_the_gravimeter_are_the_published_ones():
    found = gravimeter().poles()
    # Published with five figures by the svd-control study of the same mechanism.
    for pole in (-0.12243 + 13.551j, -0.05 + 8.6601j, -0.0088785 + 3.6493j):
        assert np.abs(found - pole).min() < 1e-4 * abs(pole)


def test_at_the_centre_of_mass_only_springs_couple():
    system = gravimeter(c=0.0)
    G = through(system, fc.by_jacobian(jacobian()), [0.01, 300.0])
    exact = np.linalg.inv(jacobian().T @ (K * jacobian()))
    np.testing.assert_allclose(G[..., 0].real, exact, rtol=1e-3, atol=1e-12)  # (f / f1)^2 = 3e-4
    static, fast = coupling(G)
    assert static > 0.5 and fast < 1e-3
    np.testing.assert_allclose(
        np.diag(G[..., 1]).real * -((2 * np.pi * 300) ** 2), [1 / M, 1 / M, 1 / INERTIA], rtol=1e-3
    )


def test_at_the_centre_of_stiffness_only_masses_couple():
    system = gravimeter(c=0.0)
    static, fast = coupling(through(system, fc.by_jacobian(jacobian(0.0)), [1e-4, 300.0]))
    assert static < 1e-6 and fast > 0.5


def test_modes_are_decoupled_at_all_frequencies():
    system = gravimeter(c=0.0)
    matrices = fc.by_modes(system)
    hz = np.array([0.01, 0.4, 1.0, 2.0, 50.0])
    G = through(system, matrices, hz)
    assert coupling(G).max() < 1e-9
    w = np.sort(np.abs(system.poles()))[::2]
    ratio = np.einsum("iif->if", G) * (w[:, None] ** 2 - (2 * np.pi * hz) ** 2)
    np.testing.assert_allclose(ratio, ratio[:, :1] * np.ones(len(hz)), rtol=1e-8)  # one mode each
    # Velocity of a mode fed back damps that one alone: q'' + ratio g q' + w^2 q = 0.
    g = 0.2 * w[1] / ratio[1, 0].real
    loop = system.close(matrices.controller([fc.rate(0.0), fc.rate(g), fc.rate(0.0)]))
    np.testing.assert_allclose(loop.damp().damping_ratio, [0.0, 0.1, 0.0], atol=1e-9)


def test_singular_vectors_decouple_at_their_frequency():
    matrices = fc.by_singular_vectors(gravimeter(), 8.0)
    # Struts alike: G^-1 = s^2 (J M^-1 J')^-1 + (k + c s), the vectors are those of J M^-1 J' at all frequencies.
    assert coupling(through(gravimeter(), matrices, [0.5, 8.0, 40.0])).max() < 1e-3
    _, turn = np.linalg.eigh(jacobian() @ np.diag([1 / M, 1 / M, 1 / INERTIA]) @ jacobian().T)
    np.testing.assert_allclose(np.sort(np.abs(matrices.into @ turn), axis=1)[:, :2], 0.0, atol=1e-3)
    assert matrices.into.shape == (3, 3)
    np.testing.assert_allclose(matrices.into @ matrices.into.T, np.eye(3), atol=1e-12)


def test_a_decoupled_loop_is_one_of_each_direction():
    """PD at the centre of mass: the same as springs and dampers there."""
    system, J = gravimeter(), jacobian()
    stiff, damp = np.array([1e4, 2e4, 3e3]), np.array([50.0, 60.0, 70.0])
    laws = [fc.pid(k, 0.0, c) for k, c in zip(stiff, damp, strict=True)]
    loop = system.close(fc.by_jacobian(J).controller(laws))
    inv = np.diag([1 / M, 1 / M, 1 / INERTIA])
    whole_k, whole_c = J.T @ (K * J) + np.diag(stiff), J.T @ (C * J) + np.diag(damp)
    exact = np.linalg.eigvals(np.block([[np.zeros((3, 3)), np.eye(3)], [-inv @ whole_k, -inv @ whole_c]]))
    for pole in exact:
        assert np.abs(loop.poles() - pole).min() < 1e-9 * abs(pole)


def test_the_centre_of_stiffness_of_the_struts():
    spatial = np.zeros((3, 6))
    spatial[:, [0, 1, 5]] = jacobian()
    # The strut along x passes HA below in y: its turn arm is +HA about z, so that its axis lies at y = -HA.
    centre = fc.centre_of_stiffness(spatial, K)
    np.testing.assert_allclose(centre[:2], [0.0, -HA], atol=1e-12)


def test_a_robots_jacobian_is_that_of_its_legs():
    robot = fx.preset("paper-robot").robot
    J = fc.robot_jacobian(robot)
    home = fx.kinematics.home_pose(robot)
    legs = home.position[0] + robot.platform_joints @ home.rotation[0].T - robot.base_joints
    axes = legs / np.linalg.norm(legs, axis=1)[:, None]
    arm = (robot.platform_joints - robot.com) @ home.rotation[0].T
    np.testing.assert_allclose(J, np.hstack([axes, np.cross(arm, axes)]), atol=1e-12)
    at = fc.robot_jacobian(robot, "cok")
    stiff = at.T @ at
    # By symmetry about z the best point leaves what no point takes away: forces across still turn about their own axis.
    assert np.linalg.norm(stiff[:3, 3:]) <= np.linalg.norm((J.T @ J)[:3, 3:]) * (1 + 1e-12)


def test_what_cannot_be_told_apart_is_refused():
    with pytest.raises(InputError, match="1 to 3"):
        fc.by_modes(gravimeter(), count=4)
    with pytest.raises(ComputationError, match="not told apart"):
        fc.by_jacobian([[1.0, 1.0], [1.0, 1.0]])
    with pytest.raises(InputError, match="has the shape"):
        gravimeter().close(fc.Decoupled(fc.gain(1.0), into=np.eye(2), out=np.eye(3)))


def test_the_centre_of_stiffness_of_a_robot_that_is_turned_at_home():
    """Legs by hand in world axes; K_tr changes evenly with the point p, the sum of its squares is least at one."""
    rpy, place, springs = np.array([0.5, -0.3, 0.7]), [0.05, -0.1, 0.8], np.array([1.0, 2.0, 3.0, 1.5, 0.7, 2.2]) * 1e6
    robot = fx.preset("paper-robot").robot
    robot = robot.replace(home=robot.home.replace(position=place, rotation=rpy))
    tips = place + robot.platform_joints @ Rotation.from_euler("xyz", rpy).as_matrix().T  # R = Rz Ry Rx
    axes = (tips - robot.base_joints) / np.linalg.norm(tips - robot.base_joints, axis=1)[:, None]

    def legs(p):
        return np.hstack([axes, np.cross(tips - p, axes)])

    def coupling(p):
        return (axes.T @ (springs[:, None] * legs(p)[:, 3:])).ravel()

    none = coupling(np.zeros(3))
    change = np.stack([coupling(e) - none for e in np.eye(3)], axis=1)
    centre = np.linalg.lstsq(change, -none, rcond=None)[0]
    found = fc.robot_jacobian(robot, "cok", springs)
    # rounding, over a condition of some 10
    np.testing.assert_allclose(found, legs(centre), rtol=0, atol=1e-12)
    com = place + Rotation.from_euler("xyz", rpy).as_matrix() @ robot.com
    np.testing.assert_allclose(fc.robot_jacobian(robot), legs(com), rtol=0, atol=1e-12)
    assert np.linalg.norm(centre - com) > 0.05
