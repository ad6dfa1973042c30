"""Maps of a quantity over poses: a line, a slice, or slices of a volume; what is not reached is shown as such."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from flexapod.analysis.checks.reachability import REACHED, REASONS
from flexapod.analysis.results.poses import coordinate_words
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import Scale, number, scale
from flexapod.common.ranking import EQUALS, first_largest, first_least
from flexapod.design.maps.findings import (
    SIDES,
    motion_path,
    quantity_name,
    quantity_unit,
    scalar,
    scalars,
    scalars_with_values,
)
from flexapod.design.maps.grid import UNITS
from flexapod.model import AXES
from flexapod.output.figures.style import (
    COLORS,
    NOTE,
    PAGE,
    SMALL,
    TEXT,
    cell_edges,
    figure,
    house_style,
    require_variables,
)

# Ground and hatching of what is not reached, by code; codes that rarely meet share one.
GROUNDS = {
    1: ("#E4E4E4", "///"), 2: ("#CFCFCF", "\\\\\\"), 3: ("#DADADA", "xx"), 4: ("#C4C4C4", "++"), 5: ("#EFEFEF", "oo"),
    6: ("#BBBBBB", "..."), 7: ("#F3DFD8", "///"), 8: ("#F3DFD8", "\\\\\\"), 9: ("#F3DFD8", "..."),
    10: ("#F3DFD8", "xx"), 11: ("#F3DFD8", "oo"), 12: ("#F3DFD8", "++"),
}  # fmt: skip
WITHOUT_UNIT = {"condition": "condition", "euler_share": "thrust over Euler load"}
LINEAR = ("stroke_margin", "guided_length", "base_joint_angle", "platform_joint_angle", "euler_share")
HATCH, OVER, BAD = "#8C8C8C", "#D55E00", "#D7263D"
BRIGHT = 0.5  # share of the colours from which dark words are easier to read on them than white ones
LOG_FROM = 20.0  # ratio of largest to least from which colours go with the logarithm
HIGHEST = 1e4  # of the least value: colours end there, towards a singularity


@house_style
@require_variables("reason", "frequency", "condition")
def workspace_map(data: xr.Dataset, quantity: str = "frequency", *, mode: int = 1) -> Figure:
    """One quantity of a map, with home and the path of the study's motion.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.workspace_map` over one, two or three coordinates.
    quantity : str
        A variable with one number per pose.
    mode : int
        Which frequency.

    Raises
    ------
    InputError
        A quantity that is not in the map, or that no leg of the robot has (margins without strokes or cylinders).
    """
    if quantity not in scalars(data):
        raise InputError("is not in this map", key="quantity", value=quantity, allowed=", ".join(scalars(data)))
    values = scalar(data, quantity, mode)
    if not np.isfinite(values.values).any() and (data.reason.values == REACHED).any():
        allowed = ", ".join(scalars_with_values(data))
        raise InputError(
            "has no value in this map: no leg has such a limit", key="quantity", value=quantity, allowed=allowed
        )
    unit = scale(values.values, quantity_unit(values))
    title = _title(data, quantity, mode)
    if values.ndim == 1:
        return _line(data, values, unit, title, quantity)
    return _slices(data, values, unit, title, quantity)


def _title(data: xr.Dataset, quantity: str, mode: int) -> str:
    words = quantity_name(data, quantity, mode)
    fixed = {name: data.attrs[f"at_{name}"] for name in AXES if data.attrs.get(f"at_{name}", 0.0)}
    place = f" ({coordinate_words(fixed)})" if fixed else ""
    return f"{words[0].upper()}{words[1:]}{place}"


def _slices(data: xr.Dataset, values: xr.DataArray, unit: Scale, title: str, quantity: str) -> Figure:
    """A slice, or small multiples along the third coordinate, with one scale of colours."""
    third = str(values.dims[2]) if values.ndim == 3 else None
    places = values[third].values if third else np.zeros(1)
    chosen = np.unique(np.linspace(0, len(places) - 1, min(len(places), 9)).round().astype(int))
    columns = min(3, len(chosen))
    rows = -(-len(chosen) // columns)
    width, height = _size(values, (PAGE - 1.4) / columns)
    fig = figure(width * columns + 1.4, height * rows + 1.4)
    grid = fig.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    norm, extend = _norm(unit(values.values), linear=quantity in LINEAR)
    path, image = motion_path(data), None
    for axes, k in zip(grid.flat, chosen, strict=False):
        part = values.isel({third: k}) if third else values
        codes = data.reason.isel({third: k}) if third else data.reason
        image = _slice(axes, part, codes, unit, norm)
        near = None if third is None else (third, places, int(k))
        _home(axes, data, part, near)
        _path(axes, part, path, data, near)
        if third:
            axes.set_title(coordinate_words({third: float(places[k])}), fontsize=TEXT, fontweight="normal")
    for axes in grid.flat[len(chosen) :]:
        axes.set_visible(False)
    _label(fig, grid, *(_axis_label(str(dim)) for dim in values.dims[:2]))
    if image is not None and np.isfinite(values.values).any():
        seen = [axes for axes in grid.flat if axes.get_visible()]
        bar = fig.colorbar(image, ax=seen, extend=extend, shrink=0.9, pad=0.02)
        bar.set_label(unit.name or WITHOUT_UNIT[quantity])
        bar.outline.set_visible(False)  # pyright: ignore
        _mark_worst(grid.flat, values, unit, quantity, third, chosen)
    _headline(fig, title)
    _legend(fig, grid.flat, data)
    return fig


def _label(fig: Figure, grid, x: str, y: str) -> None:
    """Labels of the axes: below each column of slices; at the side once, where there are several."""
    if grid.size == 1:
        grid[0, 0].set(xlabel=x, ylabel=y)
        return
    for column in grid.T:
        lowest = [axes for axes in column if axes.get_visible()][-1]
        lowest.tick_params(labelbottom=True)
        lowest.set_xlabel(x.replace(" from home", ""))
    fig.supylabel(y, fontsize=TEXT)


def _headline(fig: Figure, title: str) -> None:
    """The title in as many lines as the width of the figure asks for."""
    words = "\n".join(wrap(title, int(12 * fig.get_figwidth())))
    fig.suptitle(words, x=0.01, ha="left", fontsize=9, fontweight="bold")


def _size(values: xr.DataArray, width: float) -> tuple[float, float]:
    """Width and height of a panel [in]: as the plane is, where both axes have the same unit."""
    spans = [np.ptp(cell_edges(_shown(str(dim), values[dim].values))) for dim in values.dims[:2]]
    if UNITS[str(values.dims[0])] != UNITS[str(values.dims[1])]:
        return width, 0.75 * width
    ratio = spans[1] / spans[0]
    return (width, max(width * ratio, 0.4 * width)) if ratio <= 1 else (max(width / ratio, 0.55 * width), width)


def _norm(values: Array, *, linear: bool) -> tuple[Normalize, str]:
    """Colours go with the logarithm over a wide range, and end at `HIGHEST` times the least value."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return Normalize(0, 1), "neither"
    low, high = float(finite.min()), float(finite.max())
    if not _vary(finite):
        return Normalize(low, low + max(abs(low), 1e-12) * 1e-3), "neither"
    if linear or low <= 0 or high < LOG_FROM * low:
        return Normalize(low, high), "neither"
    return LogNorm(low, min(high, HIGHEST * low)), "max" if high > HIGHEST * low else "neither"


def _vary(values: Array) -> bool:
    """Test whether values differ by more than rounding."""
    return values.size > 0 and bool(np.ptp(values) > EQUALS * np.abs(values).max())


def _levels(norm: Normalize) -> Sequence[float]:
    """Values of the contour lines, the same in all slices."""
    low, high = float(norm.vmin or 0.0), float(norm.vmax or 1.0)
    if not isinstance(norm, LogNorm):
        return MaxNLocator(8).tick_values(low, high)
    steps = (1.0, 2.0, 5.0) if high < 1e3 * low else (1.0,)
    return LogLocator(subs=steps, numticks=99).tick_values(low, high)


def _slice(axes: Axes, part: xr.DataArray, codes: xr.DataArray, unit: Scale, norm: Normalize):
    x, y = (_shown(str(dim), part[dim].values) for dim in part.dims)
    _unreached(axes, cell_edges(x), cell_edges(y), codes.values)
    shown = np.ma.masked_invalid(unit(part.values).T)
    colors: Colormap | str = COLORS
    image = axes.pcolormesh(cell_edges(x), cell_edges(y), shown, cmap=colors, norm=norm, rasterized=True, zorder=1)
    axes.grid(visible=False)
    if min(len(x), len(y)) > 4 and shown.count() > 12 and _vary(shown.compressed()):
        levels = _levels(norm)
        inks = np.where(norm(np.asarray(levels)) > BRIGHT, "#222222", "white").tolist()
        lines = axes.contour(x, y, shown, levels=levels, colors=inks, linewidths=0.7, zorder=2)
        axes.clabel(lines, fontsize=SMALL, fmt=lambda value: number(value))
    axes.set_xlim(*cell_edges(x)[[0, -1]])
    axes.set_ylim(*cell_edges(y)[[0, -1]])
    if len({UNITS[str(dim)] for dim in part.dims}) == 1:
        axes.set_aspect("equal", adjustable="box")
    return image


def _unreached(axes: Axes, x: Array, y: Array, codes: Array) -> None:
    """Grey and hatched cells, a pattern for each reason; cells above each other are drawn as one."""
    for code in np.unique(codes[codes != REACHED]):
        ground, hatch = GROUNDS[int(code)]
        boxes = [
            [(x[i], y[a]), (x[i + 1], y[a]), (x[i + 1], y[b]), (x[i], y[b])]
            for i, column in enumerate(codes == code)
            for a, b in _runs(column)
        ]
        axes.add_collection(
            PolyCollection(boxes, facecolors=ground, edgecolors=HATCH, hatch=hatch, linewidths=0.0, zorder=0.5),
            autolim=False,
        )


def _runs(mask: np.ndarray) -> Sequence[tuple[int, int]]:
    """Beginnings and ends of the runs of True."""
    steps = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return list(zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True))


def _shown(name: str, values: Array) -> Array:
    """Coordinates in mm and deg."""
    return 1e3 * values if UNITS[name] == "m" else np.rad2deg(values)


def _axis_label(name: str) -> str:
    return f"{name} from home [{'mm' if UNITS[name] == 'm' else 'deg'}]"


_Near = tuple[str, Array, int]  # third coordinate, its values, which of them this slice is


def _in_slice(values: Array, near: _Near | None) -> np.ndarray:
    """True for values of the third coordinate that lie nearer to this slice than to its neighbours."""
    if near is None:
        return np.ones(len(values), dtype=bool)
    _, places, k = near
    edges = cell_edges(places)
    return (values >= edges[k]) & (values <= edges[k + 1])


def _home(axes: Axes, data: xr.Dataset, part: xr.DataArray, near: _Near | None) -> None:
    if not _in_slice(np.zeros(1), near)[0]:
        return
    limits = (axes.get_xlim(), axes.get_ylim())
    if any(not low <= 0 <= high for low, high in limits):
        return
    here = not any(data.attrs.get(f"at_{name}", 0.0) for name in AXES)
    label = "home" if here else "home (elsewhere in the fixed coordinates)"
    axes.plot(
        0, 0, "P", markersize=8, color=OVER if here else "none", markeredgecolor="white" if here else OVER,
        markeredgewidth=0.9, label=label, zorder=5, linestyle="none",
    )  # fmt: skip


def _path(axes: Axes, part: xr.DataArray, path: Array | None, data: xr.Dataset, near: _Near | None) -> None:
    """The motion's path in the plane of the slice; dashed where it lies elsewhere in the other coordinates."""
    if path is None:
        return
    names = [str(dim) for dim in part.dims]
    columns = [AXES.index(name) for name in names]
    inside = _in_slice(path[:, AXES.index(near[0])], near) if near else np.ones(len(path), dtype=bool)
    line = [np.where(inside, _shown(name, path[:, c]), np.nan) for name, c in zip(names, columns, strict=True)]
    if not inside.any() or max(np.ptp(path[inside][:, c]) for c in columns) < 1e-9:
        return
    fixed = [AXES.index(name) for name in AXES if name not in names and (near is None or name != near[0])]
    off = max(np.abs(path[:, c] - data.attrs.get(f"at_{AXES[c]}", 0.0)).max() for c in fixed)
    label = "path of the motion" if off < 1e-9 else "path of the motion (elsewhere in the other coordinates)"
    axes.plot(*line, color="white", linewidth=3.2, zorder=3)
    axes.plot(*line, color=OVER, linewidth=1.6, linestyle="-" if off < 1e-9 else "--", label=label, zorder=4)


def _mark_worst(grid, values: xr.DataArray, unit: Scale, quantity: str, third: str | None, chosen: Array) -> None:
    """A ring at the least or largest value, whichever is the bad end, where its slice is drawn."""
    flat, side = values.values, SIDES[quantity]
    index = np.unravel_index(first_least(flat) if side == "least" else first_largest(flat), flat.shape)
    if third and int(index[2]) not in chosen:
        return
    axes = list(grid)[int(np.flatnonzero(chosen == index[2])[0]) if third else 0]
    x, y = (_shown(str(dim), values[dim].values)[i] for dim, i in zip(values.dims[:2], index[:2], strict=True))
    axes.plot(
        x, y, "o", markersize=8, markerfacecolor="none", markeredgecolor=BAD, markeredgewidth=1.8, linestyle="none",
        label=f"{side}: {unit.text(float(flat[index])).strip()}", zorder=6, clip_on=False,
    )  # fmt: skip


def _legend(fig: Figure, grid, data: xr.Dataset) -> None:
    """Home, path, the worst place, and the reasons that occur."""
    found: dict[str, Line2D | Patch] = {}
    for axes in grid:
        handles, labels = axes.get_legend_handles_labels()
        found |= {label: handle for label, handle in zip(labels, handles, strict=True) if label not in found}
    for code in np.unique(data.reason.values[data.reason.values != REACHED]):
        ground, hatch = GROUNDS[int(code)]
        found[REASONS[code].words] = Patch(facecolor=ground, edgecolor=HATCH, hatch=hatch, linewidth=0.0)
    if found:
        longest = 0.6 + 0.06 * max(map(len, found))  # of an entry [in]
        columns = 2 if 2 * longest < fig.get_figwidth() else 1
        fig.legend(list(found.values()), list(found), loc="outside lower center", ncols=columns, fontsize=NOTE)


def _line(data: xr.Dataset, values: xr.DataArray, unit: Scale, title: str, quantity: str) -> Figure:
    """A quantity along one coordinate."""
    fig = figure(PAGE, 4.0)
    axes, name = fig.subplots(), str(values.dims[0])
    x, y = _shown(name, values[name].values), unit(values.values)
    axes.plot(x, y, color="#00336F", marker="." if len(x) < 60 else None)
    edges = cell_edges(x)
    for code in np.unique(data.reason.values[data.reason.values != REACHED]):
        ground, hatch = GROUNDS[int(code)]
        for a, b in _runs(data.reason.values == code):
            axes.axvspan(edges[a], edges[b], facecolor=ground, edgecolor=HATCH, hatch=hatch, linewidth=0.0, zorder=0.5)
    if isinstance(_norm(y, linear=quantity in LINEAR)[0], LogNorm):
        axes.set_yscale("log")
    if edges[0] <= 0 <= edges[-1]:
        here = not any(data.attrs.get(f"at_{other}", 0.0) for other in AXES)
        axes.axvline(0, color=OVER, linewidth=1.2, linestyle="-" if here else "--", label="home" if here else None)
    axes.set_xlim(*edges[[0, -1]])
    axes.set(xlabel=_axis_label(name), ylabel=unit.name or WITHOUT_UNIT[quantity])
    if np.isfinite(y).any():
        side = SIDES[quantity]
        k = first_least(y) if side == "least" else first_largest(y)
        ring = {"markerfacecolor": "none", "markeredgecolor": BAD, "markeredgewidth": 1.8, "linestyle": "none"}
        axes.plot(x[k], y[k], "o", markersize=8, label=f"{side}: {unit.text(float(values.values[k])).strip()}", **ring)
    _headline(fig, title)
    _legend(fig, [axes], data)
    return fig
