"""Figures that compare the robot by several programs, and variants of it.

Drive forces and path of the payload are laid one over the other (Figs. 8 and 9). The deviation is shown over
the joints' half-angle, with lighter pistons, and from a start with a jump in rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from flexapod.analysis.results.attributes import motion_end
from flexapod.common.errors import InputError
from flexapod.common.quantities import Scale, scale, text
from flexapod.output.figures.legs import force_panels
from flexapod.output.figures.payload import MOST_SWINGS, vibration_line
from flexapod.output.figures.style import (
    COLUMN,
    NOTE,
    PAGE,
    SMALL,
    figure,
    house_style,
    mark_end,
    readable_color,
    require_variables,
)
from flexapod.output.scene.style import AXIS_COLORS, FLEXIBLE, LEG_COLORS, RIGID
from flexapod.verification.paper.claim import PAPER_DEVIATION

# From broad and pale to fine and dark: all show where they coincide.
_BAND: dict[str, Any] = {"color": RIGID, "linewidth": 6.5, "solid_capstyle": "butt"}
_LINES: tuple[dict[str, Any], ...] = (
    {"color": LEG_COLORS[4], "linewidth": 2.8, "solid_capstyle": "butt"},
    {"color": FLEXIBLE, "linewidth": 0.9},
    {"color": LEG_COLORS[3], "linewidth": 0.9, "linestyle": "--"},
)


@house_style
@require_variables("actuator_force_rigid", "actuator_force")
def engine_forces(results: Mapping[str, xr.Dataset]) -> Figure:
    """Drive forces of the six legs by Newton-Euler and by several models, with their differences below (Fig. 8).

    The first model is compared with Newton-Euler, the others with the first.

    Parameters
    ----------
    results : mapping of names to xarray.Dataset
        With `actuator_force` (time, leg) and, by Newton-Euler with rigid legs, `actuator_force_rigid`; at most three,
        at the same instants.

    Raises
    ------
    InputError
        None or too many results, or at different instants.
    """
    first, name = _checked(results)
    rigid, time, gaps = first.actuator_force_rigid, first.time.values, dict(_gaps(results))
    big, small = scale(rigid, "N"), scale(np.array(list(gaps.values())), "N")
    forces = [rigid, *(data.actuator_force for data in results.values())]
    fig, panels = force_panels(forces, list(gaps.values()), (big, small), (2, 1.2))
    for i, (leg, (above, below)) in enumerate(panels.items()):
        above.plot(time, big(rigid.sel(leg=leg)), label="Newton-Euler, rigid legs", **_BAND)
        for (model, gap), line in zip(gaps.items(), _LINES, strict=False):
            largest = text(float(np.abs(gap).max()), "N", 2)
            label = f"{model}; at most {largest} from {'Newton-Euler' if model == name else name}"
            above.plot(time, big(results[model].actuator_force.sel(leg=leg)), label=label, **line)
            fine: dict[str, Any] = line | {"linewidth": 0.9}
            below.plot(time, small(gap[:, i]), **fine)
        mark_end(above, motion_end(first))
        mark_end(below, motion_end(first))
    fig.legend(*panels[1][0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return fig


@house_style
@require_variables("com_position", "com_position_rigid", "com_deviation")
def engine_path(results: Mapping[str, xr.Dataset], axes: Sequence[str] = ("y", "z")) -> Figure:
    """Path of the centre of mass, its deviation from the rigid one, and the models' differences, each to its own scale.

    Parameters
    ----------
    results : mapping of names to xarray.Dataset
        At most three, at the same instants; the others are compared with the first.
    axes : sequence of str
        World axes to show, a column each.

    Raises
    ------
    InputError
        None or too many results, or at different instants.
    """
    first, name = _checked(results)
    shown = {model: data.com_deviation.sel(axis=list(axes)) for model, data in results.items()}
    small = scale(np.array([values.values for values in shown.values()]), "m")
    tiny = scale(np.array([values.values - shown[name].values for values in shown.values()]), "m")
    fig = figure(COLUMN * min(len(axes), 2), 6.2, gap=0.06)
    grid = fig.subplots(3, len(axes), sharex=True, squeeze=False, height_ratios=(1, 1.1, 0.9))
    end = motion_end(first)
    for column, axis in enumerate(axes):
        _path(grid[0, column], results, axis)
        _deviation(grid[1, column], shown, axis, small)
        _difference(grid[2, column], shown, axis, tiny)
        for panel in grid[:, column]:
            mark_end(panel, end, "motion ends" if panel is grid[0, column] else "")
    names = ("position of the\ncentre of mass [mm]", f"deviation [{small.name}]", f"difference [{tiny.name}]")
    _label(fig, grid, names)
    return fig


def _path(panel: Axes, results: Mapping[str, xr.Dataset], axis: str) -> None:
    first = next(iter(results.values()))
    panel.plot(first.time, 1e3 * first.com_position_rigid.sel(axis=axis).values, label="rigid legs", **_BAND)
    for (model, data), line in zip(results.items(), _LINES, strict=False):
        panel.plot(data.time, 1e3 * data.com_position.sel(axis=axis).values, label=model, **line)
    panel.set_title(f"Path in {axis.upper()}")
    panel.margins(y=0.12)


def _deviation(panel: Axes, shown: Mapping[str, xr.DataArray], axis: str, unit: Scale) -> None:
    for values, line in zip(shown.values(), _LINES, strict=False):
        panel.plot(values.time, unit(values.sel(axis=axis)), **line)
    largest = [f"{model} {text(float(np.abs(v.sel(axis=axis)).max()), 'm', 4)}" for model, v in shown.items()]
    panel.set_title(f"Flexible minus rigid, {axis.upper()}")
    _note(panel, "largest: " + ", ".join(largest))


def _difference(panel: Axes, shown: Mapping[str, xr.DataArray], axis: str, unit: Scale) -> None:
    (name, first), *others = ((model, values.sel(axis=axis)) for model, values in shown.items())
    largest = []
    for (model, values), line in zip(others, _LINES[1:], strict=False):
        gap = values.values - first.values
        panel.plot(first.time, unit(gap), **line)
        largest.append(f"{model} at most {text(float(np.abs(gap).max()), 'm', 2)} apart")
    panel.set_title(f"Difference from {name}, {axis.upper()}")
    _note(panel, ", ".join(largest))


def _note(panel: Axes, words: str) -> None:
    """Numbers at the top of a panel, clear of its lines, and its zero."""
    panel.axhline(0, color="#555555", linewidth=0.7)
    panel.margins(y=0.35)
    panel.annotate(words, (0.02, 0.97), xycoords="axes fraction", va="top", fontsize=NOTE, color="#333333")


def _label(fig: Figure, grid: np.ndarray, names: Sequence[str]) -> None:
    for panel, name in zip(grid[:, 0], names, strict=True):
        panel.set_ylabel(name)
    for panel in grid[-1]:
        panel.set_xlabel("time [s]")
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    fig.align_ylabels(grid[:, 0])


def _gaps(results: Mapping[str, xr.Dataset]) -> Iterator[tuple[str, np.ndarray]]:
    """Drive forces of the first result less those of Newton-Euler, those of the others less those of the first."""
    reference = next(iter(results.values())).actuator_force_rigid.values
    for i, (model, data) in enumerate(results.items()):
        yield model, data.actuator_force.values - reference
        if i == 0:
            reference = data.actuator_force.values


def _checked(results: Mapping[str, xr.Dataset]) -> tuple[xr.Dataset, str]:
    """The first result and its name.

    Raises
    ------
    InputError
        None, more than can be told apart, or at different instants.
    """
    if not 1 <= len(results) <= len(_LINES):
        raise InputError("cannot be told apart", key="results", value=len(results), allowed="1 to 3 of them")
    name, first = next(iter(results.items()))
    for data in results.values():
        if data.time.shape != first.time.shape or not np.allclose(data.time, first.time, rtol=0, atol=1e-9):
            raise InputError("cannot be compared: their instants differ", key="results", allowed="one output step")
    return first, name


START = 0.2  # s after a start with a jump, shown by itself
_MARKS = {"x": "^", "y": "o", "z": "s"}


@house_style
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
            color=readable_color(AXIS_COLORS[name]),
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


@house_style
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


@house_style
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
        vibration_line(axes, time, values, MOST_SWINGS / 2, label=f"{axis.upper()}, rate jumps at the start", **style)
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
