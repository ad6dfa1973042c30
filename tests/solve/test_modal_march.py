"""Steps of a linear model along a path in C, against Gauss' two stages as one real system, and against SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import flexapod as fx
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.time.modal_march import GAUSS, STAGES, dense_march, modal_march

pytestmark = pytest.mark.consistency

SEED = np.random.default_rng(34)
TIME = np.array([0.0, 0.1, 0.25, 0.3, 0.5])


@pytest.fixture(scope="module")
def kernel():
    study = fx.preset("tripod")
    return ElasticRobot(study.robot, study.simulation).resting.kernel


def matrices(sizes: list[int], border: int) -> tuple[np.ndarray, ...]:
    """M, D, K at `TIME` of bodies that only a border couples; D and K not quite symmetric, as of loads that follow."""
    d = sum(sizes) + border
    there = np.zeros((d, d))
    for i in range(len(sizes)):
        part = slice(sum(sizes[:i]), sum(sizes[: i + 1]))
        there[part, part] = 1.0
    there[d - border :], there[:, d - border :] = 1.0, 1.0
    found = []
    for scale, skew in ((1.0, 0.0), (4.0, 1e-2), (2e4, 1e-3)):
        change = SEED.normal(size=(len(TIME), d, d)) * there
        symmetric = 0.1 * (change + change.swapaxes(1, 2)) + (6 + d) * np.eye(d)
        found.append(scale * (symmetric + skew * (change - change.swapaxes(1, 2))))
    return tuple(found)


def gauss(parts: tuple[np.ndarray, ...], force: np.ndarray) -> np.ndarray:
    """The method of two stages on (z, z'), both stages as unknowns of one real system."""
    (T, _, d, c), h, at = force.shape, TIME[-1] / len(force), CubicSpline(TIME, np.stack(parts, axis=1))
    x = np.zeros((T + 1, 2, d, c))
    for k in range(T):
        M, D, K = at(h * (k + 0.5))
        A = np.block([[np.zeros((d, d)), np.eye(d)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
        load = np.concatenate([np.zeros((2, d, c)), np.linalg.solve(M, force[k])], axis=1)
        y = x[k].reshape(2 * d, c)
        side = np.concatenate([A @ y + load[0], A @ y + load[1]])
        stages = np.linalg.solve(np.eye(4 * d) - h * np.kron(GAUSS, A), side).reshape(2, 2 * d, c)
        x[k + 1] = (y + 0.5 * h * stages.sum(axis=0)).reshape(2, d, c)
    return x


@pytest.mark.parametrize(("sizes", "border"), [([3, 3, 3], 2), ([2, 5], 0), ([], 7), ([1], 1), ([4, 4, 4, 4], 6)])
@pytest.mark.parametrize(("steps", "loads"), [(1, 1), (37, 1), (40, 5)])
def test_steps_are_those_of_gauss(kernel, sizes: list[int], border: int, steps: int, loads: int) -> None:
    """1e-10 of the largest: rounding of 40 steps, times the condition of a step's matrix, 1e2."""
    parts = matrices(sizes, border)
    force = SEED.normal(size=(steps, 2, parts[0].shape[1], loads))
    found, exact = modal_march(kernel, TIME, parts, force), gauss(parts, force)
    alone = dense_march(TIME, parts, force)
    for k in range(2):
        np.testing.assert_allclose(found[:, k], exact[:, k], rtol=0, atol=1e-10 * np.abs(exact[:, k]).max())
        np.testing.assert_allclose(alone[:, k], exact[:, k], rtol=0, atol=1e-10 * np.abs(exact[:, k]).max())


def test_steps_converge_where_matrices_change(kernel) -> None:
    """Matrices in the middle of a step serve both stages: at most a quarter of the error in half the step."""
    parts = matrices([3, 2], 2)
    push, at = SEED.normal(size=7), CubicSpline(TIME, np.stack(parts, axis=1))

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        M, D, K = at(t)
        return np.concatenate([y[7:], np.linalg.solve(M, push * np.sin(20 * t) - D @ y[7:] - K @ y[:7])])

    exact = solve_ivp(rates, (0, TIME[-1]), np.zeros(14), method="DOP853", rtol=1e-11, atol=1e-14).y[:7, -1]
    errors = []
    for steps in (50, 100):
        t = (np.arange(steps)[:, None] + STAGES) * TIME[-1] / steps
        found = modal_march(kernel, TIME, parts, (np.sin(20 * t)[..., None] * push)[..., None])
        errors.append(np.abs(found[-1, 0, :, 0] - exact).max())
    assert errors[1] < 0.3 * errors[0] < 0.01 * np.abs(exact).max()


def test_what_cannot_be_marched_is_refused(kernel) -> None:
    parts, force = matrices([2], 1), np.ones((4, 2, 3, 1))
    for wrong in (force[:0], force[:, :1], force[:, :, :2]):
        with pytest.raises(ValueError, match="loads"):
            modal_march(kernel, TIME, parts, wrong)
    with pytest.raises(ValueError, match="instants"):
        modal_march(kernel, TIME[1:], parts, force)
    for nothing in (np.zeros_like(parts[0]), np.full_like(parts[0], np.nan)):
        with pytest.raises((fx.ComputationError, ValueError)):
            modal_march(kernel, TIME, (nothing,) * 3, force)
    with pytest.raises(fx.ComputationError, match="not finite"):
        modal_march(kernel, TIME, parts, np.full_like(force, np.inf))
