"""Poles in their plane: maps of poles, root loci with the damping that gains bring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.common.arguments import number
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.control.datasets import join_complex
from flexapod.control.frequency_response import SWINGS
from flexapod.control.state_space import StateSpace
from flexapod.output.figures.style import PAGE, SMALL, figure, house_style, require_variables
from flexapod.output.scene.style import colors_of_legs

RATIOS = (0.01, 0.05, 0.1, 0.2, 0.4, 0.7)  # damping ratios with a line
MARKS = ("x", "+", "o", "s", "^", "v")


Poles = xr.Dataset | StateSpace


def pole_map(data: Poles | Sequence[Poles] | Mapping[str, Poles], below: float | None = None) -> Figure:
    """Poles with an imaginary part of 0 or more, with lines of equal damping ratio.

    Parameters
    ----------
    data : StateSpace or xarray.Dataset, sequence or mapping of these
        Linear systems, or what their `.damp` gives; several under the words that the legend shows, or under numbers.
    below : float, optional
        Frequency [Hz] up to which poles are shown; by itself all that oscillate.
    """
    if isinstance(data, Sequence) and not isinstance(data, str):
        data = {str(k): one for k, one in enumerate(data, start=1)}
    several = isinstance(data, Mapping) and not isinstance(data, xr.Dataset)
    given: Mapping[str, Any] = data if several else {"": data}  # type: ignore[assignment]
    return _pole_map({name: one.damp() if isinstance(one, StateSpace) else one for name, one in given.items()}, below)


@house_style
@require_variables("pole", "damping_ratio")
def _pole_map(results: Mapping[str, xr.Dataset], below: float | None) -> Figure:
    fig = figure(PAGE, 4.2)
    axes = fig.subplots()
    edge = _edge([join_complex(one.pole).values for one in results.values()], below)
    left = 0.0
    for k, (name, one) in enumerate(results.items()):
        s = join_complex(one.pole).values
        s = s[np.abs(s) <= 2 * np.pi * edge * (1 + 1e-9)] / (2 * np.pi)
        left = min(left, s.real.min(initial=0.0))
        axes.plot(
            s.real, s.imag, MARKS[k % len(MARKS)], color=colors_of_legs(len(results))[k], label=name,
            markerfacecolor="none", clip_on=False, zorder=3,
        )  # fmt: skip
    _plane(axes, left, edge)
    axes.set_title("Poles")
    if len(results) > 1:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return fig


@house_style
@require_variables("pole", "open_zero")
def root_locus(data: xr.Dataset, below: float | None = None) -> Figure:
    """Poles of a loop as a factor on its controller grows, and their damping ratios over it.

    Crosses: poles at the smallest factor, rings: zeros, where branches end, dots: at the factor nearest to 1.

    Parameters
    ----------
    data : xarray.Dataset
        From `flexapod.control.root_locus`.
    below : float, optional
        Frequency [Hz] up to which the plane is shown; by itself all open poles that oscillate.
    """
    if "sample" in data.attrs:
        raise InputError(
            "is of samples: its poles are in the plane of z", key="root_locus", allowed="a continuous loop"
        )
    poles, zeros = join_complex(data.pole).values / (2 * np.pi), join_complex(data.open_zero).values / (2 * np.pi)
    gain = data.gain.values
    fig = figure(PAGE, 4.2)
    plane, over = fig.subplots(1, 2, width_ratios=(1.25, 1))
    edge = _edge([2 * np.pi * poles[0]], below)
    shown = _branches(poles, edge)
    middle = int(np.abs(np.log(np.maximum(gain, 1e-300))).argmin())
    colors = colors_of_legs(min(len(shown), 18))
    for k, j in enumerate(shown):
        color = colors[k % len(colors)]
        upper = poles[:, j].imag >= 0
        x, y = np.where(upper, poles[:, j].real, np.nan), np.where(upper, poles[:, j].imag, np.nan)
        plane.plot(x, y, color=color, linewidth=1.2)
        start: dict[str, Any] = {"color": color, "clip_on": True, "zorder": 3}
        plane.plot(x[:1], y[:1], "x", **start)
        plane.plot(x[middle : middle + 1], y[middle : middle + 1], "o", markersize=4, **start)
        swings = np.abs(poles[:, j].imag) > SWINGS * np.abs(poles[:, j])
        ratio = np.where(swings, data.damping_ratio.values[:, j], np.nan)
        over.plot(gain, 100 * ratio, color=color, linewidth=1.2)
    up = zeros[zeros.imag >= 0]
    plane.plot(up.real, up.imag, "o", color="#333333", markerfacecolor="none", zorder=4)
    left = np.nanmin(np.where(poles[:, shown].imag > 0, poles[:, shown].real, np.nan), initial=0.0) if shown else 0.0
    _plane(plane, max(float(left), -edge), edge)
    plane.set_title("Poles of the loop")
    over.set_xscale("log")
    over.set_xlabel("factor on the controller")
    over.set_ylabel("damping ratio [%]")
    over.set_title("Damping")
    over.axvline(gain[middle], color="#888888", linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
    return fig


def _edge(poles: list[Array], below: float | str | None) -> float:
    """Frequency [Hz] up to which poles are shown."""
    if below is not None:
        return number(below, "below", "frequency", above=0.0)
    whole = np.concatenate(poles)
    swings = np.abs(whole.imag) > SWINGS * np.abs(whole)
    return 1.08 * float(np.abs(whole[swings] if swings.any() else whole).max(initial=0.0)) / (2 * np.pi) or 1.0


def _branches(poles: Array, edge: float) -> list[int]:
    """Branches that are in the upper half of the plane somewhere, below a frequency at first."""
    inside = (np.abs(poles[0]) <= edge) & (poles.imag > SWINGS * np.abs(poles)).any(axis=0)
    return [int(j) for j in np.flatnonzero(inside)]


def _plane(axes: Axes, left: float, edge: float) -> None:
    """Axes of the plane in Hz, lines of equal damping ratio behind all."""
    width = max(-1.12 * left, 0.02 * edge)
    axes.set_xlim(-width, 0.08 * width)
    axes.set_ylim(0, edge)
    axes.axvline(0, color="#888888", linewidth=0.8, zorder=1)
    last = np.array([np.inf, np.inf])
    for ratio in RATIOS:
        slope = np.sqrt(1 - ratio**2) / ratio
        x = min(width, edge / slope)
        axes.plot([0, -x], [0, x * slope], color="#BBBBBB", linewidth=0.7, linestyle=":", zorder=1)
        at = 0.93 * np.array([x / width, x * slope / edge])
        if at[0] > 0.05 and (np.abs(at - last) > (0.12, 0.06)).any():
            axes.annotate(
                f"{100 * ratio:g} %", (-at[0] * width, at[1] * edge), fontsize=SMALL, color="#666666", ha="center",
                va="center", bbox={"pad": 0.6, "facecolor": "white", "edgecolor": "none"}, zorder=2,
            )  # fmt: skip
            last = at
    axes.set_xlabel("real part / 2π [Hz]")
    axes.set_ylabel("imaginary part / 2π [Hz]")
