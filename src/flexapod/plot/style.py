"""House style of all figures: colours that colour-blind readers tell apart, SI units in labels, PNG and SVG files."""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

__all__ = ["AXIS_COLORS", "FLEXIBLE", "LEG_COLORS", "RIGID", "Scale", "figure", "mark_end", "save", "scale", "styled"]

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
_PREFIXES = {
    "m": ((1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")),
    "N": ((1e-3, "kN"), (1.0, "N"), (1e3, "mN"), (1e6, "µN")),
    "J": ((1e-3, "kJ"), (1.0, "J"), (1e3, "mJ"), (1e6, "µJ"), (1e9, "nJ")),
    "rad": ((180 / np.pi, "deg"), (1e3, "mrad"), (1e6, "µrad")),
    "m/s": ((1.0, "m/s"), (1e3, "mm/s")),
    "m/s²": ((1.0, "m/s²"), (1e3, "mm/s²")),
    "rad/s": ((180 / np.pi, "deg/s"),),
    "rad/s²": ((180 / np.pi, "deg/s²"),),
}


class Scale:
    """Factor from SI to the unit `name` in which a quantity reads well."""

    def __init__(self, factor: float, name: str) -> None:
        self.factor, self.name = factor, name

    def __call__(self, values: ArrayLike) -> np.ndarray:
        """Values in that unit."""
        return np.asarray(values, dtype=float) * self.factor

    def text(self, value: float, digits: int = 3) -> str:
        """A number with its unit."""
        shown = f"{value * self.factor:.{digits}g}"
        if "e" in shown:
            shown = f"{float(shown):,.0f}" if abs(float(shown)) >= 1 else shown
        return f"{shown} {self.name}"


def scale(values: ArrayLike, unit: str) -> Scale:
    """Choose the unit in which the largest of `values` (SI, `unit`) lies between 1 and 1000, if there is one.

    Parameters
    ----------
    values : array_like
        In SI units; NaN are ignored.
    unit : str
        SI unit: m, N, J, rad, m/s, rad/s, ...; others stay as they are.
    """
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    largest = float(finite.max()) if finite.size else 0.0
    choices = [Scale(factor, name) for factor, name in _PREFIXES.get(unit, ((1.0, unit),))]
    if largest == 0:
        return Scale(1.0, unit) if unit != "rad" else choices[0]
    for choice in choices:
        if largest * choice.factor >= 1:
            return choice
    return choices[-1]


def figure(width: float = 7.4, height: float = 4.6) -> Figure:
    """Empty figure [in] on the Agg canvas, without pyplot's global state."""
    made = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(made)
    return made


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the house style, whatever the user's matplotlib settings."""

    @wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with matplotlib.rc_context(_rc()):
            return draw(*args, **kwargs)

    return wrapper


def _rc() -> dict[str, Any]:
    return {**matplotlib.rcParamsDefault, **_RC, "backend": matplotlib.rcParams["backend"]}


def mark_end(axes: Axes, instant: float | None, text: str = "") -> None:
    """Mark the end of the commanded motion by a fine line, with a word on the first of a column."""
    if instant is None:
        return
    axes.axvline(instant, color="#888888", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    if text:
        place = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        axes.annotate(text, (instant, 1.0), xytext=(4, 3), va="bottom", fontsize=8, color="#555555", **place)


def save(fig: Figure, stem: str | Path, *, dpi: int = 160) -> tuple[Path, Path]:
    """Write a figure as ``stem.png`` and ``stem.svg``; folders are made as needed.

    Returns
    -------
    tuple of Path
        The PNG and the SVG file.
    """
    stem = Path(stem)
    stem.parent.mkdir(parents=True, exist_ok=True)
    png, svg = stem.with_name(stem.name + ".png"), stem.with_name(stem.name + ".svg")
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    with matplotlib.rc_context(_rc()):
        fig.savefig(png, dpi=dpi, metadata={"Software": "flexapod"})
        fig.savefig(svg, metadata={"Date": None, "Creator": "flexapod"})
    return png, svg
