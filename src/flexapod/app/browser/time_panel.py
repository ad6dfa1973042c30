"""The tab "Time": play, pause, speed, scrub; what the scene shows; charts with a cursor at its time.

A `Player` moves a scene in a thread, one at a time, whoever started it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import viser
from viser import Icon

from flexapod.analysis.results.summary import POINT_WORDS
from flexapod.app.browser import markup
from flexapod.app.browser.background import Threads
from flexapod.app.browser.charts import Chart, ChartView, charts
from flexapod.app.browser.scene import PARTS, PageScene
from flexapod.app.browser.text_fields import NumberField, TypedText, in_unit, plain, user_callback
from flexapod.common.errors import InputError
from flexapod.output.scene.geometry import nearest_index

if TYPE_CHECKING:
    from xarray import Dataset

FRAME = 1 / 25  # time between two steps [s]


class Player:
    """Steps at a fixed rate until it is stopped, the step says so, or something else takes the scene.

    The `driver` of the scene says who moves it. `step` is called with the time since the step before [s], under `lock`,
    and returns whether there is more to come; `told` with True at the start and False at the end.
    """

    def __init__(
        self,
        scene: PageScene,
        threads: Threads,
        lock: threading.RLock,
        step: Callable[[float], bool],
        told: Callable[[bool], None],
    ) -> None:
        self._scene, self._threads, self._lock, self._step, self._told = scene, threads, lock, step, told
        self._token: object = None  # of the run that is going on

    @property
    def playing(self) -> bool:
        """True while the scene moves by this player."""
        return self._token is not None and self._scene.driver is self._token

    def start(self) -> None:
        """Begin to step; whoever else moves the scene stops."""
        with self._lock:
            if self.playing:
                return
            token = self._token = self._scene.driver = object()
            self._told(True)
            self._threads.start("play", lambda: self._run(token))

    def stop(self) -> None:
        """Step no more."""
        with self._lock:
            if self.playing:
                self._scene.driver = None
                self._token = None
                self._told(False)

    def close(self) -> None:
        """Stop and say nothing: what would be told is gone."""
        self._told = _nothing
        if self.playing:
            self._scene.driver = None

    def _run(self, token: object) -> None:
        before, more = time.perf_counter(), True
        try:
            while more and self._scene.driver is token:
                now = time.perf_counter()
                with self._lock, self._scene.lock:  # who takes the scene meanwhile has the last word
                    if self._scene.driver is token:
                        more = self._step(now - before)
                before = now
                time.sleep(max(0.0, FRAME - (time.perf_counter() - now)))
        finally:
            with self._lock:
                if self._scene.driver is token:
                    self._scene.driver = None
                if self._token is token:
                    self._token = None
                    self._told(False)


def _nothing(playing: bool) -> None:
    """Report nothing."""


CHART_FRAMES = 4  # updates of the scene between two of the chart
LARGEST_FACTOR = 1e12  # on deflections; the automatic one ends below, at the rounding of positions
_NOTHING: str = "none"
NONE = "No result yet: press Simulate."
ONE = "The result has a single instant: nothing moves."
SPEEDS = {"1/100": 0.01, "1/20": 0.05, "1/10": 0.1, "1/4": 0.25, "1/2": 0.5, "real time": 1.0, "2 x": 2.0}


class TimePanel:
    """Controls of time for one user, which the scene follows; made inside the tab that holds them.

    `told_point` is called after the user has chosen another point of the payload.
    """

    client: viser.ClientHandle
    scene: PageScene

    def __init__(
        self, client: viser.ClientHandle, scene: PageScene, threads: Threads, told_point: Callable[[], None]
    ) -> None:
        self.client, self.scene, self._told_point = client, scene, told_point
        self._data: Dataset | None = None
        self._charts: dict[str, Chart] = {}
        self._time, self._end, self._frame = 0.0, 0.0, 0
        self._lock = threading.RLock()
        self._player = Player(scene, threads, self._lock, self._step, self._label)
        gui = client.gui
        self._hint = gui.add_html(markup.block(NONE, "soft"))
        self._play = gui.add_button("Play", icon=Icon.PLAYER_PLAY, disabled=True, hint="Play or pause")
        self._dial = NumberField(gui, threads, "time", "s", (0.0, 1.0), 0.001, 0.0, self._scrubbed, dimension="time")
        self._dial.disabled = True
        self._speed = gui.add_dropdown("speed", tuple(SPEEDS), initial_value="1/4", hint="Time shown per time passed")
        self._choice = gui.add_dropdown("chart", [_NOTHING], initial_value=_NOTHING)
        self._view = ChartView(gui)
        self._make_look(gui, threads)
        self._play.on_click(lambda _: self.pause() if self._player.playing else self.play())
        self._choice.on_update(user_callback(self._draw_chart))

    def show_data(self, data: Dataset | None) -> None:
        """Take a result, or nothing; the scene has it already, at the time that stays."""
        self.pause()
        with self._lock:
            self._data, self._charts = data, {} if data is None else charts(data, self.scene.point)
            if data is not None:
                self._end = float(data.time[-1])
                self._time = min(self._time, self._end)
            instants = 0 if data is None else data.sizes["time"]
            self._hint.visible = instants < 2
            self._hint.content = markup.block(ONE if instants else NONE, "soft")
            if data is not None and instants > 1:
                self._dial.fit(0.0, self._end, float(data.time[1] - data.time[0]))
                self._dial.value = self._time
            self._play.disabled = self._dial.disabled = instants < 2
            self._list_points()
            self._list_charts()
            self.follow()

    def follow(self) -> None:
        """Say of what the scene shows now what its colours mean and how large it is drawn."""
        self._legend.content = self.scene.legend()
        self._tell_scale()

    def play(self) -> None:
        """Let time pass, from the start again after the end."""
        with self._lock:
            if self._data is None:
                return
            if self._time >= self._end:
                self._time = float(self._data.time[0])
            self._player.start()

    def pause(self) -> None:
        """Stand still."""
        self._player.stop()

    def close(self) -> None:
        """Stop, and drop the result."""
        self._player.close()
        with self._lock:
            self._data, self._charts = None, {}

    def _step(self, passed: float) -> bool:
        if self._data is None:
            return False
        self._time = min(self._end, self._time + passed * SPEEDS[self._speed.value])
        self._frame += 1
        over = self._time >= self._end
        self._show(chart=over or self._frame % CHART_FRAMES == 0)
        return not over

    def _show(self, *, chart: bool = True, slider: bool = True) -> None:
        with self.client.atomic():
            self.scene.set_time(self._time)
            self._tell_time(slider)
            if chart:
                self._view.cursor(self._time)
                if self.scene.quantity != "plain":
                    self._legend.content = self.scene.legend()

    def _tell_time(self, always: bool) -> None:
        """Write the stored instant that is shown; where the user wrote a time, only if it is another one."""
        if self._data is not None:
            instants = self._data.time.values
            shown = float(instants[nearest_index(instants, self._time)])
            if always or abs(shown - self._time) > 1e-3 * self._dial.step:
                self._dial.value = shown

    def _scrubbed(self) -> None:
        with self._lock:
            if self._data is None:
                return
            self._take_scene()
            self._time = float(self._dial.value)
            self._show(slider=False)

    def _label(self, playing: bool) -> None:
        self._play.label = "Pause" if playing else "Play"
        self._play.icon = Icon.PLAYER_PAUSE if playing else Icon.PLAYER_PLAY
        if not playing:
            self._view.cursor(self._time)

    def _list_charts(self) -> None:
        kept = self._choice.value
        names = (*self._charts, _NOTHING)
        self._choice.options = names
        self._choice.value = kept if kept in self._charts else names[0]
        self._draw_chart()

    def _draw_chart(self) -> None:
        with self._lock:
            self._view.show(self._charts.get(self._choice.value), self._time)

    def _make_look(self, gui: viser.GuiApi, threads: Threads) -> None:
        """The folder of what the scene shows and how."""
        with gui.add_folder("Scene"):
            self._color = gui.add_dropdown(
                "leg colours", self.scene.quantities, initial_value="plain", visible=len(self.scene.quantities) > 1
            )
            self._point = gui.add_dropdown(
                "point", tuple(POINT_WORDS.values()), visible=False, hint="Whose path and deviation are shown"
            )
            self._legend = gui.add_html(self.scene.legend())
            self._factor = TypedText(
                gui,
                threads,
                "magnify",
                "1",
                self._take_factor,
                lambda _: self._tell_factor(),
                hint="Factor on all deflections in the picture, 1 or more",
            )
            self._factor_words = gui.add_html("")
            self._automatic = gui.add_button("Automatic factor", hint="Largest deflection well visible")
            self._scale_words = gui.add_html("")
            boxes = {name: gui.add_checkbox(name, shown) for name, shown in PARTS.items()}
        self._color.on_update(user_callback(self._recolor))
        self._point.on_update(user_callback(self._choose_point))
        self._automatic.on_click(lambda _: self._rescale(None))
        for name, box in boxes.items():
            box.on_update(user_callback(lambda name=name, box=box: self.scene.visible(name, box.value)))

    def _recolor(self) -> None:
        self._take_scene()
        self.scene.colour_by(self._color.value)
        self._legend.content = self.scene.legend()

    def _rescale(self, factor: float | None) -> None:
        self._factor_words.content = ""
        self._take_scene()
        self.scene.set_scale(factor)
        self._tell_scale()

    def _take_scene(self) -> None:
        """Stop whatever else moves the scene, a mode: the motion is to be seen."""
        if not self._player.playing:
            self.scene.driver = None

    def _list_points(self) -> None:
        """Offer the points of the payload whose deviation is known, where there is a choice."""
        self._point.visible = len(self.scene.points) > 1
        self._point.value = POINT_WORDS[self.scene.point]

    def _choose_point(self) -> None:
        with self._lock:
            self._take_scene()
            self.scene.show_point(next(key for key, name in POINT_WORDS.items() if name == self._point.value))
            if self._data is not None:
                self._charts = charts(self._data, self.scene.point)
                self._draw_chart()
        self._told_point()

    def _tell_scale(self) -> None:
        if self.scene.scale == self.scene.automatic:  # another one is the user's, who may be writing on
            self._tell_factor()
        self._scale_words.content = markup.block(self.scene.scale_words(), "soft")

    def _tell_factor(self) -> None:
        self._factor.show(plain(self.scene.scale))

    def _take_factor(self, text: str, left: bool) -> None:
        """Draw deflections as many times larger as somebody has typed, or say why not."""
        try:
            factor = in_unit(text, "", "number", "magnify")
            if not 1 <= factor <= LARGEST_FACTOR:
                problem = "makes deflections smaller" if factor < 1 else "is more than a picture can show"
                raise InputError(problem, key="magnify", value=text, allowed=f"from 1 to {LARGEST_FACTOR:g}")
        except InputError as error:
            self._factor_words.content = markup.error_html(error)
        else:
            self._rescale(factor)
