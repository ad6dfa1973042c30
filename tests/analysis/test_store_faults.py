"""results.nc: disks that are full, files that are spoilt, names, what is none of ours."""

import os

import numpy as np
import pytest
import xarray as xr
from tests.helpers.sweeps import quick

import flexapod as fx
from flexapod.analysis import open_results, save, store
from flexapod.analysis.checks import resource_limits as room
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit

resource = pytest.importorskip("resource")


@pytest.fixture(scope="module")
def data():
    return fx.run(quick())


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.nc"


def test_every_variable_comes_back(data, path):
    xr.testing.assert_identical(open_results(save(data, path)), data)


def test_what_xarray_writes_and_what_is_written_read_the_same(data, path, tmp_path):
    """Labels apart from dimensions, truth values, texts of several bytes a letter, numbers without dimension too."""
    more = data.assign(
        open=("leg", np.array([True, False] * 3)), words=("leg", np.array(["µm", "", "è", "a b", "x", "y"])), one=2.5
    ).assign_coords(home=("leg", np.arange(6.0)), place=3)
    more.attrs["flag"] = np.int64(1)
    other = tmp_path / "other.nc"
    more.to_netcdf(other, engine="netcdf4")
    save(more, path)
    with xr.open_dataset(other, decode_times=False) as a, xr.open_dataset(path, decode_times=False) as b:
        assert b.attrs.pop(store.SUM)
        xr.testing.assert_identical(a.load(), b.load())


@pytest.mark.parametrize("size", [1_000, 30_000, 120_000])
def test_a_full_disk_is_told(data, path, size):
    """A bare "RuntimeError: NetCDF: HDF error" once, after everything was computed."""
    save(data, path)
    before, limits = path.read_bytes(), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        with pytest.raises(InputError, match=r"results.nc: cannot be written: .*has space"):
            save(xr.concat([data] * 4, "copy", data_vars="all"), path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == before  # the old one stays
    assert os.listdir(path.parent) == ["results.nc"]


def test_the_reason_is_that_of_the_system(data, path, monkeypatch):
    def silent(*_, **__):
        raise RuntimeError("NetCDF: HDF error")

    monkeypatch.setattr(store, "write", silent)
    with pytest.raises(InputError, match="cannot be written: the NetCDF library says NetCDF: HDF error"):
        save(data, path)  # the disk takes it: nothing else is known
    resource_limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource_limits[1]))
    try:
        with pytest.raises(InputError, match="cannot be written: File too large"):
            save(data, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, resource_limits)


def test_a_spoilt_value_is_noticed_and_named(data, path):
    """A turned bit in a number was read as another number."""
    save(data, path)
    content = path.read_bytes()
    for name in ("com_deviation", "joint_force", "deviation_by_cause"):
        value = data[name].values.ravel()
        value = value[np.abs(value).argmax()]  # one that occurs nowhere else
        at = content.find(value.tobytes())
        assert at > 0
        path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
        with pytest.raises(InputError, match=f"is damaged: {name} is not what was written.*copy"):
            open_results(path)


def test_a_turned_bit_anywhere_changes_nothing_or_is_told(data, path):
    save(data, path)
    content, random = path.read_bytes(), np.random.default_rng(1)
    told = 0
    for at, bit in zip(random.integers(len(content), size=60), random.integers(8, size=60), strict=True):
        path.write_bytes(content[:at] + bytes([content[at] ^ (1 << bit)]) + content[at + 1 :])
        try:
            found = open_results(path)
        except InputError:
            told += 1
        else:
            xr.testing.assert_identical(found, data)
    assert told > 5  # about a fifth of the file holds something


def test_truncated_files(data, path):
    save(data, path)
    content = path.read_bytes()
    for share in (0.0, 0.01, 0.5, 0.99):
        path.write_bytes(content[: int(share * len(content))])
        with pytest.raises(InputError, match=r"results.nc: is (not a readable|damaged)"):
            open_results(path)


def test_what_is_not_a_file_of_ours(data, path, tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe.nc")
    for place in (tmp_path / "pipe.nc", "/dev/zero"):
        with pytest.raises(InputError, match="it is not a regular file"):
            open_results(place)
    data.drop_attrs().to_netcdf(path)
    with pytest.raises(InputError, match="is not a result of flexapod"):
        open_results(path)
    save(data, path)
    monkeypatch.setattr(store, "available_memory", lambda: 1000.0)
    with pytest.raises(InputError, match=r"unpacks to 4.*e-05 GB.*half the free memory"):
        open_results(path)


LONG = {"duration": 2000.0, "output_step": 1e-3}  # 2e6 instants of 2 kB


def test_results_beyond_the_memory_are_refused_before_they_are_computed(monkeypatch):
    monkeypatch.setattr(room, "available_memory", lambda: 8e9)
    with pytest.raises(InputError, match=r"2e\+06 instants, .* GB of memory, where 8 GB is free.*output_step = 0.00"):
        fx.simulate(fx.preset("paper-robot"), **LONG)
    with pytest.raises(InputError, match="GB of memory"):
        fx.simulate_actuator(fx.preset("paper-actuator"), duration=3e4, output_step=1e-5)


def test_results_of_gigabytes_are_remarked_on(monkeypatch):
    monkeypatch.setattr(room, "available_memory", lambda: 1e12)
    study = fx.model.override(fx.preset("paper-robot"), **LONG)
    takes = "take 4.67 GB, and 3 times as much while they are made"
    assert room.check_memory(study) == [
        f"the results are of 2e+06 instants: they {takes}, and most of the time goes into them; "
        "output_step = 0.4 (s) keeps some 5000"
    ]


@pytest.mark.parametrize("preset", ["paper-robot", "paper-actuator"])
def test_very_many_instants_are_remarked_on(preset):
    fine = fx.model.override(fx.preset(preset), duration=0.004, output_step=3e-8)
    (said,) = room.check_memory(fine)
    assert "1.33e+05 instants" in said and "output_step = 8e-07" in said
    assert room.check_memory(fx.model.override(fine, output_step=8e-7)) == []
    assert said in describe(fine).remarks


def test_a_control_group_gives_back_what_files_left_in_memory(monkeypatch, tmp_path):
    """A container that has read large files counts them as memory in use; runs were refused for lack of it."""
    group = {"memory.max": "1000000", "memory.current": "990000", "memory.stat": "anon 10000\ninactive_file 980000\n"}
    for name, content in group.items():
        (tmp_path / name).write_text(content, encoding="ascii")
    monkeypatch.setattr(room, "_CGROUPS", ((tmp_path, "memory.max", "memory.current", "inactive_file"),))
    assert room.available_memory() == 990_000
    (tmp_path / "memory.max").write_text("max", encoding="ascii")
    assert room.available_memory() > 1_000_000


def test_the_advised_output_step_will_do(monkeypatch):
    study = fx.model.override(fx.preset("paper-robot"), **LONG)
    monkeypatch.setattr(room, "available_memory", lambda: 1e9)
    with pytest.raises(InputError) as caught:
        room.check_memory(study)
    advised = float(caught.value.next_step.split("output_step = ")[1].split()[0])
    room.check_memory(fx.model.override(study, output_step=advised))


def test_results_beyond_the_disk_are_refused(tmp_path, monkeypatch):
    study = fx.model.override(fx.preset("paper-robot"), **LONG)
    monkeypatch.setattr(room, "free_disk", lambda folder: 1e9)
    with pytest.raises(InputError, match=r"14 GB on the disk, where 1 GB is free at .*Give output_step"):
        room.check_disk(study, tmp_path)
    assert room.free_disk(tmp_path / "not" / "there") > 0


def test_estimated_and_real_sizes(data):
    """The estimate counts what the Dataset has, to 2 %: coordinates and flags are left out."""
    more = fx.model.override(quick(), fidelity="assumed-modes", modes=3)
    for study, found in ((quick(), data), (more, fx.run(more))):
        real = sum(v.nbytes for v in found.variables.values() if "time" in v.dims)
        assert room.result_bytes(study) == pytest.approx(real, rel=0.02)


def test_sweeps_that_no_place_holds(monkeypatch, tmp_path):
    plan = {"vary": [{"key": "payload.mass", "values": [100, 101]}], "keep": {"records": ["com_deviation"]}}
    monkeypatch.setattr(room, "SMALL", 0.0)
    monkeypatch.setattr(room, "free_disk", lambda folder: 100.0)
    with pytest.raises(InputError, match=r"keep: asks for .* on the disk.*record_step"):
        fx.sweep(quick(), plan, store=tmp_path / "a.sqlite", workers=0)
    monkeypatch.setattr(room, "available_memory", lambda: 150_000.0)
    fx.sweep(quick(), plan, workers=0)
    with pytest.raises(InputError, match="of memory, 2 of them at a time"):
        fx.sweep(quick(), plan, workers=5)
    assert os.listdir(tmp_path) == []
