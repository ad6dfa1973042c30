"""Norms, relative gains and fewer states: one mode, two masses, integrators against their closed forms."""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod.common.errors import InputError

pytestmark = pytest.mark.analytic

M, K, C = 2.5, 4000.0, 3.0


def mode(m=M, k=K, c=C, sample=None):
    return fc.StateSpace(
        A=[[0, 1], [-k / m, -c / m]],
        B=[[0, 0], [1 / m, -1]],
        C=[[1, 0], [0, 1], [-k / m, -c / m]],
        D=[[0, 0], [0, 0], [1 / m, 0]],
        inputs=("force:z", "floor:z"),
        outputs=("tool:z", "speed:z", "accelerometer:z"),
        states=("z", "z rate"),
        units={"force:z": "N", "floor:z": "m s-2", "tool:z": "m", "speed:z": "m s-1", "accelerometer:z": "m s-2"},
    )


def chain(system, channel):
    """An integrator before all inputs of a system."""
    n, m = system.B.shape
    return fc.StateSpace(
        A=np.block([[system.A, system.B], [np.zeros((m, n + m))]]), B=np.vstack([np.zeros((n, m)), np.eye(m)]),
        C=np.hstack([system.C, system.D]), D=np.zeros(system.D.shape), inputs=system.inputs, outputs=system.outputs,
        states=(*system.states, *(f"sum {name}" for name in system.inputs)), units=system.units,
    ).select(channel)  # fmt: skip


def test_h2_of_one_mode_is_its_closed_form():
    data = mode().h2()
    # (1/2pi) int abs(H)^2: position 1/(2 c k), speed 1/(2 c m), m^2 of that by floors, acceleration (c^2/m + k)/(2 c)
    exact = [[1 / (2 * C * K), M**2 / (2 * C * K)], [1 / (2 * C * M), M / (2 * C)]]
    np.testing.assert_allclose(data.h2_norm[:2] ** 2, exact, rtol=1e-12)
    np.testing.assert_allclose(data.h2_norm[2, 1] ** 2, (C**2 / M + K) / (2 * C), rtol=1e-12)
    assert np.isinf(data.h2_norm[2, 0])
    assert data.attrs["warnings"].startswith("accelerometer:z by force:z is infinite: feed-through")


def test_h2_says_which_channel_drifts_or_lasts():
    data = chain(mode(), "force").h2()
    assert np.isinf(data.h2_norm.sel(output="tool:z")).all()
    assert np.isfinite(data.h2_norm.sel(output="speed:z")) or "integrator" in data.reason.sel(output="speed:z").item()
    assert "tool:z by force:z is infinite: an integrator: a pole at 0 Hz" in data.attrs["warnings"]
    undamped = mode(c=0.0).h2(outputs="tool")
    w = np.sqrt(K / M) / (2 * np.pi)
    assert np.isinf(undamped.h2_norm).all() and f"a pole at {w:.4g} Hz" in undamped.attrs["warnings"]
    assert "unstable" in mode(c=-C).h2(outputs="tool").attrs["warnings"]


def test_h2_of_what_a_loop_leaves_at_rest():
    """Under integral force feedback a wrench moves the mass without end, at a rate whose norm is finite."""
    plant = fc.StateSpace(
        A=[[0, 1], [-K / M, -C / M]], B=[[0, 0], [1 / M, 1 / M]], C=[[1, 0], [0, 1], [-K, -C]],
        D=[[0, 0], [0, 0], [1, 0]], inputs=("drive:1", "wrench:Fz"),
        outputs=("tool:z", "speed:z", "force-sensor:drive:1"), states=("z", "v"), units={},
    )  # fmt: skip
    g = 7.0
    data = plant.close(fc.IFF(g)).h2("wrench", ["tool", "speed"])
    assert np.isinf(data.h2_norm[0, 0])
    # m z'' + (c + g m) z' + k z = F + g int F: speed (s + g) / (m s^2 + C s + k), C = c + g m, whose square integrates
    # to (1 + g^2 m / k) / (2 C m) (James, Nichols & Phillips, table of integrals, order 2).
    exact = (1 + g**2 * M / K) / (2 * (C + g * M) * M)
    assert float(data.h2_norm[1, 0] ** 2) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_what_nothing_holds_among_fast_modes(seed):
    """A free mass beside two modes, states mixed: rounding parts its poles at 0; others have their closed form."""
    rng, zeta, w, W = np.random.default_rng(seed), 0.02, 30.0, 4e4
    A, B, C = np.zeros((6, 6)), np.zeros((6, 1)), np.zeros((2, 6))
    for k, omega in enumerate((0.0, w, W)):
        A[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[0, 1], [-(omega**2), -2 * zeta * omega]]
        B[2 * k + 1] = 1.0
    C[0, [0, 2]] = C[1, 2] = 1.0  # where the mass is as well, and the slow mode alone
    Q = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    mixed = fc.StateSpace(
        A=Q.T @ A @ Q, B=Q.T @ B, C=C @ Q, D=np.zeros((2, 1)), inputs=("force",), outputs=("both", "mode"),
        states=tuple("abcdef"), units={},
    )  # fmt: skip
    found = mixed.h2()
    assert np.isinf(found.h2_norm[0, 0]) and "pole at" in found.attrs["warnings"]
    assert np.isinf(float(mixed.hinf("force", "both").hinf_norm))
    # Rounding of A is 1e-16 W^2 = 2e-7 beside w^2 = 900
    assert found.h2_norm[1, 0].item() == pytest.approx(1 / np.sqrt(4 * zeta * w**3), rel=1e-6)


def test_a_slow_filter_is_none_of_what_nothing_holds():
    """1 / (s + 0.01) beside a mode of 1e5 rad/s: 1 / sqrt(0.02), and 100 at rest."""
    A = np.zeros((3, 3))
    A[0, 0], A[1:, 1:] = -0.01, [[0, 1], [-1e10, -2e3]]
    one = fc.StateSpace(
        A=A, B=[[1.0], [0.0], [1.0]], C=[[1.0, 1.0, 0.0]], D=[[0.0]], inputs=("u",), outputs=("y",),
        states=tuple("abc"), units={},
    )  # fmt: skip
    assert one.h2().h2_norm.item() == pytest.approx(1 / np.sqrt(0.02), rel=1e-6)
    assert float(one.hinf().hinf_norm) == pytest.approx(100.0, rel=1e-6)


def test_hinf_of_one_mode_is_its_closed_form():
    zeta = C / (2 * np.sqrt(K * M))
    data = mode().hinf("force", "tool")
    assert float(data.hinf_norm) == pytest.approx(1 / (K * 2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-9)
    peak = np.sqrt(K / M * (1 - 2 * zeta**2)) / (2 * np.pi)
    assert float(data.frequency) == pytest.approx(peak, rel=1e-4)  # flat there: the root of the accuracy of its size
    stiff = mode(c=50 * np.sqrt(K * M)).hinf("force", "tool")
    assert float(stiff.hinf_norm) == pytest.approx(1 / K, rel=1e-12) and stiff.frequency == 0
    assert np.isinf(mode(c=0.0).hinf("force", "tool").hinf_norm)


@pytest.mark.parametrize("zeta", [0.05, 0.5, 0.7, 0.705, 0.9])
def test_hinf_next_to_what_no_end_of_frequencies_has(zeta):
    """The acceleration of a mass by its force: 1 / M far above it, and a little more before."""
    found = mode(c=2 * zeta * np.sqrt(K * M)).hinf("force", "accelerometer")
    peak = 1 / (2 * zeta * np.sqrt(1 - zeta**2)) if zeta < 0.5**0.5 else 1.0
    assert float(found.hinf_norm) == pytest.approx(peak / M, rel=1e-9)  # ten times its accuracy
    if zeta < 0.7:
        hertz = np.sqrt(K / M / (1 - 2 * zeta**2)) / (2 * np.pi)
        assert float(found.frequency) == pytest.approx(hertz, rel=1e-4)


@pytest.mark.parametrize("sample", [None, 0.01])
def test_hinf_is_no_less_than_anything_on_a_grid_and_reached(sample):
    """Systems of all kinds, drawn: none is above what is found, and where that is said to be, it is."""
    rng = np.random.default_rng(11)
    for _ in range(150):
        n, m, p = rng.integers(1, 7), rng.integers(1, 4), rng.integers(1, 4)
        A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, m)), rng.normal(size=(p, n))
        D = rng.normal(size=(p, m)) * rng.integers(0, 2)
        if sample is None:
            A -= (np.linalg.eigvals(A).real.max() + 10 ** rng.uniform(-3, 0)) * np.eye(n)
            s = 1j * np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 400)])
        else:
            A *= rng.uniform(0.3, 0.999) / np.abs(np.linalg.eigvals(A)).max()
            s = np.exp(1j * np.linspace(0, np.pi, 400))
        names = (tuple(f"{letter}{i}" for i in range(count)) for letter, count in (("u", m), ("y", p), ("x", n)))
        inputs, outputs, states = names
        found = fc.StateSpace(
            A=A, B=B, C=C, D=D, inputs=inputs, outputs=outputs, states=states, units={}, sample=sample
        ).hinf()
        level, hertz = float(found.hinf_norm), float(found.frequency)

        def sizes(s, A=A, B=B, C=C, D=D):
            inner = s[:, None, None] * np.eye(len(A)) - A
            return np.linalg.norm(C @ np.linalg.solve(inner, np.broadcast_to(B, (len(s), *B.shape))) + D, 2, (1, 2))

        assert sizes(s).max() <= level * (1 + 1e-9)
        if np.isinf(hertz):
            assert np.linalg.norm(D, 2) == pytest.approx(level, rel=1e-8)
        else:
            there = np.array([2j * np.pi * hertz])
            assert sizes(there if sample is None else np.exp(there * sample))[0] == pytest.approx(level, rel=1e-8)


def test_norms_between_samples():
    a, b, T = 0.93, 0.2, 1e-3
    one = fc.StateSpace(
        A=[[a]], B=[[b]], C=[[1.0]], D=[[0.5]], inputs=("u",), outputs=("y",), states=("x",), units={}, sample=T
    )
    assert one.h2().h2_norm.item() == pytest.approx(np.sqrt(b**2 / (1 - a**2) + 0.25), rel=1e-12)
    assert float(one.hinf().hinf_norm) == pytest.approx(b / (1 - a) + 0.5, rel=1e-9)


@pytest.mark.parametrize(
    ("pole", "hertz", "words"),
    [
        (-1.0, 50.0, "never decays: a pole at 50 Hz"),
        (1.0, 0.0, "never decays: a pole at 0 Hz"),
        (-1.01, 50.0, "unstable"),
    ],
)
def test_norms_of_samples_that_do_not_end(pole, hertz, words):
    """What changes its sign from sample to sample is at half their rate."""
    one = fc.StateSpace(
        A=[[pole]], B=[[1.0]], C=[[1.0]], D=[[0.0]], inputs=("u",), outputs=("y",), states=("x",), units={}, sample=0.01
    )
    assert np.isinf(one.h2().h2_norm.item()) and words in one.h2().attrs["warnings"]
    found = one.hinf()
    assert np.isinf(float(found.hinf_norm)) and float(found.frequency) == pytest.approx(hertz, abs=1e-9)


def test_relative_gains_of_two_by_two():
    G = np.array([[2.0, 0.5], [0.3, 1.0]])
    static = fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 2)), C=np.zeros((2, 0)), D=G, inputs=("a", "b"), outputs=("x", "y"),
        states=(), units={},
    )  # fmt: skip
    data = static.rga([1.0, 10.0])
    one = G[0, 0] * G[1, 1] / np.linalg.det(G)  # the closed form of Bristol
    np.testing.assert_allclose(
        data.relative_gain.sel(part="real")[:, :, 1], [[one, 1 - one], [1 - one, one]], rtol=1e-13
    )
    with pytest.raises(InputError, match="as many inputs as outputs"):
        mode().rga(1.0)


def beam(count=6):
    """Modes of 10 Hz times squares, equal shares at one point: compliance 1 / k each."""
    w = 2 * np.pi * 10.0 * np.arange(1, count + 1) ** 2
    n = count
    return fc.StateSpace(
        A=np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w**2), -np.diag(0.02 * w)]]),
        B=np.vstack([np.zeros((n, 1)), np.ones((n, 1))]), C=np.hstack([np.ones((1, n)), np.zeros((1, n))]),
        D=np.zeros((1, 1)), inputs=("f",), outputs=("y",), states=tuple(f"x{i}" for i in range(2 * n)), units={},
    ), w  # fmt: skip


def test_fewer_states_keep_slow_modes_and_static_compliance():
    system, w = beam()
    for less, states in ((system.reduce(3), 6), (system.reduce(below="200 Hz"), 8)):
        assert len(less.A) == states
        np.testing.assert_allclose(less.at(0)[0, 0, 0].real, (1 / w**2).sum(), rtol=1e-12)
    less, bare = system.reduce(3), system.reduce(3, residual=False)
    np.testing.assert_allclose(np.abs(less.poles())[::2], w[:3], rtol=1e-12)
    hz = np.geomspace(1, 60, 40)
    s = 2j * np.pi * hz[:, None]
    slow = (1 / (s**2 + 0.02 * w[:3] * s + w[:3] ** 2)).sum(axis=1)
    np.testing.assert_allclose(bare.at(hz)[0, 0], slow, rtol=1e-9)
    np.testing.assert_allclose(less.at(hz)[0, 0], slow + (1 / w[3:] ** 2).sum(), rtol=1e-9)
    # Between the first modes a zero: with the residual it stays within 1 %, without it moves.
    whole = np.abs(system.zeros())[0]
    assert abs(np.abs(less.zeros())[0] / whole - 1) < 1e-2 < 3 * abs(np.abs(bare.zeros())[0] / whole - 1)


def test_modes_of_one_frequency_stay_together():
    w = 30.0
    A = np.zeros((6, 6))
    A[:3, 3:] = np.eye(3)
    A[3:, :3] = -np.diag([w**2, w**2, 9 * w**2])
    pair = fc.StateSpace(
        A=A, B=np.vstack([np.zeros((3, 1)), np.ones((3, 1))]), C=np.eye(6)[:1], D=[[0]], inputs=("f",), outputs=("y",),
        states=tuple("abcdef"), units={},
    )  # fmt: skip
    assert len(pair.reduce(1).A) == 4
    with pytest.raises(InputError, match="one of the two"):
        pair.reduce()


def test_noise_of_a_sensor_in_a_loop_of_place_and_rate():
    """Noise of the sensor moves the mass by -(kp + kd s) / (m s^2 + (c + kd) s + k + kp): its variance."""
    kp, kd, S = 3000.0, 25.0, 1e-12
    plant = fc.StateSpace(
        A=[[0, 1], [-K / M, -C / M]], B=[[0], [1 / M]], C=[[1, 0]], D=[[0]], inputs=("drive:1",), outputs=("stroke:1",),
        states=("z", "v"), units={},
    )  # fmt: skip
    loop = plant.close(fc.PID(kp, 0.0, kd, low_pass=1e6))
    # int |b1 s + b0|^2 / |a2 s^2 + a1 s + a0|^2 / 2 pi = (b1^2 a0 + b0^2 a2) / (2 a0 a1 a2); the filter of the rate is
    # far enough to change 1e-4 of it; a one-sided density counts half of the two-sided integral.
    a0, a1, a2 = K + kp, C + kd, M
    power = (kd**2 * a0 + kp**2 * a2) / (2 * a0 * a1 * a2)
    assert loop.h2("noise", "stroke").h2_norm.item() ** 2 == pytest.approx(power, rel=1e-4)
    wide = (np.array([1e-4, 1e5]), np.full(2, S))
    found = loop.psd({"noise:stroke:1": wide}, "stroke").rms.item() ** 2
    assert found == pytest.approx(S * power / 2, rel=2e-4)


def test_h2_of_samples_is_a_ratio_of_rms():
    """y_next = a y + u under white samples: rms 1 / sqrt(1 - a^2), no root of a frequency in it."""
    a = 0.6
    one = fc.StateSpace(
        A=[[a]], B=[[1]], C=[[1]], D=[[0]], inputs=("u",), outputs=("y",), states=("y",), units={"u": "V", "y": "m"},
        sample=1e-3,
    )  # fmt: skip
    data = one.h2()
    assert data.h2_norm.item() == pytest.approx(1 / np.sqrt(1 - a**2), rel=1e-12)
    assert data.h2_norm.attrs["units"] == "output_units / input_units"
    assert mode().h2().h2_norm.attrs["units"] == "output_units / input_units * Hz**0.5"
