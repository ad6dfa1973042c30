"""Modes in the background: the newest study's are listed, one of them is drawn and animated."""

from __future__ import annotations

import math
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

import viser
from viser import Icon

from flexapod.app.browser import markup
from flexapod.app.browser.background import Debouncer, Threads
from flexapod.app.browser.scene import PageScene
from flexapod.app.browser.text_fields import NumberField, user_callback
from flexapod.app.browser.time_panel import Player
from flexapod.common.errors import FlexapodError
from flexapod.common.quantities import text

SHOWN_FREQUENCY = 0.5  # of the drawn motion, whatever the mode's own [Hz]
_NONE: str = "none yet"


class ModePlayer:
    """Choice of a mode, button, amplitude and phase for one user.

    `draw` is called with the place of the mode in the list (0 is the first), amplitude as a share, phase between -1 and
    1; `size`: what the amplitude is a share of.
    """

    lock: threading.RLock

    def __init__(
        self,
        gui: viser.GuiApi,
        scene: PageScene,
        threads: Threads,
        draw: Callable[[int, float, float], None],
        size: str,
    ) -> None:
        self._scene, self._draw, self._some = scene, draw, False
        self._begin, self.lock = 0.0, threading.RLock()
        self._player = Player(scene, threads, self.lock, self._step, self._label)
        self._choice = gui.add_dropdown("mode", [_NONE], initial_value=_NONE)
        self._play = gui.add_button("Animate", icon=Icon.PLAYER_PLAY, disabled=True, hint="Show the chosen mode moving")
        self._amplitude = NumberField(gui, threads, "amplitude", "%", (1.0, 25.0), 0.5, 8.0, self._still)
        self._phase = NumberField(gui, threads, "phase", "deg", (0.0, 360.0), 1.0, 90.0, self._still, dimension="angle")
        self._size, self._note = size, gui.add_html("")
        self._choice.on_update(user_callback(self.play))
        self._play.on_click(lambda _: self.pause() if self.playing else self.play())

    @property
    def playing(self) -> bool:
        """True while a mode is animated."""
        return self._player.playing

    def offer(self, modes: Sequence[str], length: float) -> None:
        """List other modes; the place of the chosen one stays. An empty list: nothing to show, nothing moves.

        `length` [m] that amplitudes are a share of.
        """
        if not modes:
            self.pause()
        with self.lock:
            place = self._place()
            self._some = bool(modes)
            self._play.disabled = not modes
            if modes:
                slowed = f"Whatever its frequency, a mode is drawn at {SHOWN_FREQUENCY:g} Hz."
                self._note.content = markup.block(f"{slowed} 100 % of {self._size}: {text(length, 'm')}.", "soft")
                self._choice.options = tuple(modes)
                self._choice.value = modes[min(place, len(modes) - 1)]

    def play(self) -> None:
        """Show the chosen mode moving."""
        with self.lock:
            if self._some:
                self._begin = time.perf_counter()
                self._player.start()

    def pause(self) -> None:
        """Stand still."""
        self._player.stop()

    def close(self) -> None:
        """Stop; nothing is drawn any more."""
        self._player.close()
        with self.lock:
            self._some = False

    def _step(self, passed: float) -> bool:
        turned = 360.0 * SHOWN_FREQUENCY * (time.perf_counter() - self._begin)
        self._show((self._phase.value + turned) % 360.0)
        return self._some

    def _still(self) -> None:
        """Draw the mode at rest in time, at the phase of the slider."""
        with self.lock:
            if not self.playing:
                self._scene.driver = None
                self._show(self._phase.value)

    def _show(self, phase: float) -> None:
        if self._some:
            self._draw(self._place(), 0.01 * self._amplitude.value, math.sin(math.radians(phase)))

    def _place(self) -> int:
        return self._choice.options.index(self._choice.value)

    def _label(self, playing: bool) -> None:
        self._play.label = "Pause" if playing else "Animate"
        self._play.icon = Icon.PLAYER_PAUSE if playing else Icon.PLAYER_PLAY


CHANGED = 0.3  # after a change of the study, before its modes are computed [s]
Study = TypeVar("Study")


class ModeTable(NamedTuple):
    """Modes: what the scene draws, their names in the choice, their table as HTML.

    `where` they are taken, in words; `length` [m] that amplitudes are a share of.
    """

    modes: Any
    names: list[str]
    table: str
    where: str = ""
    length: float = 0.0


class ModeControls(ABC, Generic[Study]):
    """Controls of modes for one user; the `scene` draws them."""

    size: str
    """What amplitudes are a share of."""
    client: viser.ClientHandle
    scene: PageScene

    def __init__(self, client: viser.ClientHandle, scene: PageScene, threads: Threads) -> None:
        self.client, self.scene = client, scene
        self._study: Study | None = None
        self._modes: Any = None
        self._where = ""
        self._latest = Debouncer(threads, self._compute)
        self._words = client.gui.add_html("")
        self._show = ModePlayer(client.gui, scene, threads, self._draw, self.size)
        self._add_controls(client.gui, threads)
        self._table = client.gui.add_html("")

    @abstractmethod
    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        """Inputs of what the modes depend on besides the study."""

    @abstractmethod
    def _fit(self, study: Study) -> None:
        """Bring those inputs to another study."""

    @abstractmethod
    def _listed(self, study: Study) -> ModeTable:
        """The modes of a study with these inputs."""

    @abstractmethod
    def _preview(self, study: Study) -> None:
        """Draw the undeformed mechanism with these inputs."""

    def show_study(self, study: Study) -> None:
        """List the modes of another study; computed in the background."""
        self._show.pause()
        with self._show.lock:
            self._study, self._modes = study, None
        self._fit(study)
        self._latest.request(CHANGED)

    def pause(self) -> None:
        """Stand still."""
        self._show.pause()

    def close(self) -> None:
        """Stop, and drop what was computed."""
        self._show.close()
        self._latest.close()
        with self._show.lock:
            self._study = self._modes = None

    def _moved(self, quiet: float = 0.0) -> None:
        """Draw the undeformed mechanism at once; its modes follow."""
        study = self._study
        if study is not None:
            if not self._show.playing:
                self.scene.driver = None
                self._preview(study)
            self._latest.request(quiet)

    def _draw(self, place: int, amplitude: float, phase: float) -> None:
        if self._modes is not None:
            self.scene.show_mode(self._modes, place + 1, amplitude, phase, self._where)

    def _compute(self) -> None:
        """Compute and list the modes, or show why there are none."""
        study = self._study
        if study is None:
            return
        found, said = ModeTable(None, [], ""), ""
        try:
            found = self._listed(study)
        except FlexapodError as error:
            said = markup.error_html(error)
        finally:  # a fault, too, leaves no modes of the study before
            with self._show.lock:
                if study is self._study:
                    self._modes, self._where = found.modes, found.where
                    self._words.content, self._table.content = said, found.table
                    self._show.offer(found.names, found.length)
