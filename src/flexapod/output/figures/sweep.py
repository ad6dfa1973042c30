"""A sweep's quantity against what varies: curve, map, histogram, or one panel for each key."""

from __future__ import annotations

import json
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from flexapod.common.errors import InputError
from flexapod.common.quantities import scale
from flexapod.output.figures.style import (
    COLORS,
    COLUMN,
    NOTE,
    PAGE,
    TEXT,
    cell_edges,
    figure,
    house_style,
    require_variables,
)
from flexapod.output.scene.style import FLEXIBLE, RIGID

FAILED = "#C44E52"
MOST_PANELS = 6
LABEL = 28  # letters of a label beside a row of panels
FEW = 8  # values of a key that each get a tick
PERCENTILES = (5, 50, 95)
Values = NDArray[Any]


class _Shown(NamedTuple):
    """Numbers of points in the unit that is shown; `words` for an axis; names in place of numbers that are texts."""

    values: Values
    words: str
    unit: str
    names: tuple[str, ...] = ()


@house_style
@require_variables()
def sweep(data: xr.Dataset, quantity: str | None = None) -> Figure:
    """A quantity of a sweep against what varies; points that failed are marked in red.

    One key gives a curve (with random tolerances a band of percentiles), two give a map, tolerances alone a histogram;
    everything else one panel of points for each key.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.sweep`.
    quantity : str, optional
        A quantity that has one number a point; default: the first that was kept.

    Raises
    ------
    InputError
        There is no such quantity, or not one computed point.
    """
    if "axes" not in data.attrs:
        raise InputError("cannot be drawn: it is no result of a sweep", key="sweep", allowed="that of flexapod.sweep")
    found = _quantity(data, quantity)
    axes: list[dict[str, Any]] = [axis for axis in json.loads(data.attrs["axes"]) if axis["count"] > 1]
    single = [
        next((key for key in axis["keys"] if data[key].ndim == 1), axis["keys"][0])  # the first with one value a point
        for axis in axes
        if axis["keys"] and axis["name"] != "sample"
    ]
    draws = sum(axis["count"] for axis in axes if axis["name"] == "draw")
    if axes and not single and draws == sum(axis["count"] for axis in axes):
        return _histogram(found, data)
    if len(single) == 1 and len(axes) == 1 + bool(draws):
        return _curve(_key(data, single[0]), found, data)
    if len(single) == 2 and len(axes) == 2:
        return _map(_key(data, single[0]), _key(data, single[1]), found, data)
    return _panels(found, data)


def _quantity(data: xr.Dataset, name: str | None) -> _Shown:
    known = [str(n) for n, array in data.data_vars.items() if array.dims == ("point",) and array.dtype.kind == "f"]
    if name is None:
        name = next((n for n in known if np.isfinite(data[n].values).any()), next(iter(known), ""))
    if not isinstance(name, str) or name not in known:
        raise InputError(
            "is not a quantity of this sweep", key="quantity", value=name, allowed=", ".join(known) or "none"
        )
    if not np.isfinite(data[name].values).any():
        raise InputError("has no computed point", key="quantity", value=name)
    return _shown(data[name], str(data[name].attrs.get("long_name", name)))


def _key(data: xr.Dataset, name: str) -> _Shown:
    return _shown(data[name], name)


def _shown(array: xr.DataArray, words: str) -> _Shown:
    if array.ndim > 1 or array.dtype.kind not in "fiu":
        unit = str(array.attrs.get("units", "1"))
        words = words if unit == "1" else f"{words} [{unit}]"
        return _named([str(value) if array.ndim == 1 else _listed(value) for value in array.values], words)
    unit = str(array.attrs.get("units", "1"))
    shown = scale(array.values, unit) if unit != "1" else scale(array.values, "")
    return _Shown(shown(array.values), f"{words} [{shown.name}]" if shown.name else words, shown.name)


def _listed(values: Values) -> str:
    """Numbers of a list or of a table."""
    return f"[{', '.join(_listed(v) if np.ndim(v) else v if isinstance(v, str) else f'{v:.4g}' for v in values)}]"


def _named(texts: list[str], words: str) -> _Shown:
    """Texts by their place in order of appearance; long ones by number."""
    number = {text: place for place, text in enumerate(dict.fromkeys(texts))}
    names = tuple(number)
    if max(map(len, names)) > LABEL:
        names, words = tuple(str(1 + place) for place in range(len(names))), f"{words} (number of the value)"
    return _Shown(np.array([number[text] for text in texts]), words, "", names)


def _failed(data: xr.Dataset) -> Values:
    return data.status.values == "failed"


def _label(axes: Axes, x: _Shown, *, vertical: bool = False) -> None:
    axis = axes.yaxis if vertical else axes.xaxis
    axis.set_label_text(x.words)
    if x.names:
        axis.set_ticks(range(len(x.names)), x.names)


def _mark_failed(axes: Axes, x: Values) -> None:
    """Red crosses at the bottom where points failed."""
    if len(x):
        place = axes.get_xaxis_transform()
        axes.plot(x, np.full(len(x), 0.02), "x", color=FAILED, transform=place, clip_on=False, label="failed")


def _curve(x: _Shown, y: _Shown, data: xr.Dataset) -> Figure:
    fig = figure(PAGE, 4.0)
    axes = fig.subplots()
    at = np.unique(x.values)
    groups = [y.values[(x.values == value) & np.isfinite(y.values)] for value in at]
    several = max(map(len, groups)) > 1
    low, middle, high = np.array(
        [np.percentile(group, PERCENTILES) if len(group) else np.full(3, np.nan) for group in groups]
    ).T
    if several:
        axes.fill_between(at, low, high, color=RIGID, alpha=0.6, linewidth=0, label="5th to 95th percentile")
    form = "o" if x.names else "o-"
    axes.plot(at, middle, form, color=FLEXIBLE, markersize=4, label="median" if several else "computed")
    _mark_failed(axes, np.unique(x.values[_failed(data)]))
    _label(axes, x)
    axes.set_ylabel(y.words)
    if several or _failed(data).any():
        axes.legend()
    return fig


def _map(x: _Shown, y: _Shown, z: _Shown, data: xr.Dataset) -> Figure:
    fig = figure(PAGE, 4.8)
    axes = fig.subplots()
    columns, column = np.unique(x.values, return_inverse=True)
    rows, row = np.unique(y.values, return_inverse=True)
    grid, failed = np.full((len(rows), len(columns)), np.nan), np.zeros((len(rows), len(columns)), dtype=bool)
    grid[row, column], failed[row, column] = z.values, _failed(data)
    edges = cell_edges(columns), cell_edges(rows)
    shown = axes.pcolormesh(*edges, np.ma.masked_invalid(grid), cmap=COLORS, linewidth=0, rasterized=True)
    if failed.any():
        axes.pcolormesh(*edges, np.ma.masked_equal(failed, False), cmap=ListedColormap([FAILED]), alpha=0.35)
        axes.set_title(f"red: failed ({failed.sum()} of {failed.size})", fontsize=TEXT)
    axes.grid(False)
    fig.colorbar(shown, label=z.words)
    for axis, values in ((axes.xaxis, columns), (axes.yaxis, rows)):
        if len(values) <= FEW:
            axis.set_ticks(values, [f"{value:.4g}" for value in values])
    _label(axes, x)
    _label(axes, y, vertical=True)
    return fig


def _histogram(y: _Shown, data: xr.Dataset) -> Figure:
    fig = figure(PAGE, 4.0)
    axes = fig.subplots()
    values = y.values[np.isfinite(y.values)]
    axes.hist(values, bins=int(np.clip(np.sqrt(len(values)), 8, 50)), color=RIGID, edgecolor="white", linewidth=0.5)
    top = axes.get_ylim()[1]
    axes.set_ylim(0, 1.16 * top)
    for per_cent, value in zip(PERCENTILES, np.percentile(values, PERCENTILES), strict=True):
        axes.plot([value, value], [0, 1.04 * top], color=FLEXIBLE, linestyle="-" if per_cent == 50 else "--")
        words = "median" if per_cent == 50 else f"{per_cent} %"
        place = {"ha": "center", "va": "bottom", "fontsize": NOTE, "color": FLEXIBLE}
        axes.annotate(f"{words}\n{value:.4g} {y.unit}", (value, 1.05 * top), **place)
    failed = int(_failed(data).sum())
    axes.set_title(f"{len(values)} draws{f', {failed} failed' if failed else ''}", fontsize=TEXT)
    axes.set(xlabel=y.words, ylabel="points")
    axes.yaxis.set_major_locator(MaxNLocator(6, integer=True))
    return fig


def _panels(y: _Shown, data: xr.Dataset) -> Figure:
    names = [str(name) for name, array in data.coords.items() if array.dims == ("point",)]
    keys = [_key(data, name) for name in names if len(set(data[name].values.tolist())) > 1][:MOST_PANELS]
    if not keys:
        return _histogram(y, data)
    columns = min(3, len(keys))
    rows = -(-len(keys) // columns)
    fig = figure(PAGE if columns > 1 else COLUMN, 2.4 * rows + 0.3)
    grid = fig.subplots(rows, columns, sharey=True, squeeze=False)
    for place, key in zip(grid.flat, keys, strict=False):
        place.plot(key.values, y.values, ".", color=FLEXIBLE, markersize=4, alpha=0.7)
        _mark_failed(place, key.values[_failed(data)])
        _label(place, key)
    for place in grid.flat[len(keys) :]:
        place.set_visible(False)
    fig.supylabel("\n".join(wrap(y.words, LABEL * rows)), fontsize=TEXT)
    if _failed(data).any():
        grid[0, 0].legend(loc="best")
    return fig
