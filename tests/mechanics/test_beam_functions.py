"""The symmetric eigenproblem beside SciPy's."""

import numpy as np
import pytest
import scipy.linalg

from flexapod.mechanics.shapes.beam_functions import eigh

pytestmark = pytest.mark.unit


def test_values_and_vectors_are_those_of_scipy():
    """Condition of M about 2e2 here: twelve digits are left of the eigenvalues."""
    rng = np.random.default_rng(7)
    A, B = rng.normal(size=(2, 8, 8))
    K, M = A @ A.T, B @ B.T + 1e-2 * np.eye(8)
    values, X = eigh(K, M)
    np.testing.assert_allclose(values, scipy.linalg.eigh(K, M)[0], rtol=1e-11)
    np.testing.assert_allclose(X.T @ M @ X, np.eye(8), atol=1e-11)
    np.testing.assert_allclose(K @ X, M @ X * values, atol=1e-11 * values.max())
