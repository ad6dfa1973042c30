"""Leg by leg: actuator forces, lengths, deflections of the piston tips."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import FLEXIBLE, LEG_COLORS, LINE_STYLES, PAGE, RIGID, figure, mark_end, needs, scale, styled
from flexapod.scene.robot import motion_end
from flexapod.study.words import NOTHING

__all__ = ["actuator_forces", "leg_lengths", "tip_deflections"]

_WORDS = {"rigid": "rigid legs", "lumped": "legs that stretch", "assumed-modes": "flexible legs"}


@styled
@needs("actuator_force_rigid", "actuator_force")
def actuator_forces(data: xr.Dataset) -> Figure:
    """Drive forces of the six legs: Newton-Euler (rigid) against the multibody model, with their difference below.

    Parameters
    ----------
    data : xarray.Dataset
        With `actuator_force_rigid` and `actuator_force` (time, leg).
    """
    fig = figure(PAGE, 6.2)
    grid = fig.subplots(4, 3, sharex=True, height_ratios=(2.2, 1, 2.2, 1))
    rigid, multibody = data.actuator_force_rigid, data.actuator_force
    big, small = scale(rigid, "N"), scale(multibody - rigid, "N")
    end, time = motion_end(data), data.time.values
    limits = [_limits(big(x)) for x in (rigid, multibody)]
    low, high = min(x[0] for x in limits), max(x[1] for x in limits)
    worst = 1.1 * float(np.abs(small(multibody - rigid)).max())
    for i, leg in enumerate(data.leg.values):
        row, column = 2 * (i // 3), i % 3
        above, below = grid[row, column], grid[row + 1, column]
        above.plot(time, big(rigid.sel(leg=leg)), color=RIGID, linewidth=5, label="Newton-Euler, rigid legs")
        label = f"multibody model, {_WORDS.get(str(data.attrs.get('fidelity')), 'flexible legs')}"
        above.plot(time, big(multibody.sel(leg=leg)), color=FLEXIBLE, linewidth=1.1, label=label)
        below.plot(time, small((multibody - rigid).sel(leg=leg)), color=LEG_COLORS[3], linewidth=0.8)
        above.set_title(f"Leg {leg}")
        above.set_ylim(low, high)
        if worst > 0:
            below.set_ylim(-worst, worst)
        for axes in (above, below):
            mark_end(axes, end)
    for row in (0, 2):
        grid[row, 0].set_ylabel(f"force [{big.name}]")
        grid[row + 1, 0].set_ylabel(f"difference\n[{small.name}]")
    for axes in grid[3]:
        axes.set_xlabel("time [s]")
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    fig.align_ylabels(grid[:, 0])
    return fig


def _limits(values: np.ndarray) -> tuple[float, float]:
    margin = 0.07 * max(float(np.ptp(values)), 1e-9)
    return float(values.min()) - margin, float(values.max()) + margin


@styled
@needs("leg_length_command", "leg_length")
def leg_lengths(data: xr.Dataset) -> Figure:
    """Lengths of the six legs, joint to joint: what the drives command, and how far the flexible legs are off.

    Parameters
    ----------
    data : xarray.Dataset
        With `leg_length_command` and `leg_length` (time, leg).
    """
    fig = figure(PAGE, 5.0)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=(1.3, 1))
    command, error = data.leg_length_command, data.leg_length - data.leg_length_command
    small, end, time = scale(error, "m"), motion_end(data), data.time.values
    for i, leg in enumerate(data.leg.values):
        _leg_line(above, time, 1e3 * command.sel(leg=leg).values, i)
        _leg_line(below, time, small(error.sel(leg=leg)), i)
    travel = 1e3 * float((command.max("time") - command.min("time")).max())
    spread = 1e3 * float((command.max("leg") - command.min("leg")).max())
    above.set_title(f"Commanded length (longest travel {travel:.0f} mm, legs differ by up to {spread:.0f} mm)")
    below.set_title("Length error of the flexible legs")
    above.set_ylabel("joint to joint [mm]")
    below.set_ylabel(f"flexible minus\ncommand [{small.name}]")
    below.set_xlabel("time [s]")
    mark_end(above, end, "motion ends")
    mark_end(below, end)
    fig.legend(*above.get_legend_handles_labels(), loc="outside upper center", ncols=6, handlelength=2.6)
    return fig


@styled
@needs("tip_deflection", "leg_length")
def tip_deflections(data: xr.Dataset) -> Figure:
    """Lateral deflection of each piston's tip from its cylinder's axis, in the two directions of the leg frame.

    Parameters
    ----------
    data : xarray.Dataset
        With `tip_deflection` (time, leg, direction).
    """
    fig = figure(PAGE, 4.8)
    rows = fig.subplots(2, 1, sharex=True, sharey=True)
    off = data.tip_deflection * (float(np.abs(data.tip_deflection).max()) >= NOTHING)
    small, end, time = scale(off, "m"), motion_end(data), data.time.values
    words = {"a": "across the leg, direction a (level at home)", "b": "across the leg, direction b"}
    for axes, direction in zip(rows, data.direction.values, strict=True):
        for i, leg in enumerate(data.leg.values):
            _leg_line(axes, time, small(off.sel(leg=leg, direction=direction)), i)
        axes.set_title("Piston tip " + words[str(direction)])
        axes.set_ylabel(f"deflection [{small.name}]")
        mark_end(axes, end, "motion ends" if axes is rows[0] else "")
    rows[-1].set_xlabel("time [s]")
    fig.legend(*rows[0].get_legend_handles_labels(), loc="outside upper center", ncols=6, handlelength=2.6)
    return fig


def _leg_line(axes: Axes, time: np.ndarray, values: np.ndarray, i: int) -> None:
    axes.plot(time, values, color=LEG_COLORS[i], linestyle=LINE_STYLES[i], linewidth=1.2, label=f"leg {i + 1}")
