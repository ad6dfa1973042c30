"""Sampled controllers in the march against a payload on six springs by hand, exact from sample to sample."""

import numpy as np
import pytest
from scipy.linalg import expm
from tests.helpers.sampled_springs import (
    DRIVES,
    FORCES,
    LAWS,
    PID,
    STROKES,
    STUDY,
    C,
    F,
    Heave,
    K,
    Law,
    M,
    T,
    heave,
    height,
    integral,
    summed_with_today,
)

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.control import FunctionController, StateSpace
from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]


@pytest.fixture(scope="module")
def study():
    return fx.loads(STUDY)


@pytest.mark.parametrize("name", LAWS)
def test_the_payload_moves_as_the_exact_recursion_says(study, name):
    """Fixed steps of h are late by (w h)^2 / 12 of the phase: w = 1080 rad/s and 12.5 us make 1.5e-5 of 108 rad, 1.6e-3
    of an oscillation that is half of the largest displacement and damped; a leg's 0.5 um adds geometry of 1e-6. A
    reading next to the middle of two steps is rounded to either."""
    law, given, own = LAWS[name]
    data = fx.simulate(study, controller=law.system(), step=T / 40, **given)
    z, _, _ = Heave().run(law, len(data.time), **own)
    assert np.abs(heave(data) - z).max() < (4e-3 if name == "in steps" else 8e-4) * np.abs(z).max()


def test_order_two(study):
    """Errors against the exact recursion fall as the square of the step: jumps at samples cost no order."""
    law = LAWS["force, its sum"][0]
    errors = []
    for parts in (10, 20, 40):
        data = fx.simulate(study, controller=law.system(), step=T / parts)
        z, _, _ = Heave().run(law, len(data.time))
        errors.append(np.abs(heave(data) - z).max())
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.1)


def test_within_a_tolerance(study):
    law = LAWS["one sample late"][0]
    data = fx.simulate(study, controller=law.system(), tolerance=1e-6, delay_samples=1)
    z, _, _ = Heave().run(law, len(data.time), delay=1)
    assert np.abs(heave(data) - z).max() < 2e-5 * np.abs(z).max()


def test_readings_and_outputs_are_those_of_the_recursion(study):
    """What stands beside an instant was read and held before it: the reading of a leg's force, of which F is a part."""
    law = LAWS["force, its sum"][0]
    data = fx.simulate(study, controller=law.system(), step=T / 40)
    _, read, held = Heave().run(law, len(data.time) - 1)
    assert list(data.sensor.values) == list(FORCES)
    for leg in (0, 3):
        np.testing.assert_allclose(data.sensor_reading.values[1:, leg], read, atol=8e-4 * np.abs(read).max())
        np.testing.assert_allclose(data.control_input.values[1:, leg], held, atol=8e-4 * np.abs(held).max())


@pytest.mark.parametrize("law", [integral(120.0, leak=40.0), summed_with_today(120.0, leak=40.0)])
def test_ring_down_has_the_poles_of_the_closed_loop(study, law):
    """Poles of a recurrence through samples of the ring-down after the step: 1e-3 of the pole."""
    data = fx.simulate(study, controller=law.system(), step=T / 40, duration=0.25)
    z = np.diff(heave(data)[3:])  # a constant drops out
    order = 4
    rows = np.stack([z[k : len(z) - order + k] for k in range(order)], axis=1)
    found = np.roots([1.0, *-np.linalg.lstsq(rows, z[order:], rcond=None)[0][::-1]])
    wanted = Heave().poles(law)
    wanted = np.log(wanted[wanted.imag > 1e-3]) / T
    found = np.log(found[found.imag > 1e-3]) / T
    assert abs(found[np.abs(found - wanted).argmin()] - wanted[0]) < 1e-3 * abs(wanted[0])
    assert -wanted[0].real / abs(wanted[0]) > 0.05  # it is the controller that damps: 0.008 without


@pytest.mark.parametrize(("delay", "limit"), [(0, 2.0), (1, 1.0), (2, (np.sqrt(5) - 1) / 2)])
def test_limits_of_a_sampled_integrator(study, delay, limit):
    """u = - g T (sum of F before), F = u where nothing gives way: g T < 2, 1, 0.618 with 0, 1, 2 samples of delay.

    A payload of 1e9 kg moves with k / m: F is u but for (w T)^2 = 3e-9. The slowest of the three pairs of poles grows
    or falls by 0.0028 a sample at 1 % of gain from its limit: over 1000 samples 16 times.
    """
    heavy = study.replace(
        robot=study.robot.replace(payload=study.robot.payload.replace(mass=1e9, inertia=1e8 * np.eye(3)))
    )
    start = {"noise": 1e-3, "seed": 3}
    for gain, grows in ((0.99 * limit, False), (1.01 * limit, True)):
        law = integral(gain / T)
        data = fx.simulate(
            heavy, controller=law.system(), step=T, delay_samples=delay, duration=1.0, load=np.zeros(6), **start
        )
        u = np.abs(data.control_input.values).max(axis=1)
        assert (u[-200:].max() > 30 * u[200:400].max()) == grows


def test_energy_closes_with_the_work_of_control(study):
    """To 1e-6 of the most energy in it; the balance of a march is of order 2."""
    data = fx.simulate(study, controller=LAWS["force, its sum"][0].system(), step=T / 250)
    stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
    left = stored - data.work_drive - data.work_external - data.work_control
    assert float(np.abs(left - left[0]).max()) < 1e-6 * float(np.abs(data.work_external).max())
    assert float(np.abs(data.work_control).max()) > 0.1 * float(np.abs(data.work_external).max())


@pytest.mark.parametrize("steps", [{"step": T / 4}, {"tolerance": 1e-5}])
def test_a_function_gives_the_bits_of_the_law(study, steps):
    law = LAWS["force, its sum with today's"][0]
    state = np.zeros(6)

    def asked(t, y):
        nonlocal state
        u = law.c * state + law.d * y
        state = law.a * state + law.b * y
        return u

    called = fx.simulate(
        study, controller=FunctionController(function=asked, inputs=FORCES, outputs=DRIVES), sample=T, **steps
    )
    compiled = fx.simulate(study, controller=law.system(), **steps)
    np.testing.assert_array_equal(called.tool_position.values, compiled.tool_position.values)
    np.testing.assert_array_equal(called.control_input.values, compiled.control_input.values)


def test_what_a_function_raises_is_raised(study):
    def fails(t, y):
        raise ZeroDivisionError("of the controller")

    with pytest.raises(ZeroDivisionError, match="of the controller"):
        fx.simulate(study, controller=FunctionController(function=fails, inputs=FORCES, outputs=DRIVES), sample=T)


def test_noise(study):
    """The same seed gives the same bits, whatever the pieces of a run; another seed others. A density S one-sided is
    S / (2 T) a sample: over 4800 readings the variance is right to five times sqrt(2 / 4800) = 10 %."""
    still, density = Law(a=0.0, b=0.0, c=0.0, d=0.0), 2e-9
    given = {"controller": still.system(), "noise": {"force-sensor:drive": {"psd": density}}, "load": np.zeros(6)}
    a, b = (fx.simulate(study, step=T, duration=d, seed=7, **given) for d in (0.4, 0.2))
    np.testing.assert_array_equal(a.sensor_reading.values[: len(b.time)], b.sensor_reading.values)
    other = fx.simulate(study, step=T, duration=0.2, seed=8, **given)
    assert (other.sensor_reading.values[1:] != b.sensor_reading.values[1:]).all()
    variance = np.var(a.sensor_reading.values[1:])
    assert variance == pytest.approx(density / (2 * T), rel=0.1)


def test_samples_off_the_outputs_and_beside_jumps(study):
    """Outputs at 0.3 ms between samples at 0.5 ms; the load jumps at 1 ms, within an output's interval."""
    law = LAWS["force, its sum"][0]
    fixed = fx.simulate(study, controller=law.system(), step=1e-5, output_step=3e-4)
    within = fx.simulate(study, controller=law.system(), tolerance=1e-6, output_step=3e-4)
    z, _, _ = Heave().run(law, 200)
    for data in (fixed, within):
        np.testing.assert_allclose(heave(data)[::5], z[::3][: len(data.time[::5])], atol=8e-4 * np.abs(z).max())


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"sample": T / 3}, "multiple of the fixed step"),
        ({"quantise": {"strike": 1.0}}, "no channel of this controller"),
        ({"delay_samples": -1}, "a whole number"),
        ({"controller": None, "step": None, "sample": T}, "there is none"),
        ({"controller": FunctionController(function=len, inputs=("strok:1",), outputs=("drive:1",))}, "'stroke'"),
        ({"controller": FunctionController(function=len, inputs=("stroke:1",), outputs=("motor:1",))}, "not a channel"),
        (
            {"controller": FunctionController(function=len, inputs=("force-sensor:base:1",), outputs=("drive:1",))},
            "not read in time",
        ),
        ({"controller": FunctionController(function=len, inputs=("stroke",), outputs=("drive:1",))}, "not one channel"),
        ({"saturate": -1.0}, "below 0"),
    ],
)
def test_refusals(study, given, words):
    settings = {
        "controller": FunctionController(function=len, inputs=FORCES, outputs=DRIVES),
        "sample": T,
        "step": T / 10,
    } | given
    with pytest.raises(InputError, match=words):
        fx.simulate(study, **settings)


def test_what_is_held_is_not_moved():
    law = FunctionController(function=len, inputs=STROKES, outputs=DRIVES)
    with pytest.raises(InputError, match="keeps its command whatever the force"):
        fx.simulate(fx.preset("paper-robot"), controller=law, sample=1e-3)


@pytest.mark.parametrize(
    ("law", "sensors", "share"),
    [
        (fx.control.IFF(150.0, high_pass=5.0), ["force-sensor:drive"], 1e-4),
        # velocity in space by a geophone, by an accelerometer that is summed: (w T)^2 / 12 between samples
        (fx.control.Decoupled(fx.control.gain(80.0), into=[[1.0]], out=np.ones((6, 1)), sensor="geophone:tool:z"),
         ["geophone:tool:z"], 1e-3),
        (fx.control.Decoupled(fx.control.integrator(80.0, 5.0), into=[[1.0]], out=np.ones((6, 1)),
                              sensor="accelerometer:com:z"), ["accelerometer:com:z"], 1e-3),
    ],
    ids=["forces", "geophone", "accelerometer"],
)  # fmt: skip
def test_ring_down_of_a_nano_hexapod_is_what_the_linear_model_predicts(law, sensors, share):
    """Feedback between samples, closed about the linear model: the pole of heave, by a recurrence through samples of
    the ring-down after 0.1 N. Five pairs show in heave; steps of 6 us shift a pole of 1700 rad/s by 1e-5."""
    period = 1e-4
    text = fx.model.preset_text("nano-hexapod")
    start = text.index("amplitudes =")
    still = fx.loads(text[:start] + "amplitudes = { heave = 0 }" + text[text.index("\n", start) :])
    still = fx.model.override(still, fidelity="rigid")
    closed = fx.linearize(still, inputs=["drive"], outputs=sensors).close(law, sample=period)
    predicted = np.log(closed.poles().astype(complex)) / period
    load = fx.model.Load(wrench=fx.model.StepWrench(amplitude=np.array([0, 0, 0.1, 0, 0, 0]), time=2 * period))
    data = fx.simulate(
        still, controller=law, sample=period, step=period / 16, output_step=period, duration=0.1, load=load
    )
    slowest = next(x for x in fx.control.ring_down(heave(data)[10:], period) if x.imag > 100)
    nearest = predicted[np.abs(predicted - slowest).argmin()]
    assert abs(slowest - nearest) < share * abs(nearest)
    assert -nearest.real / abs(nearest) > 5 * 0.0088  # it is the controller that damps


def test_adaptive_damping_in_the_march(study):
    """Damping that finds its frequency, heave at 171 Hz tracked from 120 Hz after a push of half a period: what the
    same gain on the rate itself makes, (g + c) w / (2 k), within a tenth (the oscillator follows late)."""
    times, zero = np.array([0, 1e-3, 1e-3, 4e-3, 4e-3, 1.0]), np.zeros((6, 6))
    push = zero + np.outer([0, 0, 1, 1, 0, 0], [0, 0, F, 0, 0, 0])
    load = fx.model.Load(wrench=fx.model.CsvWrench(time=times, wrench=push))
    law = fx.control.AdaptiveDamping(gain=90.0, tracker=fx.control.Tracker(frequency=120.0, speed=200.0))
    data = fx.simulate(study, controller=law, sample=T / 2, step=T / 20, duration=0.12, load=load)
    pole = next(x for x in fx.control.ring_down(heave(data)[60:], T, order=4) if x.imag > 1)
    w = np.sqrt(6 * height() ** 2 * K / M)
    assert -pole.real / abs(pole) == pytest.approx((90.0 + C) * w / (2 * K), rel=0.1)


@pytest.mark.parametrize("steps", [{"step": T / 40}, {"tolerance": 1e-6}])
def test_a_geophone_at_the_tool(steps):
    """The payload with a proof mass, its corner of 60 Hz not far below heave, exact from sample to sample: forces
    against the voltage damp heave by a third of critical. Between samples the march takes velocities as straight: of a
    sine (w T)^2 / 12 = 1.5e-3 of what the proof mass adds to them, which is 2 zeta w0 / w = 0.4 of the reading."""
    corner, damping, volts, gain, period = 2 * np.pi * 60.0, 0.6, 28.8, 20.0, T / 4
    law = StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 1)), C=np.zeros((6, 0)), D=-gain * np.ones((6, 1)), states=(), units={},
        inputs=("geophone:tool[60 Hz, 0.6, 28.8]:z",), outputs=DRIVES, sample=period,
    )  # fmt: skip
    s = height()
    rows = np.zeros((4, 6))  # z, z', proof mass and its rate, by the same and by the force of a leg and the load
    rows[0, 1], rows[2, 3] = 1.0, 1.0
    rows[1] = [-6 * s**2 * K / M, -6 * s**2 * C / M, 0, 0, 6 * s / M, 1 / M]
    rows[3] = rows[1] + [0, 0, -(corner**2), -2 * damping * corner, 0, 0]
    whole = expm(period * np.vstack([rows, np.zeros((2, 6))]))[:4]
    x, z, read = np.zeros(4), [], []
    data = fx.simulate(fx.loads(STUDY), controller=law, output_step=period, **steps)
    for k in range(len(data.time)):
        z.append(x[0])
        read.append(volts * x[3])
        x = whole[:, :4] @ x + whole[:, 4:] @ np.array([-gain * read[-1], F * (k >= 8)])
    assert np.abs(heave(data) - z).max() < 8e-4 * np.abs(z).max()
    np.testing.assert_allclose(data.sensor_reading.values[1:, 0], read[:-1], atol=2e-3 * np.abs(read).max())


GAINS, W = (8e4, 4e6, 60.0), 2 * np.pi * 500.0  # N/m, N/(m s), N s/m of a leg, 1/s


@pytest.mark.parametrize("of", ["stroke", "tool"])
def test_tables_of_proportional_integral_and_rate_feedback(of):
    """The exact recursion of the payload with u = -(P y + I sum + D w (y - what follows y)) of a leg, or of the tool's
    height the same shared out over six legs that are inclined alike. Tolerance as above."""
    s, (P, summed, D) = height(), GAINS
    gains = {"proportional": P, "integral": summed, "derivative": D}
    if of == "tool":  # the force along z that six legs with these gains make
        gains = {name: [0, 0, float(6 * s**2 * value), 0, 0, 0] for name, value in gains.items()}
    table = PID.format(law="pid" if of == "stroke" else "tool-pid", T=T, **gains)
    data = fx.simulate(fx.loads(STUDY + table), step=T / 40)
    payload, x, total, follows, z = Heave(), np.zeros(2), 0.0, 0.0, []
    keep = np.exp(-W * T)
    for k in range(len(data.time)):
        z.append(x[0])
        y = s * x[0]
        u = -(P * y + summed * total + D * W * (y - follows))
        total, follows = total + T * y, keep * follows + (1 - keep) * y
        x = payload.A @ x + payload.B @ np.array([u, F * (k >= 2)])
    assert np.abs(heave(data) - z).max() < 8e-4 * np.abs(z).max()
    without = fx.simulate(fx.loads(STUDY), step=T / 40)
    assert np.abs(heave(without) - z).max() > 0.1 * np.abs(z).max()  # the loop matters


def test_poles_of_a_ring_down():
    """Two vibrations and an offset, known poles, to rounding; too few samples are refused."""
    t, poles = 1e-3 * np.arange(400), np.array([-5 + 200j, -30 + 900j])
    x = 0.7 + np.real(np.exp(poles[:, None] * t) * np.array([[1.0], [0.3j]])).T @ np.ones((2, 1))
    found = fx.control.ring_down(x, "1 kHz", order=4)
    np.testing.assert_allclose(found, poles, rtol=1e-8)
    with pytest.raises(InputError, match="are too few"):
        fx.control.ring_down(x[:8], 1e-3, order=10)
