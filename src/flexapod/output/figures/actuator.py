"""The single actuator: response of its tip, convergence with the number of shapes, amplitudes of the shapes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.common.quantities import number, scale, zero_rounding_lines
from flexapod.common.units import quantity
from flexapod.output.figures.payload import swings_too_often, turning_points, vibration_line
from flexapod.output.figures.style import (
    LINE_STYLES,
    NOTE,
    PAGE,
    figure,
    house_style,
    readable_color,
    require_variables,
    share_flat_scale,
)
from flexapod.output.scene.style import FLEXIBLE, LEG_COLORS, RIGID

_SHOWN = 12  # half swings of a band that are shown beside it
_LARGER = ("angles", "elevations")  # towards which the tip of an actuator in space is deflected


@house_style
@require_variables("tip_deflection", "length", "angle")
def actuator_response(data: xr.Dataset | Mapping[int, xr.Dataset]) -> Figure:
    """Tip deflection over time; with several numbers of shapes also how far each is from the finest.

    Parameters
    ----------
    data : xarray.Dataset, or mapping of number of shapes to xarray.Dataset
        Results of `flexapod.simulate_actuator` on the same output instants.
    """
    given = {int(data.attrs.get("modes", 0)): data} if isinstance(data, xr.Dataset) else data
    series = {count: given[count] for count in sorted(given)}
    counts = list(series)
    finest = series[counts[-1]]
    rows = 3 if len(series) > 1 else 2
    fig = figure(PAGE, 2.2 * rows)
    panels = fig.subplots(rows, 1, sharex=True, height_ratios=(1.6, 1.1, 0.8)[:rows] if rows == 3 else (1.6, 0.8))
    _responses(panels[0], series)
    if len(series) > 1 or "direction" in series[counts[-1]].dims:
        fig.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=max(2, len(series)))
        _differences(panels[1], series)
    length = panels[-1]
    length.plot(finest.time, finest.length, color="#333333")
    length.set(ylabel="free length [m]", title="Length outside the hub", xlabel="time [s]")
    fig.align_ylabels(panels)
    return fig


def _curves(data: xr.Dataset) -> np.ndarray:
    """Deflection of the tip over time, a column for each direction."""
    return data.tip_deflection.values.reshape(data.sizes["time"], -1)


def _responses(axes: Axes, series: Mapping[int, xr.Dataset]) -> None:
    unit = scale(xr.concat([d.tip_deflection for d in series.values()], dim="k"), "m")
    for i, (count, d) in enumerate(series.items()):
        last = i == len(series) - 1
        style = {"color": RIGID, "linewidth": 5} if last and len(series) > 1 else {"color": LEG_COLORS[i], "zorder": 3}
        style |= {"linestyle": LINE_STYLES[len(series) - 2 - i]} if not last else {}
        words = f"{count} shape{'s' if count > 1 else ''}"
        for k, line in enumerate(unit(_curves(d)).T):
            towards = f", towards larger {_LARGER[k]}" if "direction" in d.dims else ""
            axes.plot(d.time, line, label=words + towards, **style, alpha=1 - 0.6 * k)
    axes.axhline(0, color="#555555", linewidth=0.7)
    axes.set(title="Lateral deflection of the tip, in the frame of the hub", ylabel=f"deflection [{unit.name}]")


def _differences(axes: Axes, series: Mapping[int, xr.Dataset]) -> None:
    from scipy.ndimage import maximum_filter1d

    counts = list(series)
    finest = _curves(series[counts[-1]])
    for i, count in enumerate(counts[:-1]):
        gap = 1e6 * np.abs(_curves(series[count]) - finest).max(axis=1)
        envelope = maximum_filter1d(gap, max(3, len(gap) // 20))
        style = LINE_STYLES[len(counts) - 2 - i]
        axes.semilogy(series[count].time, np.maximum(envelope, 1e-6), color=LEG_COLORS[i], linestyle=style)
        place = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points", "va": "center"}
        level = float(gap[1:].max())
        axes.annotate(
            f"{count}: {number(level, 2)} µm",
            (1.0, level),
            xytext=(4, 0),
            color=readable_color(LEG_COLORS[i]),
            fontsize=NOTE,
            **place,
        )
    axes.set_title(f"Largest distance nearby from the result with {counts[-1]} shapes (right: of all)")
    axes.set_ylabel("difference [µm]")


@house_style
@require_variables("tip_deflection", "length", "angle")
def actuator_path(data: xr.Dataset, hub_radius: float = 0.0, magnify: float = 1.0) -> Figure:
    """Path of the tip in the plane of motion, rigid and flexible, with the straight beam at start and end.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.simulate_actuator`.
    hub_radius : float
        From the axis to where the beam leaves the hub [m].
    magnify : float
        How many times larger the deflection is drawn.
    """
    length, angle, across = (data[name].values for name in ("length", "angle", "tip_deflection"))
    along = np.array([np.cos(angle), np.sin(angle)])
    hub_radius = quantity(hub_radius, "length", key="hub_radius")
    rigid = (hub_radius + length) * along
    flexible = rigid + magnify * across * np.array([-along[1], along[0]])
    drawn = "" if magnify == 1 else f"; deflection {number(magnify)} times larger"
    fig = figure(PAGE, 4.4)
    axes = fig.subplots()
    for at, style in ((0, (0, (4, 3))), (-1, "-")):
        words = f"straight beam at {float(data.time[at]):.3g} s"
        axes.plot([0, rigid[0, at]], [0, rigid[1, at]], color="#555555", linewidth=1.0, linestyle=style, label=words)
    axes.plot(*rigid, color=RIGID, linewidth=4, label="tip, rigid")
    axes.plot(*flexible, color=FLEXIBLE, linewidth=1.2, label=f"tip, flexible{drawn}")
    axes.plot(0, 0, "s", color="#333333", markersize=7)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="X [m]", ylabel="Y [m]")
    axes.set_title("Tip of the beam in its plane")
    fig.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return fig


@house_style
@require_variables("mode_amplitude")
def actuator_modes(data: xr.Dataset) -> Figure:
    """Amplitude of each lateral shape over time, each on its own scale; 0 where all is rounding beside the largest.

    A shape with more swings than a figure can show is drawn as the band that it fills, its first swings beside it.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.simulate_actuator`, with `mode_amplitude` (time, mode).
    """
    labels, amplitudes = [f"Shape {mode}" for mode in data.mode.values], data.mode_amplitude
    if "direction" in amplitudes.dims:
        labels = [f"{words}, towards larger {larger}" for larger in _LARGER for words in labels]
        amplitudes = amplitudes.stack(mode_of=("direction", "mode")).rename(mode_of="shape")
    time, lines = (
        data.time.values,
        zero_rounding_lines(amplitudes.transpose(..., "time").values.reshape(len(labels), -1)),
    )
    fig = figure(PAGE, 1.0 + 1.4 * len(labels))
    zoomed = any(swings_too_often(values) for values in lines)
    grid = fig.add_gridspec(len(labels), 1 + zoomed, width_ratios=(2.6, 1)[: 1 + zoomed])
    first = fig.add_subplot(grid[0, 0])
    panels = [first, *(fig.add_subplot(grid[i, 0], sharex=first) for i in range(1, len(labels)))]
    for i, (axes, label, values) in enumerate(zip(panels, labels, lines, strict=True)):
        unit = scale(values if values.any() else lines, "m")
        if vibration_line(axes, time, unit(values), color=FLEXIBLE, linewidth=1.0):
            shown = slice(0, turning_points(values)[_SHOWN] + 1)
            beside = fig.add_subplot(grid[i, 1], title=f"its first {time[shown][-1]:.2g} s")
            beside.plot(time[shown], unit(values)[shown], color=FLEXIBLE, linewidth=1.0)
            beside.axhline(0, color="#555555", linewidth=0.7)
        axes.axhline(0, color="#555555", linewidth=0.7)
        axes.set(title=label, ylabel=f"amplitude [{unit.name}]")
        axes.tick_params(labelbottom=i == len(labels) - 1)
    share_flat_scale(panels, [float(np.abs(values).max()) for values in lines])
    panels[-1].set_xlabel("time [s]")
    fig.align_ylabels(panels)
    return fig
