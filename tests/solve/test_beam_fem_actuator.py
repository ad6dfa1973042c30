"""Beam elements on the free length: the motion of the sliding beam of the paper's Table 2 over 10 s."""

import numpy as np
import pytest
from tests.helpers.runs import run_actuator
from tests.oracles.ritz import clamped_free

from flexapod.model import override, preset
from flexapod.verification.cases.sliding import FEED, LARGEST_MM, TIP_MM

ELEMENTS, STEP = 12, 5e-5
LENGTH = 1.83
pytestmark = [pytest.mark.consistency, pytest.mark.optimised]  # 200,000 steps


def test_the_table_of_the_exact_first_mode():
    # From the exact first mode at 5 mm with q' = 0, q = sqrt(rho L) a: nodal values of the mode, a' = -L'/(2 L) a.
    phi, node = clamped_free(1), np.arange(1, ELEMENTS + 1) / ELEMENTS
    a = 2.5e-3 * np.column_stack([phi(node, 0), phi(node, 1) / ELEMENTS]).ravel()
    study = override(preset("paper-actuator"), fidelity="beam-fem", modes=2 * ELEMENTS, step=STEP, output_step=0.1)
    run = run_actuator(study, a, -FEED / (2 * LENGTH) * a)
    found = 1e3 * run["q"][::10, 0, -2]  # deflection of the last node
    np.testing.assert_allclose(found, TIP_MM, rtol=0, atol=1e-3 * LARGEST_MM)  # 0.1 % of the table's peak
