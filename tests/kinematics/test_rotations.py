"""Rotations beside SciPy's class of the same purpose, with the cases in which naive formulas lose digits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from flexapod.kinematics.rotations import (
    difference,
    displace_pose,
    exponential,
    matrix,
    product,
    quaternion,
    rotation_vector,
)

pytestmark = pytest.mark.unit

RNG = np.random.default_rng(4)
AXES = np.concatenate([np.eye(3), -np.eye(3), RNG.normal(size=(20, 3))])
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)
#: From nothing over what doubles barely hold to half a turn, about every axis.
TURNS = (np.array([0, 1e-300, 1e-12, 1e-6, 0.3, 1.5, 3.0, np.pi - 1e-9])[:, None, None] * AXES).reshape(-1, 3)
SCIPY = Rotation.from_rotvec(TURNS)


def test_matrices_and_quaternions_are_those_of_scipy():
    e = SCIPY.as_quat(canonical=True, scalar_first=True)
    assert_allclose(exponential(TURNS), SCIPY.as_matrix(), atol=1e-15 * 8)
    assert_allclose(matrix(3.0 * e), SCIPY.as_matrix(), atol=1e-15 * 8)
    assert_allclose(quaternion(SCIPY.as_matrix()), e, atol=1e-15 * 8)


def test_quaternion_of_half_turns_keeps_all_digits():
    """w = 0 there: the trace alone would lose half of them."""
    R = Rotation.from_rotvec(np.pi * AXES).as_matrix()
    e = quaternion(R)
    assert_allclose(matrix(e), R, atol=1e-15 * 8)
    assert np.all(e[:, 0] >= 0)


def test_rotation_vectors_return():
    """To rounding of the whole turn, and of a small one relative to itself."""
    found = rotation_vector(-SCIPY.as_quat(scalar_first=True))  # either sign of a quaternion is the same rotation
    assert_allclose(found, TURNS, rtol=1e-14, atol=1e-15 * 8)


def test_differences_are_left_of_what_they_turn():
    a, b = Rotation.random(30, rng=1), Rotation.random(30, rng=2)
    found = difference(a.as_quat(scalar_first=True), b.as_quat(scalar_first=True))
    assert_allclose(found, (a * b.inv()).as_rotvec(), atol=1e-14)


def test_products_and_steps_are_those_of_matrices():
    a, b = Rotation.random(30, rng=3), Rotation.random(30, rng=4)
    e = product(a.as_quat(scalar_first=True), b.as_quat(scalar_first=True))
    assert_allclose(matrix(e), a.as_matrix() @ b.as_matrix(), atol=1e-14)
    step = RNG.normal(size=(30, 6))
    moved = displace_pose(np.concatenate([RNG.normal(size=(30, 3)), a.as_quat(scalar_first=True)], axis=1), step)
    assert_allclose(matrix(moved[:, 3:]), a.as_matrix() @ exponential(step[:, 3:]), atol=1e-14)
    assert_allclose(np.linalg.norm(moved[:, 3:], axis=1), 1.0, rtol=1e-15 * 4)
