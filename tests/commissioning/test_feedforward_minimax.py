"""Coefficients of the least maximum against one program with all rows, and least times against roots by hand."""

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import flexapod as fx
from flexapod.commissioning.feedforward.minimax import FAINT, SIDES, WITHIN, least_time_by_secants, minimax

pytestmark = pytest.mark.consistency

SEED = np.random.default_rng(34)


def limits(looks: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Smooth rows of three limits, as polynomials of the look, the second the largest by far and the third all zero."""
    x = np.linspace(-1, 1, looks)
    powers = np.polynomial.chebyshev.chebvander(x, n - 1)
    G = np.stack([powers * SEED.uniform(0.5, 1.0, n), 3 * powers[::-1] * SEED.uniform(0.5, 1.0, n), 0 * powers])
    return G, np.stack([np.sin(3 * x), np.cos(5 * x), np.ones(looks)])


def whole(G: np.ndarray, g: np.ndarray, ends: tuple[np.ndarray, np.ndarray], quiet=None) -> float:
    """The least maximum by one program of all rows."""
    rows, most, n = G.reshape(-1, G.shape[2]), g.ravel(), G.shape[2]
    m = 0 if quiet is None else len(quiet[1])
    above = [np.hstack([sign * rows, np.zeros((len(rows), m)), -np.ones((len(rows), 1))]) for sign in (1, -1)]
    below = [-most, most]
    for k in range(SIDES if m else 0):
        turn = np.exp(2j * np.pi * k / SIDES) / np.cos(np.pi / SIDES)
        above.append(np.hstack([np.real(turn * quiet[0]), -np.eye(m), np.zeros((m, 1))]))
        below.append(-np.real(turn * quiet[1]))
    above.append(np.concatenate([np.zeros(n), np.ones(m), [0.0]])[None])
    below.append(np.ones(1))
    found = linprog(
        np.append(np.zeros(n + m), 1.0), A_ub=np.concatenate(above), b_ub=np.concatenate(below),
        A_eq=np.pad(ends[0], ((0, 0), (0, m + 1))), b_eq=ends[1],
        bounds=[(None, None)] * n + [(0, None)] * (m + 1),
    )  # fmt: skip
    return found.fun


@pytest.mark.parametrize(("looks", "n"), [(9, 4), (200, 12), (401, 30)])
@pytest.mark.parametrize("quiet", [False, True])
def test_few_rows_have_the_least_maximum_of_all(looks: int, n: int, quiet: bool) -> None:
    """From coefficients that tell nothing. Within the tolerance of HiGHS, 1e-7 of rows of the size of 1."""
    G, g = limits(looks, n)
    ends = np.ones((1, n)), np.array([1.0])
    heard = None
    if quiet:
        A = SEED.normal(size=(6, n)) + 1j * SEED.normal(size=(6, n))
        heard = np.array([0.3, 0.2, 0.1, 0.05, 1e-9, 1e-10])[:, None] * A, np.zeros(6, dtype=complex)
    c, found = minimax(G, g, ends, np.zeros(n), heard) if not quiet else minimax(G, g, ends, np.ones(n), heard)
    assert found == pytest.approx(whole(G, g, ends, heard), rel=1e-5)
    assert np.abs(G @ c + g).max() == pytest.approx(found, rel=1e-5)
    np.testing.assert_allclose(ends[0] @ c, ends[1], atol=1e-6)
    if quiet:
        assert np.abs(heard[0] @ c + heard[1]).sum() < 1 + FAINT


def test_what_cannot_be_met_is_told() -> None:
    G, g = limits(20, 4)
    with pytest.raises(fx.ComputationError, match="not found"):
        minimax(G, g, (np.ones((2, 4)), np.array([1.0, 2.0])), np.zeros(4))


@pytest.mark.parametrize("start", [1e-3, 0.9, 40.0])
@pytest.mark.parametrize("floor", [0.0, 0.9])
def test_least_times_are_roots(start: float, floor: float) -> None:
    """Shares that fall with the square of the time to what rest takes, with waves as of what vibrates."""
    asked = []

    def share(T: float) -> float:
        return floor + (1 - floor) * (4 / T**2) * (1 + 0.05 * np.sin(3 * T))

    def evaluate(T: float, c: np.ndarray) -> tuple[np.ndarray, float]:
        asked.append(T)
        return c, share(T)

    T, _, used = least_time_by_secants(evaluate, start, np.zeros(2), low=0.0, fine=5e-3, most=1e4)
    exact = brentq(lambda T: share(T) - 1, 1.0, 4.0)
    assert used <= WITHIN and used == share(T)
    # within 0.5 % of the share, or of the time where that hardly falls any more
    assert abs(T / exact - 1) < (2.6e-3 if not floor else 0.05)
    assert len(asked) < (12 if start == 0.9 else 30)


def test_least_times_have_bounds() -> None:
    none = np.zeros(1)
    assert least_time_by_secants(lambda T, c: (c, 2.0), 1.0, none, low=0.0, fine=0.01, most=50.0) is None
    T, _, used = least_time_by_secants(lambda T, c: (c, 0.1), 1.0, none, low=0.995, fine=0.01, most=50.0)
    assert (T, used) == (1.0, 0.1)  # no time is shorter
