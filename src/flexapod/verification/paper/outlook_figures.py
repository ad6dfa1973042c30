"""Figures of what the paper asks for next: feedforward commands, a shaped roll, force feedback, friction."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.analysis.results.attributes import robot_study
from flexapod.common.quantities import scale
from flexapod.output.figures.style import COLUMN, PAGE, figure, house_style, mark_end
from flexapod.output.scene.style import LEG_COLORS
from flexapod.verification.paper.claim import axis_motion

SPAN = 0.05  # s: a period of the first mode, and a few of the others
_COLOURS = ("#8A8A8A", LEG_COLORS[0], LEG_COLORS[3], LEG_COLORS[2])
_STYLES = ("-", "--", "-.", "-")


def _size(values: xr.DataArray) -> np.ndarray:
    """Distance [m] over time, of x, y, z."""
    return np.linalg.norm(values.values, axis=-1)


def _end(data: xr.Dataset) -> float:
    """Instant at which the roll ends [s]."""
    motion = axis_motion(robot_study(data))
    return motion.end_time - motion.hold


def _time_axis(axes: Axes, title: str, label: str) -> None:
    axes.set(title=title, xlabel="time [s]", ylabel=label)


@house_style
def commands_ahead(ahead: xr.Dataset) -> Figure:
    """Path error of the payload, in powers of ten, with commands that compensate more and more.

    Of each twentieth of a second the largest: what swings within it is solid ink otherwise.

    Parameters
    ----------
    ahead : xarray.Dataset
        From `outlook.commands_ahead`.
    """
    fig = figure(PAGE, 3.8)
    axes = fig.subplots()
    edges = np.arange(0.0, float(ahead.time[-1]) + SPAN, SPAN)
    begins = np.searchsorted(ahead.time.values, edges[:-1] - 1e-9)
    for i, name in enumerate(ahead.command.values):
        largest = np.maximum.reduceat(1e9 * _size(ahead.miss.isel(command=i)), begins)
        label = f"made up for {name}" if i else str(name)
        style = {"color": _COLOURS[i], "linestyle": _STYLES[i], "linewidth": 1.6, "label": label}
        axes.semilogy(np.repeat(edges, 2)[1:-1], np.repeat(largest, 2), **style)
    _time_axis(axes, f"Centre of mass beside its path, the largest in {1e3 * SPAN:.0f} ms", "distance [nm]")
    mark_end(axes, _end(ahead), "motion ends")
    fig.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2, handlelength=2.6)
    return fig


@house_style
def shaped_roll(shaped: xr.Dataset, shown: float = 0.25) -> Figure:
    """Vibration of the payload that the roll leaves, a panel for each number of modes it is shaped for.

    Parameters
    ----------
    shaped : xarray.Dataset
        From `outlook.shaped_roll`.
    shown : float
        How much of the time after the roll is drawn [s].
    """
    early = shaped.sel(time=shaped.time <= shown)
    unit, fig = scale(early.vibration, "m"), figure(PAGE, 0.6 + 1.35 * shaped.sizes["command"])
    panels = fig.subplots(shaped.sizes["command"], 1, sharex=True, sharey=True)
    for i, axes in enumerate(panels):
        values = unit(early.vibration.isel(command=i).sel(axis="z"))
        axes.plot(early.time, values, color=_COLOURS[i], linewidth=1.2)
        axes.axhline(0, color="#555555", linewidth=0.7)
        longer = 1e3 * float(shaped.longer[i])
        name = str(shaped.command.values[i])
        title = f"{name[0].upper()}{name[1:]}" + (f": a roll {longer:.0f} ms longer" if i else "")
        axes.set(title=title, ylabel=f"z [{unit.name}]")
    panels[-1].set_xlabel("time since the roll has ended [s]")
    fig.align_ylabels(panels)
    return fig


@house_style
def force_feedback(loops: xr.Dataset) -> Figure:
    """Compliance of the payload over frequency, and its ringing after a blow, without and with force feedback.

    Parameters
    ----------
    loops : xarray.Dataset
        From `outlook.force_feedback`.
    """
    fig = figure(2 * COLUMN, 3.4, gap=0.06)
    left, right = fig.subplots(1, 2)
    unit = scale(loops.ringing.sel(axis="z"), "m")
    for i, name in enumerate(loops.loop.values):
        style = {"color": _COLOURS[(0, 2)[i]], "linewidth": (2.0, 1.3)[i], "label": str(name)}
        left.loglog(loops.frequency, 1e6 * loops.compliance.isel(loop=i), **style)
        right.plot(loops.time, unit(loops.ringing.isel(loop=i).sel(axis="z")), **style)
    left.set(title="Compliance, upwards", xlabel="frequency [Hz]", ylabel="motion by force [µm/N]")
    left.set_xlim(float(loops.frequency[0]), float(loops.frequency[-1]))
    _time_axis(right, "After a blow from above", f"centre of mass, z [{unit.name}]")
    fig.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return fig


@house_style
def joint_friction(rubbing: xr.Dataset) -> Figure:
    """Path error of the payload with ideal joints and with friction in joints.

    Parameters
    ----------
    rubbing : xarray.Dataset
        From `outlook.joint_friction`.
    """
    fig = figure(PAGE, 4.6)
    above, below = fig.subplots(2, 1, sharex=True)
    sizes = {str(name): _size(rubbing.miss.sel(joints=name)) for name in rubbing.joints.values}
    ideal, rubs, ahead = sizes
    big = scale(np.stack([sizes[ideal], sizes[rubs]]), "m")
    above.plot(rubbing.time, big(sizes[ideal]), color="#8A8A8A", linewidth=3.0, label="ideal joints")
    above.plot(rubbing.time, big(sizes[rubs]), color=LEG_COLORS[3], linewidth=1.2, label="joints that rub")
    above.set(title="Centre of mass beside its path", ylabel=f"distance [{big.name}]")
    small = scale(sizes[ahead], "m")
    below.plot(rubbing.time, small(sizes[ahead]), color=LEG_COLORS[2], linewidth=1.2,
               label="the same, weight and inertia made up for")  # fmt: skip
    _time_axis(below, "With commands ahead that know no friction", f"distance [{small.name}]")
    mark_end(above, _end(rubbing), "motion ends")
    mark_end(below, _end(rubbing))
    fig.legend(handles=[*above.get_lines()[:2], below.get_lines()[0]], loc="outside upper center", ncols=3)
    fig.align_ylabels([above, below])
    return fig
