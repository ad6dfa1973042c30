"""Which part is to blame: the deviation split by cause and by leg."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import PAGE, Scale, figure, mark_end, needs, scale, styled
from flexapod.study.names import CAUSE_WORDS
from flexapod.study.scene import motion_end

__all__ = ["deviation_by_cause"]

_COLORS = {"axial-strain": "#0072B2", "bending": "#D55E00", "drive": "#009E73"}


@styled
@needs("deviation_by_cause")
def deviation_by_cause(data: xr.Dataset) -> Figure:
    """Deviation of the centre of mass by cause over time, and by leg at the largest deviation of each axis.

    Parameters
    ----------
    data : xarray.Dataset
        With `deviation_by_cause` (time, cause, leg, axis) and `com_deviation` (time, axis).
    """
    fig = figure(PAGE, 5.6)
    grid = fig.subplots(3, 2, width_ratios=(2.1, 1), sharex="col")
    total = data.com_deviation
    acting = np.abs(data.deviation_by_cause).max(("time", "leg", "axis")) > 0
    parts = data.deviation_by_cause.sel(cause=acting)
    small = scale(total, "m")
    end, time = motion_end(data), data.time.values
    for row, axis in enumerate(data.axis.values):
        left, right = grid[row]
        sums = parts.sel(axis=axis).sum("leg")
        left.plot(time, small(total.sel(axis=axis)), color="#C8C8C8", linewidth=5, label="whole deviation")
        for cause in parts.cause.values:
            label = CAUSE_WORDS.get(str(cause), str(cause))
            left.plot(time, small(sums.sel(cause=cause)), color=_COLORS.get(str(cause)), linewidth=1.2, label=label)
        left.axhline(0, color="#555555", linewidth=0.7)
        left.set_title(f"{str(axis).upper()}, over time")
        left.set_ylabel(f"deviation [{small.name}]")
        mark_end(left, end, "motion ends" if row == 0 else "")
        _by_leg(right, parts.sel(axis=axis), total.sel(axis=axis), small, str(axis))
    grid[-1, 0].set_xlabel("time [s]")
    grid[-1, 1].set_xlabel("leg")
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    for column in grid.T:
        fig.align_ylabels(column)
    return fig


def _by_leg(axes: Axes, parts: xr.DataArray, total: xr.DataArray, small: Scale, axis: str) -> None:
    """Stacked bars: what each leg contributes, cause by cause, at the instant of the largest deviation."""
    at = int(np.abs(total.values).argmax())
    legs = np.arange(1, parts.sizes["leg"] + 1)
    above, below = np.zeros(len(legs)), np.zeros(len(legs))
    for cause in parts.cause.values:
        values = small(parts.isel(time=at).sel(cause=cause))
        base = np.where(values >= 0, above, below)
        axes.bar(legs, values, bottom=base, color=_COLORS.get(str(cause)), width=0.7)
        above, below = above + np.maximum(values, 0), below + np.minimum(values, 0)
    axes.axhline(0, color="#555555", linewidth=0.7)
    axes.set_xticks(legs)
    axes.grid(axis="x", visible=False)
    axes.set_ylabel(f"part [{small.name}]")
    axes.set_title(f"{axis.upper()}, by leg at {float(total.time[at]):.2f} s")
    axes.use_sticky_edges = False
    axes.margins(y=0.1)
