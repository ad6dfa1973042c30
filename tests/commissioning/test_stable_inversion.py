"""Stable inversion against closed forms: a flat pair of masses, a path through a zero to the right."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.commissioning.feedforward.actuator_inversion import inverse, linear_response, tip_inversion
from flexapod.control import StateSpace
from flexapod.kinematics import motion_law

pytestmark = pytest.mark.analytic


def space(A, B, C) -> StateSpace:
    n = len(A)
    states = tuple(f"x{k}" for k in range(n))
    return StateSpace(
        A=A, B=B, C=C, D=np.zeros((1, 1)), inputs=("u",), outputs=("y",), states=states, units={"u": "N", "y": "m"}
    )


def bump(t: np.ndarray, order: int) -> np.ndarray:
    """Derivatives 2, 4 of a way of degree 11 from 0 to 1 in a second, at rest to the fifth derivative."""
    way = np.polynomial.Polynomial([0, 0, 0, 0, 0, 0, 462, -1980, 3465, -3080, 1386, -252])
    return np.where((t >= 0) & (t <= 1), way.deriv(order)(t), 0.0)


def test_two_masses_and_a_spring_are_flat() -> None:
    """Without zeros the force is that of both masses and of the spring's stretch: (m1 + m2) y'' + m1 m2 / k y''''."""
    m1, m2, k = 2.0, 0.7, 350.0
    A = [[0, 0, 1, 0], [0, 0, 0, 1], [-k / m1, k / m1, 0, 0], [k / m2, -k / m2, 0, 0]]
    found = inverse(space(A, [[0], [0], [1 / m1], [0]], [[0, 1, 0, 0]]), 1.0, lambda t: bump(t, 2))
    exact = (m1 + m2) * bump(found.time, 2) + m1 * m2 / k * bump(found.time, 4)
    # the transform of y'' falls as w^-4 beyond the last of 1024 harmonics, times w^2 of the inverse: 1e-6
    np.testing.assert_allclose(found.value, exact, rtol=0, atol=1e-5 * np.abs(exact).max())
    assert found.before < 2e-3
    assert found.after < 2e-3


def test_the_place_to_command_of_a_mass_on_a_spring() -> None:
    """A mass on a spring that is led: its foot goes y + m/k y'', so its acceleration is y'' + m/k y''''."""
    k_over_m = 900.0
    A = [[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [k_over_m, 0, -k_over_m, 0]]
    found = inverse(space(A, [[0], [1], [0], [0]], [[0, 0, 1, 0]]), 1.0, lambda t: bump(t, 2))
    exact = bump(found.time, 2) + bump(found.time, 4) / k_over_m
    np.testing.assert_allclose(found.value, exact, rtol=0, atol=1e-5 * np.abs(exact).max())


def test_a_zero_to_the_right_is_answered_before() -> None:
    """y'' = u - u'/z : u before the path is a multiple of e^(z t), by hand u(0-) = z int y'' e^(-z t) dt."""
    z = 12.0  # output x1 - x2/z of a double integrator x1' = x2, x2' = u
    found = inverse(space([[0, 1], [0, 0]], [[0], [1]], [[1.0, -1 / z]]), 1.0, lambda t: bump(t, 2))
    early = (found.time < 0) & (found.time > -0.5)
    fine = np.linspace(0.0, 1.0, 200_001)
    start = z * np.trapezoid(bump(fine, 2) * np.exp(-z * fine), fine)
    exact = start * np.exp(z * found.time[early])
    np.testing.assert_allclose(found.value[early], exact, rtol=0, atol=1e-5 * np.abs(found.value).max())
    assert found.before > 5 / z
    assert found.after < 2e-3


def test_zeros_on_the_axis_are_refused() -> None:
    A = [[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, -9.0, 0]]  # both beside each other
    with pytest.raises(fx.InputError, match="imaginary axis"):
        inverse(space(A, [[0], [1], [0], [1]], [[1.0, 0, 1, 0]]), 1.0, lambda t: bump(t, 2))


def beam(**more) -> fx.ActuatorStudy:
    study = fx.preset("paper-actuator")
    turn = fx.model.ProfileLaw(law="smooth", amplitude=np.deg2rad(2.0), duration=0.5)
    motion = fx.model.ActuatorMotion(rotation=turn, extension=fx.model.RateLaw(rate=0.0))
    still = study.initial.replace(tip_displacement=0.0)
    simulation = study.simulation.replace(duration=None, modes=5)
    return study.replace(motion=motion, initial=still, simulation=simulation).replace(**more)


@pytest.mark.parametrize("drives", ["given", "force"])
def test_the_tip_goes_where_that_of_a_rigid_beam_would(drives) -> None:
    study = beam()
    found = tip_inversion(study, drives)
    length, law = study.actuator.free_length, study.motion.rotation
    exact = found.study.simulation.replace(tolerance=1e-6)
    data = fx.simulate_actuator(found.study.replace(simulation=exact))
    t = data.time.values - found.inverse.before
    tip = length * data.angle.values + data.tip_deflection.values
    miss = np.abs(tip - length * motion_law(law, t).position).max()
    # squares of the rate, (0.13 rad/s)^2 against the first frequency squared: 1e-5; the march 1e-6
    assert miss < 3e-5 * found.miss[0]
    first = np.abs(found.inverse.zeros[found.inverse.zeros.real > 0]).min()
    early = found.inverse.value[found.inverse.time < 0]
    times = found.inverse.time[found.inverse.time < 0]
    k = [np.searchsorted(times, x / first) for x in (-6.0, -4.0)]
    assert early[k[1]] / early[k[0]] == pytest.approx(np.exp(first * (times[k[1]] - times[k[0]])), rel=1e-2)
    assert "more" in found.study.notes[-1]


def test_answers_are_exact_for_straight_inputs() -> None:
    double = space([[0, 1], [0, 0]], [[0], [1]], [[1.0, 0.0]])
    t = np.linspace(0.0, 2.0, 21)
    np.testing.assert_allclose(linear_response(double, t, 3 * t)[0], 0.5 * t**3, rtol=0, atol=1e-13)


def test_the_study_as_a_file(tmp_path) -> None:
    for drives in ("given", "force"):
        made = fx.compensate(beam(), "stable-inversion", drives=drives, out=tmp_path / f"{drives}.toml")
        again = fx.load(tmp_path / f"{drives}.toml")
        assert again.motion == made.motion
        assert again.load == made.load


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (
            {"motion": fx.preset("paper-actuator").motion, "simulation": fx.model.Simulation(duration=1.0)},
            "motion.rotation",
        ),
        ({"actuator": fx.preset("paper-actuator").actuator.replace(gravity=9.81)}, "gravity"),
    ],
)
def test_beams_without_a_model_that_stays_are_refused(change, key) -> None:
    with pytest.raises(fx.InputError, match=key):
        fx.compensate(beam(**change), "stable-inversion")
    with pytest.raises(fx.InputError, match="single actuator"):
        fx.compensate(beam(), 0)
