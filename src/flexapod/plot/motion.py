"""The commanded motion: position, rate and acceleration over time."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexapod.plot.style import LEG_COLORS, LINE_STYLES, PAGE, figure, mark_end, needs, scale, styled
from flexapod.scene.robot import motion_coordinates, motion_end
from flexapod.study.words import NOTHING

__all__ = ["motion_law"]

_TURNS = ("roll", "pitch", "yaw")
_UNITS = {"position": ("m", "rad"), "rate": ("m/s", "rad/s"), "acceleration": ("m/s²", "rad/s²")}


@styled
@needs("translation_command")
def motion_law(data: xr.Dataset) -> Figure:
    """Commanded motion of the platform, of those axes that move: position, rate and acceleration.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation, with its study in the attributes.
    """
    law = motion_coordinates(data)
    moving = [str(name) for name in law.coordinate.values if np.ptp(law.position.sel(coordinate=name).values) > NOTHING]
    turns = [name for name in moving if name in _TURNS]
    shifts = [name for name in moving if name not in _TURNS]
    groups = [group for group in (turns, shifts) if group] or [["roll"]]
    fig = figure(PAGE, 5.2)
    grid = fig.subplots(3, len(groups), sharex=True, squeeze=False)
    end = motion_end(data)
    for column, names in enumerate(groups):
        for row, part in enumerate(_UNITS):
            axes, values = grid[row, column], law[part].sel(coordinate=names)
            unit = scale(values, _UNITS[part][names[0] in _TURNS])
            for i, name in enumerate(names):
                style = {"color": LEG_COLORS[i], "linestyle": LINE_STYLES[i]}
                axes.plot(data.time, unit(values.sel(coordinate=name)), label=name, **style)
            axes.set_ylabel(f"{part} [{unit.name}]")
            if row == 0:
                axes.set_title(" and ".join(names).capitalize() + " from home")
            mark_end(axes, end, "motion ends" if row == column == 0 else "")
        grid[-1, column].set_xlabel("time [s]")
        if len(names) > 1:
            grid[0, column].legend()
    fig.align_ylabels(grid)
    return fig
