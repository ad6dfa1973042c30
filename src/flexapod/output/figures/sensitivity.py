"""Sensitivities as a tornado: bars to both sides, the longest on top, a panel for each output."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexapod.design.tornado import bars, factor_words
from flexapod.output.figures.style import NOTE, PAGE, figure, house_style, require_variables

MOST = 10  # bars of an output
UP, DOWN = "#b5442c", "#2c6fb5"


@house_style
@require_variables("sensitivity", "factor_effect")
def tornado(data: xr.Dataset) -> Figure:
    """Sensitivities of each output, per cent for a per cent, the largest on top.

    Beside the bars: change of the output by halving an error or doubling a stiffness.

    Parameters
    ----------
    data : xarray.Dataset
        From `flexapod.sensitivity`.
    """
    names = [str(name) for name in data.output.values]
    rows = [bars(data, name)[:MOST] for name in names]
    heights = [max(len(found), 2) + 2.0 for found in rows]
    fig = figure(PAGE, 0.4 + 0.23 * sum(heights))
    panels = np.atleast_1d(fig.subplots(len(names), 1, height_ratios=heights))
    for axes, name, found in zip(panels, names, rows, strict=True):
        sizes = [bar.sensitivity for bar in found]
        axes.barh(range(len(found)), sizes, color=[UP if size > 0 else DOWN for size in sizes], height=0.72)
        for place, bar in enumerate(found):
            axes.annotate(
                f" {bar.sensitivity:+.2f}   {factor_words(bar)}", (max(bar.sensitivity, 0.0), place), va="center",
                fontsize=NOTE,
            )  # fmt: skip
        axes.set_yticks(range(len(found)), [bar.key for bar in found])
        axes.set_ylim(max(len(found), 2) - 0.5, -0.5)
        axes.axvline(0.0, color="#222222", linewidth=0.8)
        axes.grid(axis="y", visible=False)
        axes.margins(x=0.3)
        axes.set_title(name.replace("_", " "))
    panels[-1].set_xlabel("per cent of the output for a per cent of the key")
    return fig
