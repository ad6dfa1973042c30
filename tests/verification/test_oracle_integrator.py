"""Closed forms about generalized-alpha, input shaping and rest-to-rest motion reproduce their tables."""

import numpy as np
import pytest
from scipy.integrate import quad
from tests.oracles import integrator

pytestmark = pytest.mark.literature


def test_spectral_radius_at_unit_step():
    for rho_inf, radius in {0: 0.906563, 0.5: 0.989313, 0.8: 0.999475, 0.9: 0.999942}.items():
        assert integrator.spectral_radius(rho_inf, 1.0) == pytest.approx(radius, abs=6e-7)
        # a cluster of three equal eigenvalues at infinity: cube root of the distance, and 1e-4 at Om = 1e6
        assert integrator.spectral_radius(rho_inf, 1e6) == pytest.approx(rho_inf, abs=2e-4)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.8, 0.9])
def test_leading_errors(rho_inf):
    step = 0.02
    exact = np.array(integrator.numerical_damping(rho_inf, step))
    # next terms are Om^2 smaller; 1e-16 / Om^3 of rounding against chi^3
    np.testing.assert_allclose(integrator.leading_errors(rho_inf, step), exact, rtol=5 * step**2)


def test_energy_lost_in_a_period():
    rho_inf, step = 0.8, 0.05
    ratio, longer = integrator.numerical_damping(rho_inf, step)
    radius = integrator.spectral_radius(rho_inf, step)
    lost = 1 - radius ** (2 * 2 * np.pi / step * (1 + longer))
    assert integrator.energy_loss_per_period(rho_inf, step) == pytest.approx(lost, rel=0.01)
    assert ratio == pytest.approx(lost / (4 * np.pi), rel=0.01)


def test_shapers():
    expected = {
        "ZV": [0.539238, 0.460762],
        "ZVD": [0.290778, 0.496921, 0.212301],
        "ZVDD": [0.156799, 0.401938, 0.343443, 0.097820],
    }
    for name, impulses in expected.items():
        ours, times = integrator.shaper(name, 0.05)
        np.testing.assert_allclose(ours, impulses, atol=6e-7)
        period = 1 / np.sqrt(1 - 0.05**2)
        assert integrator.residual(ours, times * period, 2 * np.pi, 0.05) < 1e-14
        assert times[1] * period == pytest.approx(0.500626, abs=6e-7)


def test_undamped_shapers_leave_cosines():
    for ratio in (0.7, 0.9, 1.2):
        for name, power in {"ZV": 1, "ZVD": 2, "ZVDD": 3}.items():
            left = integrator.residual(*integrator.shaper(name), 2 * np.pi * ratio)
            assert left == pytest.approx(abs(np.cos(np.pi * ratio / 2)) ** power, abs=1e-14)


def test_insensitivity_at_five_per_cent():
    ratios = np.linspace(0.7, 1.3, 60001)
    for name, width in {"ZV": 0.0636, "ZVD": 0.2871, "EI": 0.3994}.items():
        impulses, times = integrator.shaper(name)
        left = np.abs(np.exp(2j * np.pi * np.outer(ratios, times)) @ impulses)
        inside = ratios[left <= 0.05 + 1e-12]
        assert inside[-1] - inside[0] == pytest.approx(width, abs=1e-4)  # grid 1e-5, four digits


ACCELERATION = {  # of a unit rest-to-rest motion over tau in [0, 1]
    "bang-bang": lambda tau: 4.0 if tau < 0.5 else -4.0,
    "cycloidal": lambda tau: 2 * np.pi * np.sin(2 * np.pi * tau),
    "quintic": lambda tau: 60 * tau - 180 * tau**2 + 120 * tau**3,
}


@pytest.mark.parametrize(
    ("profile", "at_ten"), [("bang-bang", 0.05730703), ("cycloidal", 0.12510186), ("quintic", 0.08083873)]
)
def test_residual_of_rest_to_rest_motion(profile, at_ten):
    assert integrator.residual_of_motion(profile, 10.0) == pytest.approx(at_ten, abs=6e-9)
    push = ACCELERATION[profile]
    for s in (3.0, 10.0, 25.0):  # Duhamel: x'' + s^2 x = -y''; amplitude = |int y'' exp(i s tau)| / s
        parts = [
            quad(push, *half, weight=weight, wvar=s, epsabs=1e-13)[0]
            for weight in ("cos", "sin")
            for half in ((0.0, 0.5), (0.5, 1.0))
        ]
        amplitude = np.hypot(parts[0] + parts[1], parts[2] + parts[3]) / s
        assert integrator.residual_of_motion(profile, s) == pytest.approx(amplitude, abs=1e-11)


def test_bang_bang_has_the_right_zeros():
    assert integrator.residual_of_motion("bang-bang", 4 * np.pi) == pytest.approx(0, abs=1e-15)
