"""Loops about one mode and two masses against their closed forms; sampled loops against their limits."""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod.errors import InputError

M, K, C = 3.0, 1200.0, 0.9  # kg, N/m, N s/m
W = np.sqrt(K / M)  # 20 rad/s
GAINS = [0.3, 2.0, 11.0]


def strut(m=M, k=K, c=C, parallel=0.0, turning=0.0):
    """A mass on a strut with an actuator: force sensor above the strut's spring, a spring beside both."""
    stiff = k + parallel - m * turning**2
    return fc.StateSpace(
        A=[[0, 1], [-stiff / m, -c / m]],
        B=[[0, 0], [1 / m, 1 / m]],
        C=[[1, 0], [1, 0], [-k, -c]],
        D=[[0, 0], [0, 0], [1, 0]],
        inputs=("drive:1", "wrench:Fz"),
        outputs=("tool:z", "stroke:1", "force-sensor:drive:1"),
        states=("z", "z rate"),
        units={"drive:1": "N", "wrench:Fz": "N", "tool:z": "m", "stroke:1": "m", "force-sensor:drive:1": "N"},
    )


def same(found, exact, rtol=1e-9):
    """Poles, each once; two solutions of one polynomial: its condition, below 1e3 here, times rounding."""
    exact = np.asarray(exact, complex)
    assert len(found) == len(exact)
    for pole in exact:
        assert np.abs(found - pole).min() <= rtol * max(abs(pole), 1e-3)


@pytest.mark.parametrize("g", GAINS)
def test_iff_damps_one_mode_by_its_closed_form(g):
    loop = strut().close(fc.IFF(g))
    # s^2 (m s^2 + c s + k) y = m s^2 f, so that s (m s^2 + c s + k) + g m s^2 = 0: one pole at 0, the rest is a mode.
    same(loop.poles(), [0, *np.roots([M, C + g * M, K])])
    ratio = float(loop.damp().damping_ratio[-1])
    assert ratio == pytest.approx(g / (2 * W) + C * W / (2 * K), rel=1e-6)


@pytest.mark.parametrize("g", GAINS)
def test_dvf_damps_one_mode_by_its_closed_form(g):
    loop = strut().close(fc.DVF(g))
    assert float(loop.damp().damping_ratio[0]) == pytest.approx((C + g) * W / (2 * K), rel=1e-6)
    filtered = strut().close(fc.DVF(g, low_pass="1 Hz"))
    w = 2 * np.pi
    same(filtered.poles(), np.roots(np.polyadd(np.polymul([M, C, K], [1 / w, 1.0]), [g, 0.0])))


def test_iff_with_a_parallel_spring_reaches_its_best_damping():
    """Frequency w with both springs, zero z = sqrt(kp / m): at most (w - z) / (2 z), at g = w sqrt(w / z)."""
    kp = 400.0
    plant = strut(c=0.0, parallel=kp)
    w, z = np.sqrt((K + kp) / M), np.sqrt(kp / M)
    np.testing.assert_allclose(plant.zeros("drive", "force-sensor"), [-1j * z, 1j * z], rtol=1e-9)
    loop = plant.close(fc.IFF(w * np.sqrt(w / z)))
    ratios = loop.damp().damping_ratio.values
    assert ratios.min() == pytest.approx((w - z) / (2 * z), rel=1e-6)


def test_iff_with_the_stiffness_put_back_keeps_static_stiffness():
    plain, stiff = (strut().close(fc.IFF(5.0, parallel_stiffness=kp)) for kp in (0.0, 300.0))
    # At rest the integrator stops where force + kp z = 0: f - k z + kp z = 0 with m z'' = f - k z + F.
    assert stiff.at(1e-9)[0, 1, 0].real == pytest.approx(1 / 300.0, rel=1e-6)
    assert abs(plain.at(1e-9)[0, 1, 0]) > 1e4 / K


@pytest.mark.parametrize(("factor", "stable"), [(0.99, True), (1.01, False)])
def test_iff_on_a_rotating_mass_is_stable_up_to_its_limit(factor, stable):
    """Struts that turn at W with a mass: g_max = w_i (w0^2 / W^2 - 1) (Dehaeze & Collette 2021)."""
    w0, speed, w_i = 20.0, 6.0, 3.0
    m, k, c = 1.0, w0**2, 1e-9
    a = k / m - speed**2
    plant = fc.StateSpace(
        A=[[0, 0, 1, 0], [0, 0, 0, 1], [-a, 0, -c / m, 2 * speed], [0, -a, -2 * speed, -c / m]],
        B=np.vstack([np.zeros((2, 2)), np.eye(2) / m]),
        C=[[-k, 0, -c, 0], [0, -k, 0, -c]],
        D=np.eye(2),
        inputs=("drive:1", "drive:2"),
        outputs=("force-sensor:drive:1", "force-sensor:drive:2"),
        states=("u", "v", "u rate", "v rate"),
        units={},
    )
    limit = w_i * (w0**2 / speed**2 - 1)
    loop = plant.close(fc.IFF(factor * limit, high_pass=w_i / (2 * np.pi)))
    assert bool(loop.poles().real.max() < 0) is stable


def wire():
    """An actuator that is its own sensor."""
    return fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 1)), C=np.zeros((1, 0)), D=[[1.0]], inputs=("drive:1",),
        outputs=("stroke:1",), states=(), units={},
    )  # fmt: skip


@pytest.mark.parametrize(("late", "limit"), [(0, 2.0), (1, 1.0), (2, (np.sqrt(5) - 1) / 2)])
def test_a_sampled_integrator_is_stable_up_to_its_limit(late, limit):
    T = 1e-3
    for share, stable in ((0.99, True), (1.01, False)):
        law = fc.Decentralised(fc.integrator(share * limit / T), sensor="stroke")
        loop = wire().close(law, sample=T, delay=late * T)
        assert bool(np.abs(loop.poles()).max() < 1) is stable


def test_a_rate_between_samples_is_the_last_difference():
    law = fc.DVF(7.0).sampled("1 kHz", ["stroke:1"], ["drive:1"])
    assert (law.sample, law.inputs, law.outputs) == (1e-3, ("stroke:1",), ("drive:1",))
    hz = np.array([10.0, 300.0])
    z = np.exp(2j * np.pi * hz * 1e-3)
    np.testing.assert_allclose(law.at(hz)[0, 0], -7.0 * (1 - 1 / z) / 1e-3, rtol=1e-12)


@pytest.mark.parametrize("delay", [0.0, 0.4e-3, 1e-3, 1.7e-3, 3.2e-3])
def test_a_held_input_with_a_delay_follows_the_exact_motion(delay):
    """Steps of the input at all samples, each late: the mode's exact response between them."""
    T, n = 1e-3, 12
    plant = strut().select("drive", ["tool", "force-sensor"])
    found = plant.sampled(T, delay)
    u = np.random.default_rng(3).standard_normal(n)
    x, seen = np.zeros(len(found.A)), []
    for value in u:
        seen.append(found.C @ x + found.D @ [value])
        x = found.A @ x + found.B @ [value]
    zeta = C / (2 * np.sqrt(K * M))
    wd = W * np.sqrt(1 - zeta**2)

    def step(t):
        t = np.maximum(t, 0.0)
        ring = np.exp(-zeta * W * t)
        z = (1 - ring * (np.cos(wd * t) + zeta * W / wd * np.sin(wd * t))) / K
        return z, ring * W**2 / wd * np.sin(wd * t) / K

    at = np.arange(n) * T
    z = sum(value * step(at - k * T - delay)[0] for k, value in enumerate(np.diff(u, prepend=0.0)))
    v = sum(value * step(at - k * T - delay)[1] for k, value in enumerate(np.diff(u, prepend=0.0)))
    now = np.array([np.append(0, u)[max(0, int(np.floor((t - delay) / T + 1e-9)) + 1)] for t in at])
    exact = np.stack([z, now - K * z - C * v], axis=1)
    np.testing.assert_allclose(seen, exact, atol=1e-12 * np.abs(exact).max(axis=0).max())


def test_a_delay_stays_exact_in_the_response():
    tau, g = 2e-3, 40.0
    loop = strut().close(fc.PID(800.0, 0.0, g), delay="2 ms")
    hz = np.geomspace(0.1, 500, 60)
    s = 2j * np.pi * hz
    G, L = 1 / (M * s**2 + C * s + K), (800.0 + g * s) * np.exp(-s * tau)
    H = loop.frequency_response(hz).frequency_response
    H = H.sel(part="real") + 1j * H.sel(part="imaginary")
    np.testing.assert_allclose(H.sel(output="tool:z", input="wrench:Fz"), G / (1 + G * L), rtol=1e-9)
    asked = H.sel(output="control:drive:1")
    np.testing.assert_allclose(asked.sel(input="wrench:Fz"), -(800.0 + g * s) * G / (1 + G * L), rtol=1e-9)


def test_noise_of_a_sensor_and_what_is_asked_for():
    loop = strut().close(fc.PID(800.0, 0.0, 40.0, low_pass=500.0))
    hz = np.geomspace(0.1, 500, 60)
    s = 2j * np.pi * hz
    G, L = 1 / (M * s**2 + C * s + K), 800.0 + 40.0 * s / (1 + s / (2 * np.pi * 500))
    tool = loop.select("noise:stroke:1", ["tool", "control"]).at(hz)[:, 0]
    np.testing.assert_allclose(tool[0], -G * L / (1 + G * L), rtol=1e-9)
    np.testing.assert_allclose(tool[1], -L / (1 + G * L), rtol=1e-9)
    assert loop.units["noise:stroke:1"] == "m" and loop.units["control:drive:1"] == "N"


def test_an_inner_and_an_outer_loop_are_both_at_once():
    inner, outer = fc.IFF(4.0, high_pass=0.2), fc.PID(500.0, 100.0, sensor="tool")
    both = strut().close(fc.Together((inner, outer)))
    after = strut().close(inner).close(outer)
    same(after.poles(), both.poles(), rtol=1e-9)
    hz = np.geomspace(0.01, 100, 30)
    for name in ("wrench:Fz", "noise:tool:z", "noise:force-sensor:drive:1"):
        one, other = (loop.select(name, ["tool", "stroke", "control"]).at(hz) for loop in (both, after))
        np.testing.assert_allclose(one, other, rtol=1e-8)


def test_a_rate_of_what_jumps_is_refused():
    with pytest.raises(InputError, match="jumps with an input"):
        strut().close(fc.DVF(3.0, sensor="force-sensor:drive"))
    with pytest.raises(InputError, match="straight through"):
        strut().close(fc.Decentralised(fc.gain(-1.0), sensor="force-sensor:drive"))
    with pytest.raises(InputError, match="Did you mean 'stroke'"):
        strut().close(fc.DVF(3.0, sensor="strok"))
