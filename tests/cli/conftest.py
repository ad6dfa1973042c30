"""The command as a user types it, in an empty folder of its own."""

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from flexapod.app.cli.cli import app
from flexapod.model import preset_text

Command = Callable[..., Result]


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def flexapod(folder) -> Command:
    """`flexapod("check", "a.toml")` -> exit_code, stdout, stderr."""
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments], prog_name="flexapod")


@pytest.fixture
def study(folder) -> Callable[..., Path]:
    """A file from a preset, with pieces of its text replaced: `study(("100 kg", "-100 kg"))`."""

    def write(*changes: tuple[str, str], preset: str = "paper-robot", more: str = "") -> Path:
        text = preset_text(preset)
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in {preset}"
            text = text.replace(old, new)
        path = folder / "study.toml"
        path.write_text(text + more, encoding="utf-8")
        return Path(path.name)

    return write


#: A short run: 0.2 s of a robot whose legs only stretch.
SHORT = (
    ('duration = "1 s" ', 'duration = "0.15 s" '),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
    ('amplitude = "26.6 deg"', 'amplitude = "2 deg"'),
    ('fidelity = "assumed-modes"', 'fidelity = "lumped"'),
    ("tolerance = 1e-4", 'step = "1 ms"'),
)
