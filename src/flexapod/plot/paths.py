"""Path of the payload: rigid against flexible, and the deviation between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import (
    AXIS_COLORS,
    COLUMN,
    FLEXIBLE,
    NOTE,
    RIGID,
    figure,
    flat_on_the_scale_of_others,
    mark_end,
    needs,
    scale,
    styled,
)
from flexapod.scene.robot import motion_end
from flexapod.study.after.summary import POINT_WORDS
from flexapod.study.words import cleared

__all__ = ["com_path"]


@styled
@needs("com_deviation")
def com_path(data: xr.Dataset, axes: Sequence[str] = ("y", "z"), point: str = "com") -> Figure:
    """Path of a payload point, rigid against flexible, with the deviation below on its own scale.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.simulate` or `flexapod.run`.
    axes : sequence of str
        World axes to show, a column each.
    point : str
        ``com`` (centre of mass) or ``tool``.
    """
    fig = figure(COLUMN * min(len(axes), 2), 4.6, gap=0.06)
    grid = fig.subplots(2, len(axes), sharex=True, squeeze=False, height_ratios=(1.15, 1.0))
    deviation = data[f"{point}_deviation"].sel(axis=list(axes))
    small = scale(deviation, "m")
    end, time = motion_end(data), data.time.values
    name = POINT_WORDS[point]
    largest, sizes = float(np.abs(small(data[f"{point}_deviation"])).max()), []
    for column, axis in enumerate(axes):
        _paths(grid[0, column], data, point, axis)
        below = grid[1, column]
        values = cleared(small(deviation.sel(axis=axis)), largest)
        sizes.append(float(np.abs(values).max()))
        below.plot(time, values, color=AXIS_COLORS[axis], linewidth=1.1)
        below.axhline(0, color="#555555", linewidth=0.7)
        if sizes[-1]:
            _peak(below, time, values, small.name)
        below.set_xlabel("time [s]")
        below.set_title(f"Flexible minus rigid, {axis.upper()}")
        mark_end(grid[0, column], end, "motion ends")
        mark_end(below, end)
    flat_on_the_scale_of_others(grid[1], sizes)
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    grid[0, 0].set_ylabel(f"position of the\n{name} [mm]")
    grid[1, 0].set_ylabel(f"deviation [{small.name}]")
    return fig


def _paths(axes: Axes, data: xr.Dataset, point: str, axis: str) -> None:
    """Rigid path as a broad pale band, flexible path as a fine dark line on it: both show where they coincide."""
    time = data.time.values
    rigid, flexible = (data[f"{point}_position{end}"].sel(axis=axis).values for end in ("_rigid", ""))
    axes.plot(time, 1e3 * rigid, color=RIGID, linewidth=6, solid_capstyle="butt", label="rigid legs")
    axes.plot(time, 1e3 * flexible, color=FLEXIBLE, linewidth=1.3, label="flexible legs")
    axes.set_title(f"Path in {axis.upper()}")
    axes.margins(y=0.12)
    if np.ptp(rigid) < 1e-6:  # nothing moves along this axis: no false drama by the choice of the scale
        middle = 1e3 * float(rigid.mean())
        axes.set_ylim(middle - 1, middle + 1)


def _peak(axes: Axes, time: np.ndarray, values: np.ndarray, unit: str) -> None:
    """Mark the largest deviation with its value."""
    at = int(np.argmax(np.abs(values)))
    above = values[at] > values.mean()
    axes.margins(y=0.22)
    axes.plot(time[at], values[at], "o", color="#333333", markersize=4, zorder=5)
    right = time[at] > 0.5 * (time[0] + time[-1])
    axes.annotate(
        f"peak {values[at]:.3g} {unit}".replace("-", "\N{MINUS SIGN}"),
        (time[at], values[at]),
        xytext=(-6 if right else 6, 6 if above else -6),
        textcoords="offset points",
        ha="right" if right else "left",
        va="bottom" if above else "top",
        fontsize=NOTE,
    )
