"""What the deviation depends on: the joints' half-angle, and a start with a jump in rate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from flexapod.common.quantities import scale
from flexapod.output.figures.style import COLUMN, PAGE, SMALL, figure, ink, styled
from flexapod.output.figures.swings import MOST, vibration_line
from flexapod.output.scene.colours import AXIS_COLORS
from flexapod.verification.paper.claim import PAPER_DEVIATION

START = 0.2  # s after a start with a jump, shown by itself
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
    """Deviation, and vibration after the roll, against the mass of a piston, hollow ones and thinner ones.

    Parameters
    ----------
    light : xarray.Dataset
        From `light.light_pistons`; its first piston is the paper's.
    """
    fig = figure(PAGE, 2.9)
    panels = fig.subplots(1, 3, sharex=True)
    hollow = light.inner.values > 0
    kinds = {"hollow": hollow, "thinner": ~hollow}
    shown = {
        "Deviation in z": (light.deviation_peak.sel(axis="z"), "largest deviation [µm]"),
        "Centre of mass": (light.payload_vibration, "peak to peak after the roll [µm]"),
        "Tips of the pistons": (light.tip_vibration, "peak to peak after the roll [µm]"),
    }
    for axes, (title, (values, label)) in zip(panels, shown.items(), strict=True):
        for (kind, some), axis in zip(kinds.items(), "yz", strict=True):
            chosen = np.flatnonzero(some | (np.arange(len(some)) == 0))
            axes.loglog(
                light.piston_mass[chosen],
                1e6 * values[chosen],
                _MARKS[axis] + "-",
                color=AXIS_COLORS[axis],
                label=kind,
                markersize=5,
            )
        axes.set(title=title, xlabel="mass of a piston [kg]", ylabel=label)
        axes.xaxis.set_major_formatter(ScalarFormatter())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xticks([0.5, 1.0, 2.0, 3.0])
    panels[0].yaxis.set_major_formatter(ScalarFormatter())
    panels[0].yaxis.set_minor_formatter(NullFormatter())
    panels[0].set_yticks([20, 50, 100])
    fig.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return fig


@styled
def start_jump(smooth: xr.Dataset, jump: xr.Dataset) -> Figure:
    """Deviation with a smooth start against a start whose rate jumps, on one scale, an axis a row, its start beside it.

    A deviation that swings more often than a picture can show is drawn as the band that it fills.

    Parameters
    ----------
    smooth, jump : xarray.Dataset
        Results of the same robot and stroke.
    """
    fig = figure(PAGE, 5.0, gap=0.05)
    grid = fig.subplots(2, 2, sharex="col", sharey="row", width_ratios=(2.6, 1))
    unit, first = scale(jump.com_deviation, "m"), jump.time.values <= START
    for (axes, beside), axis in zip(grid, ("y", "z"), strict=True):
        values, time = unit(jump.com_deviation.sel(axis=axis)), jump.time.values
        style = {"color": AXIS_COLORS[axis], "linewidth": 0.9}
        vibration_line(axes, time, values, MOST / 2, label=f"{axis.upper()}, rate jumps at the start", **style)
        beside.plot(time[first], values[first], **style)
        for panel in (axes, beside):
            calm = unit(smooth.com_deviation.sel(axis=axis))
            panel.plot(smooth.time, calm, color="#222222", linewidth=1.4, label="smooth start")
            panel.axhline(0, color="#555555", linewidth=0.7)
        peak = float(np.abs(values).max())
        axes.set_title(f"Flexible minus rigid, {axis.upper()}: up to {peak:.3g} {unit.name}")
        axes.set_ylabel(f"deviation [{unit.name}]")
    grid[0, 1].set_title(f"Its first {START:g} s")
    for panel, last in zip(grid[-1], (float(jump.time[-1]), START), strict=True):
        panel.set_xlabel("time [s]")
        panel.set_xlim(float(jump.time[0]), last)
    words = [axes.get_legend_handles_labels() for axes in grid[:, 0]]
    lines = {name: line for handles, names in words for line, name in zip(handles, names, strict=True)}
    fig.legend(list(lines.values()), list(lines), loc="outside upper center", ncols=3)
    return fig
