"""Random vibration of the tool: rms of what is at each frequency and above, with its steps named by mode."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from flexapod.common.quantities import scale
from flexapod.common.ranking import ranked
from flexapod.output.figures.style import NOTE, PAGE, figure, needs, styled
from flexapod.output.scene.colours import AXIS_COLORS

NAMED = 3  # modes with the largest steps
ROW = 10  # height of a name [points]
LEAST = 0.05  # share of a mode in the variance that is worth a name
ROUNDING = 1e-9  # of the largest, a radian as a metre: what symmetry makes zero comes out at 1e-13 and less
DECADES = 1e4  # from the lowest to the highest frequency, from which on each has one number


@styled
@needs("vibration_cumulative", "vibration_by_mode")
def vibration(data: xr.Dataset) -> Figure:
    """Cumulative rms of the tool along and about the axes over frequency.

    Each curve starts at the whole rms and falls by what each frequency adds; modes with the largest steps are named.

    Parameters
    ----------
    data : xarray.Dataset
        From `flexapod.vibration`.
    """
    fig = figure(PAGE, 5.2)
    panels = fig.subplots(2, 1, sharex=True)
    for axes, names, unit, title in zip(
        panels, (("x", "y", "z"), ("rx", "ry", "rz")), ("m", "rad"),
        ("displacement of the tool", "rotation of the tool"), strict=True,
    ):  # fmt: skip
        part = data.vibration_cumulative.sel(component=list(names))
        moves = bool(part.max() >= ROUNDING * data.vibration_cumulative.max())
        part = part if moves else 0 * part
        small = scale(part, unit)
        for name, color, width in zip(names, AXIS_COLORS.values(), (3.2, 1.3, 1.3), strict=True):
            values = small(part.sel(component=name))  # x broad: y often lies upon it
            axes.plot(data.spectrum_frequency.values, values, color=color, linewidth=width, label=name)
        axes.set_xscale("log")
        axes.set_ylim(bottom=0)
        axes.set_ylabel(f"rms from here up [{small.name}]")
        words = title[0].upper() + title[1:] + ("" if moves else ", zero but for rounding")
        axes.set_title(words, pad=4 + ROW * NAMED)
        if moves:
            _name_modes(axes, data, list(names))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[-1].set_xlabel("frequency [Hz]")
    f = data.spectrum_frequency.values
    panels[-1].xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if f[-1] < DECADES * f[0] else (1,)))
    panels[-1].xaxis.set_major_formatter("{x:g}")
    panels[-1].xaxis.set_minor_formatter(NullFormatter())
    fig.align_ylabels(panels)
    return fig


def _name_modes(axes: Axes, data: xr.Dataset, names: list[str]) -> None:
    """Lines at the modes that take the largest shares of the variance; those of one frequency once."""
    part = (data.vibration_by_mode * data.vibration_rms).sel(component=names).sum("component").values
    whole = float((data.vibration_rms.sel(component=names) ** 2).sum())
    if not whole > 0:
        return
    f = data.frequency.values
    groups = np.cumsum(np.append(0, np.diff(f) > 1e-3 * f[1:]))
    sizes = np.bincount(groups, weights=part)
    named = [group for group in ranked(np.asarray(sizes, float))[:NAMED] if sizes[group] > LEAST * whole]
    for row, group in enumerate(sorted(named, reverse=True)):
        at = np.flatnonzero(groups == group)
        axes.axvline(f[at[0]], color="#777777", linewidth=0.8, linestyle=":")
        number = ("modes " if at.size > 1 else "mode ") + ", ".join(str(k + 1) for k in at)
        axes.annotate(
            f"{number}: {f[at[0]]:.3g} Hz", (f[at[0]], 1.0), xycoords=("data", "axes fraction"),
            xytext=(0, 2 + ROW * row), textcoords="offset points", ha="center", fontsize=NOTE,
        )  # fmt: skip
