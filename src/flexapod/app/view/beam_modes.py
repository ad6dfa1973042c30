"""Modes of a single actuator's beam at a free length: frequencies and damping, rotation and extension held."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.app.view import words
from flexapod.app.view.latest import Latest
from flexapod.app.view.scene import Scene
from flexapod.errors import FlexapodError
from flexapod.study.words import number, text

if TYPE_CHECKING:
    import viser

__all__ = ["BeamModes"]

QUIET = 0.2  # after a change, before the modes are computed [s]


class BeamModes:
    """Length and number of shapes of a beam, and the frequencies they give, for one user."""

    def __init__(self, client: viser.ClientHandle, scene: Scene) -> None:
        self.client, self.scene = client, scene
        self._study: model.ActuatorStudy | None = None
        self._latest = Latest(self._compute, quiet=QUIET)
        gui = client.gui
        self._length = gui.add_slider("free length [m]", 0.0, 1.0, 0.01, 0.5, hint="Length outside the hub")
        self._count = gui.add_slider("shapes", 1, 12, 1, 3, hint="Number of lateral shapes")
        self._words = gui.add_html("")
        for slider in (self._length, self._count):
            slider.on_update(lambda event: self._moved() if event.client is not None else None)

    def show_study(self, study: model.ActuatorStudy) -> None:
        """List the modes of another study; computed in the background."""
        actuator = study.actuator
        self._study = study
        self._length.min, self._length.max = 0.05 * actuator.length, actuator.length
        self._length.precision = max(0, math.ceil(2 - math.log10(actuator.length)))
        self._length.step, self._length.value = 0.005 * actuator.length, actuator.free_length
        self._count.value = min(12, max(1, study.simulation.modes))
        self._latest.request()

    def pause(self) -> None:
        """Nothing moves here."""

    def close(self) -> None:
        """Drop the study."""
        self._latest.close()
        self._study = None

    def _moved(self) -> None:
        if self._study is not None:
            self.scene.driver = None
            self.scene.show_pose((self._study.actuator.angle, self._length.value))
            self._latest.request()

    def _compute(self) -> None:
        study = self._study
        if study is None:
            return
        try:
            self._words.content = _described(study, self._length.value, self._count.value)
        except FlexapodError as error:
            self._words.content = words.error_html(error)
        except Exception as error:
            self._words.content = words.fault_html(error)


def _described(study: model.ActuatorStudy, length: float, count: int) -> str:
    """Frequencies and damping of the beam at a free length [m] with a number of shapes."""
    from flexapod.study.describe.actuator import describe_actuator

    still = model.ActuatorMotion()
    actuator = study.actuator.replace(free_length=length)
    simulation = study.simulation.replace(modes=count, duration=study.duration)
    changed = study.replace(actuator=actuator, simulation=simulation, motion=still, load=model.ActuatorLoad())
    beam = describe_actuator(changed).beam[0]
    if beam.problem is not None:
        return words.block(beam.problem, "error")
    rows = [
        [str(i), number(f, 4), number(100 * d, 3)]
        for i, (f, d) in enumerate(zip(beam.frequency, beam.damping_ratio, strict=True), start=1)
    ]
    sag = f"The tip sags by {text(beam.sag, 'm')} where the beam lies level. " if beam.sag else ""
    note = sag + "Rotation and extension held, about the straight beam at rest."
    return words.table_html(["Mode", "frequency [Hz]", "damping [%]"], rows) + words.block(note, "soft")
