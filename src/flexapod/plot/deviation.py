"""Which part is to blame: the deviation split by cause and by leg."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import PAGE, Scale, figure, flat_on_the_scale_of_others, mark_end, needs, scale, styled
from flexapod.scene.robot import motion_end
from flexapod.study.names import cause_words
from flexapod.study.words import cleared

__all__ = ["deviation_by_cause"]

MOST = 9  # causes that colours tell apart
_SMALLER = " smaller ones together"
_COLORS = {"axial-strain": "#0072B2", "bending": "#D55E00", "drive": "#009E73"}
_MORE = ("#E69F00", "#56B4E9", "#A23B72", "#7A5195", "#8C6D1F", "#444444", "#BDB76B", "#FF9DA7", "#9C755F", "#76B7B2")


@styled
@needs("deviation_by_cause")
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
    shown = data.deviation_by_cause.sel(cause=np.array([cleared(size, sizes.max()) > 0 for size in sizes], dtype=bool))
    parts = _largest(shown)
    small = scale(total, "m")
    end, time, colors = motion_end(data), data.time.values, _colors(parts.cause.values)
    largest, seen = float(np.abs(small(total)).max()), []
    for row, axis in enumerate(data.axis.values):
        left, right = grid[row]
        lines = small(np.vstack([total.sel(axis=axis).values[None], parts.sel(axis=axis).sum("leg").T.values]))
        lines = cleared(lines, largest)
        seen.append(float(np.abs(lines).max()))
        left.plot(time, lines[0], color="#C8C8C8", linewidth=5, label="whole deviation")
        for cause, values in zip(map(str, parts.cause.values), lines[1:], strict=True):
            left.plot(time, values, color=colors[cause], linewidth=1.2, label=_words(cause))
        left.axhline(0, color="#555555", linewidth=0.7)
        left.set_title(f"{str(axis).upper()}, over time")
        left.set_ylabel(f"deviation [{small.name}]")
        mark_end(left, end, "motion ends" if row == 0 else "")
        size = np.abs(total.sel(axis=axis).values) if seen[-1] else np.linalg.norm(total.values, axis=1)
        _by_leg(right, parts.sel(axis=axis).isel(time=int(size.argmax())), small, str(axis), colors)
    flat_on_the_scale_of_others(grid[:, 0], seen)
    grid[-1, 0].set_xlabel("time [s]")
    grid[-1, 1].set_xlabel("leg")
    fig.legend(
        *grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4 if len(parts.cause) < 4 else 3
    )
    for column in grid.T:
        fig.align_ylabels(column)
    return fig


def _largest(parts: xr.DataArray) -> xr.DataArray:
    """The largest causes, and all smaller ones as one, where they are more than colours tell apart."""
    if parts.sizes["cause"] <= MOST:
        return parts
    ranked = np.argsort(-np.abs(parts.transpose("cause", ...).values).max(axis=(1, 2, 3)))
    kept, rest = np.sort(ranked[: MOST - 1]), ranked[MOST - 1 :]
    others = parts.isel(cause=rest).sum("cause").expand_dims(cause=[f"{len(rest)}{_SMALLER}"])
    return xr.concat([parts.isel(cause=kept), others], "cause")


def _words(cause: str) -> str:
    return cause if cause.endswith(_SMALLER) else cause_words(cause)


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
    axes.set_ylabel(f"part [{small.name}]")
    axes.set_title(f"{axis.upper()}, by leg at {float(parts.time):.2f} s")
    axes.use_sticky_edges = False
    axes.margins(y=0.1)
