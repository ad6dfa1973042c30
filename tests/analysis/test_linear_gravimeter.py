"""A plate on three struts in a plane, the gravimeter of svd-control by T. Dehaeze (MIT): its poles."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.verification.cases.linear import gravimeter

pytestmark = pytest.mark.analytic

M, INERTIA, K, C = 400.0, 115.0, 15e3, 20.0
BELOW, BESIDE = 0.85, 0.5
POLES = [-0.12243 + 13.551j, -0.05 + 8.6601j, -0.0088785 + 3.6493j]


def test_its_poles():
    lin = fx.linearize(gravimeter(), inputs=["drive", "floor:x"], outputs=["tool", "accelerometer:com"])
    assert len(lin.states) == 6
    poles = lin.poles()
    # five digits are printed: half of the last one is 4e-5 of 0.12243
    found = sorted(poles[poles.imag > 0], key=lambda s: -s.imag)
    assert np.real(found) == pytest.approx(np.real(POLES), rel=5e-5)
    assert np.imag(found) == pytest.approx(np.imag(POLES), rel=5e-5)


def test_its_poles_from_its_matrices():
    lin = fx.linearize(gravimeter(), inputs="drive", outputs="tool")
    J = np.array([[1.0, 0, BELOW], [0, 1, -BESIDE], [0, 1, BESIDE]])
    mass = np.diag([M, M, INERTIA])
    A = np.block(
        [[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(mass, J.T @ J * K), -np.linalg.solve(mass, J.T @ J * C)]]
    )
    assert np.sort(np.abs(lin.poles())) == pytest.approx(np.sort(np.abs(np.linalg.eigvals(A))), rel=1e-12)
    # a force of a drive pushes the plate as J^T says
    B = np.linalg.solve(mass, J.T)
    rates = [lin.states.index(f"payload {name} rate") for name in ("x", "y", "rz")]
    assert lin.B[rates] == pytest.approx(B, abs=1e-14)
