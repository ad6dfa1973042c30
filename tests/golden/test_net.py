"""Prints of nine studies against those stored on this machine before a change; see `tests.golden.net`."""

import json

import numpy as np
import pytest
import xarray as xr
from tests.golden.net import STORED, STUDIES, differences, of_dataset, printed, prints

pytestmark = pytest.mark.golden

STORE = "nothing stored to compare with: `python -m tests.golden.net --store`, before a change that only moves things"


@pytest.mark.skipif(not STORED.exists(), reason=STORE)
def test_prints_are_as_stored():
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    wrong = {name: differences(prints(name), stored[name]) for name in STUDIES if name in stored}
    assert not {name: keys for name, keys in wrong.items() if keys}


def test_a_print_sees_the_last_bit_the_shape_and_the_unit():
    x = np.linspace(0.0, 1.0, 5)
    one = xr.Dataset({"x": ("time", x, {"units": "m"})})
    bit, unit = one.copy(deep=True), one.copy(deep=True)
    bit.x.values[3] = np.nextafter(x[3], 2.0)
    unit.x.attrs["units"] = "mm"
    assert of_dataset(one) == of_dataset(one.copy(deep=True))
    assert differences(of_dataset(one), of_dataset(bit)) == differences(of_dataset(one), of_dataset(unit)) == ["x"]
    assert printed(x) != printed(x[:, None])
    assert printed("ab", "c") != printed("a", "bc")


def test_a_print_sees_every_part_of_a_kernel():
    found = prints("tripod")
    assert {key.split(".")[0] for key in found} == {"text", "parameters", "simulate", "modes", "budget"}
    assert found == prints("tripod")
