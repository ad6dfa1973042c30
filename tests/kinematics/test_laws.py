"""Laws of motion: derivatives, ends, continuity, limits."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import central_difference

from flexapod.common.errors import InputError
from flexapod.kinematics import laws

pytestmark = pytest.mark.unit

KNOTS = {"s-curve": np.cumsum((0, *laws.S_CURVE_FRACTIONS)), "trapezoid": np.cumsum((0, *laws.TRAPEZOID_FRACTIONS))}
RNG = np.random.default_rng(7)


def smooth_instants(profile):
    """Instants at least 0.01 away from the ends and from the breaks of piecewise profiles."""
    tau = RNG.uniform(0.01, 0.99, 400)
    knots = KNOTS.get(profile, np.array([0.0, 1.0]))
    return tau[np.min(np.abs(tau[:, None] - knots), axis=1) > 0.01]


@pytest.mark.parametrize("profile", laws.PROFILES)
def test_rate_and_acceleration_are_the_derivatives(profile):
    """Step 1e-3: truncation below 1e-10 for all profiles, round-off below 1e-11 of accelerations of order ten."""
    tau = smooth_instants(profile)
    s = laws.step(profile, tau)
    np.testing.assert_allclose(s.rate, central_difference(lambda x: laws.step(profile, x).position, tau), atol=1e-9)
    np.testing.assert_allclose(s.acceleration, central_difference(lambda x: laws.step(profile, x).rate, tau), atol=1e-9)


@pytest.mark.parametrize("profile", laws.PROFILES)
def test_step_rests_before_and_after(profile):
    s = laws.step(profile, [-0.5, -1e-9, 1.0, 1.5])
    np.testing.assert_array_equal(s.position, [0, 0, 1, 1])
    np.testing.assert_array_equal(s.rate, 0)
    np.testing.assert_array_equal(s.acceleration, 0)


@pytest.mark.parametrize("profile", laws.PROFILES)
def test_step_is_symmetric_and_monotonic(profile):
    tau = np.linspace(0, 1, 1001)
    s = laws.step(profile, tau)
    np.testing.assert_allclose(s.position + s.position[::-1], 1, atol=1e-15)
    assert np.all(np.diff(s.position) >= 0)


@pytest.mark.parametrize(
    ("profile", "rate", "acceleration"),
    [
        ("quintic", 15 / 8, 10 / np.sqrt(3)),
        ("cycloidal", 2.0, 2 * np.pi),
        ("s-curve", 1.6, 6.4),  # jerk 51.2 for an eighth: 6.4; area of the trapezoid of acceleration: 1.6
        ("trapezoid", 4 / 3, 16 / 3),
        ("linear", 1.0, 0.0),
    ],
)
def test_peak_values(profile, rate, acceleration):
    s = laws.step(profile, np.linspace(0, 1, 100001))  # a grid this fine misses a smooth peak by less than 1e-8
    assert np.max(s.rate) == pytest.approx(rate, abs=1e-8)
    assert np.max(np.abs(s.acceleration)) == pytest.approx(acceleration, abs=1e-7)


@pytest.mark.parametrize("profile", ["quintic", "cycloidal", "s-curve", "smooth"])
def test_acceleration_is_continuous(profile):
    """Jerk is bounded (60, 4 pi^2, 51.2, about 190), so steps of 1e-6 change the acceleration by less than 1e-3."""
    tau = np.concatenate([k + np.linspace(-5e-6, 5e-6, 11) for k in (0, 1 / 8, 1 / 4, 3 / 8, 5 / 8, 3 / 4, 7 / 8, 1)])
    a = laws.step(profile, tau).acceleration.reshape(-1, 11)
    assert np.max(np.abs(np.diff(a, axis=1))) < 1e-3


def test_smooth_step_is_flat_to_all_orders_at_its_ends():
    """exp(-1/tau) falls below any power of tau."""
    tau = np.array([1e-3, 5e-3, 0.01])
    assert np.all(laws.step("smooth", tau).position < tau**20)
    assert laws.step("smooth", 0.5).position == 0.5


def test_rest_to_rest_scales():
    law = laws.rest_to_rest([1.0, 2.0, 3.0, 9.0], profile="quintic", amplitude=-2.0, duration=4.0, start=1.0)
    np.testing.assert_allclose(law.position, [0, -2 * 0.103515625, -1, -2])
    np.testing.assert_allclose(law.rate[2], -2 / 4 * 15 / 8)


def test_spin_up_formula_and_derivatives():
    t = np.array([0.5, 3.0, 7.5, 14.0, 17.0])
    law = laws.spin_up(t, rate=6.0, duration=15.0)
    inside = t[:4]
    psi = 6 / 15 * (inside**2 / 2 + (15 / (2 * np.pi)) ** 2 * (np.cos(2 * np.pi * inside / 15) - 1))
    np.testing.assert_allclose(law.position[:4], psi, rtol=1e-13)
    assert law.position[4] == pytest.approx(6 * 15 / 2 + 6 * 2)
    for k, name in enumerate(("position", "rate")):
        slope = central_difference(lambda x, name=name: getattr(laws.spin_up(x, rate=6.0, duration=15.0), name), t)
        np.testing.assert_allclose(law[k + 1], slope, atol=1e-9)


def test_constant_rate():
    law = laws.constant_rate([0.0, 2.0], rate=0.1)
    np.testing.assert_allclose(law, [[0.0, 0.2], [0.1, 0.1], [0, 0]])


def test_spline_interpolates_and_rests_at_its_ends():
    times = np.array([0.2, 0.5, 0.6, 1.1, 1.3])
    values = RNG.normal(size=(5, 6))
    curve = laws.spline(times, values)
    law = laws.spline_law(times, curve, first=0.2, last=1.3)
    np.testing.assert_allclose(law.position, values, atol=1e-12)
    np.testing.assert_allclose(law.rate[[0, -1]], 0, atol=1e-9)
    np.testing.assert_allclose(law.acceleration[[0, -1]], 0, atol=1e-8)
    outside = laws.spline_law([0.0, 2.0], curve, first=0.2, last=1.3)
    np.testing.assert_allclose(outside.position, values[[0, -1]], atol=1e-12)
    assert np.all(outside.rate == 0) and np.all(outside.acceleration == 0)


def test_spline_of_two_rows_is_the_quintic_profile():
    t = np.linspace(0, 2, 21)
    law = laws.spline_law(t, laws.spline([0, 2], [1.0, 4.0]), first=0, last=2)
    quintic = laws.rest_to_rest(t, profile="quintic", amplitude=3.0, duration=2.0)
    np.testing.assert_allclose(law.position, 1 + quintic.position, atol=1e-13)
    np.testing.assert_allclose(law.acceleration, quintic.acceleration, atol=1e-12)


def test_unknown_profile_is_refused_with_the_nearest_name():
    with pytest.raises(InputError, match=r"quintics.*cycloidal.*Did you mean 'quintic'"):
        laws.step("quintics", 0.5)
