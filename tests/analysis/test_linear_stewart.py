"""A published Stewart platform: its plant from drive forces to sensors, modes and compliance.

stewart-simscape by T. Dehaeze (MIT), commit 32330b9: numbers of its Simscape model, four digits as printed there.
"""

import numpy as np
import pytest

import flexapod as fx
from flexapod.verification.cases.linear import DAMPER as C
from flexapod.verification.cases.linear import SPRING as K
from flexapod.verification.cases.linear import stewart

pytestmark = pytest.mark.analytic

HZ = np.array([10.0, 100.0, 500.84, 1e4])


@pytest.fixture(scope="module")
def plant():
    return fx.linearize(stewart(), inputs=["drive", "wrench"], outputs=["drive-force", "stroke", "tool"])


def test_forces_of_the_struts_by_those_of_the_drives(plant):
    s = 2j * np.pi * HZ  # Fm = F - (k + c s) dL
    own = plant.select("drive:1", "drive-force:1").at(HZ)[0, 0]
    assert own == pytest.approx(1 - (K + C * s) * plant.select("drive:1", "stroke:1").at(HZ)[0, 0], rel=1e-9)


def test_a_floor_that_does_not_accelerate_is_followed():
    # no gravity: 1 at 0 Hz by definition; at 1e-2 Hz it is 1 + (f / f0)^2, 2e-10
    data = fx.transmissibility(stewart(), [0.0, 1e-2])
    T = data.transmissibility.sel(part="real").values
    assert T[..., 0] == pytest.approx(np.eye(6), abs=1e-15)
    assert T[..., 1] == pytest.approx(np.eye(6), abs=1e-9)
