"""House style of all figures: colours that colour-blind readers tell apart, units in labels, the width of a page.

Figures are as wide as a page of a journal (170 mm), or as a column (85 mm) where they have one column of panels by
themselves: their letters then have the size at which they are read, 7 points at least.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.text import Text

from flexapod.errors import InputError
from flexapod.study.store import replacing
from flexapod.study.words import Scale, scale

__all__ = [
    "AXIS_COLORS",
    "COLORS",
    "COLUMN",
    "FLEXIBLE",
    "LEG_COLORS",
    "NOTE",
    "PAGE",
    "RIGID",
    "SMALL",
    "TEXT",
    "Scale",
    "figure",
    "mark_end",
    "needs",
    "save",
    "scale",
    "styled",
]

P = ParamSpec("P")

# Okabe & Ito's palette, in an order whose neighbours also differ in lightness.
LEG_COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#A23B72")
AXIS_COLORS = {"x": "#7A5195", "y": "#0072B2", "z": "#D55E00"}
LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (3, 1)))
RIGID = "#B8B8B8"
FLEXIBLE = "#0B3C5D"
GRID = "#DDDDDD"
COLORS = "cividis"  # of maps: even in lightness, and for colour-blind readers
COLUMN, PAGE = 3.35, 6.7  # widths of a column and of a page [in]: 85 and 170 mm
TEXT, NOTE, SMALL = 8.5, 7.5, 7.0  # sizes of letters [points]

INCH = 0.0254  # [m]
# What files say of themselves: no dates, so that the same figure is the same file.
_METADATA: dict[str, dict[str, str | None]] = {
    "png": {"Software": "flexapod"},
    "svg": {"Date": None, "Creator": "flexapod"},
    "pdf": {"CreationDate": None, "Creator": "flexapod", "Producer": None},
}
_RC = {
    "font.family": "DejaVu Sans",
    "font.size": TEXT,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": TEXT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "xtick.labelsize": NOTE,
    "ytick.labelsize": NOTE,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": NOTE,
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "flexapod",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "path.simplify_threshold": 0.2,
}


def figure(width: float = PAGE, height: float = 4.0, gap: float = 0.02) -> Figure:
    """Empty figure [in] on the Agg canvas, without pyplot's global state; `gap` between columns, as a share of one."""
    made = Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(wspace=gap))
    FigureCanvasAgg(made)
    return made


def needs(*names: str) -> Callable[[Callable[P, Figure]], Callable[P, Figure]]:
    """Refuse a first argument that is no Dataset, or mapping of Datasets, with these variables."""

    def decorate(draw: Callable[P, Figure]) -> Callable[P, Figure]:
        @wraps(draw)
        def checked(*args: P.args, **kwargs: P.kwargs) -> Figure:
            given: Any = args[0] if args else next(iter(kwargs.values()), None)
            several = isinstance(given, Mapping) and not hasattr(given, "data_vars")
            for data in given.values() if several else (given,):
                missing = [name for name in names if name not in getattr(data, "data_vars", ())]
                if missing:
                    raise InputError(
                        f"cannot be drawn: the result has no {missing[0]!r}",
                        key=draw.__name__,
                        allowed=f"a result with {', '.join(names)}",
                    )
            return draw(*args, **kwargs)

        return checked

    return decorate


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the house style, whatever the user's matplotlib settings."""

    @wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with matplotlib.rc_context(_rc()):
            return draw(*args, **kwargs)

    return wrapper


def _rc() -> Any:
    return {**matplotlib.rcParamsDefault, **_RC, "backend": matplotlib.rcParams["backend"]}


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
    formats: Sequence[str] = ("png", "svg"),
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
        Width on paper [m], as 0.085 for a column; letters keep their size, long titles and legends are broken. For
        figures with one column of panels. The figure itself stays as it is.

    Returns
    -------
    tuple of Path
        A file for each of `formats`, in their order.

    Raises
    ------
    InputError
        The folder cannot be made or written to, a format is unknown, or the width is not positive.
    """
    stem = Path(stem)
    unknown = [name for name in formats if name not in _METADATA]
    if unknown:
        raise InputError("is no format of figures", key="formats", value=unknown[0], allowed=", ".join(_METADATA))
    if width is not None and not width > 0:
        raise InputError("is no width", key="width", value=width, allowed="above 0 m, as 0.085 or 0.17")
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    written = [stem.with_name(f"{stem.name}.{name}") for name in formats]
    engine = fig.get_layout_engine()
    with matplotlib.rc_context(_rc()), _resized(fig, width):
        for path, name in zip(written, formats, strict=True):
            with replacing(path) as temporary:
                fig.savefig(temporary, dpi=dpi, format=name, metadata=_METADATA[name])
            fig.set_layout_engine(None)  # the places are found once: that takes longer than to draw
    fig.set_layout_engine(engine)
    return tuple(written)


@contextmanager
def _resized(fig: Figure, width: float | None) -> Iterator[None]:
    """The figure with another width [m], for as long as it is written."""
    if width is None:
        yield
        return
    before = tuple(float(size) for size in fig.get_size_inches())
    titles = [text for axes in fig.axes for text in axes.findobj(Text) if text.get_text() == axes.get_title(loc="left")]
    share = width / INCH / before[0]
    fig.set_size_inches(width / INCH, before[1] * min(1.0, np.sqrt(share)))
    for title in titles:
        title.set_wrap(True)
    legends = list(fig.legends)
    for legend in legends:
        _narrowed(fig, legend, share)
    try:
        yield
    finally:
        fig.set_size_inches(before[0], before[1])
        for title in titles:
            title.set_wrap(False)
        fig.legends[:] = legends


def _narrowed(fig: Figure, legend: Any, share: float) -> None:
    """The same legend outside the panels in fewer columns."""
    legend.remove()
    where: Any = f"outside {legend._outside_loc} center"
    fig.legend(
        legend.legend_handles,
        [text.get_text() for text in legend.get_texts()],
        loc=where,
        ncols=max(1, int(legend._ncols * share)),
        title=legend.get_title().get_text() or None,
    )
