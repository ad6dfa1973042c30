"""Loops about one mode and two masses against their closed forms; sampled loops against their limits."""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod.common.errors import InputError

pytestmark = pytest.mark.analytic

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
    both = strut().close(fc.Parallel((inner, outer)))
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


def test_the_best_gain_of_iff_is_its_closed_form():
    kp = 400.0
    plant = strut(c=0.0, parallel=kp)
    w, z = np.sqrt((K + kp) / M), np.sqrt(kp / M)
    found = fc.best_gain(plant, fc.IFF(1.0), least=1.0, most=1e3)
    assert found.gain.item() == pytest.approx(w * np.sqrt(w / z), rel=1e-4)  # flat there
    assert found.damping_ratio.item() == pytest.approx((w - z) / (2 * z), rel=1e-6)
    assert found.least_damping_ratio.max() <= found.damping_ratio


def test_the_best_gain_holds_what_falls_by_itself():
    """x' = a x - g x falls without g > a; beside it z'' + c z' + (1 + g) k z = 0 is damped less the larger g: g = a."""
    a, c, k = 3.0, 0.8, 5.0
    plant = fc.StateSpace(
        A=[[a, 0, 0], [0, 0, 1], [0, -k, -c]], B=[[1, 0], [0, 0], [0, k]], C=[[1, 0, 0], [0, 1, 0]], D=np.zeros((2, 2)),
        inputs=("drive:1", "drive:2"), outputs=("stroke:1", "stroke:2"), states=("x", "z", "v"), units={},
    )  # fmt: skip
    found = fc.best_gain(plant, fc.Decentralised(fc.gain(1.0), sensor="stroke"), least=0.1, most=100.0)
    exact = c / 2 / np.sqrt((1 + a) * k)
    # a jump at a: between two factors 1 / 40 of a decade apart, 6 %, the larger one is sure to be found
    assert a < found.gain.item() < a * 10 ** (1 / 40)
    assert found.damping_ratio.item() == pytest.approx(exact, rel=0.03) and found.damping_ratio.item() < exact
    factor, least = found.factor.values, found.least_damping_ratio.values
    assert (least[factor < a] == -1).all()
    assert least[factor > a] == pytest.approx(c / 2 / np.sqrt((1 + factor[factor > a]) * k), rel=1e-9)


def test_branches_of_a_root_locus_go_from_poles_to_zeros():
    kp = 400.0
    plant, z = strut(c=0.0, parallel=kp), np.sqrt(kp / M)
    gains = np.concatenate([[0.0], np.geomspace(1e-2, 1e6, 400)])
    data = fc.root_locus(plant, fc.IFF(1.0), gains)
    pole = data.pole.sel(part="real").values + 1j * data.pole.sel(part="imaginary").values
    for row, g in zip(pole, gains, strict=True):
        if 1e-2 < g < 1e4:
            same(row, np.roots([1, g, (K + kp) / M, g * z**2]), rtol=1e-7)  # two real ones meet on the way
    steps = np.abs(np.diff(pole[:, :], axis=0)) / (1 + np.abs(pole[1:]))
    assert steps.max() < 0.6  # no branch jumps to another's place
    same(pole[0], [0, 1j * np.sqrt((K + kp) / M), -1j * np.sqrt((K + kp) / M)])
    zeros = data.open_zero.sel(part="real").values + 1j * data.open_zero.sel(part="imaginary").values
    same(zeros, [1j * z, -1j * z])


@pytest.mark.parametrize("tau", [0.0, 0.01, 0.3])
def test_margins_of_an_integrator_with_a_delay_are_closed_forms(tau):
    """Integrator g/s around a wire: crossing at g rad/s with 90 degrees but the delay; limit where g tau = pi / 2."""
    g = 4.0
    law = fc.Decentralised(fc.integrator(g), sensor="stroke")
    data = fc.margins(wire(), law, delay=tau)
    assert data.phase_margin.item() == pytest.approx(np.pi / 2 - g * tau, rel=1e-7)
    assert data.phase_margin_frequency.item() == pytest.approx(g / (2 * np.pi), rel=1e-7)
    assert data.delay_margin.item() == pytest.approx(np.pi / (2 * g) - tau, rel=1e-7)
    limit = np.pi / (2 * tau) / g if tau else np.inf
    assert data.gain_margin.sel(side="above").item() == pytest.approx(limit, rel=1e-7)
    assert data.attrs["unstable_poles"] == 0


@pytest.mark.parametrize(("factor", "growing"), [(0.98, 0), (1.02, 2), (5.1, 4), (4.9, 2)])
def test_growing_poles_of_a_delayed_integrator_are_counted(factor, growing):
    """Pairs cross as g tau passes pi/2, 5 pi/2: s = i w, g = w, w tau = pi/2 + 2 pi n."""
    g = 4.0
    law = fc.Decentralised(fc.integrator(g), sensor="stroke")
    assert fc.margins(wire(), law, delay=factor * np.pi / (2 * g)).attrs["unstable_poles"] == growing


def test_margins_of_a_servo_are_those_of_its_polynomials():
    plant, law = strut(), fc.PID(2000.0, 0.0, 60.0, low_pass=30.0)
    data = fc.margins(plant, law)
    w = 2 * np.pi * 30
    top = np.polyadd(np.polymul([2000.0], [1 / w, 1.0]), [60.0, 0.0])
    bottom = np.polymul([M, C, K], [1 / w, 1.0])
    # |top|^2 = |bottom|^2 on the axis: a polynomial in w^2; size 1 and its angle.
    square = lambda p: np.polymul(p, p * (-1.0) ** np.arange(len(p) - 1, -1, -1))  # noqa: E731
    roots = np.roots(np.polysub(square(top), square(bottom)))
    at = np.unique(np.round([abs(r.imag) for r in roots if abs(r.real) < 1e-6 * abs(r)], 9))
    angles = [np.angle(-np.polyval(top, 1j * x) / np.polyval(bottom, 1j * x)) for x in at]
    assert data.phase_margin.item() == pytest.approx(min(angles, key=abs), rel=1e-6)
    x = np.linspace(0.01, 500, 200001)
    distance = np.abs(1 + np.polyval(top, 1j * x) / np.polyval(bottom, 1j * x)).min()
    assert data.modulus_margin.item() == pytest.approx(distance, rel=1e-6)


def test_two_loops_are_cut_one_by_one():
    """Two masses, each held by a servo: the loop of the first sees the second with its servo."""
    m, k, g = 2.0, 500.0, 30.0
    Kc = np.array([[2 * k, -k], [-k, 2 * k]])
    plant = fc.StateSpace(
        A=np.block([[np.zeros((2, 2)), np.eye(2)], [-Kc / m, np.zeros((2, 2))]]),
        B=np.vstack([np.zeros((2, 2)), np.eye(2) / m]),
        C=np.hstack([np.eye(2), np.zeros((2, 2))]),
        D=np.zeros((2, 2)),
        inputs=("drive:1", "drive:2"),
        outputs=("stroke:1", "stroke:2"),
        states=tuple("abcd"),
        units={},
    )
    data = fc.margins(plant, fc.DVF(g))
    # L1 = g s z1/f1 with f2 = -g z2': z1/f1 = (m s^2 + g s + 2 k) / ((m s^2 + 2 k)(m s^2 + g s + 2 k) - k^2); it is
    # positive real, so that its phase stays within 90 degrees: no limit of gain, a phase margin of 90 degrees at least.
    assert np.isinf(data.gain_margin.sel(side="above")).all()
    s = 2j * np.pi * data.phase_margin_frequency.values
    own = m * s**2 + g * s + 2 * k
    L1 = g * s * own / ((m * s**2 + 2 * k) * own - k**2)
    np.testing.assert_allclose(np.abs(L1), 1.0, rtol=1e-7)
    np.testing.assert_allclose(np.angle(-L1), data.phase_margin, rtol=1e-7)
