"""Modes of a robot with its drives locked: a list at a pose, one of them drawn and animated."""

from __future__ import annotations

import math
import threading
import time
from typing import TYPE_CHECKING, Any

from viser import Icon

from flexapod import model
from flexapod.app.view import words
from flexapod.app.view.latest import Latest
from flexapod.app.view.player import Player
from flexapod.app.view.scene import Scene
from flexapod.errors import FlexapodError
from flexapod.study.words import number

if TYPE_CHECKING:
    import viser
    from xarray import Dataset

__all__ = ["RobotModes"]

SHOWN_FREQUENCY = 0.5  # of the drawn motion, whatever the mode's own [Hz]
LISTED = 24  # modes in the list
QUIET = 0.3  # after a change of the study, before its modes are computed [s]
_NONE: str = "none yet"


class RobotModes:
    """Controls of a robot's modes for one user."""

    def __init__(self, client: viser.ClientHandle, scene: Scene) -> None:
        self.client, self.scene = client, scene
        self._study: model.Study | None = None
        self._modes: Dataset | None = None
        self._begin, self._closed = 0.0, False
        self._lock = threading.RLock()
        self._player = Player(scene, self._lock, self._step, self._label)
        self._posed = Latest(self._compute)
        self._changed = Latest(self._compute, quiet=QUIET)
        gui = client.gui
        self._words = gui.add_html("")
        self._choice = gui.add_dropdown("mode", [_NONE], initial_value=_NONE)
        self._play = gui.add_button("Animate", icon=Icon.PLAYER_PLAY, disabled=True, hint="Show the chosen mode moving")
        self._amplitude = gui.add_slider("amplitude [% of the robot]", 1.0, 25.0, 0.5, 8.0)
        self._phase = gui.add_slider("phase [deg]", 0.0, 360.0, 1.0, 90.0)
        self._pose = self._make_pose(gui)
        self._table = gui.add_html("")
        self._choice.on_update(lambda event: self.play() if event.client is not None else None)
        self._play.on_click(lambda _: self.pause() if self._player.playing else self.play())
        for slider in (self._amplitude, self._phase):
            slider.on_update(lambda event: self._draw() if event.client is not None else None)

    def show_study(self, study: model.Study) -> None:
        """List the modes of another study at the chosen pose; computed in the background."""
        self.pause()
        with self._lock:
            self._study, self._modes = study, None
        self._changed.request()

    def play(self) -> None:
        """Show the chosen mode moving."""
        with self._lock:
            if self._modes is not None:
                self._begin = time.perf_counter()
                self._player.start()

    def pause(self) -> None:
        """Stand still."""
        self._player.stop()

    def close(self) -> None:
        """Stop, and drop what was computed."""
        self._player.close()
        self._posed.close()
        self._changed.close()
        with self._lock:
            self._closed, self._study, self._modes = True, None, None

    def _step(self, passed: float) -> bool:
        turned = 360.0 * SHOWN_FREQUENCY * (time.perf_counter() - self._begin)
        self._show((self._phase.value + turned) % 360.0)
        return self._modes is not None

    def _draw(self) -> None:
        """Draw the mode at rest in time, at the phase of the slider."""
        with self._lock:
            if not self._player.playing:
                self.scene.driver = None
                self._show(self._phase.value)

    def _show(self, phase: float) -> None:
        if self._modes is not None:
            share = math.sin(math.radians(phase))
            self.scene.show_mode(self._modes, self._chosen(), 0.01 * self._amplitude.value, share)

    def _chosen(self) -> int:
        return self._choice.options.index(self._choice.value) + 1

    def _label(self, playing: bool) -> None:
        self._play.label = "Pause" if playing else "Animate"
        self._play.icon = Icon.PLAYER_PAUSE if playing else Icon.PLAYER_PLAY

    def _compute(self) -> None:
        """Modes at the pose of the sliders, or in words why there are none."""
        from flexapod import study as fx

        study, pose = self._study, self._at()
        if study is None:
            return
        try:
            found, said = fx.modes(study, pose), ""
        except FlexapodError as error:
            found, said = None, words.error_html(error)
        except Exception as error:
            found, said = None, words.fault_html(error)
        with self._lock:
            if study is not self._study or self._closed:
                return
            self._modes = found
            self._words.content = said
            self._play.disabled = found is None
            self._list(found)

    def _list(self, found: Dataset | None) -> None:
        place = self._chosen()
        if found is None:
            self.pause()
            self._table.content = ""
            return
        rows = [
            [str(int(m)), number(float(f), 4), number(100 * float(d), 3), str(kind)]
            for m, f, d, kind in zip(found.mode, found.frequency, found.damping_ratio, found.kind.values, strict=True)
        ][:LISTED]
        options = tuple(f"{m}: {f} Hz, {kind}" for m, f, _, kind in rows)
        self._choice.options = options
        self._choice.value = options[min(place, len(options)) - 1]
        header = ["Mode", "frequency [Hz]", "damping [%]", "what moves most"]
        more = found.sizes["mode"] - len(rows)
        self._table.content = (
            words.table_html(header, rows)
            + (words.block(f"and {more} higher ones", "soft") if more > 0 else "")
            + words.block("Drives locked, about the static equilibrium at the pose above.", "soft")
        )

    def _make_pose(self, gui: viser.GuiApi) -> dict[str, Any]:
        """Sliders of the pose from home: millimetres and degrees."""
        with gui.add_folder("Pose from home"):
            lengths = {name: gui.add_slider(f"{name} [mm]", -400.0, 400.0, 1.0, 0.0) for name in model.AXES[:3]}
            angles = {name: gui.add_slider(f"{name} [deg]", -60.0, 60.0, 0.5, 0.0) for name in model.AXES[3:]}
            home = gui.add_button("Home", icon=Icon.HOME)
        sliders = {**lengths, **angles}
        for slider in sliders.values():
            slider.on_update(lambda event: self._moved() if event.client is not None else None)
        home.on_click(lambda _: self._go_home())
        return sliders

    def _at(self) -> dict[str, float]:
        """The pose of the sliders in m and rad."""
        units = [1e-3] * 3 + [math.pi / 180] * 3
        return {name: unit * self._pose[name].value for name, unit in zip(model.AXES, units, strict=True)}

    def _go_home(self) -> None:
        for slider in self._pose.values():
            slider.value = 0.0
        self._moved()

    def _moved(self) -> None:
        """Draw the undeformed robot at once; its modes follow."""
        if not self._player.playing:
            self.scene.driver = None
            self.scene.show_pose(self._at())
        self._posed.request()
