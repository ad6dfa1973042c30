"""Zeros of a hinged beam from the torque on its hub to its tip, which fade fast: exact fractions, closed forms."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import brentq

import flexapod as fx
import flexapod.control as fc
from flexapod import model

pytestmark = pytest.mark.analytic

RHO, EI, LENGTH, HUB = 1.2, 200.0, 2.0, 0.5
#: Of the closed form tan a + tanh a = 0: s = +-2 a^2 sqrt(EI / (m L^4)), whatever the hub.
EXACT = [
    2 * brentq(lambda a: np.sin(a) * np.cosh(a) + np.cos(a) * np.sinh(a), (k + 0.5) * np.pi, (k + 1.0) * np.pi) ** 2
    * np.sqrt(EI / (RHO * LENGTH**4)) for k in range(4)
]  # fmt: skip


def finite(elements):
    """M, K of a beam of cubics that turns with its hub about one end, places and slopes; torque; place of the tip."""
    h, n = LENGTH / elements, 2 * elements + 2
    M, K = np.zeros((2, n, n))
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                  [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])  # fmt: skip
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                  [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])  # fmt: skip
    for e in range(elements):
        at = np.ix_(range(2 * e, 2 * e + 4), range(2 * e, 2 * e + 4))
        M[at] += RHO * h / 420 * m
        K[at] += EI / h**3 * k
    M[1, 1] += HUB
    return M[1:, 1:], K[1:, 1:], np.eye(n - 1)[0], np.eye(n - 1)[-2]


def sign(M, K, b, c, s):
    """Sign of the determinant of [K + s^2 M, -b; c, 0] in exact numbers."""
    n, square = len(M), Fraction(s) ** 2
    rows = [[Fraction(K[i, j]) + square * Fraction(M[i, j]) for j in range(n)] + [Fraction(-b[i])] for i in range(n)]
    rows.append([*(Fraction(x) for x in c), Fraction(0)])
    found = 1
    for k in range(n + 1):
        pivot = next(i for i in range(k, n + 1) if rows[i][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        found *= (1 if rows[k][k] > 0 else -1) * (1 if pivot == k else -1)
        for i in range(k + 1, n + 1):
            if rows[i][k]:
                share = rows[i][k] / rows[k][k]
                rows[i] = [x - share * y for x, y in zip(rows[i], rows[k], strict=True)]
    return found


def test_zeros_of_many_elements_are_those_of_exact_numbers():
    """Twelve cubics: modes to 4 kHz beside zeros at 6 Hz, whose response is the difference of what all modes add."""
    M, K, b, c = finite(12)
    n = len(M)
    plant = fc.StateSpace(
        A=np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), np.zeros((n, n))]]),
        B=np.concatenate([np.zeros(n), np.linalg.solve(M, b)])[:, None], C=np.concatenate([c, np.zeros(n)])[None],
        D=[[0.0]], inputs=("torque",), outputs=("tip",), states=tuple(map(str, range(2 * n))), units={},
    )  # fmt: skip
    zeros = plant.zeros()
    for k, exact in enumerate(EXACT):
        found = zeros[np.abs(zeros - exact).argmin()]
        assert found.imag == 0 and found.real == pytest.approx(exact, rel=(1e-5, 2e-4, 1e-3, 5e-3)[k])  # of the mesh
        # of these matrices: within 1e-6 the determinant changes its sign
        assert sign(M, K, b, c, found.real * (1 - 1e-6)) == -sign(M, K, b, c, found.real * (1 + 1e-6))
        assert np.abs(zeros + found).min() < 1e-6 * exact  # and to the left


@pytest.mark.parametrize(("settings", "known"), [
    ({"fidelity": "beam-fem", "modes": 24}, (1e-5, 2e-4, 1e-3, 5e-3)),
    ({"modes": 12}, (1e-6, 1e-6, 1e-5, 1e-3)),
])  # fmt: skip
def test_zeros_of_an_actuator_with_many_shapes(settings, known):
    actuator = model.Actuator(
        rhoA=RHO, EI=EI, length=LENGTH, free_length=LENGTH, hub_radius=0.0, hub_inertia=HUB, gravity=0.0, damping=0.0
    )
    given = model.ActuatorStudy(actuator=actuator, simulation=model.Simulation(duration=1.0, **settings))
    zeros = fx.linearize(given, inputs="drive:rotation", outputs="tip:rotation", drives="force").zeros()
    for exact, close in zip(EXACT, known, strict=True):
        assert np.abs(zeros - exact).min() < close * exact and np.abs(zeros + exact).min() < close * exact


def test_what_symmetry_makes_none_has_no_zeros():
    """A force in the middle of two equal masses turns nothing: where the response is rounding there are no zeros."""
    k = np.array([[3.0, -1.0], [-1.0, 3.0]]) * (1 + 1e-16)
    plant = fc.StateSpace(
        A=np.block([[np.zeros((2, 2)), np.eye(2)], [-k, -0.01 * k]]), B=[[0], [0], [0.3], [0.3]],
        C=[[1 / 0.7, -1 / 0.7, 0, 0]], D=[[0.0]], inputs=("f",), outputs=("turn",), states=tuple("abcd"), units={},
    )  # fmt: skip
    assert plant.zeros().size == 0


def test_zeros_of_noise_that_is_differentiated():
    """Asked for of a mass under velocity feedback by noise of its place, on a spring."""
    plant = fc.StateSpace(
        A=[[0, 1], [-9.0, 0]], B=[[0], [1]], C=[[1, 0]], D=[[0]], inputs=("drive:1",), outputs=("stroke:1",),
        states=("z", "v"), units={},
    )  # fmt: skip
    loop = plant.close(fc.DVF(2.0))
    found = loop.zeros("noise:stroke:1", "control:drive:1")  # -g s (s^2 + 9) / (s^2 + g s + 9)
    assert found[np.argsort(found.imag)] == pytest.approx(np.array([-3j, 0, 3j]), abs=1e-9)
