"""The oracle of spin-up reproduces the peaks of Simo and Vu-Quoc's beam and of the 8 m aluminium beam."""

import numpy as np
import pytest
from tests.oracles import spinup

pytestmark = pytest.mark.literature

SIMO = {"length": 10.0, "EI": 1.4e4, "m": 1.2, "rate": 6.0, "duration": 15.0}
E, AREA, SECOND, DENSITY = 6.8952e10, 7.2968e-5, 8.2189e-9, 2766.7
ALUMINIUM = {"length": 8.0, "EI": E * SECOND, "m": DENSITY * AREA, "duration": 15.0}
T = np.arange(0, 20.0005, 1e-3)
# case, peak and its time (Ritz), largest residual after the spin-up, peak of a full nonlinear code
CASES = [
    (SIMO, -0.57437, 6.762, 3.7e-3, -0.57384),
    (ALUMINIUM | {"rate": 4.0}, -0.53440, 6.766, 8.4e-3, -0.53370),
    (ALUMINIUM | {"rate": 6.0}, -0.75262, 6.541, 7.7e-3, -0.75069),
]


@pytest.mark.parametrize(("case", "peak", "when", "rest", "nonlinear"), CASES)
def test_peak_and_residual(case, peak, when, rest, nonlinear):
    lag = spinup.tip_lag(T, **case)
    assert lag.min() == pytest.approx(peak, abs=3e-5)  # the tables keep fewer shapes: 2e-5 between 4 and 6
    assert T[lag.argmin()] == pytest.approx(when, abs=1.5e-3)  # output every millisecond, flat maximum
    assert abs(lag[T > 15]).max() == pytest.approx(rest, rel=0.03)  # printed to two digits, sampled
    assert lag.min() == pytest.approx(nonlinear, rel=5e-3)


def test_without_stiffening_it_diverges():
    case = ALUMINIUM | {"rate": 6.0}  # above the first bending frequency, 2.91 rad/s
    assert 1.875104068712**2 * np.sqrt(case["EI"] / case["m"]) / 64 == pytest.approx(2.910742, abs=6e-6)
    assert abs(spinup.tip_lag(T, **case, stiffening=False)).max() > 1e6


def test_steady_extension():
    small, rod = spinup.steady_extension(10.0, 2.8e7, 1.2, 6.0)
    assert small == pytest.approx(5.142857e-4, abs=6e-11)
    assert rod == pytest.approx(5.143175e-4, abs=6e-11)
    assert spinup.steady_extension(8.0, E * AREA, DENSITY * AREA, 4.0)[0] == pytest.approx(1.0957e-4, abs=6e-9)
    assert spinup.steady_extension(8.0, E * AREA, DENSITY * AREA, 6.0)[0] == pytest.approx(2.465e-4, abs=6e-8)


def test_law_is_its_own_derivative():
    t, h = np.linspace(0.5, 14.5, 29), 1e-4
    angle, rate, push = (np.array([spinup.law(t + d, 6.0, 15.0)[i] for d in (-h, 0, h)]) for i in range(3))
    np.testing.assert_allclose((angle[2] - angle[0]) / (2 * h), rate[1], atol=1e-8)  # h^2/6 and rounding / h
    np.testing.assert_allclose((rate[2] - rate[0]) / (2 * h), push[1], atol=1e-8)
    np.testing.assert_allclose(spinup.law(15.0, 6.0, 15.0)[0], 45.0)
