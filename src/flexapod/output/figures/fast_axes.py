"""Panels whose ticks are drawn together, and the settings of matplotlib for all figures, whatever the user's own.

Matplotlib has five artists for each tick, makes and draws them one by one. A panel here draws all grid lines as
one curve and all marks as one, in the style of one tick, and has one tick an axis until somebody asks for the
others. Axes that need more than that (logarithms, minor ticks, rotated words, formulas) are matplotlib's own
from the start. What is drawn is the same.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from contextlib import contextmanager, nullcontext
from copy import copy
from functools import cache
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis, Tick, XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import NullLocator

from flexapod.common.arrays import Array

TEXT, NOTE, SMALL = 8.5, 7.5, 7.0  # sizes of letters [points]

_RC = {
    "font.family": "DejaVu Sans",
    "font.size": TEXT,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # above the panel: nothing else is there, and to look for it takes a third of the drawing
    "axes.labelsize": TEXT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "xtick.labelsize": NOTE,
    "ytick.labelsize": NOTE,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": NOTE,
    "legend.title_fontsize": NOTE,
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "flexapod",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "path.simplify_threshold": 0.2,
}


@cache
def rc_settings() -> Any:
    """The defaults of matplotlib, and ours."""
    defaults = {name: value for name, value in matplotlib.rcParamsDefault.items() if name != "backend"}
    ours: Any = defaults | _RC
    with matplotlib.rc_context(ours):  # asked for its backend, matplotlib would import pyplot
        now: Any = matplotlib.rcParams
        return {name: now[name] for name in defaults}


def settings_active() -> bool:
    """Test whether the settings of `rc_settings` are in force."""
    return rc_settings().items() <= dict.items(matplotlib.rcParams)


_LISTS = ("majorTicks", "minorTicks")
Places = list[tuple[float, str]]
_AXIS: Any = Axis  # much of what is used of it is private


class _Plain(_AXIS):
    """An axis that looks for its places once in a layout (`kept`), and draws them together."""

    kept: dict[Any, Any] | None = None  # what was found for a panel of one size, while a figure is saved

    @contextmanager
    def _unmade(self) -> Iterator[None]:
        """Leave ticks that nobody has asked for unmade while their style changes; they are made in it later."""
        missing = [name for name in _LISTS if name not in vars(self)]
        for name in missing:
            setattr(self, name, [])
        try:
            yield
        finally:
            for name in missing:
                if not vars(self).get(name, True):
                    delattr(self, name)

    def set_tick_params(self, *args: Any, **kwargs: Any) -> None:
        with self._unmade():
            super().set_tick_params(*args, **kwargs)

    def set_clip_path(self, *args: Any, **kwargs: Any) -> None:
        with self._unmade():
            super().set_clip_path(*args, **kwargs)

    def _get_tick(self, major: bool) -> Tick:
        with nullcontext() if settings_active() else matplotlib.rc_context(rc_settings()):
            made = super()._get_tick(major)
        made.set_clip_path(self.axes.patch)
        return made

    def get_major_ticks(self, numticks: int | None = None) -> list[Tick]:
        alone = len(self.majorTicks) == 1
        ticks = super().get_major_ticks(numticks)
        if alone and len(self.majorTicks) > 1:  # somebody wants them all
            super()._update_ticks()
        return ticks

    def _found(self, what: str, find: Any) -> Any:
        if self.kept is None:
            return find()
        key = (what, self.axes.bbox.bounds, *self.get_view_interval())
        if key not in self.kept:
            self.kept[key] = find()
        return self.kept[key]

    def _places(self) -> Places | None:
        """Places within the view and their numbers; None where matplotlib's own ticks are needed."""
        return self._found("places", self._look)

    def _look(self) -> Places | None:
        if len(self.majorTicks) > 1 or not isinstance(self.get_minor_locator(), NullLocator):
            return None
        tick = self.majorTicks[0]
        if tick.tick2line.get_visible() or tick.label2.get_visible() or _is_dressed(tick.label1):
            return None
        places = np.asarray(self.get_majorticklocs())
        words = self.major.formatter.format_ticks(places)
        if any("$" in word or "\n" in word for word in words):
            return None
        low, high = self.get_transform().transform(sorted(self.get_view_interval()))
        near = 1e-10 * (high - low)
        at = self.get_transform().transform(places)
        return [
            (float(place), word)
            for place, word, shown in zip(places, words, (at >= low - near) & (at <= high + near), strict=True)
            if shown
        ]

    def _update_ticks(self) -> list[Tick]:
        places = self._places()
        if places is None:
            return self._found("ticks", super()._update_ticks)
        if not places:
            return []
        tick = self.majorTicks[0]
        tick.update_position(places[0][0])
        tick.label1.set_text(places[0][1])
        return [tick]

    def _get_ticklabel_bboxes(self, ticks: list[Tick], renderer: Any = None) -> Any:
        return self._found(f"boxes {len(ticks)}", lambda: self._boxes(ticks, renderer))

    def _boxes(self, ticks: list[Tick], renderer: Any) -> Any:
        if not self._places() or len(ticks) != 1:
            return super()._get_ticklabel_bboxes(ticks, renderer)
        if not ticks[0].label1.get_visible() or not ticks[0].label1.get_in_layout():
            return [], []
        return [box.translated(x, y) for _, (x, y), (box, _) in self._words(renderer)], []

    def _words(self, renderer: Any) -> list[tuple[str, Array, tuple[Any, tuple[float, float]]]]:
        """Numbers, their places on the canvas, and how each lies there: its box, and where its letters begin."""
        return self._found("words", lambda: self._set(renderer))

    def _set(self, renderer: Any) -> list[tuple[str, Array, tuple[Any, tuple[float, float]]]]:
        places = self._places() or []
        label: Any = self.majorTicks[0].label1
        at = np.tile(np.array(label.get_position(), dtype=float), (len(places), 1))
        at[:, "xy".index(self.axis_name)] = [place for place, _ in places]
        style = self.axis_name, hash(label.get_fontproperties()), label.get_ha(), label.get_va(), self.axes.figure.dpi
        words = [(word, _lies(label, word, style, renderer)) for _, word in places]
        return [(word, xy, lies) for xy, (word, lies) in zip(label.get_transform().transform(at), words, strict=True)]

    def draw(self, renderer: Any) -> None:
        places = self._places() if self.get_visible() else None
        if places is None:
            super().draw(renderer)
            return
        renderer.open_group("matplotlib.axis", gid=self.get_gid())
        boxes = self._get_ticklabel_bboxes(self._update_ticks(), renderer)
        if places:
            self._draw_ticks(renderer, places)
        self._update_label_position(renderer)
        self.label.draw(renderer)
        self._update_offset_text_position(*boxes)
        self.offsetText.set_text(self.major.formatter.get_offset())
        self.offsetText.draw(renderer)
        renderer.close_group("matplotlib.axis")
        self.stale = False

    def _draw_ticks(self, renderer: Any, places: Places) -> None:
        tick, along = self.majorTicks[0], np.array([place for place, _ in places])
        grid, marks = copy(tick.gridline), copy(tick.tick1line)
        lines = np.column_stack([along, along, np.full(len(along), np.nan)]).ravel()
        across = np.tile([0.0, 1.0, np.nan], len(along))
        grid.set_data(*((lines, across) if self.axis_name == "x" else (across, lines)))
        none = np.zeros(len(along))
        marks.set_data(*((along, none) if self.axis_name == "x" else (none, along)))
        grid.draw(renderer)
        marks.draw(renderer)
        if tick.label1.get_visible():
            self._draw_words(renderer, tick.label1)

    def _draw_words(self, renderer: Any, label: Text) -> None:
        gc, (_, high) = renderer.new_gc(), renderer.get_canvas_width_height()
        gc.set_foreground(label.get_color())
        gc.set_alpha(label.get_alpha())
        for word, (x, y), (_, (right, up)) in self._words(renderer):
            down = high - (y + up) if renderer.flipy() else y + up
            renderer.draw_text(gc, x + right, down, word, label.get_fontproperties(), 0, mtext=label)
        gc.restore()


def _is_dressed(label: Text) -> bool:
    """Test whether a label needs more than plain horizontal letters."""
    asked = label.get_rotation(), label.get_path_effects(), label.get_bbox_patch(), label.get_usetex(), label.get_wrap()
    return any(asked) or label.get_url() is not None


_LIE: dict[Any, tuple[Any, tuple[float, float]]] = {}
MOST = 4096  # words whose room is kept


def _lies(label: Text, word: str, style: Hashable, renderer: Any) -> tuple[Any, tuple[float, float]]:
    """The box of a word about its place, and where its letters begin; once in a process for words of a style."""
    key = (word, style, type(renderer))
    if key not in _LIE:
        if len(_LIE) >= MOST:
            _LIE.clear()
        one: Any = copy(label)
        one.set_text(word)
        box, ((_, _, *begin), *_), *_ = one._get_layout(renderer)
        _LIE[key] = box, begin[0] if len(begin) == 1 else (begin[0], begin[1])
    return _LIE[key]


class _X(_Plain, XAxis):
    pass


class _Y(_Plain, YAxis):
    pass


class Panel(Axes):
    """Axes whose ticks are drawn together."""

    xaxis: XAxis
    yaxis: YAxis

    def _init_axis(self) -> None:
        self.xaxis, self.yaxis = _X(self, clear=False), _Y(self, clear=False)
        for name, spine in self.spines.items():
            spine.register_axis(self.xaxis if name in ("top", "bottom") else self.yaxis)


class Panels(Figure):
    """A figure whose subplots are panels, unless a projection is asked for."""

    def add_subplot(self, *args: Any, **kwargs: Any) -> Any:
        """Add a subplot as matplotlib does; it is a `Panel` unless other axes are asked for."""
        if not {"projection", "polar", "axes_class"} & kwargs.keys() and not (args and isinstance(args[0], Axes)):
            kwargs["axes_class"] = Panel
        return super().add_subplot(*args, **kwargs)


@contextmanager
def cached_ticks(fig: Figure) -> Iterator[None]:
    """Ticks and the room of their numbers are looked for once in a panel of one size, not anew for every neighbour."""
    axes: list[Any] = [axis for panel in fig.axes if isinstance(panel, Panel) for axis in (panel.xaxis, panel.yaxis)]
    for axis in axes:
        axis.kept = {}
        if isinstance(axis.get_minor_locator(), NullLocator):
            vars(axis).setdefault("minorTicks", [])
    try:
        yield
    finally:
        for axis in axes:
            axis.kept = None
            if not vars(axis).get("minorTicks", True):
                del vars(axis)["minorTicks"]
