"""Spin-up of a beam on a turning hub (Simo & Vu-Quoc; Wu & Haug): peaks of the marched actuator."""

import numpy as np
import pytest
from tests.helpers.runs import run_actuator
from tests.oracles import spinup

from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import Actuator, ActuatorMotion, ActuatorStudy, RateLaw, Simulation, SpinUpLaw
from flexapod.solve.modal.actuator_modes import turning_matrices
from flexapod.verification.cases.turning import TABLE

pytestmark = pytest.mark.literature

TS = 15.0
# case; peak and its instant by Ritz's method, peak of full nonlinear finite elements, largest lag after the spin-up
CASES = [
    ({"length": length, "EI": EI, "m": m, "rate": rate}, *values) for _, (length, EI, _, m), rate, *values in TABLE
]
ALUMINIUM = CASES[2][0]


def beam(case):
    return Actuator(length=case["length"], free_length=case["length"], rhoA=case["m"], EI=case["EI"])


def tip_lag(case, basis, modes):
    """Instants (T,) [s] and tip deflection (T,) [m] each millisecond."""
    study = ActuatorStudy(
        actuator=beam(case),
        motion=ActuatorMotion(rotation=SpinUpLaw(rate=case["rate"], duration=TS), extension=RateLaw(rate=0.0)),
        simulation=Simulation(basis=basis, modes=modes, duration=20.0, step=1e-3, output_step=1e-3),
    )
    run = run_actuator(study)
    return run["time"], run["q"][:, 0, 2:] @ lateral_basis(basis, modes).tip


@pytest.mark.parametrize(("basis", "modes"), [("clamped-free", 3), ("clamped-free", 6), ("tip-load", 3)])
@pytest.mark.parametrize(("case", "peak", "when", "nonlinear", "rest"), CASES)
def test_peak(case, peak, when, nonlinear, rest, basis, modes):
    time, lag = tip_lag(case, basis, modes)
    assert lag.min() == pytest.approx(peak, rel=2e-4)  # three shapes: 1.5e-4
    assert lag.min() == pytest.approx(nonlinear, rel=5e-3)  # the physics left out: 0.1 to 0.26 %
    assert time[lag.argmin()] == pytest.approx(when, abs=1.5e-3)  # output each millisecond, flat maximum
    assert abs(lag[time > TS]).max() == pytest.approx(rest, rel=0.03)  # printed to two digits


@pytest.mark.parametrize(("case", "peak"), [case[:2] for case in CASES])
def test_whole_history(case, peak):
    time, lag = tip_lag(case, "clamped-free", 6)
    exact = spinup.tip_lag(time, **case, duration=TS)  # the same six modes, another method in time
    # Order 2 with omega_1 h = 3e-3: 1e-6 of the amplitude a radian, over some seconds of the peak's making.
    np.testing.assert_allclose(lag, exact, rtol=0, atol=2e-6 * abs(peak))


def test_bending_stiffness_alone_would_lose_the_beam():
    # 6 rad/s is above the first frequency, 2.91 rad/s: without the stiffening of foreshortening the field across the
    # beam wins. With it the beam stands.
    case = ALUMINIUM
    settings = Simulation(basis="clamped-free", modes=6)
    M, _, rest = turning_matrices(beam(case), settings, 0.0)
    turning = turning_matrices(beam(case), settings, case["rate"])[2]
    assert np.linalg.eigvalsh(rest - case["rate"] ** 2 * M)[0] < 0 < np.linalg.eigvalsh(turning)[0]
