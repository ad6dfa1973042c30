"""Order of the time integration for robots whose coordinates are held, on carriages, with closed attitudes."""

from itertools import pairwise

import numpy as np
import pytest
from tests.helpers.moving import SOFT, moving
from tests.helpers.runs import run_robot

pytestmark = pytest.mark.convergence


@pytest.mark.parametrize("kind", ["8-UPS", "3-RPS", "6-PUS", "3-UPU", "3-UPS+UP"])
def test_order_two(kind):
    # Soft drives and one shape: some 40 and 100 Hz, which steps of a quarter of a millisecond and less resolve.
    runs = [run_robot(moving(kind, SOFT, axial_modes=0, modes=1, step=h)) for h in (2.5e-4, 1.25e-4, 6.25e-5)]
    for name in ("pose", "q", "v", "lam"):
        first, second = (np.abs(a[name] - b[name]).max() for a, b in pairwise(runs))
        assert np.log2(first / second) == pytest.approx(2.0, abs=0.1), name
