"""Sweeps as Zarr folders: written for other programs, and read, also those that were stores of earlier versions."""

import json
import os

import numpy as np
import pytest
import xarray as xr
import zarr
from tests.helpers.sweeps import diameters, quick

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.design.sweeps import open_sweep, save_zarr, zarr_folder

pytestmark = pytest.mark.unit

KEPT = {"scalars": ["com_deviation_peak", "com_deviation_peak_by_axis"], "records": ["com_deviation"]}
STROKES = {"vary": [{"key": "leg.stroke.max", "values": ["1.05 m", "0.8 m", "1.06 m"]}], "keep": KEPT}


def sweep(path, plan=STROKES):
    return fx.sweep(quick(), plan, store=path, workers=0).load()


@pytest.mark.parametrize("portion", [1, 64 << 20])
def test_written_with_the_sweep_and_read_by_anybody(tmp_path, monkeypatch, portion):
    """A name that ends in .zarr asks for it; the store lies beside it, and a second run writes the folder again."""
    monkeypatch.setattr(zarr_folder, "BYTES", portion)
    made = sweep(tmp_path / "a.sqlite")
    xr.testing.assert_identical(open_sweep(tmp_path / "a.zarr").load(), made)  # the store, as there is no folder
    for _ in range(2):
        xr.testing.assert_identical(sweep(tmp_path / "a.zarr"), made)
        assert sorted(os.listdir(tmp_path)) == ["a.sqlite", "a.zarr"]
        with xr.open_zarr(tmp_path / "a.zarr", chunks=None) as plain:  # without a warning
            xr.testing.assert_identical(plain.load(), made)
    (tmp_path / "a.sqlite").unlink()
    xr.testing.assert_identical(open_sweep(tmp_path / "a.zarr").load(), made)


def test_a_folder_of_something_else_is_refused_before_anything_is_computed(tmp_path):
    (tmp_path / "a.zarr").mkdir()
    (tmp_path / "a.zarr" / "mine").touch()
    with pytest.raises(InputError, match=r"a.zarr: is not a store of a sweep"):
        sweep(tmp_path / "a.zarr")
    with pytest.raises(InputError, match=r"a.zarr: is not a store of a sweep"):
        save_zarr(fx.sweep(quick(), diameters(2), workers=0), tmp_path / "a.zarr")
    assert os.listdir(tmp_path) == ["a.zarr"] and os.listdir(tmp_path / "a.zarr") == ["mine"]


TEXTS = ("message", "remarks", "c", "axis")


@pytest.fixture
def earlier(tmp_path):
    """A store as it was before SQLite: four points, of which one was written and not yet marked."""
    header = {"flexapod_sweep_format": 2, "flexapod_version": "0.1.0", "study_hash": "1f", "axes": "[]"}
    names = {"coordinates": "a.b c", "varied": "a.b c", "kept": "x by s r", "complete": "x by r"}
    nan, path = np.nan, tmp_path / "a.zarr"
    variables = {
        "a.b": ("point", [1.0, 2.0, 3.0, 4.0]), "c": ("point", ["u", "v", "w", "u"]), "axis": ["x", "y", "z"],
        "time": [0.0, 0.1], "x": ("point", [5.0, nan, 6.0, 7.0]), "s": ("point", [nan, nan, 1.0, 2.0]),
        "by": (("point", "axis"), np.arange(12.0).reshape(4, 3)),
        "r": (("point", "time"), np.arange(8.0).reshape(4, 2)),
        "status": ("point", np.array([1, 2, 0, 1], dtype=np.int8)),
        "message": ("point", ["", "no", "", ""]), "remarks": ("point", ["hm", "", "early", ""]),
    }  # fmt: skip
    stored = xr.Dataset(variables, attrs=header | names)
    for name in stored.variables:
        stored[name].attrs = {"long_name": name}
        stored[name] = stored[name].astype(object if stored[name].dtype.kind == "U" else stored[name].dtype)
    checked = {name: {"compressors": zarr.codecs.ZstdCodec(checksum=True)} for name in stored.variables}
    stored.to_zarr(path, encoding=checked, consolidated=False)
    return path


def test_an_earlier_store_is_read(earlier):
    """Status in words, values and words of points that it calls computed or failed alone, keys as coordinates."""
    found, nan = open_sweep(earlier).load(), np.nan
    assert found.status.values.tolist() == ["computed", "failed", "pending", "computed"]
    wanted = {
        "x": [5.0, nan, nan, 7.0], "by": [[0.0, 1.0, 2.0], [nan] * 3, [nan] * 3, [9.0, 10.0, 11.0]],
        "s": [nan, nan, nan, 2.0], "r": np.arange(8.0).reshape(4, 2), "message": ["", "no", "", ""],
        "remarks": ["hm", "", "", ""], "a.b": [1.0, 2.0, 3.0, 4.0], "c": ["u", "v", "w", "u"], "axis": ["x", "y", "z"],
        "time": [0.0, 0.1],
    }  # fmt: skip
    for name, values in wanted.items():
        np.testing.assert_array_equal(found[name].values, np.array(values, dtype=found[name].dtype), err_msg=name)
        assert (found[name].dtype.kind, found[name].attrs["long_name"]) == ("O" if name in TEXTS else "f", name)
    assert [*found.data_vars, *sorted(found.coords)] == [
        "x",
        "by",
        "s",
        "r",
        "status",
        *TEXTS[:2],
        "a.b",
        "axis",
        "c",
        "time",
    ]
    assert found.attrs == {"flexapod_sweep_format": 2, "flexapod_version": "0.1.0", "study_hash": "1f", "axes": "[]"}


@pytest.mark.parametrize("name", ["a.zarr", "a.sqlite"])
def test_an_earlier_store_is_not_continued(earlier, name):
    with pytest.raises(InputError, match=r"a.zarr: is a sweep as Zarr.*can be read, not continued.*--out"):
        sweep(earlier.with_name(name))
    renamed = earlier.rename(earlier.with_name("store"))
    with pytest.raises(InputError, match=r"store: is a sweep as Zarr.*can be read, not continued"):
        sweep(renamed)
    sweep(earlier.with_name(name))


def test_another_format_is_refused(earlier):
    about = earlier / "zarr.json"
    content = json.loads(about.read_text())
    content["attributes"]["flexapod_sweep_format"] = 1
    about.write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"another version of flexapod.*Read it with flexapod 0.1.0"):
        open_sweep(earlier)


@pytest.mark.parametrize("file", ["x/c/0", "status/c/0", "message/c/0", "by/zarr.json", "zarr.json"])
def test_a_damaged_folder_is_refused(earlier, file):
    content = (earlier / file).read_bytes()
    turned = content[:-5] + bytes([content[-5] ^ 1]) + content[-4:]  # of the last number; a checksum follows
    for damage in (b"", content[: len(content) // 2], turned if "/c/" in file else b"{}", None):
        (earlier / file).unlink()
        os.mkfifo(earlier / file) if damage is None else (earlier / file).write_bytes(damage)
        with pytest.raises(InputError, match=r"a.zarr: is (a damaged|not a) store of a sweep"):
            open_sweep(earlier)  # of a pipe: reading it would never end
