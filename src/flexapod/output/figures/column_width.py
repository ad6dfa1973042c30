"""A figure for a narrower place on paper: fewer panels beside each other, letters as they were, long words broken."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from copy import deepcopy
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Annotation, Text

MOST = 6  # panels in a column
TALLEST = 9.2  # of a column: what a page has room for [in]
FLATTER, SPACE = 0.75, 0.85  # heights against the wide figure: of a panel without a shape of its own, of one in space
WIDE, HIGHER, HIGHEST = 0.1, 1.6, 2.4  # margins above which a panel has words in it; how much more notes, legends need
FINE = 200  # dots per inch at which letters are as wide as they are on paper
INSET = 0.04  # clear of the right edge [in]
BESIDE = 1.25  # length of a label beside a panel against the panel's height: it may reach into the gaps
_EDGES = {"left": 0.02, "right": 0.91, "bottom": 0.04, "top": 0.91, "hspace": 0.3}  # of a column of pictures in space

Stack = list[Axes]


def resize_figure(fig: Figure, width: float) -> Figure:
    """A copy of a figure at another width [in]; below three quarters of its own the panels are stacked.

    Up to six panels go into one column, the columns below each other; more, and small pictures, go into two columns,
    where panels without a title of their own stay below the one that has it. Labels of axes stand where a row begins
    and a column ends, as before.
    """
    made = deepcopy(fig)
    FigureCanvasAgg(made)
    made.set_dpi(FINE)
    before, high = (float(size) for size in made.get_size_inches())
    share = width / before
    if share >= 0.75:
        made.set_size_inches(width, high)
        return made
    stacks, columns = _stacks(made)
    tall = high * share**0.25 if columns == 0 else _stacked(made, stacks, columns, (before, high), width)
    made.set_size_inches(width, min(tall, TALLEST))
    _broken(made, max(columns, 1))
    return made


def _panels(fig: Figure) -> list[Axes]:
    return [axes for axes in fig.axes if axes.get_visible() and axes.get_subplotspec() is not None]


def _place(axes: Axes) -> tuple[int, int]:
    """Row and column of a panel."""
    spec = axes.get_subplotspec()
    return (0, 0) if spec is None else (spec.rowspan.start, spec.colspan.start)


def _stacks(fig: Figure) -> tuple[list[Stack], int]:
    """Stacks of panels that stay together, in reading order, and their columns; 0 if the figure has one already."""
    panels = sorted(_panels(fig), key=_place)
    columns = sorted({_place(axes)[1] for axes in panels})
    if len(columns) < 2:
        return [], 0
    if len(panels) <= MOST and (len(columns) == 2 or not any(_keeps_shape(axes) for axes in panels)):
        return [[axes for axes in panels if _place(axes)[1] == column] for column in columns], 1
    stacks: list[Stack] = []
    for axes in panels:
        row, column = _place(axes)
        above = next((stack for stack in stacks if _place(stack[-1]) == (row - 1, column)), None)
        if above is None or axes.get_title(loc="left") or axes.get_title():
            stacks.append([axes])
        else:
            above.append(axes)
    return stacks, 2


def _keeps_shape(axes: Axes) -> bool:
    """Test whether the height of a panel follows its width."""
    return axes.name != "rectilinear" or axes.get_aspect() != "auto"


def _height(axes: Axes) -> float:
    """Height of a panel against that on the wide figure."""
    if axes.name != "rectilinear":
        return SPACE
    return 1.0 if _keeps_shape(axes) else FLATTER


def _stacked(fig: Figure, stacks: list[Stack], columns: int, size: tuple[float, float], width: float) -> float:
    """Give the panels their new places; the height that they need [in]."""
    first = stacks[0][0].get_subplotspec()
    if first is None:
        return size[1]
    grid = first.get_gridspec()
    ratios = np.asarray(grid.get_height_ratios(), dtype=float)
    rows = [stacks[i : i + columns] for i in range(0, len(stacks), columns)]
    heights = [float(ratios[_place(axes)[0]]) for row in rows for axes in row[0]]
    height = max(_height(axes) for stack in stacks for axes in stack)
    scale = min(height, width / columns / (size[0] / grid.ncols))
    in_space = all(axes.name != "rectilinear" for stack in stacks for axes in stack)
    edges: dict[str, Any] = _EDGES if in_space else {}
    places = fig.add_gridspec(len(heights), columns, height_ratios=heights, **edges)
    _carry_labels(fig, stacks)
    at = 0
    for row in rows:
        for column, stack in enumerate(row):
            for k, axes in enumerate(stack):
                axes.set_subplotspec(places[at + k, column])
        at += len(row[0])
    _outer_labels([[axes for stack in stacks[column::columns] for axes in stack] for column in range(columns)])
    return size[1] * sum(heights) / float(ratios.sum()) * scale


def _carry_labels(fig: Figure, stacks: Iterable[Stack]) -> None:
    """Every panel with the label of its row, every last panel of a stack with the label of its column."""
    panels = _panels(fig)
    for stack in stacks:
        for axes in stack:
            row, column = _place(axes)
            beside = (other.get_ylabel() for other in panels if _place(other)[0] == row and other.get_ylabel())
            below = (other.get_xlabel() for other in panels if _place(other)[1] == column and other.get_xlabel())
            axes.set(ylabel=axes.get_ylabel() or next(beside, ""), xlabel=axes.get_xlabel() or next(below, ""))


def _outer_labels(columns: Sequence[Stack]) -> None:
    """Labels and numbers of shared axes at the left and at the bottom only."""
    for stack in columns:
        for axes, below in zip(stack, [*stack[1:], None], strict=True):
            if axes.name != "rectilinear":
                continue
            shared = below is not None and axes.get_shared_x_axes().joined(axes, below)
            axes.tick_params(axis="x", labelbottom=not shared)
            if shared:
                axes.set_xlabel("")
    for left, right in pairwise(columns):
        for beside, axes in zip(left, right, strict=False):
            if beside.get_ylabel() == axes.get_ylabel():
                axes.set_ylabel("")
            if axes.get_shared_y_axes().joined(axes, beside):
                axes.tick_params(axis="y", labelleft=False)
    for axes in columns[0]:
        if axes.name == "rectilinear":
            axes.tick_params(axis="y", labelleft=True)


def _broken(fig: Figure, columns: int) -> None:
    """Break legends, titles, notes and labels that would run over the edge of their column or of their panel."""
    notes = {axes: [text for text in axes.texts if _runs_right(text)] for axes in _panels(fig)}
    legends = {axes: legend for axes in notes if (legend := axes.get_legend()) is not None}
    for part in (*legends.values(), *(note for several in notes.values() for note in several)):
        part.set_in_layout(False)  # what is too wide leaves no room for the panels
    for axes in notes:
        across = (axes.margins() or (0.0, 0.0))[1] if axes.name == "rectilinear" else 0.0
        if across > WIDE and axes.get_autoscaley_on():
            axes.margins(y=(HIGHEST if axes in legends else HIGHER) * across)
    fig.draw_without_rendering()
    wide = fig.get_figwidth()
    for legend in list(fig.legends):
        _fitted(fig, legend, wide)
    for axes in notes:
        if axes.name == "rectilinear":
            _break(axes.yaxis.label, BESIDE * axes.get_position().height * fig.bbox.height)
    _closed(fig)
    for axes in notes:
        box = axes.get_position()
        bars = [bar.get_position().x0 for bar in fig.axes if bar.get_subplotspec() is None]  # of colours
        end = min([(int(0.5 * (box.x0 + box.x1) * columns) + 1) / columns, *bars]) * wide - INSET
        if axes in legends:
            _fitted(axes, legends[axes], (box.x1 - box.x0) * wide)
        for title in _titles(axes):
            middle = title.get_horizontalalignment() == "center"
            _break(title, (0.95 * (box.x1 - box.x0) * wide if middle else end - box.x0 * wide) * fig.dpi)
        for note in notes[axes]:
            _break(note, (box.x1 * wide - INSET) * fig.dpi - note.get_window_extent().x0)
    headline = next((text for text in fig.texts if text.get_text() == fig.get_suptitle() != ""), None)
    if headline is not None:
        headline.set_text(" ".join(headline.get_text().split()))
        _break(headline, (wide - 2 * INSET) * fig.dpi)


def _closed(fig: Figure) -> None:
    """Take away the height that panels with equal scales leave free above and below them."""
    free: dict[int, float] = {}
    fig.draw_without_rendering()
    for axes in _panels(fig):
        box = axes.get_tightbbox() if axes.name == "rectilinear" and axes.get_aspect() != "auto" else None
        if box is not None:
            row, high = _place(axes)[0], axes.get_position(original=True).height
            left = max(high - box.height / fig.bbox.height, 0.0)
            free[row] = min(left, free.get(row, left))
    if free:
        fig.set_figheight(fig.get_figheight() * (1 - sum(free.values())))
        fig.draw_without_rendering()


def _titles(axes: Axes) -> list[Any]:
    words = {axes.get_title(loc=where) for where in ("left", "center")} - {""}
    found = axes.findobj(lambda part: isinstance(part, Text) and part.get_text() in words)
    return [part for part in found if isinstance(part, Text)]


def _runs_right(text: Text) -> bool:
    """Test whether a text is a note that begins inside a panel and runs to the right."""
    if not isinstance(text, Annotation) or text.get_rotation() or text.get_horizontalalignment() != "left":
        return False
    coords: Any = text.xycoords
    across = coords[0] if isinstance(coords, tuple) else coords
    return bool(across == "data" or (across == "axes fraction" and text.xy[0] < 1))


def _fitted(of: Figure | Axes, legend: Legend, room: float) -> None:
    """The legend again, in as many columns as there is room for [in]: that of a figure above or below its panels."""
    fig = of.get_figure(root=True)
    names = [text.get_text() for text in legend.get_texts()]
    title, handles = legend.get_title().get_text() or None, [part for part in legend.legend_handles if part is not None]
    box = legend.get_window_extent()
    edge = "upper" if box.y0 + box.y1 > of.bbox.y0 + of.bbox.y1 else "lower"
    where = f"outside {edge} center" if isinstance(of, Figure) else "best"
    look = {"title": title, "handlelength": legend.handlelength, "loc": where}
    for columns in range(len(names), 0, -1):
        if isinstance(of, Figure):
            of.legends.clear()  # axes replace theirs
        made = of.legend(handles, names, ncols=columns, **look)
        made.set_in_layout(isinstance(of, Figure))
        if fig is None or made.get_window_extent().width <= room * fig.dpi:
            return


def _break(text: Text, room: float) -> None:
    """Break a text at spaces so that no line is wider than `room` [pixels]."""

    def over(words: str) -> bool:
        text.set_text(words)
        box = text.get_window_extent()
        return (box.height if text.get_rotation() == 90 else box.width) > room

    whole = text.get_text()
    if not over(whole):
        return
    lines: list[str] = []
    for word in re.split(r"(?<!\d) ", whole):  # a number stays with its unit
        longer = f"{lines[-1]} {word}" if lines else word
        lines = [*lines, word] if lines and over(longer) else [*lines[:-1], longer]
    text.set_text("\n".join(lines))
