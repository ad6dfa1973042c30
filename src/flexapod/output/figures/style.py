"""House style of all figures: colours that colour-blind readers tell apart, units in labels, width, files.

Figures are as wide as a page of a journal (170 mm); `save` writes them as wide as a column (85 mm), too.
Letters have the size at which they are read, 7 points at least.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from numbers import Real
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_kind
from flexapod.common.files import path_of, replace_file
from flexapod.output.figures.column_width import resize_figure

INCH = 0.0254  # [m]
TEXT, NOTE, SMALL = 8.5, 7.5, 7.0  # sizes of letters [points]

_RC: Any = {
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

P = ParamSpec("P")
T = TypeVar("T")

LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (3, 1)), (0, (1, 3)), (0, (7, 2)))
COLORS = "cividis"  # of maps: even in lightness, and for colour-blind readers
COLUMN, PAGE = 3.35, 6.7  # widths of a column and of a page [in]: 85 and 170 mm

CONTRAST = 4.6  # of words; a little above what is asked for, as colours are rounded
FINEST, WIDEST = 2400, 2.0  # dots an inch, and [m]: a picture of more has no room in the memory
# Files by their endings. What they say of themselves: no dates, so that the same figure is the same file. PNG files are
# deflated in two thirds of the usual time, to 8 % more bytes.
_FORMATS: dict[str, dict[str, Any]] = {
    "png": {"metadata": {"Software": "flexapod"}, "pil_kwargs": {"compress_level": 3}},
    "svg": {"metadata": {"Date": None, "Creator": "flexapod"}},
    "pdf": {"metadata": {"CreationDate": None, "Creator": "flexapod", "Producer": None}},
}


def figure(width: float = PAGE, height: float = 4.0, gap: float = 0.02) -> Figure:
    """Empty figure [in] on the Agg canvas, without pyplot's global state; `gap` between columns, as a share of one."""
    made = Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(wspace=gap))
    FigureCanvasAgg(made)
    return made


def require_variables(*names: str) -> Callable[[Callable[P, Figure]], Callable[P, Figure]]:
    """Refuse a first argument that is no Dataset, or mapping of Datasets, with these variables, or has no instant.

    Without names any Dataset will do.
    """

    def decorate(draw: Callable[P, Figure]) -> Callable[P, Figure]:
        @wraps(draw)
        def draw_checked(*args: P.args, **kwargs: P.kwargs) -> Figure:
            given: Any = args[0] if args else next(iter(kwargs.values()), None)
            several = isinstance(given, Mapping) and not hasattr(given, "data_vars")
            for data in (given.values() or (None,)) if several else (given,):
                missing = [name for name in names if name not in getattr(data, "data_vars", ())]
                if not (missing or hasattr(data, "data_vars")):
                    what = f"cannot be drawn: it is a {type(data).__name__}"
                    raise InputError(what, key=draw.__name__.lstrip("_"), allowed="a result, a Dataset")
                if missing:
                    raise InputError(
                        f"cannot be drawn: the result has no {missing[0]!r}",
                        key=draw.__name__.lstrip("_"),
                        allowed=f"a result with {', '.join(names)}",
                    )
                if getattr(data, "sizes", {}).get("time") == 0:
                    raise InputError("has no instant", key="time", allowed="one at least")
            return draw(*args, **kwargs)

        return draw_checked

    return decorate


def house_style(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the house style, whatever the user's matplotlib settings."""

    @wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with house_settings():
            fig = draw(*args, **kwargs)
            for axes in fig.axes:
                for axis in (axes.xaxis, axes.yaxis):  # other ticks are made after the first, whenever that is
                    axis.get_major_ticks(1)
            return fig

    return wrapper


@contextmanager
def house_settings() -> Iterator[None]:
    """Settings of matplotlib for all figures: its defaults, and ours."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_RC)
        yield


def share_flat_scale(panels: Sequence[Axes], sizes: Sequence[float]) -> None:
    """Give panels of `sizes` 0 the vertical limits of the panel of the largest: zero is drawn as a flat line."""
    limits = panels[max(range(len(panels)), key=lambda i: sizes[i])].get_ylim()
    for panel, size in zip(panels, sizes, strict=True):
        if size == 0 and max(sizes) > 0:
            panel.set_ylim(limits)


def cell_edges(centres: Array) -> Array:
    """Edges of cells around values (n,): half-way between neighbours, as wide beyond the first and the last."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5])
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def legend_columns(entries: int, most: int = 6) -> int:
    """Columns of a legend with a number of entries: in one row, or in rows of about the same length."""
    rows = -(-entries // most)
    return -(-entries // rows)


def readable_color(color: str) -> str:
    """A colour for words on white: as it is, or darker, so that its contrast is 4.5 at least (WCAG 2.2, 1.4.3)."""
    red, green, blue = to_rgb(color)
    while 1.05 / (_luminance(red, green, blue) + 0.05) < CONTRAST:
        red, green, blue = (0.97 * part for part in (red, green, blue))
    return to_hex((red, green, blue))


def _luminance(*parts: float) -> float:
    """Relative luminance of an sRGB colour (WCAG 2.2)."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def mark_end(axes: Axes, instant: float | None, text: str = "") -> None:
    """Mark the end of the commanded motion by a fine line; with a word, on the first of a column, below its title."""
    if instant is None:
        return
    axes.axvline(instant, color="#888888", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    if text:
        place = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        axes.set_title(axes.get_title(loc="left"), pad=15)
        axes.annotate(text, (instant, 1.0), xytext=(4, 3), va="bottom", fontsize=SMALL, color="#555555", **place)


def save(
    fig: Figure,
    stem: str | Path,
    *,
    dpi: int = 200,
    formats: Sequence[str] = ("png",),
    width: float | None = None,
) -> tuple[Path, ...]:
    """Write a figure as ``stem.png``, ``stem.svg``, ``stem.pdf``; existing files are replaced by complete ones.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
    stem : path
        Without ending; the folder is made if needed.
    dpi : int
        Of the PNG file.
    formats : sequence of str
        Of png, svg, pdf.
    width : float, optional
        Width on paper [m], as 0.085 for a column: letters keep their size, panels beside each other go below each
        other, long titles and legends are broken. The figure itself stays as it is.

    Returns
    -------
    tuple of Path
        A file for each of `formats`, in their order.

    Raises
    ------
    InputError
        The folder cannot be made or written to, a format is unknown, or the width is not positive.
    """
    check_kind(fig, Figure, "fig", "a figure of matplotlib, as calls of flexapod.output.figures give it")
    stem = path_of(stem, "stem")
    if not stem.name:
        raise InputError("names no file", key="stem", value=str(stem), allowed='a name without ending, as "figure"')
    check_formats(formats)
    if isinstance(dpi, bool) or not isinstance(dpi, Real) or not 1 <= dpi <= FINEST:
        raise InputError("is not a number of dots", key="dpi", value=dpi, allowed=f"1 to {FINEST} an inch")
    if width is not None and (isinstance(width, bool) or not isinstance(width, Real) or not 0 < width <= WIDEST):
        raise InputError(
            "is not a width", key="width", value=width, allowed=f"above 0 m, as 0.085 or 0.17, up to {WIDEST:g} m"
        )
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    written = [stem.with_name(f"{stem.name}.{name}") for name in formats]
    with house_settings():
        shown = fig if width is None else resize_figure(fig, width / INCH)
        with _laid_out(shown, dpi):
            for name, path in zip(formats, written, strict=True):
                with replace_file(path) as place:
                    shown.savefig(place, dpi=dpi, format=name, **_FORMATS[name])
    return tuple(written)


def check_formats(formats: Sequence[str]) -> None:
    """Refuse formats of figures that are unknown, and none.

    Raises
    ------
    InputError
    """
    check_kind(formats, (list, tuple), "formats", f"a list of {', '.join(_FORMATS)}")
    unknown = [name for name in formats if not isinstance(name, str) or name not in _FORMATS]
    if unknown or not formats:
        value = unknown[0] if unknown else "none"
        raise InputError("is not a format of figures", key="formats", value=value, allowed=", ".join(_FORMATS))


@contextmanager
def _laid_out(fig: Figure, dpi: float) -> Iterator[None]:
    """The figure on a canvas of Agg with its places found, once for all of its files: that takes as long as drawing."""
    engine, before = fig.get_layout_engine(), fig.dpi
    if not isinstance(fig.canvas, FigureCanvasAgg):
        FigureCanvasAgg(fig)
    fig.dpi = dpi  # widths of letters depend on it a little
    try:
        if engine is not None:
            engine.execute(fig)
        fig.set_layout_engine(None)
        yield
    finally:
        fig.set_layout_engine(engine)
        fig.dpi = before
