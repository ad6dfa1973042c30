"""Results of a simulation that are made when they are asked for: no reader of a Dataset can tell."""

import pickle

import numpy as np
import pytest
import xarray as xr
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.analysis.results.lazy_arrays import LazyArrays

pytestmark = pytest.mark.unit

SHORT = {"fidelity": "lumped", "duration": 0.02}


@pytest.fixture
def data():
    return fx.simulate(paper_robot(), **SHORT)


def test_an_array_is_made_once_and_what_made_it_is_dropped():
    made = []
    values = LazyArrays({"there": np.ones(2), "later": lambda: made.append(1) or np.zeros(3)})
    assert list(values) == ["there", "later"]
    assert values.peek("later") is None
    assert not made
    assert values["later"] is values["later"] is values.peek("later")
    assert made == [1]


def test_a_dataset_knows_shapes_and_kinds_of_what_was_not_made(data):
    told = {name: (array.shape, array.dtype) for name, array in data.variables.items()}
    assert told == {name: (array.values.shape, array.values.dtype) for name, array in data.variables.items()}


def test_a_dataset_is_the_one_that_xarray_makes(data):
    """It is put together of its parts, past all that xarray itself does with them."""
    for found in (data.load(), fx.modes(paper_robot()), fx.stiffness(paper_robot())):
        own = xr.Dataset({name: array.variable for name, array in found.data_vars.items()}, found.coords, found.attrs)
        xr.testing.assert_identical(found, own)
        assert list(found.variables) == list(own.variables)
        assert list(found.xindexes) == list(own.xindexes)
        assert found.sizes == own.sizes
        assert {name: array.dtype for name, array in found.variables.items()} == {
            name: array.dtype for name, array in own.variables.items()
        }


def test_arrays_are_the_same_each_time_they_are_read(data):
    part = data.isel(time=slice(2, 5), leg=[0, 3]).deviation_by_cause
    assert np.shares_memory(data.leg_length.values, data["leg_length"].values)
    np.testing.assert_array_equal(part.values, data.deviation_by_cause.values[2:5][:, :, [0, 3]])
    np.testing.assert_array_equal(data.com_deviation, data.com_position - data.com_position_rigid)


@pytest.mark.parametrize("again", [lambda data: data.copy(deep=True), lambda data: pickle.loads(pickle.dumps(data))])
def test_copies_have_arrays_of_their_own(data, again):
    other = again(data)
    other.com_deviation.values[:] = 7.0
    other["leg_length"][0] = 8.0
    assert (other.com_deviation == 7.0).all()
    assert (other.leg_length[0] == 8.0).all()
    assert (np.abs(data.com_deviation) < 1.0).all()
    assert (data.leg_length[0] != 8.0).all()


def test_loaded_and_stored_results_hold_all(data, tmp_path):
    fx.study.save(data, tmp_path / "results.nc")
    stored = fx.study.open_results(tmp_path / "results.nc")
    for name, array in data.load().data_vars.items():
        np.testing.assert_array_equal(array.values, stored[name].values, err_msg=name)
