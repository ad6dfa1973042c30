"""Studies that are computed in a moment, or for minutes: texts of presets with pieces replaced."""

from pathlib import Path

from tests.helpers.texts import replaced

from flexapod.model import preset_text

#: A motion of 0.2 s: computed in a moment.
SHORT = (
    ('duration = "1 s" ', 'duration = "0.15 s" '),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
    ('amplitude = "26.6 deg"', 'amplitude = "2 deg"'),
)

#: The same of a robot whose legs only stretch.
BRIEF = (*SHORT, ('fidelity = "assumed-modes"', 'fidelity = "lumped"'), ("tolerance = 1e-4", 'step = "1 ms"'))

#: A motion that is computed for minutes, unless somebody cancels it.
LONG = (
    ('duration = "2 s" ', 'duration = "1000 s" '),
    ("tolerance = 1e-4", 'step = "0.5 ms"\noutput_step = "10 ms"'),
    ('hold = "1 s" ', 'hold = "999 s" '),
)

#: An actuator in space, for a second.
SPACE = (Path(__file__).parents[2] / "examples" / "actuator-in-space.toml").read_text(encoding="utf-8")
SPACE = SPACE.replace('duration = "2.5 s"', 'duration = "1 s"\ntolerance = 1e-2')


def study_text(*changes: tuple[str, str], preset: str = "paper-robot") -> str:
    """The text of a preset with pieces replaced."""
    return replaced(preset_text(preset), *changes)
