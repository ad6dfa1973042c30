"""No file that is written for other programs tells where, on which machine and by whom it was made."""

import platform
import socket
import zipfile
from pathlib import Path

import pytest

import flexapod as fx
from flexapod.model import override, preset_text
from flexapod.output.exchange.formats import FORMATS

pytestmark = pytest.mark.consistency

FOLDER = "a-private-folder-of-somebody"
USER, MACHINE = "somebody-private", "a-private-machine"
STEPPED = ("fmu", "c")


def content_of(path):
    """Bytes of a file; of an archive those of all that is in it, unpacked."""
    if not zipfile.is_zipfile(path) or path.suffix == ".npz":
        return path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        return b"".join(name.encode() + archive.read(name) for name in archive.namelist())


@pytest.mark.parametrize("format", FORMATS)
def test_neither_paths_nor_names_of_machine_and_user_are_told(format, tmp_path, monkeypatch):
    folder = tmp_path / FOLDER
    folder.mkdir()
    monkeypatch.chdir(folder)
    for name in ("USER", "LOGNAME", "LNAME", "USERNAME"):
        monkeypatch.setenv(name, USER)
    for place in (platform, socket):
        monkeypatch.setattr(place, "node" if place is platform else "gethostname", lambda: MACHINE)
    (folder / "study.toml").write_text(preset_text("tripod"), encoding="utf-8")
    study = override(fx.load(folder / "study.toml"), output_step=0.1)
    options = {"step": 5e-4} if format in STEPPED else {}
    found = fx.export(study, format, folder / f"written{(*FORMATS[format].endings, '')[0]}", **options)
    for path in found.files:
        content = content_of(path)
        for word in (FOLDER, USER, MACHINE, str(tmp_path), str(fx.__path__[0]), str(Path.home())):
            assert word.encode() not in content, (path.name, word)
            assert word.encode("utf-16-le") not in content, (path.name, word)
