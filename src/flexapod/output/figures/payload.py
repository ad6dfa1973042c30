"""The payload over time: commanded motion, path, deviation by cause, energies.

A curve that oscillates more often than a picture can show is drawn as the band that it fills.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.ndimage import maximum_filter1d

from flexapod.analysis.results.attributes import motion_coordinates, motion_end
from flexapod.analysis.results.cause_labels import cause_labels
from flexapod.analysis.results.summary import POINT_WORDS
from flexapod.common.errors import check_known, names_of
from flexapod.common.quantities import NOTHING, Scale, scale, text, zero_rounding
from flexapod.common.ranking import descending_order, first_largest
from flexapod.output.figures.style import (
    COLUMN,
    LINE_STYLES,
    NOTE,
    PAGE,
    figure,
    house_style,
    mark_end,
    require_variables,
    share_flat_scale,
)
from flexapod.output.scene.style import AXIS_COLORS, ENERGIES, FLEXIBLE, LEG_COLORS, RIGID

_TURNS = ("roll", "pitch", "yaw")
_UNITS = {"position": ("m", "rad"), "rate": ("m/s", "rad/s"), "acceleration": ("m/s²", "rad/s²")}


@house_style
@require_variables("translation_command")
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


@house_style
@require_variables("com_deviation")
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
    shown = [*axes] if isinstance(axes, str) else names_of(axes, "axes")
    for axis in shown or [""]:
        check_known(axis, AXIS_COLORS, "axes", "is no axis")
    check_known(point, POINT_WORDS, "point", "is not a point of the payload")
    return _com_path(data, shown, point)


def _com_path(data: xr.Dataset, axes: Sequence[str], point: str) -> Figure:
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
        values = zero_rounding(small(deviation.sel(axis=axis)), largest)
        sizes.append(float(np.abs(values).max()))
        below.plot(time, values, color=AXIS_COLORS[axis], linewidth=1.1)
        below.axhline(0, color="#555555", linewidth=0.7)
        if sizes[-1]:
            _peak(below, time, values, small.name)
        below.set(xlabel="time [s]", title=f"Flexible minus rigid, {axis.upper()}")
        mark_end(grid[0, column], end, "motion ends")
        mark_end(below, end)
    share_flat_scale(grid[1], sizes)
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
    at = first_largest(np.abs(values))
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


MOST = 9  # causes that colours tell apart
_SMALLER = " smaller ones together"
_COLORS = {"axial-strain": "#0072B2", "bending": "#D55E00", "drive": "#009E73"}
_MORE = ("#E69F00", "#56B4E9", "#A23B72", "#7A5195", "#8C6D1F", "#444444", "#BDB76B", "#FF9DA7", "#9C755F", "#76B7B2")


@house_style
@require_variables("deviation_by_cause")
def deviation_by_cause(data: xr.Dataset) -> Figure:
    """Deviation of the centre of mass by cause over time, and by leg at the largest deviation of each axis.

    An axis with nothing but rounding is drawn as 0; its bars belong to the instant of the largest distance.

    Parameters
    ----------
    data : xarray.Dataset
        With `deviation_by_cause` (time, cause, leg, axis) and `com_deviation` (time, axis).
    """
    fig = figure(PAGE, 5.6)
    grid = fig.subplots(3, 2, width_ratios=(2.1, 1), sharex="col")
    total = data.com_deviation
    sizes = np.abs(data.deviation_by_cause).max(("time", "leg", "axis"))
    shown = data.deviation_by_cause.sel(
        cause=np.array([zero_rounding(size, sizes.max()) > 0 for size in sizes], dtype=bool)
    )
    parts = _largest(shown)
    small = scale(total, "m")
    end, time, words, colors = motion_end(data), data.time.values, cause_labels(data), _colors(parts.cause.values)
    largest, seen = float(np.abs(small(total)).max()), []
    for row, axis in enumerate(data.axis.values):
        left, right = grid[row]
        lines = small(np.vstack([total.sel(axis=axis).values[None], parts.sel(axis=axis).sum("leg").T.values]))
        lines = zero_rounding(lines, largest)
        seen.append(float(np.abs(lines).max()))
        left.plot(time, lines[0], color="#C8C8C8", linewidth=5, label="whole deviation")
        for cause, values in zip(map(str, parts.cause.values), lines[1:], strict=True):
            left.plot(time, values, color=colors[cause], linewidth=1.2, label=words.get(cause, cause))
        left.axhline(0, color="#555555", linewidth=0.7)
        left.set(title=f"{str(axis).upper()}, over time", ylabel=f"deviation [{small.name}]")
        mark_end(left, end, "motion ends" if row == 0 else "")
        size = np.abs(total.sel(axis=axis).values) if seen[-1] else np.linalg.norm(total.values, axis=1)
        _by_leg(right, parts.sel(axis=axis).isel(time=first_largest(size)), small, str(axis), colors)
    share_flat_scale(grid[:, 0], seen)
    grid[-1, 0].set_xlabel("time [s]")
    grid[-1, 1].set_xlabel("leg")
    columns = 4 if len(parts.cause) < 4 else 3
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=columns)
    for column in grid.T:
        fig.align_ylabels(column)
    return fig


def _largest(parts: xr.DataArray) -> xr.DataArray:
    """The largest causes, and all smaller ones as one, where they are more than colours tell apart."""
    if parts.sizes["cause"] <= MOST:
        return parts
    order = descending_order(np.abs(parts.transpose("cause", ...).values).max(axis=(1, 2, 3)))
    kept, rest = np.sort(order[: MOST - 1]), order[MOST - 1 :]
    others = parts.isel(cause=rest).sum("cause").expand_dims(cause=[f"{len(rest)}{_SMALLER}"])
    return xr.concat([parts.isel(cause=kept), others], "cause")


def _colors(causes: np.ndarray) -> dict[str, str]:
    """A colour for each cause; those that every robot has keep theirs."""
    others = [str(cause) for cause in causes if str(cause) not in _COLORS]
    return _COLORS | {cause: _MORE[i % len(_MORE)] for i, cause in enumerate(others)}


def _by_leg(axes: Axes, parts: xr.DataArray, small: Scale, axis: str, colors: dict[str, str]) -> None:
    """Stacked bars: what each leg contributes, cause by cause, at one instant."""
    legs = np.arange(1, parts.sizes["leg"] + 1)
    above, below = np.zeros(len(legs)), np.zeros(len(legs))
    for cause in parts.cause.values:
        values = small(parts.sel(cause=cause))
        base = np.where(values >= 0, above, below)
        axes.bar(legs, values, bottom=base, color=colors[str(cause)], width=0.7)
        above, below = above + np.maximum(values, 0), below + np.minimum(values, 0)
    axes.axhline(0, color="#555555", linewidth=0.7)
    axes.set_xticks(legs)
    axes.grid(axis="x", visible=False)
    axes.set(ylabel=f"part [{small.name}]", title=f"{axis.upper()}, by leg at {float(parts.time):.2f} s")
    axes.use_sticky_edges = False
    axes.margins(y=0.1)


_SIGN = {"work_drive": -1.0, "work_base": -1.0, "work_control": -1.0, "work_external": -1.0}


@house_style
@require_variables("energy_kinetic", "work_drive")
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
    _energy_line(rows[1], time, data.energy_strain, "Strain energy, with that of the drive springs", "energy")
    balance = xr.concat([_SIGN.get(name, 1.0) * data[name] for name in names], dim="part").sum("part")
    open_by, largest = balance - balance[0], max(float(np.abs(change).max()) for change in changes.values())
    _energy_line(
        rows[2], time, open_by, f"Balance: energies plus losses minus works{_closed(open_by, largest)}", "balance"
    )
    rows[0].set(title="Energies and works, change since the start", ylabel=f"energy [{big.name}]")
    fig.legend(*rows[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, handlelength=3)
    rows[-1].set_xlabel("time [s]")
    for axes in rows:
        mark_end(axes, end, "motion ends" if axes is rows[0] else "")
    fig.align_ylabels(rows)
    return fig


def _closed(open_by: xr.DataArray, largest: float) -> str:
    """Largest residual of a balance beside the largest change of its terms, as text; "" where it says nothing."""
    most = float(np.abs(open_by).max())
    if not 0 < most < largest:
        return ""
    return f", off by up to {text(most, 'J', 2)} of {text(largest, 'J')}"


def _energy_line(axes: Axes, time: np.ndarray, values: xr.DataArray, title: str, label: str) -> None:
    small = scale(values, "J")
    axes.plot(time, small(values), color="#333333", linewidth=1.0)
    axes.set(title=title, ylabel=f"{label} [{small.name}]")


MOST_SWINGS = 240  # half swings across a page: more of them are solid ink
SEEN = 0.02  # of the range of a curve: a smaller swing is the width of its line
NEIGHBOURS = 5  # maxima of which the largest is the edge: where several vibrations add up, not each reaches it
EDGE = 600  # instants of a band at most; each stands for those up to the next


def turning_points(values: np.ndarray) -> np.ndarray:
    """Indices of the maxima and minima of a curve."""
    return np.flatnonzero(np.diff(np.sign(np.diff(values))) != 0) + 1


def swings_too_often(values: np.ndarray, most: float = MOST_SWINGS) -> bool:
    """Test whether a curve oscillates more often than a panel can show; invisible oscillations do not count."""
    return bool(np.count_nonzero(np.abs(np.diff(values[turning_points(values)])) > SEEN * np.ptp(values)) > most)


def vibration_line(axes: Axes, time: np.ndarray, values: np.ndarray, most: float = MOST_SWINGS, **style: Any) -> bool:
    """Draw a curve, or between its maxima and its minima the band that it fills where it turns back more often.

    Parameters
    ----------
    axes : Axes
    time, values : array, shape (n,)
    most : float
        Half swings that the panel can show, as of `swings_too_often`.
    style
        Color, linewidth and label of the curve, as of `Axes.plot`.

    Returns
    -------
    bool
        Whether it is a band.
    """
    if not swings_too_often(values, most):
        axes.plot(time, values, **style)
        return False
    at = turning_points(values)
    middle = 0.5 * (values[at[:-1]] + values[at[1:]])
    middle = np.interp(time, 0.5 * (time[at[:-1]] + time[at[1:]]), middle)
    low, high = (sign * _edge(time, sign * values, at[sign * (values[at] - middle[at]) >= 0]) for sign in (-1.0, 1.0))
    first = np.unique(np.linspace(0, len(time) - 1, EDGE).astype(int))
    time, low, high = time[first], np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    axes.fill_between(time, low, high, color=style["color"], alpha=0.25, linewidth=0)
    edge: dict[str, Any] = style | {"linewidth": 0.8}
    axes.plot(time, low, **edge)
    edge["label"] = None
    axes.plot(time, high, **edge)
    return True


def _edge(time: np.ndarray, values: np.ndarray, maxima: np.ndarray) -> np.ndarray:
    """Upper edge of what a curve fills, through the largest of neighbouring maxima."""
    return np.interp(time, time[maxima], maximum_filter1d(values[maxima], NEIGHBOURS, mode="nearest"))
