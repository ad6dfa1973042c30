"""Modes of a single actuator's beam at a free length, hub and extension held: a list, one of them animated."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod import model
from flexapod.app.view import words
from flexapod.app.view.dial import Dial
from flexapod.app.view.listed_modes import Listed, ListedModes
from flexapod.app.view.threads import Threads
from flexapod.scene.geometry import BEAM_POINTS
from flexapod.study.words import number, text

if TYPE_CHECKING:
    import viser

    from flexapod.scene.beam_modes import BeamModes as Modes

__all__ = ["BeamModes"]

QUIET = 0.1  # after the slider has moved, before the modes are computed [s]
MOST = 12  # shapes


class BeamModes(ListedModes[model.ActuatorStudy]):
    """Length and number of shapes of a beam, and the modes they give, for one user."""

    size = "the free length"

    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        def moved() -> None:
            self._moved(QUIET)

        self._length = Dial(
            gui, threads, "free length", "m", (0.0, 1.0), 0.01, 0.5, moved, dimension="length", hint="Outside the hub"
        )
        self._count = Dial(gui, threads, "shapes", "", (1, MOST), 1, 3, moved, hint="Lateral shapes, and modes")

    def _fit(self, study: model.ActuatorStudy) -> None:
        actuator = study.actuator
        self._length.fit(0.05 * actuator.length, actuator.length, 0.005 * actuator.length)
        self._length.value = actuator.free_length
        self._count.value = min(MOST, max(1, study.simulation.modes))

    def _listed(self, study: model.ActuatorStudy) -> Listed:
        from flexapod.scene.beam_modes import beam_modes

        still = _still(study, self._length.value, int(self._count.value))
        found = beam_modes(still, BEAM_POINTS)
        kinds = [f", {kind}" if study.actuator.space else "" for kind in found.kind]
        names = [
            f"{i}: {number(f, 4)} Hz{kind}" for i, (f, kind) in enumerate(zip(found.frequency, kinds, strict=True), 1)
        ]
        return Listed(
            found, names, _table(found, still), f"{text(found.free_length, 'm', 4)} of free length", found.free_length
        )

    def _preview(self, study: model.ActuatorStudy) -> None:
        self.scene.show_pose(self._length.value)


def _still(study: model.ActuatorStudy, length: float, count: int) -> model.ActuatorStudy:
    """The study at rest at a free length [m] with a number of shapes."""
    return study.replace(
        actuator=study.actuator.replace(free_length=length),
        simulation=study.simulation.replace(modes=count, duration=study.duration),
        motion=model.ActuatorMotion(),
        load=model.ActuatorLoad(),
    )


def _table(modes: Modes, study: model.ActuatorStudy) -> str:
    """Frequencies and damping as HTML, and the sag where the beam lies level."""
    from flexapod.study.before.describe.actuator import describe_actuator

    rows = [
        [str(i), number(f, 4), number(100 * d, 3), kind]
        for i, (f, d, kind) in enumerate(zip(modes.frequency, modes.damping_ratio, modes.kind, strict=True), start=1)
    ]
    sag = describe_actuator(study).beam[0].sag
    level = f"The tip sags by {text(sag, 'm')} where the beam lies level. " if sag else ""
    note = level + "Hub and extension held, about the straight beam at rest."
    return words.table_html(["Mode", "frequency [Hz]", "damping [%]", "what moves"], rows) + words.block(note, "soft")
