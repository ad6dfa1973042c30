"""House style of all figures: colours that colour-blind readers tell apart, SI units in labels, PNG and SVG files."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from flexapod.errors import InputError
from flexapod.study.store import replacing
from flexapod.study.words import Scale, scale

__all__ = [
    "AXIS_COLORS",
    "FLEXIBLE",
    "LEG_COLORS",
    "RIGID",
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

_RC = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "svg.fonttype": "path",
    "svg.hashsalt": "flexapod",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "path.simplify_threshold": 0.2,
}


def figure(width: float = 7.4, height: float = 4.6, gap: float = 0.02) -> Figure:
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
        axes.set_title(axes.get_title(loc="left"), pad=17)
        axes.annotate(text, (instant, 1.0), xytext=(4, 3), va="bottom", fontsize=8, color="#555555", **place)


def save(fig: Figure, stem: str | Path, *, dpi: int = 160) -> tuple[Path, Path]:
    """Write a figure as ``stem.png`` and ``stem.svg``; existing ones are replaced when the new ones are complete.

    Returns
    -------
    tuple of Path
        The PNG and the SVG file.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """
    stem = Path(stem)
    png, svg = stem.with_name(stem.name + ".png"), stem.with_name(stem.name + ".svg")
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    with matplotlib.rc_context(_rc()):
        with replacing(png) as temporary:
            fig.savefig(temporary, dpi=dpi, metadata={"Software": "flexapod"})
        with replacing(svg) as temporary:
            fig.savefig(temporary, metadata={"Date": None, "Creator": "flexapod"})
    return png, svg
