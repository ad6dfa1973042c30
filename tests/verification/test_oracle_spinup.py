"""The oracle of spin-up reproduces the peaks of Simo and Vu-Quoc's beam and of the 8 m aluminium beam."""

import numpy as np
import pytest
from tests.oracles import spinup

from flexapod.verification.cases.turning import DURATION, TABLE

pytestmark = pytest.mark.literature

T = np.arange(0, 20.0005, 1e-3)
BEAMS = [{"length": length, "EI": EI, "m": rhoA, "rate": rate} for _, (length, EI, _, rhoA), rate, *_ in TABLE]
CASES = [(beam, *row[3:]) for beam, row in zip(BEAMS, TABLE, strict=True)]


@pytest.mark.parametrize(("case", "peak", "when", "nonlinear", "rest"), CASES)
def test_peak_and_residual(case, peak, when, nonlinear, rest):
    lag = spinup.tip_lag(T, **case, duration=DURATION)
    assert lag.min() == pytest.approx(peak, abs=3e-5)  # the tables keep fewer shapes: 2e-5 between 4 and 6
    assert T[lag.argmin()] == pytest.approx(when, abs=1.5e-3)  # output every millisecond, flat maximum
    assert abs(lag[T > DURATION]).max() == pytest.approx(rest, rel=0.03)  # printed to two digits, sampled
    assert lag.min() == pytest.approx(nonlinear, rel=5e-3)


def test_without_stiffening_it_diverges():
    case = BEAMS[2]  # above the first bending frequency, 2.91 rad/s
    assert 1.875104068712**2 * np.sqrt(case["EI"] / case["m"]) / 64 == pytest.approx(2.910742, abs=6e-6)
    assert abs(spinup.tip_lag(T, **case, duration=DURATION, stiffening=False)).max() > 1e6


def test_steady_extension():
    (small, rod), (slow, _), (fast, _) = (
        spinup.steady_extension(length, EA, rhoA, rate) for _, (length, _, EA, rhoA), rate, *_ in TABLE
    )
    assert small == pytest.approx(5.142857e-4, abs=6e-11)
    assert rod == pytest.approx(5.143175e-4, abs=6e-11)
    assert slow == pytest.approx(1.0957e-4, abs=6e-9)
    assert fast == pytest.approx(2.465e-4, abs=6e-8)


def test_law_is_its_own_derivative():
    t, h = np.linspace(0.5, 14.5, 29), 1e-4
    angle, rate, push = (np.array([spinup.law(t + d, 6.0, 15.0)[i] for d in (-h, 0, h)]) for i in range(3))
    np.testing.assert_allclose((angle[2] - angle[0]) / (2 * h), rate[1], atol=1e-8)  # h^2/6 and rounding / h
    np.testing.assert_allclose((rate[2] - rate[0]) / (2 * h), push[1], atol=1e-8)
    np.testing.assert_allclose(spinup.law(15.0, 6.0, 15.0)[0], 45.0)
