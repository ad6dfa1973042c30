"""Reading regular files of bounded size, and writing whole ones."""

import errno
import os
import stat
import subprocess
import tempfile
from pathlib import Path

import pytest

from flexapod import model
from flexapod.common import files
from flexapod.common.errors import InputError
from flexapod.common.files import atomic_file, read_bytes, read_text, replace_file
from flexapod.common.tables import csv_tables
from flexapod.design.sweeps.plan import read_plan
from flexapod.mechanics.symbolic import cache
from flexapod.model import preset_text

pytestmark = pytest.mark.unit

resource = pytest.importorskip("resource")  # and pipes: neither is on Windows


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    return path


@pytest.mark.parametrize("read", [model.load, read_plan, lambda path: csv_tables.read_table(path, csv_tables.POSE)])
@pytest.mark.parametrize("place", ["pipe", "/dev/zero", "/dev/full"])
def test_what_is_not_a_regular_file_is_refused(pipe, read, place):
    """A pipe without a writer once hung for ever, /dev/zero filled the memory."""
    with pytest.raises(InputError, match="cannot be read: it is not a regular file"):
        read(pipe if place == "pipe" else Path(place))


def test_sizes_are_bounded(tmp_path, monkeypatch):
    path = tmp_path / "large.toml"
    path.touch()
    os.truncate(path, files.LARGEST_TABLE + 1)  # no space is taken
    for read in (model.load, read_plan, lambda path: csv_tables.read_table(path, csv_tables.POSE)):
        with pytest.raises(InputError, match=r"cannot be read: it is larger than 100? MB"):
            read(path)
    # what grows while it is read, or tells no size, is bounded too
    path.write_bytes(b"123456")
    monkeypatch.setattr(files, "_refuse", lambda found, most: None)
    with pytest.raises(OSError, match="larger than"):
        read_bytes(path, 5)
    assert read_bytes(path, 6) == b"123456"


def test_texts(tmp_path):
    path = tmp_path / "text"
    path.write_bytes(b"\xef\xbb\xbf\xc2\xb5")
    assert read_text(path, 10) == "µ"
    path.write_bytes(b"\xb5")
    with pytest.raises(OSError, match="not UTF-8 text"):
        read_text(path, 10)


@pytest.mark.parametrize("read", [model.load, lambda path: csv_tables.read_table(Path(path), csv_tables.POSE)])
def test_a_name_with_a_zero_byte(read):
    with pytest.raises(InputError, match="its name holds a zero byte"):
        read("a\0b")


def test_a_pipe_in_the_cache_of_kernels_is_removed(tmp_path):
    os.mkfifo(tmp_path / f"{'a' * 32}-{'b' * 16}.so")
    assert cache.intact_libraries(tmp_path, "a" * 32) == []
    assert list(tmp_path.iterdir()) == []


def test_a_file_appears_whole_or_not_at_all(tmp_path):
    path = tmp_path / "deep" / "a.txt"
    for end in (KeyboardInterrupt, OSError, ValueError):
        with pytest.raises(end), atomic_file(path) as temporary:
            temporary.write_text("half", encoding="utf-8")
            raise end
        assert list(path.parent.iterdir()) == []
    with replace_file(path) as temporary:
        temporary.write_text("whole", encoding="utf-8")
    assert path.read_text(encoding="utf-8") == "whole"
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


def limited(size):
    """No file of this process may become larger: what a full disk is to its writers."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


@pytest.fixture
def full():
    """Files of this process may have 8 kB."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    limited(8192)
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_in_words(tmp_path, full):
    path = tmp_path / "a.bin"
    with (
        pytest.raises(InputError, match=r"a.bin: cannot be written: File too large.*has space"),
        replace_file(path) as part,
    ):
        part.write_bytes(bytes(20_000))
    assert list(tmp_path.iterdir()) == []


def test_names_that_are_not_utf8_are_refused_before_anything_is_computed(tmp_path):
    """They were computed with, then lost: neither NetCDF nor reports can hold them."""
    bad = os.fsdecode(os.fsencode(tmp_path) + b"/b\xe9")
    with pytest.raises(InputError, match=r"b\\udce9: has a name that is not UTF-8 text"):
        model.load(bad)
    with pytest.raises(InputError, match="not UTF-8"):
        read_plan(bad)
    with pytest.raises(InputError, match="not UTF-8"):
        model.loads(preset_text("paper-robot"), path=bad)
    with pytest.raises(InputError, match="not UTF-8"), replace_file(bad):
        pass


def test_files_are_waited_for(tmp_path, monkeypatch):
    waited = []
    monkeypatch.setattr(files.os, "fsync", lambda handle: waited.append(stat.S_ISDIR(os.fstat(handle).st_mode)))
    with atomic_file(tmp_path / "a" / "b" / "c") as temporary:
        temporary.write_text("x", encoding="utf-8")
    assert waited == [False, True, True, True]  # the file, its folder, and the folders that were made


def test_folders_that_cannot_be_waited_for(tmp_path, monkeypatch):
    def refuse(handle):
        raise OSError(errno.EINVAL, "not here")

    monkeypatch.setattr(files.os, "fsync", refuse)
    files.sync_folder(tmp_path)


def named(process, dot=".", machine=None):
    """A name that this process of this machine gives to what it writes."""
    return f"{dot}flexapod-{machine or files._here()}-{process}-0123456789ab"


@pytest.fixture
def gone():
    """The number of a process that has ended."""
    child = subprocess.Popen(["true"])
    child.wait()
    return child.pid


def test_what_killed_processes_left_is_removed_by_the_next_that_writes_there(tmp_path, gone):
    removed = [f"{named(gone)}.nc", f"{named(gone)}.png", named(gone), ".flexapod-0123"]
    # Of another machine, and of names that tell no process, age decides; what is not such a name is somebody's.
    kept = [f"{named(os.getppid())}.nc", named(gone, machine="0" * 8), ".flexapod-4567", ".flexapod.toml"]
    for name in (*removed, *kept):
        (tmp_path / name).write_text("half", encoding="utf-8")
    for name in (".flexapod-0123", ".flexapod.toml"):
        os.utime(tmp_path / name, (0, 0))
    (tmp_path / f"{named(gone)}.zarr" / "c").mkdir(parents=True)
    with atomic_file(tmp_path / "a.nc"):
        pass
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["a.nc", *kept])


def test_folders_of_killed_processes_in_the_temporary_one(tmp_path, gone, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    left = tmp_path / named(gone, "")
    (left / "deep").mkdir(parents=True)
    (left / "deep" / "kernel.c").touch()
    kept = [tmp_path / name for name in ("flexapod-results", named(os.getppid(), ""))]
    for path in kept:
        path.mkdir()
    with pytest.raises(KeyboardInterrupt), files.temporary_folder() as folder:
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        (folder / "a").touch()
        assert sorted(tmp_path.iterdir()) == sorted([*kept, folder])
        raise KeyboardInterrupt
    assert sorted(tmp_path.iterdir()) == sorted(kept)


def test_only_files_are_replaced(tmp_path, pipe):
    """Whoever may write to a folder of devices once got a file in place of the device."""
    place = pipe
    for path, words in ((place, "not a regular file"), (tmp_path, "Is a directory"), (Path("."), "Is a directory")):
        with pytest.raises(InputError, match=words), replace_file(path):
            pytest.fail("it is written")
    assert stat.S_ISFIFO(place.stat().st_mode)
