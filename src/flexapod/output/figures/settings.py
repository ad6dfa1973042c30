"""Settings of matplotlib in which figures are drawn, whatever the user's own."""

from __future__ import annotations

from functools import cache
from typing import Any

import matplotlib

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
def settings() -> Any:
    """The defaults of matplotlib, and ours."""
    defaults = {name: value for name, value in matplotlib.rcParamsDefault.items() if name != "backend"}
    ours: Any = defaults | _RC
    with matplotlib.rc_context(ours):  # asked for its backend, matplotlib would import pyplot
        now: Any = matplotlib.rcParams
        return {name: now[name] for name in defaults}


def are_set() -> bool:
    """Whether they hold now."""
    return settings().items() <= dict.items(matplotlib.rcParams)
