"""Base of both scenes: one user's scene, parts to hide, factor on deflections, driver of its motion."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from flexapod.app.browser.markup import run_script
from flexapod.common.arrays import Array
from flexapod.common.quantities import number, text

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.output.scene.geometry import BeamMotion, RobotMotion

STRAIGHT = "Drawn without deflections."

#: What can be shown and hidden, and whether it is shown at first.
PARTS = {"rigid ghost": True, "paths": True, "deviation arrow": True, "labels": True, "frames": False, "grid": True}


#: Parts that show a result: hidden while there is none.
OF_RESULTS = ("rigid ghost", "paths", "deviation arrow")


class PageScene(ABC):
    """One user's scene. Every method may be called from any thread.

    `data`: the result that is shown over time, or None; `scale`: factor on deflections; `driver`: who moves the scene
    by itself (`Player`), who finds another one here stops; `quantities`: what `colour_by` takes; `point`: whose
    deviation is drawn, ``tool`` of a robot whose tool is apart, unless the user wants ``com``; `drawn`: in words what
    is drawn where that is not the result over time, else ""; `told` is called where what is drawn, or the factor on it,
    has become another.
    """

    client: viser.ClientHandle
    lock: threading.RLock
    scale: float
    automatic: float
    time: float
    quantity: str
    point: str
    drawn: str

    quantities: tuple[str, ...] = ("plain",)

    def __init__(self, client: viser.ClientHandle) -> None:
        self.client, self.lock = client, threading.RLock()
        self.data: Dataset | None = None
        self.scale, self.automatic, self.time = 1.0, 1.0, 0.0
        self.driver: object | None = None
        self._factor: float | None = None  # the user's, in place of the automatic one
        self.quantity, self.point, self._wanted = "plain", "com", "tool"
        self.drawn, self._note = "", ""
        self.told: Callable[[], None] = _nothing
        self._shown = dict(PARTS)
        self._parts: dict[str, list[Any]] = {name: [] for name in PARTS}
        self._now: tuple[str, ...] = ()
        self._closed = False
        self._away: Array

    @property
    def points(self) -> tuple[str, ...]:
        """Points whose deviation the result has, the one that matters most first."""
        return ("com",)

    @abstractmethod
    def show_study(self, study: Any) -> None:
        """Draw a study undeformed at the instant that was shown, at first the start; no result is shown any more."""

    @abstractmethod
    def show_pose(self, pose: Any) -> None:
        """Draw the undeformed mechanism at a pose, without ghost, paths and arrow."""

    def show_data(self, data: Dataset | None) -> None:
        """Take a result of the study that is shown and draw it, deflections magnified so that they are seen."""
        with self.lock:
            if self._closed:
                return
            self.data = data
            motion = self._take(data)
            if motion is None:
                self._only()
                return
            self.automatic = motion.automatic_scale()
            self.scale = self._factor or self.automatic
            self._redraw_paths()
            self.set_time(min(self.time, float(motion.time[-1])))
            self.told()

    @abstractmethod
    def set_time(self, time: float) -> None:
        """Draw the stored instant nearest to `time` [s]; only what changes is sent."""

    @abstractmethod
    def show_mode(self, modes: Any, mode: int, amplitude: float, phase: float, where: str = "") -> None:
        """Draw a mode: number from 1, largest displacement as a share of the mechanism's size, phase between -1 and 1.

        `modes`: of a robot the result of `flexapod.modes`, of a single actuator `scene.robot.BeamModes`; `where`:
        in words the pose or length that they belong to.
        """

    @abstractmethod
    def legend(self) -> str:
        """Legend of the colours, as HTML."""

    def set_scale(self, factor: float | None) -> None:
        """Draw deflections `factor` times larger; None: the automatic factor."""
        with self.lock:
            self._factor = None if factor is None else max(1.0, float(factor))
            self.scale = self._factor or self.automatic
            if self.data is not None:
                self._redraw_paths()
                self.set_time(self.time)
                self.told()

    def show_point(self, point: str) -> None:
        """Draw path and deviation of another point of a robot whose tool is apart: ``com`` or ``tool``."""
        with self.lock:
            self.point = self._wanted = point
            if self.data is not None:
                self._redraw_paths()
                self.set_time(self.time)

    def picture_words(self) -> str:
        """Caption of the scene: a few words on what is drawn and how many times larger deflections are."""
        if self.drawn:
            return self.drawn
        larger = "in true size" if self.scale == 1 else f"{number(self.scale, 4)} times larger"
        return f"the motion, deflections {larger}"

    def scale_words(self) -> str:
        """Sentence on how large deflections are drawn."""
        if self.drawn:
            return self._note
        if self.scale == 1:
            return "Deflections are drawn in true size."
        return f"Deflections are drawn {number(self.scale, 4)} times larger than they are."

    def colour_by(self, quantity: str) -> None:
        """Colour the legs by "force", "stroke margin", "bending", or by their number ("plain")."""
        with self.lock:
            self.quantity = quantity
            if self.data is not None:
                self.set_time(self.time)

    def visible(self, name: str, on: bool) -> None:
        """Show or hide a part by its name in `PARTS`."""
        with self.lock:
            self._shown[name] = on
            for handle in self._parts[name]:
                handle.visible = on and (name not in OF_RESULTS or name in self._now)

    def close(self) -> None:
        """Drop the arrays; nothing is drawn any more."""
        with self.lock:
            self._closed, self.data, self.driver = True, None, None
            for handles in self._parts.values():
                handles.clear()

    def _add(self, part: str, handle: Any) -> Any:
        """Register a node under the part that hides and shows it."""
        self._parts[part].append(handle)
        handle.visible = self._shown[part]
        return handle

    def _draws(self, what: str, note: str = "") -> None:
        """Remember what is drawn and a sentence on its size, and report a change to the caption."""
        if (what, note) != (self.drawn, self._note):
            self.drawn, self._note = what, note
            self.told()

    def _only(self, *parts: str) -> None:
        """Show, of the parts that show a result, these alone, unless the user hides them."""
        self._now = parts
        for part in OF_RESULTS:
            self.visible(part, self._shown[part])

    def _begin(self) -> None:
        """Forget result and nodes before those of another study replace them by name: no flicker while dragging."""
        self.data = None
        for handles in self._parts.values():
            handles.clear()

    def _light(self) -> None:
        """Light the scene more softly than the page's own light, under which all colours are pale."""
        scene = self.client.scene
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(None)
        scene.add_light_directional("/light", intensity=2.0, position=(1.0, -1.5, 3.0))
        scene.add_light_hemisphere("/light_around", ground_color=(150, 150, 150), intensity=1.6)

    @abstractmethod
    def _take(self, data: Dataset | None) -> RobotMotion | BeamMotion | None:
        """Take the arrays of a result, or none, in place of those before."""

    @abstractmethod
    def _redraw_paths(self) -> None:
        """Draw anew what depends on the factor but not on time."""

    @abstractmethod
    def _whole(self) -> tuple[Array, Array]:
        """Points between which all lies that moves in the study, and those with a label beside them, (n, 3) [m]."""

    def _look(self, away: Array) -> None:
        """See the whole from the direction `away`, (3,); so it is seen again after `reset_view`."""
        self._away = away
        self.reset_view()

    def reset_view(self) -> None:
        """Place the camera where the whole study fits into what the panel leaves of the page; the page knows that."""
        points, labelled = (found[np.isfinite(found).all(axis=1)].tolist() for found in self._whole())
        run_script(self.client, "picture", {"away": self._away.tolist(), "points": points, "labelled": labelled})


def mode_note(size: float) -> str:
    """Sentence on how large a mode is drawn; `size` of its largest displacement [m]."""
    return f"A mode has no size of its own: its largest displacement is drawn as {text(size, 'm')}."


def _nothing() -> None:
    """Report nothing."""
