"""How many poles of delayed loops grow, against closed forms and a delay that is a string of points."""

import numpy as np
import pytest

import flexapod.control as fc

pytestmark = pytest.mark.analytic


def system(A, B, C, inputs="u", outputs="y"):
    """A state space whose channels are numbered."""
    A, B, C = (np.array(x, dtype=float) for x in (A, B, C))
    return fc.StateSpace(
        A=A, B=B, C=C, D=np.zeros((len(C), B.shape[1])), units={},
        inputs=tuple(f"{inputs}{i}" for i in range(B.shape[1])), outputs=tuple(f"{outputs}{i}" for i in range(len(C))),
        states=tuple(f"{inputs} x{i}" for i in range(len(A))),
    )  # fmt: skip


def gains(value):
    """A controller u = value y."""
    value = np.atleast_2d(value)
    n = len(value)
    return fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, n)), C=np.zeros((n, 0)), D=value, units={}, states=(),
        inputs=tuple(f"y{i}" for i in range(n)), outputs=tuple(f"u{i}" for i in range(n)),
    )  # fmt: skip


def test_poles_cross_and_come_back_as_the_delay_rises():
    """m x'' + c x' + k x = -g x(t - tau), g < k: on both sides of the resonance the loop has size 1.

    m^2 w^4 + (c^2 - 2 m k) w^2 + k^2 - g^2 = 0; e^(-i w tau) = -(k - m w^2 + i c w) / g. At the larger w a pair
    begins to grow with each such delay, at the smaller one it ends.
    """
    m, c, k, g = 2.0, 1.0, 800.0, 120.0
    low, high = np.sort(np.sqrt(np.roots([m**2, c**2 - 2 * m * k, k**2 - g**2])))

    def delays(w):
        first = -np.angle(-(k - m * w**2 + 1j * c * w) / g) % (2 * np.pi)
        return (first + 2 * np.pi * np.arange(6)) / w

    starts, ends = delays(high), delays(low)
    between = np.sort(np.concatenate([starts, ends]))[:9]
    wanted, found = [], []
    plant = system([[0, 1], [-k / m, -c / m]], [[0], [1 / m]], [[1, 0]])
    for tau in 0.5 * (between[1:] + between[:-1]):
        wanted.append(2 * int((starts < tau).sum() - (ends < tau).sum()))
        found.append(fc.margins(plant, gains(-g), delay=tau).attrs["unstable_poles"])
    assert found == wanted
    assert wanted[:3] == [2, 0, 2] and max(wanted) == 4


def by_points(A, late, delay, count):
    """Poles of x' = A x + late x(t - delay), the past of x by its values at Chebyshev's points."""
    k = np.arange(count + 1)
    x = np.cos(np.pi * k / count)
    c = np.where((k == 0) | (k == count), 2.0, 1.0) * (-1.0) ** k
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(count + 1))
    D = (D - np.diag(D.sum(axis=1))) * 2 / delay
    n = len(A)
    whole = np.kron(D, np.eye(n))
    whole[:n] = 0.0
    whole[:n, :n], whole[:n, -n:] = A, late
    return np.linalg.eigvals(whole)


@pytest.mark.parametrize("seed", range(4))
def test_as_many_poles_grow_as_of_a_delay_of_points(seed):
    """Two loops across each other, drawn; their poles without delay may grow. 60 points hold what turns ten times."""
    rng = np.random.default_rng(seed)
    A, B, C, K = (rng.normal(size=size) for size in ((4, 4), (4, 2), (2, 4), (2, 2)))
    A -= (np.linalg.eigvals(A).real.max() + 0.1 * rng.normal()) * np.eye(4)
    late, plant, sure = B @ K @ C, system(A, B, C), 0
    for tau in rng.uniform(0.1, 6.0, 4):
        poles = by_points(A, late, tau, 60)
        if np.abs(poles.real).min() > 1e-3:  # clear of the axis
            sure += 1
            assert fc.margins(plant, gains(K), delay=tau).attrs["unstable_poles"] == (poles.real > 0).sum()
    assert sure > 2
