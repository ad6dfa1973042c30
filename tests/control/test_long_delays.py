"""Margins of loops with long delays: a lag, whose limits have a closed form, and two loops beside a fine scan."""

import numpy as np
import pytest
from scipy.optimize import brentq

import flexapod as fx
import flexapod.control as fc

pytestmark = pytest.mark.analytic

K, T = 3.0, 0.2  # gain, and time of the lag [s]: L = K exp(-s tau) / (1 + s T)
W = np.sqrt(K**2 - 1) / T  # where |L| = 1


def gains(matrix):
    """A controller u = matrix y."""
    m = len(matrix)
    return fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, m)), C=np.zeros((m, 0)), D=matrix, units={}, states=(),
        inputs=tuple(f"y{i}" for i in range(m)), outputs=tuple(f"u{i}" for i in range(m)),
    )  # fmt: skip


def lags(times, turn=None):
    """Lags side by side, whose channels are turned."""
    m, turn = len(times), np.eye(len(times)) if turn is None else turn
    return fc.StateSpace(
        A=-np.diag(1 / times), B=np.diag(1 / times) @ turn.T, C=turn, D=np.zeros((m, m)), units={},
        inputs=tuple(f"u{i}" for i in range(m)), outputs=tuple(f"y{i}" for i in range(m)),
        states=tuple(f"x{i}" for i in range(m)),
    )  # fmt: skip


def least(distance, w):
    """The least of a function of frequencies, about each of the lowest points of a scan."""
    found = distance(w)
    low = np.flatnonzero((found[1:-1] <= found[:-2]) & (found[1:-1] <= found[2:])) + 1
    low = low[np.argsort(found[low])[:20]]
    return min(float(distance(np.linspace(w[i - 1], w[i + 1], 20_001)).min()) for i in low.tolist())


@pytest.mark.parametrize("delay", [0.01, 0.1, 1.0, 7.3, 30.0, 90.0])
def test_a_lag_with_a_delay(delay):
    """At a limit w tau + atan(w T) = pi + 2 pi n. Once the turns between neighbouring frequencies were not seen."""
    data = fc.margins(lags(np.array([T])), gains([[-K]]), delay=delay)
    turns = np.arange(int(30 / T * delay / (2 * np.pi)) + 3)  # beyond w T = 30 no limit is nearer
    at = [
        brentq(lambda w, n=n: w * delay + np.arctan(w * T) - np.pi - 2 * np.pi * n, 0, 2 * np.pi * (n + 1) / delay)
        for n in turns.tolist()
    ]
    factors = np.sqrt(1 + (np.array(at) * T) ** 2) / K
    below, above = data.gain_margin.values[0]
    # the ends of a search that goes on until 41^-6 of an interval is left; the roots beside it to 1e-12
    assert above == pytest.approx(factors[factors > 1].min(), rel=1e-8)
    assert below == pytest.approx(factors[factors <= 1].max(initial=0.0), rel=1e-8)
    phase = np.pi - (W * delay + np.arctan(W * T))
    assert data.phase_margin.item() == pytest.approx((phase + np.pi) % (2 * np.pi) - np.pi, abs=1e-8 * (1 + W * delay))
    assert data.delay_margin.item() == pytest.approx(phase % (2 * np.pi) / W, abs=1e-8 * (1 + delay))
    first = (np.pi - np.arctan(W * T)) / W  # delays at which a pair of poles begins to grow
    assert data.attrs["unstable_poles"] == 2 * max(0, int(np.ceil((delay - first) * W / (2 * np.pi))))
    nearest = least(
        lambda w: np.abs(1 + K * np.exp(-1j * w * delay) / (1 + 1j * w * T)), np.linspace(0, 50 * W, 500_001)
    )
    assert data.modulus_margin.item() == pytest.approx(nearest, rel=1e-4)


def test_two_coupled_loops_with_a_delay():
    """Of loops F = exp(-s tau) K G: 1 + L_k = det(1 - F) / det(1 - F without row and column k)."""
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    times, law, delay = np.array([0.2, 0.03]), np.array([[-2.0, 0.3], [-0.4, -1.5]]), 3.0
    data = fc.margins(lags(times, turn), gains(law), delay=delay)

    def returned(k, w):
        """1 + L_k at frequencies [rad/s]."""
        G = (turn[:, :, None] / (1 + 1j * w * times[:, None])[None]).transpose(2, 0, 1) @ turn.T
        F = np.exp(-1j * w * delay)[:, None, None] * (law @ G)
        return np.linalg.det(np.eye(2) - F) / (1 - F[:, 1 - k, 1 - k])

    w = np.linspace(1e-3, 400.0, 500_001)
    for k in range(2):
        assert data.modulus_margin.values[k] == pytest.approx(least(lambda w, k=k: np.abs(returned(k, w)), w), rel=1e-4)
        L = returned(k, w) - 1
        at = np.flatnonzero((L.imag[1:] * L.imag[:-1] < 0) & (L.real[1:] < 0))
        factors = -1 / (L.real[at] + L.imag[at] / (L.imag[at] - L.imag[at + 1]) * np.diff(L.real)[at])
        below, above = data.gain_margin.values[k]
        assert above == pytest.approx(factors[factors > 1].min(), rel=1e-5)
        assert below == pytest.approx(factors[factors <= 1].max(initial=0.0), rel=1e-5)


@pytest.mark.parametrize("delay", [200.0, 1e6, 1e12, 1e300])
def test_delays_without_end_are_refused(delay):
    with pytest.raises(fx.InputError, match=r"turns the loop .* at most 2500 turns, \d+ s here") as error:
        fc.margins(lags(np.array([T])), gains([[-K]]), delay=delay)
    assert error.value.key == "delay"


def test_a_robots_delay_of_a_second_is_bounded(monkeypatch):
    """Responses at 139,000 frequencies once, of all six drives at 870,000 in 17 s; now at what the turns need."""
    robot = fx.linearize(fx.preset("nano-hexapod"), inputs="drive:1", outputs="force-sensor:drive:1")
    asked = []
    at = fc.StateSpace.at
    monkeypatch.setattr(fc.StateSpace, "at", lambda self, hz: asked.append(np.size(hz)) or at(self, hz))
    robot = fc.StateSpace(**{name: getattr(robot, name) for name in fc.StateSpace.__dataclass_fields__})
    fc.margins(robot, fc.IFF(50.0), delay=1.0)
    assert sum(asked) / 2 < 100_000  # of the robot and of its law
