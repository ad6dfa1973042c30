"""Figures of matplotlib as figures of plotly, so that a page can zoom into them: same curves, colours and words.

A figure is translated axes by axes, each at its place in the figure. What has no counterpart (3D axes, coloured
maps) makes the whole figure stay a picture. Curves have no more points than can be seen, packed as base64.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_hex, to_rgba
from matplotlib.container import BarContainer
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation
from matplotlib.ticker import FixedLocator

from flexapod.output.report.replay import MOST_POINTS, plotly_array
from flexapod.output.scene.geometry import decimation_indices

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.backend_bases import GraphicsContextBase
    from matplotlib.figure import Figure
    from matplotlib.path import Path
    from matplotlib.transforms import Transform


PIXELS = 96 / 72  # of a point
_Ends = tuple[float, float]
_MARKS = {
    "o": "circle", "s": "square", "^": "triangle-up", "v": "triangle-down", "D": "diamond", "X": "x", "x": "x-thin",
    "P": "cross", "*": "star", "h": "hexagon", ".": "circle", "+": "cross-thin",
}  # fmt: skip
_UNIT = re.compile(r"\[([^\]]+)\]\s*$")


def plotly_figure(figure: Figure) -> dict[str, Any] | None:
    """Data and layout of a drawn figure in the form of plotly; None where it has something without a counterpart.

    The figure is drawn or saved, so that its axes have their places. Curves of more than `MOST_POINTS` points are
    thinned: of each interval the least and the largest value stay.
    """
    panels = [axes for axes in figure.axes if axes.get_visible()]
    if not panels or any(axes.name != "rectilinear" or axes.images or _maps(axes) or _drawn(axes) for axes in panels):
        return None
    width, height = (float(size) * 96 for size in figure.get_size_inches())
    size = [round(width), round(height), _above(figure, panels)]
    layout: dict[str, Any] = {"annotations": [], "shapes": [], "size": size}
    data: list[dict[str, Any]] = []
    shown = {text.get_text() for legend in _legends(figure, panels) for text in legend.get_texts()}
    for k, axes in enumerate(panels, start=1):
        layout |= _axes(axes, k, panels)
        layout["annotations"] += [*_title(axes, k), *_notes(axes, k)]
        layout["shapes"] += [*_rules(axes, k), *_bands(axes, k)]
        data += [*_areas(axes, k), *_lines(axes, k), *_bars(axes, k)]  # areas lie below curves
    _label(data, shown)
    if all("[s]" in axes.get_xlabel() and axes.get_xscale() == "linear" for axes in panels if axes.get_xlabel()):
        layout["hovermode"] = "x unified"
    return {"data": data, "layout": layout}


def _above(figure: Figure, panels: list[Axes]) -> int:
    """Height above a figure for buttons and legend [pixels], where its own legend does not leave room for them."""
    return 6 if figure.legends else 48 if _legends(figure, panels) else 28


def _maps(axes: Axes) -> bool:
    """Test whether axes have collections with colours by value, or with hatching."""
    return any(part.get_array() is not None or part.get_hatch() for part in axes.collections)


def _drawn(axes: Axes) -> bool:
    """Test whether axes have circles, arcs or polygons: a drawing, not curves."""
    return any(not isinstance(patch, Rectangle) for patch in axes.patches)


def _legends(figure: Figure, panels: list[Axes]) -> list[Any]:
    return [*figure.legends, *(legend for axes in panels if (legend := axes.get_legend()) is not None)]


def _key(letter: str, k: int) -> str:
    return letter if k == 1 else f"{letter}{k}"


def _axes(axes: Axes, k: int, panels: list[Axes]) -> dict[str, Any]:
    """Both axes of a panel: place, label, limits, ticks; linked with the first panel that shares them."""
    box = axes.get_position()
    made = {}
    for letter, low, high in (("x", box.x0, box.x1), ("y", box.y0, box.y1)):
        axis = axes.xaxis if letter == "x" else axes.yaxis
        limits = axes.get_xlim() if letter == "x" else axes.get_ylim()
        log = axis.get_scale() == "log"
        shared = axes.get_shared_x_axes() if letter == "x" else axes.get_shared_y_axes()
        first = next(i for i, other in enumerate(panels, start=1) if other is axes or shared.joined(axes, other))
        label = {"text": axis.get_label_text().replace("\n", "<br>"), "standoff": 4}
        made[f"{letter}axis{'' if k == 1 else k}"] = {
            "domain": [round(max(low, 0.0), 4), round(min(high, 1.0), 4)],
            "anchor": _key("y" if letter == "x" else "x", k),
            "type": "log" if log else "linear",
            "range": [float(v) for v in (np.log10(limits) if log else limits)],
            "showticklabels": bool(axis.get_tick_params().get("labelbottom" if letter == "x" else "labelleft", True)),
            **({"title": label} if label["text"] else {}),
            **({"matches": _key(letter, first)} if first != k else {}),
            **_ticks(axis, limits, log),
        }
    return made


def _ticks(axis: Any, limits: tuple[float, float], log: bool) -> dict[str, Any]:
    """Ticks that were set manually."""
    if not isinstance(axis.get_major_locator(), FixedLocator):
        return {"exponentformat": "power", "dtick": 1} if log else {}
    places = [float(place) for place in axis.get_majorticklocs()]
    words = [label.get_text() for label in axis.get_majorticklabels()]
    inside = [(p, w) for p, w in zip(places, words, strict=False) if min(limits) <= p <= max(limits)]
    return {"tickvals": [p for p, _ in inside], "ticktext": [w for _, w in inside]}


def _title(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    text = axes.get_title(loc="left") or axes.get_title()
    if text:
        size = float(axes.title.get_fontsize()) * PIXELS  # type: ignore[arg-type]
        place = {"xref": f"{_key('x', k)} domain", "yref": f"{_key('y', k)} domain", "x": 0, "y": 1}
        above = 22 if _has_note_above(axes) else 6
        yield {
            **place, "text": f"<b>{_safe(text)}</b>", "showarrow": False, "xanchor": "left", "yanchor": "bottom",
            "align": "left", "yshift": above, "font": {"size": round(min(size, 14), 1)},
        }  # fmt: skip


def _has_note_above(axes: Axes) -> bool:
    """Test whether a note stands between panel and title, such as that of `mark_end`."""
    return any(isinstance(note, Annotation) and note.xy[1] == 1.0 and note.xycoords == ("data", "axes fraction")
               for note in axes.texts)  # fmt: skip


def _notes(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    """Notes in a panel, where they are tied to its data or its frame."""
    for note in axes.texts:
        if not note.get_text() or not note.get_visible():
            continue
        coords = note.xycoords if isinstance(note, Annotation) else "data"
        kinds = coords if isinstance(coords, tuple) else (coords, coords)
        if not all(kind in ("data", "axes fraction") for kind in kinds):
            continue
        place: dict[str, Any] = {}
        at = note.xy if isinstance(note, Annotation) else note.get_position()
        for letter, kind, value in zip("xy", kinds, at, strict=True):
            scale = axes.get_xscale() if letter == "x" else axes.get_yscale()
            own = _key(letter, k)
            place[f"{letter}ref"] = own if kind == "data" else f"{own} domain"
            place[letter] = float(np.log10(value)) if kind == "data" and scale == "log" else float(value)
        shift = note.get_position() if isinstance(note, Annotation) and note.anncoords == "offset points" else (0, 0)
        across, up = note.get_horizontalalignment(), note.get_verticalalignment()
        size = round(float(note.get_fontsize()) * PIXELS, 1)  # type: ignore[arg-type]
        yield {
            **place,
            "text": _safe(note.get_text()),
            "showarrow": False,
            "textangle": -note.get_rotation(),
            "align": "left",
            "xshift": shift[0] * PIXELS,
            "yshift": shift[1] * PIXELS,
            "xanchor": across,
            "yanchor": {"top": "top", "center": "middle", "center_baseline": "middle"}.get(up, "bottom"),
            "font": {"size": size, "color": to_hex(note.get_color())},
        }


def _ties(axes: Axes, artist: Any) -> tuple[bool, bool]:
    """True for each of the two coordinates of an artist that is in units of the data."""
    return tuple(artist.get_transform().contains_branch_seperately(axes.transData))  # type: ignore[return-value]


def _lines(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    """Curves, those that lie above others last."""
    unit = _UNIT.search(axes.get_ylabel()) or _shared_unit(axes)
    for line in sorted(axes.get_lines(), key=lambda line: line.get_zorder()):
        if _ties(axes, line) != (True, True) or not line.get_visible():
            continue
        x, y = (np.ma.filled(np.ma.asarray(np.atleast_1d(v), dtype=float), np.nan) for v in line.get_data())
        seen, name = decimation_indices(y[None], MOST_POINTS), str(line.get_label())
        yield {
            "type": "scatter", "xaxis": _key("x", k), "yaxis": _key("y", k), "x": plotly_array(x[seen]),
            "y": plotly_array(y[seen]), "name": "" if name.startswith("_") else name, **_look(line),
            "hovertemplate": f"%{{y:.5g}} {unit.group(1) if unit else ''}",
        }  # fmt: skip


def _shared_unit(axes: Axes) -> re.Match[str] | None:
    """The unit of the panel at the left of a row, where only that has a label."""
    place = axes.get_subplotspec()
    if place is None or axes.figure is None:
        return None
    row = place.rowspan.start
    for other in axes.figure.axes:
        spec, found = other.get_subplotspec(), _UNIT.search(other.get_ylabel())
        if found and spec is not None and spec.rowspan.start == row:
            return found
    return None


def _look(line: Line2D) -> dict[str, Any]:
    drawn, marks = line.get_linestyle() not in ("None", "", " "), line.get_marker() not in ("None", "", " ", None)
    color = _color(line.get_color(), line.get_alpha())
    look: dict[str, Any] = {"mode": "+".join(["lines"] * drawn + ["markers"] * marks) or "none"}
    if drawn:
        look["line"] = {"color": color, "width": round(float(line.get_linewidth()) * PIXELS, 2), "dash": _dash(line)}
    if marks:
        face = line.get_markerfacecolor()
        hollow = "-open" if face == "none" or line.get_fillstyle() == "none" else ""
        symbol = _MARKS.get(str(line.get_marker()), "circle") + hollow
        size = float(line.get_markersize()) * PIXELS * (0.5 if line.get_marker() == "." else 1.0)
        edge = line.get_markeredgecolor() if hollow else face
        look["marker"] = {"symbol": symbol, "size": round(size, 1), "color": _color(edge, line.get_alpha())}
    return look


def _dash(line: Line2D) -> str:
    """Dashes in pixels: matplotlib tells those of its own making to a renderer alone."""
    like, told = Line2D([0, 1], [0, 0]), _Dashes()
    like.update_from(line)
    like.set_marker("")
    like.draw(told)
    return "solid" if not told.dashes else ",".join(f"{max(d * PIXELS, 1):.1f}px" for d in told.dashes)


class _Dashes(RendererBase):
    """Renderer that keeps the dashes [points] of what was drawn last."""

    dashes: Any = None

    def draw_path(self, gc: GraphicsContextBase, path: Path, transform: Transform, rgbFace: Any = None) -> None:
        self.dashes = gc.get_dashes()[1]


def _color(color: Any, alpha: float | None = None) -> str:
    red, green, blue, opacity = to_rgba(color, alpha)
    if opacity == 1:
        return to_hex(color)
    return f"rgba({round(255 * red)}, {round(255 * green)}, {round(255 * blue)}, {opacity:.3g})"


def _rules(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    """Lines across a panel, at a value of one of its axes."""
    for line in axes.get_lines():
        ties = _ties(axes, line)
        if ties in ((True, True), (False, False)):
            continue
        x, y = (np.asarray(v, dtype=float) for v in line.get_data())
        yield {
            "type": "line", "layer": "above", **_reach(k, ties, (x[0], x[-1]), (y[0], y[-1])),
            "line": {"color": _color(line.get_color()), "width": float(line.get_linewidth()), "dash": _dash(line)},
        }  # fmt: skip


def _bands(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    """Coloured bands across a panel."""
    for patch in axes.patches:
        ties = _ties(axes, patch)
        if isinstance(patch, Rectangle) and ties not in ((True, True), (False, False)):
            x0, y0, x1, y1 = patch.get_x(), patch.get_y(), patch.get_x(), patch.get_y()
            ends = ((x0, x1 + patch.get_width()), (y0, y1 + patch.get_height()))
            fill = _color(patch.get_facecolor())
            look = {"fillcolor": fill, "line": {"width": 0}}
            yield {"type": "rect", "layer": "below", **_reach(k, ties, *ends), **look}


def _reach(k: int, ties: tuple[bool, bool], x: _Ends, y: _Ends) -> dict[str, Any]:
    """Ends of a shape, in data or in shares of the panel."""
    reach: dict[str, Any] = {}
    for letter, tied, ends in zip("xy", ties, (x, y), strict=True):
        own = _key(letter, k)
        reach[f"{letter}ref"] = own if tied else f"{own} domain"
        reach |= {f"{letter}{i}": float(value) for i, value in enumerate(ends)}
    return reach


def _bars(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    unit = _UNIT.search(axes.get_ylabel()) or _shared_unit(axes)
    for bars in (part for part in axes.containers if isinstance(part, BarContainer)):
        boxes = list(bars.patches)
        yield {
            "type": "bar", "xaxis": _key("x", k), "yaxis": _key("y", k), "name": "", "offset": 0,
            "x": [box.get_x() for box in boxes], "y": [box.get_height() for box in boxes],
            "base": [box.get_y() for box in boxes], "width": [box.get_width() for box in boxes],
            "marker": {"color": [_color(box.get_facecolor()) for box in boxes], "line": {"width": 0}},
            "customdata": [box.get_height() for box in boxes],
            "hovertemplate": f"%{{customdata:.4g}} {unit.group(1) if unit else ''}<extra></extra>",
        }  # fmt: skip


def _areas(axes: Axes, k: int) -> Iterator[dict[str, Any]]:
    """Areas between curves."""
    for area in axes.collections:
        for path in area.get_paths() if _ties(axes, area) == (True, True) else ():
            x, y = np.asarray(path.vertices).T
            yield {
                "type": "scatter", "xaxis": _key("x", k), "yaxis": _key("y", k),
                "x": plotly_array(x), "y": plotly_array(y), "mode": "lines", "line": {"width": 0},
                "fill": "toself", "hoverinfo": "skip",
                "fillcolor": _color(area.get_facecolor()[0]), "name": str(area.get_label()).lstrip("_"),
            }  # fmt: skip


def _safe(text: str) -> str:
    """Words as they are: plotly would read markup in them."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace("\n", "<br>")


def _label(data: list[dict[str, Any]], shown: set[str]) -> None:
    """Each name once in the legend, and only those that the figure's own legend has; curves of a name go together."""
    seen: set[str] = set()
    for trace in data:
        name = trace["name"]
        trace["showlegend"] = name in shown and name not in seen
        trace["legendgroup"] = name or None
        trace["name"] = _safe(name)
        seen.add(name)
