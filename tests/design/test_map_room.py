"""A map that neither memory nor disk holds is refused before it is computed."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.checks import resource_limits
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit


def test_maps_beyond_the_memory_are_refused(monkeypatch):
    monkeypatch.setattr(resource_limits, "available_memory", lambda: 2e8)
    volume = {name: np.linspace(-0.01, 0.01, 100) for name in ("surge", "sway", "heave")}
    with pytest.raises(InputError, match=r"axes.*GB of memory, where 0.2 GB is free.*fewer points"):
        fx.workspace_map(fx.preset("paper-robot"), volume)


def test_the_estimate_is_the_size_of_a_map():
    """Within a tenth: numbers of a pose that depend on the robot."""
    count = 20
    data = fx.workspace_map(fx.preset("paper-robot"), {"surge": np.linspace(-0.01, 0.01, count)})
    held = sum(data[name].nbytes for name in data.data_vars)
    assert 8 * count * (resource_limits.POSE + data.sizes["mode"]) == pytest.approx(held, rel=0.1)
