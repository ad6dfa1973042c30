"""Impedances, gains over the pose, adaptive damping, and struts that all have one gain: closed forms."""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod.common.errors import InputError

pytestmark = pytest.mark.analytic


def mass(m=2.0, k=5e3, c=4.0):
    return fc.StateSpace(
        A=[[0, 1], [-k / m, -c / m]], B=[[0], [1 / m]], C=[[1, 0]], D=[[0]], inputs=("drive:1",), outputs=("stroke:1",),
        states=("z", "v"), units={"drive:1": "N", "stroke:1": "m"},
    )  # fmt: skip


def test_the_impedance_of_a_spring_beside_a_damper_and_a_mass():
    m, k, c = 2.0, 5e3, 4.0
    hz = np.array([0.5, 3.0, 40.0])
    w = 2 * np.pi * hz
    data = fc.impedance(mass(m, k, c), hz, force="drive", place="stroke")
    np.testing.assert_allclose(data.parallel_damping, c, rtol=1e-9)
    np.testing.assert_allclose(data.parallel_stiffness, k - m * w**2, rtol=1e-9)
    Z = c + 1j * (m * w - k / w)
    found = data.impedance.sel(part="real") + 1j * data.impedance.sel(part="imaginary")
    np.testing.assert_allclose(found, Z, rtol=1e-9)


def test_the_impedance_of_a_spring_behind_a_damper():
    """A spring, then a damper to earth: x = f (1/k + 1/(c s)); the damper's travel is a state."""
    k, c = 3e4, 70.0
    row = fc.StateSpace(
        A=[[0.0]], B=[[1 / c]], C=[[1.0]], D=[[1 / k]], inputs=("f",), outputs=("x",), states=("travel",), units={}
    )
    data = fc.impedance(row, [1.0, 30.0], force="f", place="x")
    np.testing.assert_allclose(data.series_damping, c, rtol=1e-9)
    np.testing.assert_allclose(data.series_stiffness, k, rtol=1e-9)
    with pytest.raises(InputError, match="above 0"):
        fc.impedance(row, [0.0], force="f", place="x")


def test_gains_between_poses_are_between_those_at_the_poses():
    grid = fc.Scheduled(
        axes={"heave": [-0.1, 0.1], "roll": [0.0, 0.2]},
        controllers=[fc.IFF(g, high_pass=h) for g, h in ((10.0, 1.0), (20.0, 2.0), (30.0, 3.0), (40.0, 4.0))],
    )
    names = (["force-sensor:drive:1"], ["drive:1"])
    law = grid.at({"heave": 0.05, "roll": 0.05}, *names)
    # 1/4 and 3/4 along heave, 3/4 and 1/4 along roll: 10 + 20 * 3/4 + 10 / 4
    assert law.C[0, 0] * law.B[0, 0] == pytest.approx(-27.5) and law.A[0, 0] == pytest.approx(-2 * np.pi * 2.75)
    at = grid.at({"heave": -0.1, "roll": 0.2}, *names)
    np.testing.assert_allclose(at.A, fc.IFF(20.0, high_pass=2.0).on(*names).A)
    with pytest.raises(InputError, match=r"outside of the grid. Allowed: -0.1 to 0.1"):
        grid.at({"heave": 0.2}, *names)
    with pytest.raises(InputError, match="4, one for each point"):
        fc.Scheduled(axes={"heave": [0, 1], "roll": [0, 1]}, controllers=[fc.IFF(1.0)])


def test_a_scheduled_controller_along_a_path_is_its_own_law_where_the_path_stands_still():
    names = (["stroke:1"], ["drive:1"])
    T = 1e-3
    grid = fc.Scheduled(
        axes={"heave": [0.0, 1.0]}, controllers=[fc.PID(k, 50.0, 2.0, low_pass=40.0) for k in (10.0, 30.0)]
    )
    found = grid.following(lambda t: {"heave": 0.25}, T, *names)
    law = grid.at({"heave": 0.25}, *names, period=T)
    y = np.random.default_rng(1).standard_normal(50)
    x, exact = np.zeros(len(law.A)), []
    for value in y:
        exact.append((law.C @ x + law.D @ [value]).item())
        x = law.A @ x + law.B @ [value]
    seen = [found.function(k * T, y[k : k + 1])[0] for k in range(50)]
    np.testing.assert_allclose(seen, exact, rtol=1e-12)
    assert found.function(20 * T, y[20:21])[0] == seen[20]  # a sample that comes again


@pytest.mark.parametrize("hertz", [7.0, 13.0])
def test_a_tracker_finds_a_frequency(hertz):
    tracker, T = fc.Tracker(frequency="10 Hz", speed=10.0), 1e-3
    state = tracker.start()
    for k in range(6000):
        state = tracker.step(np.sin(2 * np.pi * hertz * k * T), state, T)
    # The midpoint rule bends frequencies by (w T)^2 / 12, 6e-4 at 13 Hz; the loop ripples at twice the frequency.
    assert state[2] / (2 * np.pi) == pytest.approx(hertz, rel=2e-3)


@pytest.mark.parametrize("width", [0.2, 0.7, 1.5])
def test_an_oscillator_follows_as_fast_as_its_width_says(width):
    """At a frequency that is held, a' = w (k (y - a) - b), b' = w a: from rest under a cosine at w, by its closed form.

    a = cos wt - e^(-dt) (cos vt - d / v sin vt), b = sin wt - w / v e^(-dt) sin vt; d = k w / 2, v^2 = w^2 - d^2.
    """
    w, T = 2 * np.pi * 10.0, 1e-4
    tracker = fc.Tracker(frequency="10 Hz", width=width, speed=0.0)
    d, v, state = width * w / 2, w * np.sqrt(1 - width**2 / 4), tracker.start()
    for k in range(3000):
        state = tracker.step(np.cos(w * (k + 0.5) * T), state, T)
        if k % 100 == 99:
            t = (k + 1) * T
            fades = np.exp(-d * t)
            a = np.cos(w * t) - fades * (np.cos(v * t) - d / v * np.sin(v * t))
            b = np.sin(w * t) - fades * w / v * np.sin(v * t)
            # frequencies are bent by (w T)^2 / 12 = 3e-6, over 19 rad; readings hold for a step: (w T)^2 / 24
            np.testing.assert_allclose(state[:2], [a, b], atol=2e-4)
    assert state[2] == pytest.approx(w, rel=1e-12)


@pytest.mark.parametrize("width", [0.3, 1.0, 2.0])
def test_a_tracker_finds_a_frequency_with_its_time_constant_whatever_its_width(width):
    """In the oscillator's steady state the mean of its law is w' = -speed (w - w_y); it lags by 2 / (width w).

    Both together: error exp(s t) with 2 / (width w) s^2 + s + speed = 0.
    """
    w, speed, T = 2 * np.pi * 20.0, 1.0, 5e-4
    tracker = fc.Tracker(frequency="20.4 Hz", width=width, speed=speed)
    state, off = tracker.start(), []
    for k in range(int(1.5 / T)):
        state = tracker.step(np.sin(w * k * T), state, T)
        off.append(state[2] - 2 / T * np.tan(w * T / 2))  # the midpoint rule swings slower than its own frequency
    period = round(2 * np.pi / w / T)
    early, late = (np.mean(off[at : at + period]) for at in (round(0.4 / T), round(1.4 / T)))
    lag = 2 / (width * w)
    slow = (1 - np.sqrt(1 - 4 * speed * lag)) / (2 * lag)
    # terms of second order of the detuning, half of the 2 % that there are at first
    assert np.log(early / late) == pytest.approx(slow, rel=0.01)


@pytest.mark.parametrize("k", [2e3, 2e4])
def test_adaptive_damping_damps_a_mode_whose_frequency_it_does_not_know(k):
    m, c, g, T = 2.0, 0.2, 6.0, 5e-4
    plant = mass(m, k, c).sampled(T)
    w = np.sqrt(k / m)
    law = fc.AdaptiveDamping(gain=g, tracker=fc.Tracker(frequency="8 Hz", speed=40.0)).sampled(
        T, ["stroke:1"], ["drive:1"]
    )
    x, seen = np.array([1e-3, 0.0]), []
    n = int(8.0 / T)
    for i in range(n):
        y = plant.C @ x
        x = plant.A @ x + plant.B @ np.atleast_1d(law.function(i * T, y))
        seen.append(y.item())
    peaks = np.abs(np.array(seen))
    first, last = int(2.0 / T), int(5.0 / T)
    cycles = round(2 * np.pi / w / T)
    rate = np.log(peaks[first : first + cycles].max() / peaks[last : last + cycles].max()) / 3.0
    # With the frequency found mode and oscillator are linear: m z'' + c z' + k z = g w b, a' = w (z - a - b), b' = w a,
    # the slowest pair of these, near (c + g) / 2m. Half a sample of lag turns the force by w T / 2, 2.5 % at most.
    both = [[0, 1, 0, 0], [-k / m, -c / m, 0, g * w / m], [w, 0, -w, -w], [0, 0, w, 0]]
    slowest = -np.linalg.eigvals(np.array(both)).real.max()
    assert rate == pytest.approx(slowest, rel=0.03)
    assert slowest == pytest.approx((c + g) / (2 * m), rel=0.15)


def hexapod():
    """A payload on six struts: J of arbitrary places, masses with inertia."""
    rng = np.random.default_rng(4)
    base, top = rng.standard_normal((6, 3)), 0.5 * rng.standard_normal((6, 3)) + [0, 0, 2.0]
    legs = (top - base) / np.linalg.norm(top - base, axis=1)[:, None]
    J = np.hstack([legs, np.cross(top - [0, 0, 2.1], legs)])
    M = np.diag([30.0, 30.0, 30.0, 2.0, 3.0, 4.0])
    return J, M


@pytest.mark.parametrize("which", ["iff", "dvf"])
def test_struts_with_one_gain_damp_all_modes_by_the_closed_form(which):
    """Force sensors on struts with ideal joints: zeta_i = g/(2 w_i) + c w_i/(2 k); velocities: (c + g) w_i/(2 k)."""
    J, M = hexapod()
    k, c, g = 4e4, 5.0, {"iff": 3.0, "dvf": 40.0}[which]
    inv = np.linalg.inv(M)
    stroke = np.hstack([J, np.zeros((6, 6))])
    names = [str(i) for i in range(1, 7)]
    plant = fc.StateSpace(
        A=np.block([[np.zeros((6, 6)), np.eye(6)], [-inv @ J.T @ J * k, -inv @ J.T @ J * c]]),
        B=np.vstack([np.zeros((6, 6)), inv @ J.T]),
        C=np.vstack([stroke, np.hstack([-k * J, -c * J])]),
        D=np.vstack([np.zeros((6, 6)), np.eye(6)]),
        inputs=tuple(f"drive:{i}" for i in names),
        outputs=(*(f"stroke:{i}" for i in names), *(f"force-sensor:drive:{i}" for i in names)),
        states=tuple(f"x{i}" for i in range(12)),
        units={},
    )
    w = np.sqrt(np.sort(np.linalg.eigvals(inv @ J.T @ J * k).real))
    loop = plant.close(fc.IFF(g) if which == "iff" else fc.DVF(g))
    data = loop.damp()
    swings = data.pole.sel(part="imaginary").values > 1e-6
    exact = g / (2 * w) + c * w / (2 * k) if which == "iff" else (c + g) * w / (2 * k)
    np.testing.assert_allclose(data.frequency.values[swings], w / (2 * np.pi), rtol=1e-6)
    np.testing.assert_allclose(data.damping_ratio.values[swings], exact, rtol=1e-6)
