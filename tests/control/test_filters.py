"""Laws of one channel by the transfers that textbooks give them, alone, in controllers and between samples."""

import numpy as np
import pytest
from scipy import signal

import flexapod as fx
import flexapod.control as fc
from flexapod.common.errors import InputError

pytestmark = pytest.mark.analytic

HZ = np.geomspace(0.3, 300.0, 25)
S = 2j * np.pi * HZ
W, Z = 2 * np.pi * 12.0, 0.35
G, D = 40.0, 3.0

#: Laws at 12 Hz, and their transfers as they are written; all by definition, so that rounding alone may differ.
LAWS = {
    "gain": (fc.gain(-3.0), -3.0 + 0 * S),
    "rate": (fc.rate(D), D * S),
    "rate with a corner": (fc.rate(D, 12.0), D * S / (1 + S / W)),
    "integrator": (fc.integrator(G), G / S),
    "low-pass": (fc.low_pass(12.0), W / (S + W)),
    "low-pass of two": (fc.low_pass(12.0, 2, Z), W**2 / (S**2 + 2 * Z * W * S + W**2)),
    "high-pass": (fc.high_pass(12.0), S / (S + W)),
    "high-pass of two": (fc.high_pass(12.0, 2, Z), S**2 / (S**2 + 2 * Z * W * S + W**2)),
    "notch": (fc.notch(12.0, Z, 0.1), (S**2 + 0.2 * Z * W * S + W**2) / (S**2 + 2 * Z * W * S + W**2)),
    "lead": (fc.lead(12.0, 3.0), (1 + 3 * S / W) / (1 + S / (3 * W)) / 3),
    "positive feedback": (fc.positive_feedback(12.0, Z, 0.7), 0.7 * W**2 / (S**2 + 2 * Z * W * S + W**2)),
    "pid": (fc.pid(G, 5.0, D, 12.0), G + 5.0 / S + D * S / (1 + S / W)),
    "pid of an exact rate": (fc.pid(G, 5.0, D), G + 5.0 / S + D * S),
    "leaky integrator": (fc.integrator(G, 12.0), G / (S + W)),
    "behind each other": (fc.lead(12.0, 3.0) * fc.high_pass(30.0),
                          (1 + 3 * S / W) / (1 + S / (3 * W)) / 3 * S / (S + 2.5 * W)),
    "a rate behind a filter": (fc.rate(D) * fc.low_pass(12.0, 2, Z), D * S * W**2 / (S**2 + 2 * Z * W * S + W**2)),
    "beside each other": (fc.notch(12.0, Z) + fc.rate(D, 12.0),
                          (S**2 + W**2) / (S**2 + 2 * Z * W * S + W**2) + D * S / (1 + S / W)),
}  # fmt: skip


@pytest.mark.parametrize("name", list(LAWS))
def test_laws_have_their_transfers(name):
    law, exact = LAWS[name]
    np.testing.assert_allclose(law.at(HZ), exact, rtol=1e-10)


@pytest.mark.parametrize("law", [fc.low_pass, fc.high_pass])
def test_filters_of_two_are_those_of_butterworth_where_no_damping_is_given(law):
    """|H|^2 = 1 / (1 + r^4), r = f / corner or corner / f."""
    hz = np.array([3.0, 12.0, 50.0])
    r = hz / 12.0 if law is fc.low_pass else 12.0 / hz
    np.testing.assert_allclose(np.abs(law(12.0, 2).at(hz)), 1 / np.sqrt(1 + r**4), rtol=1e-10)


@pytest.mark.parametrize("to_force", [1.0, 1e-9, 1e9])
@pytest.mark.parametrize("to_place", [1.0, 1e-9])
def test_zeros_do_not_depend_on_units(to_force, to_place):
    """Force on the first of two masses, its acceleration seen: poles of the second alone on its springs, 0 twice."""
    m, k, c = 2.0, 700.0, 3.0
    near = np.array([[-2.0, 1.0], [1.0, -2.0]]) / m
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [k * near, c * near]])
    plant = fc.StateSpace(
        A=A, B=to_force * np.array([[0], [0], [1 / m], [0]]), C=to_place * A[2:3], D=[[to_place * to_force / m]],
        inputs=("u",), outputs=("y",), states=("x1", "x2", "v1", "v2"), units={},
    )  # fmt: skip
    exact = np.roots([m, 2 * c, 2 * k, 0, 0])
    # two zeros in one place are as uncertain as the root of rounding
    np.testing.assert_allclose(np.sort_complex(np.round(plant.zeros(), 5)), np.sort_complex(exact), atol=1e-5)


@pytest.mark.parametrize("name", list(LAWS))
def test_products_and_sums(name):
    """Behind each other transfers multiply, beside each other they add, whichever of the two takes the rate."""
    (law, exact), (other, beside) = LAWS[name], LAWS["low-pass of two"]
    for both in (law * other, other * law):
        np.testing.assert_allclose(both.at(HZ), exact * beside, rtol=1e-10)
    np.testing.assert_allclose((law + other).at(HZ), exact + beside, rtol=1e-10)
    np.testing.assert_allclose((-2.0 * law).at(HZ), -2.0 * exact, rtol=1e-10)


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: fc.rate(1.0) * fc.rate(1.0), None),
        (lambda: fc.lead(20.0, 0.0), "ratio"),
        (lambda: fc.low_pass(20.0, 3), "order"),
        (lambda: fc.complementary(20.0, 4), "order"),
        (lambda: fc.notch(0.0), "frequency"),
        (lambda: fc.ControlLaw.of([1.0, 0.0, 0.0], [1.0]), "numerator"),
    ],
)
def test_laws_that_there_are_not(call, key):
    with pytest.raises(InputError) as refused:
        call()
    assert key is None or refused.value.key == key


@pytest.mark.parametrize("order", [1, 2, 3])
def test_complementary_filters_add_up_and_fall(order):
    low, high = fc.complementary(12.0, order)
    np.testing.assert_allclose(low.at(HZ) + high.at(HZ), 1.0, rtol=1e-10)
    # a decade and a half beyond the corner each further octave takes 2^order: 5 % of that is left of the other terms
    for law, hz in ((low, [2400.0, 4800.0]), (high, [0.06, 0.03])):
        near, far = np.abs(law.at(hz))
        assert near / far == pytest.approx(2.0**order, rel=0.05)


def motion(speed=False):
    """A mass of 2 kg on a spring, seen by two sensors of its place, the second of them also of its speed."""
    A = [[0, 1], [-800.0 / 2, -6.0 / 2]]
    return fc.StateSpace(
        A=A, B=[[0], [0.5]], C=[[1, 0], [0, 1] if speed else [1, 0]], D=[[0], [0]], inputs=("drive:1",),
        outputs=("encoder:1", "stroke:1"), states=("z", "v"), units={},
    )  # fmt: skip


def test_fused_sensors_are_low_passed_and_high_passed():
    """With one motion in both the law acts as if on one sensor; noise of each enters through its own filter."""
    law = fc.pid(300.0, 0.0, 25.0, low_pass=80.0)
    loop = motion().close(fc.SensorFusion(law, low="encoder", high="stroke", corner=12.0))
    plant = 1 / (2 * S**2 + 6 * S + 800)
    K = 300.0 + 25.0 * S / (1 + S / (2 * np.pi * 80))
    share = W / (S + W)
    H = loop.select(["drive", "noise:encoder:1", "noise:stroke:1"], "encoder").at(HZ)[0]
    for found, given in zip(H, (1.0, -K * share, -K * (1 - share)), strict=True):
        np.testing.assert_allclose(found, given * plant / (1 + K * plant), rtol=1e-9)


def test_a_rate_of_a_speed_is_a_mass():
    """-g times the acceleration, which follows the force at once: (m + g) z'' + c z' + k z = f."""
    loop = motion(speed=True).close(fc.DVF(1.5, sensor="stroke"))
    H = loop.select("drive", "encoder").at(HZ)[0, 0]
    np.testing.assert_allclose(H, 1 / (3.5 * S**2 + 6 * S + 800), rtol=1e-9)


def test_filtered_rates_between_samples():
    """The last difference over the period through the filter of held readings, by scipy.signal."""
    T, y = 2e-3, np.random.default_rng(4).standard_normal(60)
    law = fc.Decentralised(fc.rate(D) * fc.low_pass(12.0, 2, Z), sensor="stroke")
    sampled = law.sampled(T, ["stroke:1"], ["drive:1"])
    _, found, _ = signal.dlsim((sampled.A, sampled.B, sampled.C, sampled.D, T), y)
    b, a, _ = signal.cont2discrete(([W**2], [1, 2 * Z * W, W**2]), T, "zoh")
    expected = signal.lfilter(b.ravel(), a, np.diff(y, prepend=0.0) / T)
    np.testing.assert_allclose(found.ravel(), -D * expected, atol=1e-9 * np.abs(D * expected).max())


def test_several_actuators_and_sensors_of_parts():
    """Two controllers that share one of three actuators: the sum, channel by channel."""
    readings, actuators = ("stroke:1", "stroke:2", "tool:z"), ("drive:1", "drive:2", "drive:3")
    one = fc.Decentralised(fc.gain(2.0), sensor=["stroke:1", "stroke:2"], actuator=["drive:3", "drive:1"])
    two = fc.Decentralised(fc.low_pass(12.0) * 5.0, sensor="tool:z", actuator="drive:1")
    found = fc.Parallel((one, two)).on(readings, actuators)
    expected = {("drive:3", "stroke:1"): -2.0, ("drive:1", "stroke:2"): -2.0, ("drive:1", "tool:z"): -5 * W / (S + W)}
    H = found.at(HZ)
    for i, out in enumerate(found.outputs):
        for j, into in enumerate(found.inputs):
            np.testing.assert_allclose(H[i, j], expected.get((out, into), 0.0) * np.ones(len(HZ)), atol=1e-12)


def test_singular_vectors_of_what_is_not_symmetric():
    """A response without phase is decoupled to its singular values, whatever side they are on."""
    G = np.array([[3.0, 1.0, -0.5], [0.2, 2.0, 0.7], [-1.0, 0.4, 1.5]])
    static = fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 3)), C=np.zeros((3, 0)), D=G, inputs=("drive:1", "drive:2", "drive:3"),
        outputs=("stroke:1", "stroke:2", "stroke:3"), states=(), units={},
    )  # fmt: skip
    found = fc.by_singular_vectors(static, 5.0)
    alone = found.into @ G @ found.out
    np.testing.assert_allclose(np.abs(alone), np.diag(np.linalg.svd(G, compute_uv=False)), atol=1e-12)


def test_the_centre_of_stiffness_of_a_turned_platform():
    """No point beside it couples forces and turns less: its neighbours in platform axes, at a home that is turned."""
    study = fx.preset("paper-robot")
    robot = study.robot.replace(home=study.robot.home.replace(rotation=[0.3, -0.2, 0.5]))
    weights = np.array([1.0, 2.0, 3.0, 1.5, 0.7, 2.2])

    def coupling(J):
        return np.linalg.norm((J.T @ (weights[:, None] * J))[:3, 3:])

    least = coupling(fc.robot_jacobian(robot, "cok", weights))
    home = fx.kinematics.home_pose(robot)
    away = home.rotation[0].T @ fc.centre_of_stiffness(fc.robot_jacobian(robot), weights)
    around = [coupling(fc.robot_jacobian(robot, robot.com + away + 0.01 * step)) for step in (*np.eye(3), *-np.eye(3))]
    assert least < min(around)


def test_a_delayed_loop_passes_noise_on_to_what_is_asked_for():
    tau, K = 3e-3, 300.0 + 25.0 * S / (1 + S / (2 * np.pi * 80))
    law = fc.PID(300.0, 0.0, 25.0, low_pass=80.0)
    loop = motion().close(law, delay=tau)
    H = loop.frequency_response(HZ).frequency_response.sel(input="noise:stroke:1")
    H = H.sel(part="real") + 1j * H.sel(part="imaginary")
    plant = 1 / (2 * S**2 + 6 * S + 800)
    around = K * plant * np.exp(-S * tau)
    np.testing.assert_allclose(H.sel(output="control:drive:1"), -K / (1 + around), rtol=1e-9)
    np.testing.assert_allclose(H.sel(output="stroke:1"), -around / (1 + around), rtol=1e-9)


def test_delay_margin_of_a_loop_that_leads_half_a_turn():
    """Place fed back to add: the loop -g / (m s^2 + c s + k) has size 1 on both sides of the resonance.

    A delay t brings it to -1 where its angle less w t is -pi, half a turn and more away: t = (pi + e) / w above.
    """
    g, m, c, k = 60.0, 2.0, 1.0, 800.0
    data = fc.margins(motion_with(c), fc.Decentralised(fc.gain(-g), sensor="stroke"))
    # |m s^2 + c s + k| = g: m^2 w^4 + (c^2 - 2 m k) w^2 + k^2 - g^2 = 0
    w = np.sqrt(np.roots([m**2, c**2 - 2 * m * k, k**2 - g**2]))
    lag = np.angle(-g / (m * (1j * w) ** 2 + c * 1j * w + k)) + np.pi
    assert data.delay_margin.item() == pytest.approx(((lag % (2 * np.pi)) / w).min(), rel=1e-6)
    assert data.delay_margin.item() > np.pi / w.max()


def motion_with(c):
    """The same mass with another damper."""
    one = motion()
    return fc.StateSpace(A=[[0, 1], [-400.0, -c / 2]], B=one.B, C=one.C, D=one.D, inputs=one.inputs,
                         outputs=one.outputs, states=one.states, units={})  # fmt: skip


def test_norms_and_impulses_between_samples():
    """A resonance between samples and one that alternates from sample to sample, by scipy.signal on a fine grid."""
    T = 2e-3
    for A in ([[0.9, 0.3], [-0.4, 0.7]], [[-0.8, 0.1], [0.0, 0.3]]):
        one = fc.StateSpace(A=A, B=[[1.0], [0.5]], C=[[1.0, -0.2]], D=[[0.3]], inputs=("u",), outputs=("y",),
                            states=("a", "b"), units={}, sample=T)  # fmt: skip
        w, H = signal.dfreqresp((one.A, one.B, one.C, one.D, T), np.linspace(0.0, np.pi, 20_001))
        found = one.hinf()
        # flat at the peak: a grid of 1.6e-4 rad misses it by a part of 1e-7
        assert float(found.hinf_norm) == pytest.approx(np.abs(H).max(), rel=1e-6)
        assert float(found.frequency) == pytest.approx(w[np.abs(H).argmax()] / (2 * np.pi * T), rel=1e-3)
        _, y = signal.dimpulse((one.A, one.B, one.C, one.D, T), n=20)
        seen = one.impulse(duration=19 * T).impulse_response.values[0, 0]
        np.testing.assert_allclose(seen, y[0].ravel(), atol=1e-12)
