"""Arrays in files of others: read as SciPy and NumPy read what they wrote; damaged and hostile ones are refused."""

import io
import json
import os
import resource
import subprocess
import sys
import time
import zipfile
import zlib
from struct import pack

import numpy as np
import pytest
from scipy.io import loadmat, savemat

import flexapod as fx
from flexapod import control
from flexapod.common.errors import InputError
from flexapod.common.tables.array_files import json_arrays, mat_arrays, npz_arrays, texts_of
from flexapod.common.tables.systems import read_system
from flexapod.model import preset_text

pytestmark = pytest.mark.unit

#: Bytes: Python with NumPy and what is imported takes 120 MB of them, a file of the largest size thrice its own.
ROOM = 600_000_000


def everything(_):
    return True


def written(given, **how):
    buffer = io.BytesIO()
    savemat(buffer, given, **how)
    return buffer.getvalue()


def same(one, other):
    """Like arrays, cells one by one; of texts the rows."""
    if isinstance(other, np.ndarray) and other.dtype == object:
        return one.shape == other.shape and all(map(same, one.ravel(), other.ravel()))
    return one.shape == other.shape and np.array_equal(one, other)


GIVEN = {
    "real": np.arange(12.0).reshape(3, 4) - 5.5,
    "complex": np.array([[1 + 2j, -3j], [np.inf - 1j, 5]]),
    "single": np.arange(5, dtype=np.float32),
    "cube": np.arange(24.0).reshape(2, 3, 4) * (1 - 2j),
    "none": np.zeros((0, 3)),
    "scalar": 1e-300,
    "text": "Größe µm",
    "rows": np.array(["abc", "de ", "f  "]),
    **{f"i{k}": np.array([[np.iinfo(k).min, 3, np.iinfo(k).max]], dtype=k)
       for k in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")},
    "flag": np.array([True, False]),
    "cells": np.array(["tool:z", "x", ""], dtype=object),
    "mixed": np.array([np.arange(3.0), "text", np.array(["a", np.ones((2, 2))], dtype=object)], dtype=object),
}  # fmt: skip


@pytest.mark.parametrize("how", [{}, {"do_compression": True}, {"oned_as": "column"}])
def test_files_of_version_5_are_read_as_scipy_reads_them(how):
    content = written(GIVEN, **how)
    expected, found = loadmat(io.BytesIO(content)), mat_arrays(content, everything)
    assert set(found) == set(GIVEN)
    for name in GIVEN:
        assert same(found[name], expected[name]), name


def test_files_of_version_4_are_read_as_scipy_reads_them():
    given = {k: GIVEN[k] for k in ("real", "complex", "single", "scalar", "rows", "ii2", "iu1", "ii4")} | {
        "text": "abc"
    }
    content = written(given, format="4")
    expected, found = loadmat(io.BytesIO(content)), mat_arrays(content, everything)
    assert set(found) == set(given)
    for name in given:
        assert same(found[name], expected[name]), name


def test_numbers_of_the_other_order_of_bytes_are_read():
    """A matrix [[1, 3], [2, 4i]] of a machine with the largest byte first, written by hand from the format's pages."""

    def element(kind, data):
        return pack(">II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    inner = element(6, pack(">II", 0x0806, 0)) + element(5, pack(">ii", 2, 2)) + pack(">HH", 1, 1) + b"A\0\0\0"
    inner += element(2, bytes([1, 2, 3, 0])) + element(9, pack(">4d", 0, 0, 0, 4))
    content = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI" + element(14, inner)
    assert np.array_equal(mat_arrays(content, everything)["A"], [[1, 3], [2, 4j]])


@pytest.mark.parametrize("how", [np.savez, np.savez_compressed])
def test_files_of_numpy_are_read_as_numpy_reads_them(how):
    given = {k: np.asarray(v) for k, v in GIVEN.items() if np.asarray(v).dtype != object}
    given |= {"turned": np.asfortranarray(given["cube"]), "large": given["real"].astype(">f8"), "bytes": np.array(b"a")}
    buffer = io.BytesIO()
    how(buffer, **given)
    found = npz_arrays(buffer.getvalue(), everything)
    assert set(found) == set(given)
    for name, value in given.items():
        assert found[name].dtype == value.dtype and np.array_equal(found[name], value), name


def test_texts_are_those_of_lists_cells_and_rows():
    read = mat_arrays(written(GIVEN), everything)
    assert texts_of(read["cells"]) == ["tool:z", "x", ""] and texts_of(read["rows"]) == ["abc", "de", "f"]
    assert texts_of(["a ", "b"]) == ["a", "b"] and texts_of("a") == ["a"] and texts_of(np.array(["a"])) == ["a"]
    for other in (None, 3, [1], [["a"]], {}, np.ones(2), read["mixed"]):
        assert texts_of(other) is None


def law():
    return {
        "A": np.array([[-30.0, 1.0], [0.0, -2.0]]), "B": np.ones((2, 1)), "C": np.ones((1, 2)), "D": np.zeros((1, 1)),
        "inputs": np.array(["stroke:1"], dtype=object), "outputs": np.array(["drive:1"], dtype=object),
    }  # fmt: skip


def as_file(folder, ending, changes):
    given, path = law() | changes, folder / f"law{ending}"
    if ending == ".json":
        path.write_text(json.dumps({name: np.asarray(value).tolist() for name, value in given.items()}))
    elif ending == ".mat":
        savemat(path, given)
    else:
        np.savez(path, **{name: x.astype(str) if x.dtype == object else x for name, x in given.items()})
    return path


@pytest.mark.parametrize("ending", [".mat", ".npz"])
@pytest.mark.parametrize("name", ["A", "B", "C", "D", "sample"])
def test_imaginary_parts_are_not_lost(tmp_path, ending, name):
    whole = (law() | {"sample": np.array(0.1)})[name]
    path = as_file(tmp_path, ending, {name: whole + 0j})
    assert np.array_equal(read_system(path)["A"], law()["A"])
    with pytest.raises(InputError, match="no matrix of finite numbers") as error:
        read_system(as_file(tmp_path, ending, {name: whole + 1e-3j}))
    assert (error.value.file, error.value.key) == (str(path), name)


def test_imaginary_parts_are_not_lost_elsewhere(tmp_path):
    names = {"inputs": ("a",), "outputs": ("b",), "states": ("x",), "units": {}}
    one = {"A": [[-1.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]]}
    for key in one:
        for value in (np.array([[1j]]), [[1j]]):
            with pytest.raises(InputError):
                control.StateSpace(**(one | {key: value}), **names)
    for call in (
        lambda x: control.by_jacobian(x),
        lambda x: control.ControlLaw(A=x, B=x, C=x[0], D=x[0]),
        lambda x: control.ring_down(np.tile(x.ravel(), 50), 1e-3),
        lambda x: fx.modes("paper-robot.toml", x),
        lambda x: fx.model.ConstantWrench(value=np.tile(x[0], 3)),
    ):
        with pytest.raises(InputError):
            call(np.full((2, 2), 1j))
    savemat(tmp_path / "a.mat", {"frequency": np.array([1.0, 2j]), "frf": np.ones(2)})
    with pytest.raises(InputError, match="no array of numbers"):
        fx.read_frf(tmp_path / "a.mat")


@pytest.mark.parametrize("name", ["A", "D", "sample", "inputs"])
def test_integers_of_hundreds_of_digits_and_deep_lists_are_refused(tmp_path, name):
    path = tmp_path / "law.json"
    plain = {key: json.dumps(np.asarray(value).tolist()) for key, value in law().items()}
    deep = "[" * 900 + "]" * 900
    for odd in (
        "1" * 400,
        "-" + "1" * 400,
        "1" * 5000,
        f"[[{'1' * 400}]]",
        deep,
        "[" * 50 + "1" + "]" * 50,
        "[" * 100_000,
        "[[1], [1, 2]]",
        "{}",
        "null",
        '"text"',
        "[[null]]",
        "NaN",
        "[" * 100_000 + "]" * 100_000,
    ):
        if (name, odd) in (("inputs", '"text"'), ("sample", "[" * 50 + "1" + "]" * 50)):
            continue  # one name, one number
        path.write_text("{" + ", ".join(f'"{key}": {value}' for key, value in (plain | {name: odd}).items()) + "}")
        with pytest.raises(InputError):
            read_system(path)


def member(name, data, size=None, kind=zipfile.ZIP_DEFLATED):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", kind) as archive:
        archive.writestr(name, data)
    content = buffer.getvalue()
    if size is not None:  # the unpacked size, in both heads
        content = content.replace(pack("<I", len(data)), pack("<I", size))
    return content


def npy(shape, data=b"", letters="<f8"):
    head = repr({"descr": letters, "fortran_order": False, "shape": shape}).encode()
    return b"\x93NUMPY\x01\x00" + pack("<H", len(head)) + head + data


def zlib_of_zeros(size):
    machine, parts = zlib.compressobj(), []
    for _ in range(size // 1_000_000):
        parts.append(machine.compress(b"\0" * 1_000_000))
    return b"".join([*parts, machine.flush()])


def mat_bomb():
    data = zlib_of_zeros(112_000_000)
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + pack("<II", 15, len(data)) + data


def deep_cells():
    cells = np.array([1.0], dtype=object)
    for _ in range(12):
        cells = np.array([cells, 1.0], dtype=object)
    return written({"A": cells})


HOSTILE = {
    "zeros.npz": lambda: member("A.npy", npy((14_000_000,), b"\0" * 112_000_000)),
    "zeros-8.npz": lambda: member("A.npy", npy((13_000_000,), b"\0" * 13_000_000, "|b1")),
    "lies.npz": lambda: member("A.npy", npy((6_000_000,), b"\0" * 48_000_000), size=1000),
    "packed.npz": lambda: member("A.npy", npy((2,), b"\0" * 16), kind=zipfile.ZIP_LZMA),
    "shape.npz": lambda: member("A.npy", npy((10**12,))),
    "shapes.npz": lambda: member("A.npy", npy((10**12, 0, 7), b"\0")),
    "minus.npz": lambda: member("A.npy", npy((-1, -1), b"\0" * 8)),
    "nothing.npz": lambda: member("A.npy", npy((10**12,), letters="<U0")),
    "objects.npz": lambda: member("A.npy", npy((1,), b"\0" * 8, "|O")),
    "deep.npz": lambda: member("A.npy", npy((1,)).replace(b"'<f8'", b"(" * 4000)),
    "names.npz": lambda: member("inputs.npy", npy((13_000_000,), b"\0" * 13_000_000, "|S1")),
    "zeros.mat": mat_bomb,
    "deep.mat": deep_cells,
    "cells.mat": lambda: written({"A": np.array([0.0] * 10_001, dtype=object)}),
    "struct.mat": lambda: written({"A": {"a": 1.0}}),
    "rows.json": lambda: b'{"A": [' + b"[]," * 1_000_000 + b"[]]}",
    "numbers.json": lambda: b'{"A": [' + b"0," * 13_000_000 + b"0]}",
}

MEASURED = """
import sys, time
from pathlib import Path
import numpy, zipfile, json
import flexapod as fx
from flexapod.common.tables.systems import read_system
for name in sys.argv[1:]:
    began = time.process_time()
    try:
        read_system(Path(name))
        what = "read"
    except fx.InputError as error:
        what = "refused: " + error.what
    print(Path(name).name, time.process_time() - began, what, sep=chr(9))
status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines() if ":" in line)
print(int(status["VmHWM"].split()[0]) * 1024)  # of this program alone; ru_maxrss counts what its parent had, too
"""


def test_hostile_files_cost_little(tmp_path):
    """Once 94 s and 4.7 GB for 1.5 MB; the limit of memory ends a process that still asks for more."""
    paths = []
    for name, make in HOSTILE.items():
        paths.append(tmp_path / name)
        paths[-1].write_bytes(make())
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, *map(str, paths)], capture_output=True, text=True, timeout=100,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (3_000_000_000,) * 2),
    )  # fmt: skip
    *lines, memory = done.stdout.splitlines()
    assert len(lines) == len(paths), done.stderr[-2000:]
    for name, seconds, said in (line.split("\t") for line in lines):
        assert said.startswith("refused"), (name, said)
        assert float(seconds) < 5, (name, seconds)  # the slowest takes 0.3
    assert float(memory) < ROOM


def damaged(content, seed):
    """A file with some bytes of its own changed, left out, or put in, or cut off."""
    rng = np.random.default_rng(seed)
    data = bytearray(content)
    for _ in range(rng.integers(1, 4)):
        at, kind = int(rng.integers(len(data))), rng.integers(5)
        if kind == 0:
            data[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            data[at : at + 4] = pack("<I", int(rng.choice([0, 1, 2**31 - 1, 2**31, 2**32 - 1, 14, 15, 2**16, 10**6])))
        elif kind == 2:
            del data[at : at + int(rng.integers(1, 9))]
        elif kind == 3:
            data[at:at] = bytes(rng.integers(256, size=int(rng.integers(1, 9))).tolist())
        else:
            del data[at:]
        if not data:
            break
    return bytes(data)


def files(given):
    one = {name: x.astype(str) if x.dtype.kind == "O" else x for name, x in given.items()}
    for how in (np.savez, np.savez_compressed):
        buffer = io.BytesIO()
        how(buffer, **one)
        yield ".npz", buffer.getvalue()
    yield ".mat", written(given)
    yield ".mat", written(given, do_compression=True)
    yield ".mat", written({k: one[k] for k in one}, format="4")


@pytest.mark.parametrize("count", [40, 400])
def test_damaged_files_are_read_or_refused(tmp_path, count):
    """SciPy's reader ends Python on some of these. Numbers that are read nevertheless are finite ones."""
    began = time.monotonic()
    for which, (ending, content) in enumerate(files(law() | {"sample": np.array(0.5)})):
        for seed in range(count):
            (tmp_path / f"a{ending}").write_bytes(damaged(content, 1000 * which + seed))
            try:
                found = read_system(tmp_path / f"a{ending}")
            except InputError:
                continue
            assert found["A"].shape == (2, 2) and np.isfinite(found["A"]).all()
    measured = {
        "frequency": np.arange(4.0),
        "frf": np.ones((2, 1, 4)) * 1j,
        "outputs": np.array(["a", "b"], dtype=object),
    }
    for which, options in enumerate(({}, {"do_compression": True})):
        content = written(measured, **options)
        for seed in range(count):
            (tmp_path / "a.mat").write_bytes(damaged(content, 10_000 * which + seed))
            try:
                assert fx.read_frf(tmp_path / "a.mat").frequency_response.sizes["frequency"] > 0
            except InputError:
                continue
    assert time.monotonic() - began < 60


def test_a_study_names_the_file_and_what_is_wrong(tmp_path):
    (tmp_path / "law.npz").write_bytes(HOSTILE["packed.npz"]())
    text = preset_text("nano-hexapod") + '\n[control]\nlaw = "file"\nfile = "law.npz"\nsample = "1 ms"\n'
    with pytest.raises(InputError, match=r"cannot be read: A is packed") as error:
        fx.model.loads(text, path=tmp_path / "a.toml")
    assert error.value.key == "control.file"


def test_json_without_names_is_told():
    with pytest.raises(ValueError, match="no names"):
        json_arrays(b"[]", everything)
