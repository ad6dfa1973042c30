"""`flexapod cache`: what is kept, and how it goes."""

import json
import sys

import pytest

pytestmark = pytest.mark.cli

NAMES = [f"{i:032x}-{i:016x}.so" for i in range(3)]


@pytest.fixture
def kernels(folder, monkeypatch):
    place = folder / "kernels"
    monkeypatch.setenv("FLEXAPOD_CACHE", str(place))
    monkeypatch.delenv("FLEXAPOD_CACHE_MEGABYTES", raising=False)
    place.mkdir(mode=0o700)
    for name in NAMES:
        (place / name).write_bytes(b"x" * 500_000)
    (place / "notes.txt").write_text("mine")
    (place / ".flexapod-abc.so").write_text("left by a process that was killed")
    return place


def test_what_is_kept(flexapod, kernels):
    result = flexapod("cache")
    assert result.exit_code == 0
    assert result.stdout == f"Folder: {kernels}\n3 compiled kernels, 1.5 MB of at most 256 MB\n"
    assert json.loads(flexapod("cache", "--json").stdout) == {
        "folder": str(kernels),
        "kernels": 3,
        "bytes": 1_500_000,
        "limit_bytes": 256_000_000,
        "unused_because": None,
    }


def test_clear_removes_kernels_and_nothing_else(flexapod, kernels):
    result = flexapod("cache", "--clear")
    assert result.exit_code == 0
    assert result.stdout == f"Removed 3 compiled kernels (1.5 MB) from {kernels}.\n"
    assert [path.name for path in kernels.iterdir()] == ["notes.txt"]
    assert json.loads(flexapod("cache", "--clear", "--json").stdout) == {
        "folder": str(kernels),
        "removed": 0,
        "bytes": 0,
    }


def test_a_folder_that_is_not_there_is_not_made(flexapod, folder, monkeypatch):
    monkeypatch.setenv("FLEXAPOD_CACHE", str(folder / "none"))
    assert "0 compiled kernels, 0 MB" in flexapod("cache").stdout
    assert flexapod("cache", "--clear").exit_code == 0
    assert not (folder / "none").exists()


def test_a_folder_that_is_not_used_is_said_to_be(flexapod, kernels, monkeypatch):
    if sys.platform != "win32":
        kernels.chmod(0o777)
        assert "Not used: others may write to it" in flexapod("cache").stdout
    for place in (kernels / "notes.txt", kernels / "notes.txt" / "below"):
        monkeypatch.setenv("FLEXAPOD_CACHE", str(place))
        assert "Not used: " in flexapod("cache").stdout


def test_kernels_that_cannot_be_removed(flexapod, kernels):
    (kernels / NAMES[0]).unlink()
    (kernels / NAMES[0]).mkdir()  # unlink refuses a folder, to root as well
    result = flexapod("cache", "--clear")
    assert result.exit_code == 1
    assert "1 of 3 kernels" in result.stderr


def test_a_bound_that_is_none(flexapod, kernels, monkeypatch):
    monkeypatch.setenv("FLEXAPOD_CACHE_MEGABYTES", "1 GB")
    result = flexapod("cache")
    assert result.exit_code == 2
    assert "FLEXAPOD_CACHE_MEGABYTES = 1 GB" in result.stderr
    assert "allowed" in result.stderr
