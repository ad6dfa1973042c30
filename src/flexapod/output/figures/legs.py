"""Leg by leg: actuator forces, lengths, deflections of the piston tips."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike

from flexapod.analysis.results.attributes import motion_end
from flexapod.common.errors import check_known
from flexapod.common.quantities import NOTHING, Scale, scale, text
from flexapod.common.ranking import EQUALS
from flexapod.output.figures.payload import MOST_SWINGS, vibration_line
from flexapod.output.figures.style import (
    LINE_STYLES,
    PAGE,
    figure,
    house_style,
    legend_columns,
    mark_end,
    require_variables,
    share_flat_scale,
)
from flexapod.output.scene.style import FLEXIBLE, LEG_COLORS, RIGID, colors_of_legs, drives

ROUNDING = 1e-11  # of where drives stand
_WORDS = {"rigid": "rigid legs", "lumped": "legs that stretch", "assumed-modes": "flexible legs"}


@house_style
@require_variables()
def actuator_forces(data: xr.Dataset) -> Figure:
    """Forces of the drives: rigid robot against the multibody model, with their difference below.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation; legs without drive are left out.
    """
    found = drives(data)
    rigid, multibody, gap = found.rigid, found.force, found.force - found.rigid
    big, small = scale(rigid, found.unit), scale(gap, found.unit)
    fig, panels = force_panels([rigid, multibody], [gap], (big, small), (2.2, 1), found.word)
    words = "Newton-Euler" if found.plain else "rigid robot"
    most, quick = MOST_SWINGS / legend_columns(len(panels), 3), False
    time, label = data.time.values, f"multibody model, {_WORDS.get(str(data.attrs.get('fidelity')), 'flexible legs')}"
    for leg, (above, below) in panels.items():
        above.plot(time, big(rigid.sel(leg=leg)), color=RIGID, linewidth=5, label=f"{words}, rigid legs")
        above.plot(time, big(multibody.sel(leg=leg)), color=FLEXIBLE, linewidth=1.1, label=label)
        quick |= vibration_line(below, time, small(gap.sel(leg=leg)), most, color=LEG_COLORS[3], linewidth=0.8)
        mark_end(above, motion_end(data))
        mark_end(below, motion_end(data))
    handles, names = next(iter(panels.values()))[0].get_legend_handles_labels()
    if quick:
        handles.append(Patch(facecolor=LEG_COLORS[3], alpha=0.25))
        names.append("what its swings fill")
    fig.legend(handles, names, loc="outside upper center", ncols=3)
    return fig


def force_panels(
    forces: Sequence[xr.DataArray],
    gaps: Sequence[ArrayLike],
    units: tuple[Scale, Scale],
    ratios: tuple[float, float],
    word: str = "force",
) -> tuple[Figure, dict[int, tuple[Axes, Axes]]]:
    """A figure with a panel for forces and one for their differences below it for each leg, all on the same scales.

    Parameters
    ----------
    forces, gaps : sequence of arrays, shape (time, leg)
        All that will be drawn; the legs of `forces` get panels.
    units : tuple of Scale
        Of forces and of differences.
    ratios : tuple of float
        Heights of the two panels.
    word : str
        What is drawn.
    """
    legs, (big, small) = forces[0].leg.values, units
    across = legend_columns(len(legs), 3)
    rows = -(-len(legs) // across)
    fig = figure(PAGE, 0.2 + 3.0 * rows)
    grid = fig.subplots(2 * rows, across, sharex=True, squeeze=False, height_ratios=ratios * rows)
    low, high = _limits(big(np.asarray(forces)))
    worst = 1.1 * float(np.abs(small(np.asarray(gaps))).max())
    panels = {}
    for place in range(rows * across):
        above, below = grid[2 * (place // across) : 2 * (place // across) + 2, place % across]
        if place >= len(legs):
            above.remove()
            below.remove()
            continue
        panels[int(legs[place])] = above, below
        above.set_title(f"Leg {legs[place]}")
        above.set_ylim(low, high)
        if worst > 0:
            below.set_ylim(-worst, worst)
        if place + across >= len(legs):
            below.set_xlabel("time [s]")
            below.tick_params(labelbottom=True)
        if place % across == 0:
            above.set_ylabel(f"{word} [{big.name}]")
            below.set_ylabel(f"difference\n[{small.name}]")
    fig.align_ylabels(grid[:, 0])
    return fig, panels


def _limits(values: np.ndarray) -> tuple[float, float]:
    margin = 0.07 * max(float(np.ptp(values)), 1e-9)
    return float(values.min()) - margin, float(values.max()) + margin


@house_style
@require_variables()
def leg_lengths(data: xr.Dataset) -> Figure:
    """Commanded lengths of the legs, or places of their carriages, and the errors of the flexible robot.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation; legs without drive are left out.
    """
    found = drives(data)
    command, error, lengths = found.command, found.position - found.command, found.place == "length"
    error = error * (float(np.abs(error).max()) > ROUNDING * float(np.abs(command).max()))
    big = Scale(1e3, "mm") if found.place_unit == "m" else scale(command, "rad")
    small, end, off = scale(error, found.place_unit), motion_end(data), lengths or bool(error.any())
    fig = figure(PAGE, 5.0 if off else 3.0)
    above, *others = fig.subplots(1 + off, 1, sharex=True, squeeze=False, height_ratios=(1.3, 1)[: 1 + off])[:, 0]
    for i, leg in enumerate(data.leg.values):
        if leg in command.leg:
            _leg_line(above, data, big(command.sel(leg=leg)), i)
            for below in others:
                _leg_line(below, data, small(error.sel(leg=leg)), i)
    travel = float((command.max("time") - command.min("time")).max())
    spread = float((command.max("leg") - command.min("leg")).max())
    words = f"longest travel {_rounded(travel, found.place_unit)}"
    differ = spread > EQUALS * float(np.abs(command).max())
    words += (f", legs differ by up to {_rounded(spread, 'm')}" if differ else ", all legs alike") * lengths
    above.set_title(f"Commanded {found.place} ({words})")
    above.set_ylabel("joint to joint [mm]" if lengths else f"{found.place} [{big.name}]")
    for below in others:
        below.set_title("Length error of the flexible legs" if lengths else "How far the drives are off")
        below.set_ylabel(f"flexible minus\ncommand [{small.name}]")
        mark_end(below, end)
    [above, *others][-1].set_xlabel("time [s]")
    mark_end(above, end, "motion ends")
    _leg_legend(fig, above)
    return fig


def _rounded(value: float, unit: str) -> str:
    """A travel in words: whole millimetres, or what reads well where it is below one."""
    return f"{1e3 * value:.0f} mm" if unit == "m" and value >= 1e-3 else text(value, unit, 2)


@house_style
@require_variables("tip_deflection", "com_deviation")
def tip_deflections(data: xr.Dataset) -> Figure:
    """Lateral deflection of each piston's tip from its cylinder's axis, in two directions, each to its own scale.

    Parameters
    ----------
    data : xarray.Dataset
        With `tip_deflection` (time, leg, direction).
    """
    fig = figure(PAGE, 4.8)
    rows = fig.subplots(2, 1, sharex=True)
    off = data.tip_deflection * (float(np.abs(data.tip_deflection).max()) >= NOTHING)
    end, sizes = motion_end(data), [float(np.abs(off.sel(direction=name)).max()) for name in data.direction.values]
    words = {"a": "across the leg, direction a (level at home)", "b": "across the leg, direction b"}
    for axes, direction, size in zip(rows, data.direction.values, sizes, strict=True):
        small = scale(size or max(sizes), "m")
        for i, leg in enumerate(data.leg.values):
            _leg_line(axes, data, small(off.sel(leg=leg, direction=direction)), i)
        axes.set(title="Piston tip " + words[str(direction)], ylabel=f"deflection [{small.name}]")
        mark_end(axes, end, "motion ends" if axes is rows[0] else "")
    share_flat_scale(rows.tolist(), sizes)
    rows[-1].set_xlabel("time [s]")
    _leg_legend(fig, rows[0])
    return fig


def _leg_line(axes: Axes, data: xr.Dataset, values: np.ndarray, i: int) -> None:
    color, style = colors_of_legs(i + 1)[i], LINE_STYLES[i % len(LINE_STYLES)]
    axes.plot(data.time, values, color=color, linestyle=style, linewidth=1.2, label=f"leg {data.leg.values[i]}")


def _leg_legend(fig: Figure, axes: Axes) -> None:
    lines, words = axes.get_legend_handles_labels()
    fig.legend(lines, words, loc="outside upper center", ncols=legend_columns(len(words)), handlelength=2.6)


@house_style
@require_variables()
def by_leg(data: xr.Dataset, name: str) -> Figure:
    """A result of an element over time, a line for each leg that has it.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation.
    name : str
        Of a variable (time, leg).
    """
    known = [str(variable) for variable, array in data.data_vars.items() if {"time", "leg"} == {*array.dims}]
    check_known(name, known, "name", "is no variable of time and legs")
    values = data[name]
    unit, fig = scale(values, values.attrs["units"]), figure(PAGE, 3.0)
    axes = fig.subplots()
    for i, leg in enumerate(data.leg.values):
        if values.sel(leg=leg).notnull().any():
            _leg_line(axes, data, unit(values.sel(leg=leg)), i)
    axes.set(xlabel="time [s]", ylabel=f"{name.replace('_', ' ')} [{unit.name}]")
    mark_end(axes, motion_end(data), "motion ends")
    _leg_legend(fig, axes)
    return fig
