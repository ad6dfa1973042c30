"""Results that come from a file: damaged, hostile or of something else, they are refused in words."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

import flexapod as fx
from flexapod.analysis import open_results, save
from flexapod.app.browser.header import open_source

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def results():
    robot, beam = fx.preset("paper-robot"), fx.preset("paper-actuator")
    short = fx.model.override(robot, duration=0.02, fidelity="lumped")
    return {"robot": fx.run(short), "beam": fx.run(fx.model.override(beam, duration=0.05))}


def refusal(data, path) -> str:
    if path.exists():
        path.unlink()
    data.to_netcdf(path)
    with pytest.raises(fx.InputError, match=r"results\.nc") as refused:
        open_source(path)
    return str(refused.value)


@pytest.mark.parametrize("kind", ["robot", "beam"])
def test_results_of_every_kind_open(results, kind, tmp_path):
    found = open_source(save(results[kind], tmp_path / "results.nc"))
    assert found.data.equals(results[kind])


@pytest.mark.parametrize(("kind", "shape"), [("f8", (2_000_000_000,)), ("i1", (40_000, 50_000)), ("f8", (10**6,) * 3)])
def test_what_would_fill_the_memory_is_not_unpacked(kind, shape, tmp_path):
    """Zeros pack a thousandfold: 2 MB on disk, 16 GB in memory."""
    path = tmp_path / "zeros.nc"
    with netCDF4.Dataset(path, "w") as file:
        dims = [file.createDimension(f"d{i}", size).name for i, size in enumerate(shape)]
        zeros = file.createVariable("com_deviation", kind, dims, zlib=True, chunksizes=(100,) * len(shape))
        zeros[(slice(0, 100),) * len(shape)] = 0
        file.flexapod_version = "0.1.0"
    assert path.stat().st_size < 3e6
    with pytest.raises(fx.InputError, match=r"zeros\.nc: unpacks to .* GB from .* MB\. Allowed: at most .* GB"):
        open_results(path)


def test_pieces_that_would_fill_the_memory_are_not_unpacked(tmp_path):
    """One number, stored in a piece that unpacks to 3.2 GB."""
    path = tmp_path / "zeros.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", None)
        file.createVariable("time", "f8", ("time",), zlib=True, chunksizes=(400_000_000,))
    with pytest.raises(fx.InputError, match=r"unpacks to 3\.2 GB"):
        open_results(path)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.6, 0.9, 0.999])
def test_a_file_that_is_cut_off_is_refused(results, share, tmp_path):
    whole = save(results["robot"], tmp_path / "whole.nc").read_bytes()
    path = tmp_path / "results.nc"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(fx.InputError, match="is not a readable NetCDF file"):
        open_source(path)


def test_damaged_bytes_never_end_in_a_fault(results, tmp_path):
    """Refused in words or read: what a few hundred wrong bytes do to the reader is not ours to know."""
    whole, path = save(results["beam"], tmp_path / "whole.nc").read_bytes(), tmp_path / "results.nc"
    for seed in range(40):
        rng = np.random.default_rng(seed)
        broken = np.frombuffer(whole, np.uint8).copy()
        broken[rng.integers(0, min(len(broken), 20_000), 300)] = rng.integers(0, 256, 300)
        path.write_bytes(broken.tobytes())
        try:
            open_source(path)
        except fx.InputError as error:
            assert str(path) in str(error)


def test_what_is_no_file_is_refused(tmp_path):
    with pytest.raises(fx.InputError, match="Is a directory"):
        open_results(tmp_path)


ATTRIBUTES = [
    ("study", None, "study: is missing"),
    ("study", 3, "is not a text"),
    ("study", "x" * 2_000_000, "has more than 1000000 characters"),
    ("study", "[robot", "is not valid TOML"),
    ("study", "[actuator]\n", "results.nc"),
    ("warnings", np.array([1.0, 2.0]), "is not a text"),
    ("study_file", 1.0, "is not a text"),
    ("partial", None, "partial: is missing"),
    ("partial", "no", "is not a number"),
    ("tolerance", np.nan, "is not a number"),
    ("fidelity", "perfect", "fidelity"),
    ("modes", 10**9, "does not fit the"),
    ("flexapod_version", 3, "is not a result of flexapod"),
]


@pytest.mark.parametrize(("name", "value", "words"), ATTRIBUTES)
@pytest.mark.parametrize("kind", ["robot", "beam"])
def test_attributes_are_what_they_should_be(results, kind, name, value, words, tmp_path):
    data = results[kind].copy()
    data.attrs = {k: v for k, v in data.attrs.items() if k != name} | ({} if value is None else {name: value})
    assert words in refusal(data, tmp_path / "results.nc")


def test_a_study_of_something_else_is_refused(results, tmp_path):
    robot, beam = results["robot"], results["beam"]
    for data, other in ((robot, beam), (beam, robot)):
        assert "something else" in refusal(data.assign_attrs(study=other.attrs["study"]), tmp_path / "results.nc")


@pytest.mark.parametrize("kind", ["robot", "beam"])
def test_variables_are_what_they_should_be(results, kind, tmp_path):
    data, path = results[kind], tmp_path / "results.nc"
    name = "leg_length" if kind == "robot" else "length"
    values = data[name].values
    elsewhere = tuple(f"d{i}" for i in range(values.ndim))
    changed = {
        "is missing": data.drop_vars(name),
        "varies over nothing": data.assign({name: 3.0}),
        "varies over d0": data.assign({name: xr.Variable(elsewhere, values)}),
        "does not hold numbers": data.assign({name: data[name].astype(str)}),
        "not finite": data.assign({name: data[name] * np.nan}),
        "has instants that do not grow": data.isel(time=slice(None, None, -1)),
        "is not a list of instants": data.drop_vars("time"),
        "not a result of a simulation": data.drop_vars(["com_deviation", "angle"], errors="ignore"),
    }
    for words, broken in changed.items():
        assert words in refusal(broken, path), words
    assert "has instants that do not grow" in refusal(data.isel(time=[]), path)
    if kind == "robot":
        assert "has other labels" in refusal(data.assign_coords(leg=data.leg + 1), path)
        assert "another number of legs" in refusal(data.isel(leg=slice(0, 5)), path)
        assert "has other labels" in refusal(data.assign_coords(axis=["x", "y", "w"]), path)
