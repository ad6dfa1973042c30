"""Vibration left after a small rest-to-rest turn of the actuator against the closed form of every mode."""

import numpy as np
import pytest
from tests.helpers.runs import run_actuator
from tests.oracles.integrator import residual_of_motion
from tests.oracles.ritz import clamped_free_root
from tests.oracles.sliding import constants

from flexapod.model import override, preset

pytestmark = pytest.mark.analytic

TURN, LENGTH, MODES = 1e-4, 1.83, 3
TABLE = {"cycloidal": 0.12510186, "quintic": 0.08083873}  # s = 10


@pytest.mark.parametrize("profile", TABLE)
def test_residual_of_every_mode(profile):
    # a_i'' + omega_i^2 a_i = -L f_i theta'': an oscillator on a base that travels L f_i TURN. At this turn the
    # centrifugal terms are 1e-9 of the others.
    study = preset("paper-actuator")
    beam = study.actuator
    omega = np.array([clamped_free_root(i) ** 2 for i in (1, 2, 3)]) * np.sqrt(beam.EI / beam.rhoA) / LENGTH**2
    duration = 10.0 / omega[0]
    study = study.replace(
        motion=study.motion.replace(
            rotation={"law": profile, "amplitude": TURN, "duration": duration}, extension={"law": "rate", "rate": 0.0}
        ),
        initial=study.initial.replace(tip_displacement=0.0),
    )
    h = duration / 20000
    run = run_actuator(override(study, modes=MODES, duration=1.1 * duration, step=h, output_step=duration / 10))
    a, rate = run["q"][-1, 0, 2:], run["v"][-1, 2:]
    left = np.hypot(a, rate / omega) / (LENGTH * constants(MODES).f * TURN)
    exact = [residual_of_motion(profile, w * duration) for w in omega]
    assert exact[0] == pytest.approx(TABLE[profile], abs=6e-9)
    # The integrator shifts s = omega T by s (omega h)^2 / 12: 2e-7 and 5e-5 in modes 1 and 2, 1e-3 in mode 3, times
    # the slope d residual / ds: at most 0.1, 4e-4, 1e-5.
    np.testing.assert_allclose(left, exact, rtol=0, atol=5e-8)
