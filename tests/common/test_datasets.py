"""Datasets put together of their parts are those that xarray makes, and do not load dask."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from flexapod.common.datasets import build_dataset

pytestmark = pytest.mark.unit

WORDS = np.array(["", "it fell"], dtype=object)
PARTS = {
    "numbers": (
        {
            "response": (("output", "part"), np.ones((2, 2)), {"units": "m/N"}),
            "norm": ((), 3.0, {"long_name": "size"}),
            "whole": ("output", [1, 2]),
            "rotated": (["part"], np.array([1j, 2.0])),
            "stable": ("output", np.array([True, False])),
        },
        {"output": ("output", ["x", "yy"]), "output_units": ("output", ["m", "rad"]), "part": ["real", "imaginary"]},
    ),
    "words": (
        {"message": ("point", WORDS, {"long_name": "why"}), "state": ("point", WORDS.astype(str))},
        {"point": np.arange(2), "key": ("point", WORDS)},
    ),
    "labels of time": (
        {"path": (("time", "axis"), np.zeros((3, 2)))},
        {"time": np.linspace(0, 1, 3), "axis": ["a", "b"]},
    ),
    "no labels": ({"a": ("n", np.arange(3.0))}, None),
}


@pytest.mark.parametrize("name", PARTS)
def test_it_is_what_xarray_makes(name):
    data, coords = PARTS[name]
    ours, theirs = build_dataset(data, coords, {"study": name}), xr.Dataset(data, coords, {"study": name})
    xr.testing.assert_identical(ours, theirs)
    for key in theirs.variables:
        assert ours[key].dtype == theirs[key].dtype and ours[key].encoding == theirs[key].encoding
    assert {key: type(index) for key, index in ours.xindexes.items()} == {
        key: type(index) for key, index in theirs.xindexes.items()
    }


def test_what_came_of_xarray_goes_in():
    """Variables and arrays of a Dataset, its labels among them."""
    data, coords = PARTS["numbers"]
    whole = xr.Dataset(data, coords)
    again = build_dataset({name: whole.variables[name] for name in data}, {name: whole[name] for name in coords})
    xr.testing.assert_identical(again, whole)
    assert again.sel(output="yy").whole == 2
    again.response.attrs["units"] = again.output_units.attrs["units"] = "mm/N"  # of the new one alone
    assert whole.response.units == "m/N" and not whole.output_units.attrs


def test_lengths_that_differ_are_refused():
    with pytest.raises(ValueError, match="conflicting sizes"):
        build_dataset({"a": ("n", [1.0, 2.0])}, {"n": [1, 2, 3]})


def test_dask_is_not_loaded():
    code = "import sys; from flexapod.common.datasets import build_dataset; "
    code += "build_dataset({'a': ('n', [1.0])}, {'n': ['x']}); "
    code += "print('dask.array' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"
