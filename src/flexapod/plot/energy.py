"""Energies over time and how well their balance closes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import LINE_STYLES, PAGE, figure, mark_end, needs, scale, styled
from flexapod.scene.colours import ENERGIES
from flexapod.scene.robot import motion_end

__all__ = ["energies"]

_SIGN = {"work_drive": -1.0, "work_external": -1.0}


@styled
@needs("energy_kinetic", "work_drive")
def energies(data: xr.Dataset) -> Figure:
    """Energies and works since the start, the strain energy on its own scale, and the closure of the balance.

    Parameters
    ----------
    data : xarray.Dataset
        With the `energy_...` and `work_...` variables (time) [J].
    """
    fig = figure(PAGE, 5.8)
    rows = fig.subplots(3, 1, sharex=True, height_ratios=(1.6, 1, 1))
    end, time = motion_end(data), data.time.values
    names = [name for name in ENERGIES if name in data]
    changes = {name: data[name] - data[name][0] for name in names}
    big = scale(xr.concat(list(changes.values()), dim="part"), "J")
    for i, name in enumerate(names):
        words, color = ENERGIES[name]
        rows[0].plot(time, big(changes[name]), label=words, color=color, linestyle=LINE_STYLES[i])
    _line(rows[1], time, data.energy_strain, "Strain energy, with that of the drive springs", "energy")
    balance = xr.concat([_SIGN.get(name, 1.0) * data[name] for name in names], dim="part").sum("part")
    _line(
        rows[2],
        time,
        balance - balance[0],
        "Balance: energies plus losses minus works, change since the start",
        "balance",
    )
    rows[0].set_title("Energies and works, change since the start")
    rows[0].set_ylabel(f"energy [{big.name}]")
    fig.legend(*rows[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, handlelength=3)
    rows[-1].set_xlabel("time [s]")
    for axes in rows:
        mark_end(axes, end, "motion ends" if axes is rows[0] else "")
    fig.align_ylabels(rows)
    return fig


def _line(axes: Axes, time: np.ndarray, values: xr.DataArray, title: str, label: str) -> None:
    small = scale(values, "J")
    axes.plot(time, small(values), color="#333333", linewidth=1.0)
    axes.set_title(title)
    axes.set_ylabel(f"{label} [{small.name}]")
