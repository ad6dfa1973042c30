"""What the deviation depends on: the joints' half-angle, and a start with a jump in rate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from flexapod.paper.claim import PAPER_DEVIATION
from flexapod.plot.style import COLUMN, PAGE, SMALL, figure, ink, styled
from flexapod.scene.colours import AXIS_COLORS
from flexapod.words import scale

_MARKS = {"x": "^", "y": "o", "z": "s"}


@styled
def half_angles(sweeps: Mapping[str, xr.Dataset]) -> Figure:
    """Largest deviation, largest drive force and lowest frequency against the half-angle of the joint pairs.

    Parameters
    ----------
    sweeps : mapping of title to xarray.Dataset
        With `deviation_peak` (half_angle, axis), `force_peak`, `lowest_frequency`, `verdict` (half_angle).
    """
    fig = figure(COLUMN * min(len(sweeps), 2), 6.6)
    grid = fig.subplots(3, len(sweeps), sharex=True, sharey="row", squeeze=False, height_ratios=(2, 1, 1))
    for column, (title, sweep) in enumerate(sweeps.items()):
        top, force, pitch = grid[:, column]
        _peaks(top, sweep)
        top.set_title(title)
        force.semilogy(sweep.half_angle, 1e-3 * sweep.force_peak, "o-", color="#333333", markersize=4)
        pitch.semilogy(sweep.half_angle, sweep.lowest_frequency, "o-", color="#333333", markersize=4)
        pitch.set_xlabel("half-angle of the joint pairs [deg]")
        for axes in (top, force, pitch):
            axes.axvline(30, color="#C44E52", linewidth=1.2)
            for angle, words in zip(sweep.half_angle.values, sweep.verdict.values, strict=True):
                if str(words) != "":
                    axes.axvspan(angle - 0.35, angle + 0.35, color="#C44E52", alpha=0.15, linewidth=0)
        _lost(top, sweep)
    grid[0, 0].set_ylabel("largest deviation of the\ncentre of mass [µm]")
    grid[1, 0].set_ylabel("largest drive\nforce [kN]")
    grid[2, 0].set_ylabel("lowest frequency\non the path [Hz]")
    grid[0, 0].legend(loc="upper left")
    fig.align_ylabels(grid[:, 0])
    return fig


def _peaks(axes: Axes, sweep: xr.Dataset) -> None:
    for axis in sweep.axis.values:
        name = str(axis)
        values = 1e6 * sweep.deviation_peak.sel(axis=name)
        axes.semilogy(
            sweep.half_angle, values, _MARKS[name] + "-", color=AXIS_COLORS[name], label=name.upper(), markersize=5
        )
    for name, limit in PAPER_DEVIATION.items():
        axes.axhline(1e6 * limit, color=AXIS_COLORS[name], linewidth=0.9, linestyle=(0, (5, 3)))
        axes.annotate(
            f"the paper's {1e3 * limit:.0f} mm in {name.upper()}",
            (4.5, 1e6 * limit),
            xytext=(0, 2 if name == "z" else -2),
            textcoords="offset points",
            va="bottom" if name == "z" else "top",
            fontsize=SMALL,
            color=ink(AXIS_COLORS[name]),
        )
    axes.annotate("architecture singularity", (30, 0.03), xycoords=("data", "axes fraction"), xytext=(-3, 0),
                  textcoords="offset points", rotation=90, ha="right", fontsize=SMALL, color="#C44E52")  # fmt: skip
    axes.set_xlim(4, 31)


def _lost(axes: Axes, sweep: xr.Dataset) -> None:
    """Name the half-angles at which there is no result."""
    for angle, words in zip(sweep.half_angle.values, sweep.verdict.values, strict=True):
        if str(words) != "":
            place = {
                "xycoords": ("data", "axes fraction"),
                "textcoords": "offset points",
                "rotation": 90,
                "va": "bottom",
            }
            label = str(words).split(":")[0].split(" from ")[0]
            axes.annotate(label, (angle, 0.03), xytext=(-7, 0), ha="right", fontsize=SMALL, color="#C44E52", **place)


@styled
def light_pistons(light: xr.Dataset) -> Figure:
    """Vibration of payload and tips after the roll against the mass of a piston, hollow ones and thinner ones.

    Parameters
    ----------
    light : xarray.Dataset
        From `light.light_pistons`; its first piston is the paper's.
    """
    fig = figure(PAGE, 2.9)
    panels = fig.subplots(1, 2, sharex=True)
    hollow = light.inner.values > 0
    kinds = {"hollow": hollow, "thinner": ~hollow}
    titles = {"payload_vibration": "Centre of mass", "tip_vibration": "Tips of the pistons"}
    for axes, (name, title) in zip(panels, titles.items(), strict=True):
        for (kind, shown), axis in zip(kinds.items(), "yz", strict=True):
            chosen = light.isel(piston=np.flatnonzero(shown | (np.arange(len(shown)) == 0)))
            axes.loglog(
                chosen.piston_mass,
                1e6 * chosen[name],
                _MARKS[axis] + "-",
                color=AXIS_COLORS[axis],
                label=kind,
                markersize=5,
            )
        axes.set(title=title, xlabel="mass of a piston [kg]", ylabel="peak to peak after the roll [µm]")
        axes.xaxis.set_major_formatter(ScalarFormatter())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xticks([0.5, 1.0, 2.0, 3.0])
    panels[0].legend()
    return fig


@styled
def start_jump(smooth: xr.Dataset, jump: xr.Dataset) -> Figure:
    """Deviation with a smooth start against a start whose rate jumps, on one scale, an axis a row.

    Parameters
    ----------
    smooth, jump : xarray.Dataset
        Results of the same robot and stroke.
    """
    fig = figure(PAGE, 5.0)
    rows = fig.subplots(2, 1, sharex=True)
    unit = scale(jump.com_deviation, "m")
    for axes, axis in zip(rows, ("y", "z"), strict=True):
        values = unit(jump.com_deviation.sel(axis=axis))
        axes.plot(jump.time, values, color=AXIS_COLORS[axis], linewidth=0.8, label="rate jumps at the start")
        axes.plot(
            smooth.time, unit(smooth.com_deviation.sel(axis=axis)), color="#222222", linewidth=1.4, label="smooth start"
        )
        axes.axhline(0, color="#555555", linewidth=0.7)
        peak = float(np.abs(values).max())
        axes.set_title(f"Flexible minus rigid, {axis.upper()} (largest with the jump: {peak:.3g} {unit.name})")
        axes.set_ylabel(f"deviation [{unit.name}]")
        axes.legend(ncols=2, loc="upper right")
        axes.margins(y=0.2)
    rows[-1].set_xlabel("time [s]")
    rows[-1].set_xlim(float(jump.time[0]), float(jump.time[-1]))
    return fig
