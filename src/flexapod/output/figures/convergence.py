"""Convergence of results with step and shapes, and accuracy of every fidelity against its cost."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.output.figures.style import PAGE, SMALL, figure, house_style, readable_color, require_variables
from flexapod.output.scene.style import FLEXIBLE, LEG_COLORS

_WORDS = {"deviation": "centre of mass", "tip": "tip deflection"}
# Colour, marker and name of each family; markers differ too, for print in grey.
_FAMILIES = {
    "shapes": (LEG_COLORS[0], "o", "shapes"),
    "elements": (LEG_COLORS[3], "s", "elements (2 shapes each)"),
    "segments": (LEG_COLORS[2], "^", "segments (1 shape each)"),
}
_RUNGS = {
    ("rigid", ""): ("#666666", "X", "rigid"),
    ("lumped", ""): ("#222222", "D", "lumped"),
    ("finite-segment", ""): (LEG_COLORS[2], "^", "finite-segment (segments)"),
    ("assumed-modes", "clamped-free"): (LEG_COLORS[4], "v", "assumed-modes, clamped-free"),
    ("assumed-modes", "tip-load"): (LEG_COLORS[0], "o", "assumed-modes, tip-load"),
    ("beam-fem", ""): (LEG_COLORS[3], "s", "beam-fem (elements)"),
    ("solid-fem", ""): (LEG_COLORS[1], "h", "solid-fem (shapes), with shear"),
}
# Where the numbers of a fidelity stand, so that neighbours do not cover each other.
_SIDES = {
    ("finite-segment", ""): ((4, 6), "left"),
    ("assumed-modes", "clamped-free"): ((-5, 4), "right"),
    ("assumed-modes", "tip-load"): ((-6, -8), "right"),
    ("beam-fem", ""): ((6, -3), "left"),
    ("solid-fem", ""): ((5, -9), "left"),
}
_OTHER = (LEG_COLORS[1], "P")
_FILE, _CHOSEN = LEG_COLORS[5], LEG_COLORS[1]


@house_style
@require_variables("family", "steps", "error_tip")
def convergence(data: xr.Dataset) -> Figure:
    """Error against step, and against the number of shapes per plane, a quantity a row.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.converge`, whole or partial.
    """
    names = [name for name in _WORDS if f"error_{name}" in data]
    fig = figure(PAGE, 2.9 * len(names) + 0.5)
    grid = fig.subplots(len(names), 2, squeeze=False, sharex="col")
    for row, name in zip(grid, names, strict=True):
        for axes, families in zip(row, (("step", "file", "recommended"), tuple(_FAMILIES)), strict=True):
            axes.set_yscale("log")
            axes.set_ylim(*_range(data, name, families))
            _allowed(axes, data, name == names[0])
        _step(row[0], data, name)
        _shapes(row[1], data, name)
        row[0].set_ylabel(f"{_WORDS[name]}:\nrelative error")
    grid[0, 0].set_title(f"Step ({_subject(data)})")
    grid[0, 1].set_title(f"Shapes ({_step_of(data)})")
    grid[-1, 0].set_xlabel("step [ms]")
    grid[-1, 1].set_xlabel("lateral shapes per plane")
    fig.align_ylabels(grid[:, 0])
    named = {words: part for axes in grid.flat for part, words in zip(*axes.get_legend_handles_labels(), strict=True)}
    fig.legend(list(named.values()), list(named), loc="outside lower center", ncols=4)
    return fig


def _step(axes: Axes, data: xr.Dataset, name: str) -> None:
    part = _successes(data, "step", name)
    x, y = 1e3 * part.step.values, part[f"error_{name}"].values
    _slope(axes, x, y, 2.0)
    axes.loglog(x, y, "o-", color=FLEXIBLE, markersize=5, label="fixed step")
    _step_ticks(axes, x)
    for family, mark, color, words in (
        ("file", "*", _FILE, "as in the file"),
        ("recommended", "P", _CHOSEN, "recommended"),
    ):
        found = _successes(data, family, name)
        if found.sizes["setting"] and np.isfinite(found.step).all():
            axes.plot(1e3 * found.step, found[f"error_{name}"], mark, color=color, markersize=10, label=words,
                      markeredgecolor="white")  # fmt: skip


def _step_ticks(axes: Axes, steps: np.ndarray) -> None:
    """Every other step by name, where there are many."""
    shown = np.unique(steps)[:: 2 if len(steps) > 7 else 1]
    if len(shown):
        axes.set_xticks(shown, [f"{h:.3g}" for h in shown])
        axes.minorticks_off()


def _shapes(axes: Axes, data: xr.Dataset, name: str) -> None:
    for family, (color, mark, words) in _FAMILIES.items():
        part = _successes(data, family, name)
        if part.sizes["setting"]:
            axes.loglog(part.shapes, part[f"error_{name}"], mark + "-", color=color, markersize=5, label=words)
    floor = data.attrs.get(f"floor_{name}", 0.0)
    lowest = [e for e in data[f"error_{name}"].values if e > 0]
    if lowest and min(lowest) < 100 * floor:
        axes.axhspan(1e-3 * floor, floor, color="#DDDDDD", linewidth=0, zorder=0, label="rounding")
    counts = sorted({int(k) for family in _FAMILIES for k in _successes(data, family, name).shapes.values})
    if counts:
        axes.set_xticks(counts, [str(k) for k in counts])
        axes.minorticks_off()


def _slope(axes: Axes, x: np.ndarray, y: np.ndarray, order: float) -> None:
    """A line of the order of theory through the finest error, as far up as the largest."""
    if not len(x):
        return
    at = int(np.argmin(x))
    reach = np.array([x[at], min(x.max(), x[at] * (3 * y.max() / y[at]) ** (1 / order))])
    line = y[at] * (reach / x[at]) ** order
    axes.plot(reach, line, color="#888888", linewidth=1.0, linestyle=(0, (4, 3)), label=f"order {order:g}")


def _range(data: xr.Dataset, name: str, families: tuple[str, ...]) -> tuple[float, float]:
    """Limits of a panel: the errors that are there, and the accuracy that was asked for."""
    errors = data[f"error_{name}"].values[np.isin(data.family.values, families)]
    known = [*errors[errors > 0], data.attrs["accuracy"]]
    return 0.3 * min(known), 3 * max(known)


def _allowed(axes: Axes, data: xr.Dataset, asked: bool) -> None:
    """The accuracy that was asked for."""
    if asked:
        axes.axhline(data.attrs["accuracy"], color="#C44E52", linewidth=1.0, linestyle=(0, (1, 1.5)), label="asked for")


def _successes(data: xr.Dataset, family: str, name: str) -> xr.Dataset:
    """Rows of a family that have an error above zero."""
    return data.isel(setting=np.flatnonzero((data.family.values == family) & (data[f"error_{name}"].values > 0)))


def _subject(data: xr.Dataset) -> str:
    rows = data.isel(setting=np.flatnonzero(data.family.values == "step"))
    if not rows.sizes["setting"]:
        return "none computed"
    first = rows.isel(setting=0)
    basis = f", {first.basis.values!s}" if str(first.basis.values) else ""
    shapes = f", {int(first.shapes)} shapes" if int(first.shapes) else ""
    return f"{first.fidelity.values!s}{basis}{shapes}"


def _step_of(data: xr.Dataset) -> str:
    rows = [float(h) for h, f in zip(data.step.values, data.family.values, strict=True) if f in _FAMILIES]
    return f"all with step {1e3 * rows[0]:.5g} ms" if rows else "none computed"


@house_style
@require_variables("fidelity", "seconds", "error_tip")
def ladder(data: xr.Dataset) -> Figure:
    """Error of every fidelity against the time of the run, a quantity a panel; numbers: shapes, segments, elements.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.ladder`, whole or partial.
    """
    names = [name for name in _WORDS if f"error_{name}" in data]
    fig = figure(PAGE, 4.2)
    row = fig.subplots(1, len(names), squeeze=False)[0]
    for axes, name in zip(row, names, strict=True):
        for (fidelity, basis), (color, mark, words) in _styles(data).items():
            _rung(axes, data, name, (fidelity, basis), color, mark, words)
        axes.set(xscale="log", yscale="log")
        axes.margins(0.12, 0.08)
        axes.set(xlabel="time of the run [s]", title=f"{_WORDS[name].capitalize()}: relative error")
        _plain_times(axes, data)
    handles, labels = row[0].get_legend_handles_labels()
    fig.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=3 if len(names) > 1 else 2,
        title="numbers: shapes per plane, beam elements, segments",
    )
    return fig


def _styles(data: xr.Dataset) -> dict[tuple[str, str], tuple[str, str, str]]:
    """Colour, marker and name of every fidelity and basis that is there, in the order of the ladder."""
    there = dict.fromkeys(zip(map(str, data.fidelity.values), map(str, data.basis.values), strict=True))
    return {key: _RUNGS.get(key, (*_OTHER, ", ".join(filter(None, key)))) for key in there}


def _rung(axes: Axes, data: xr.Dataset, name: str, of: tuple[str, str], color: str, mark: str, words: str) -> None:
    chosen = (data.fidelity.values == of[0]) & (data.basis.values == of[1]) & (data[f"error_{name}"].values > 0)
    part = data.isel(setting=np.flatnonzero(chosen))
    if not part.sizes["setting"]:
        return
    x, y = part.seconds.values, part[f"error_{name}"].values
    axes.plot(x, y, color=color, linewidth=0.9, alpha=0.7)
    axes.plot(x, y, mark, color=color, markersize=7, markeredgecolor="white", markeredgewidth=0.6, label=words)
    per = 2 if of[0] == "beam-fem" else 1
    side, align = _SIDES.get(of, ((7, 3), "left"))
    for seconds, error, k in zip(x, y, part.shapes.values, strict=True):
        if k:
            axes.annotate(str(int(k) // per), (seconds, error), xytext=side, textcoords="offset points", fontsize=SMALL,
                          color=readable_color(color), ha=align)  # fmt: skip


def _plain_times(axes: Axes, data: xr.Dataset) -> None:
    """Ticks at 1, 2, 5 of every decade that is there."""
    low, high = float(data.seconds.min()), float(data.seconds.max())
    ticks = [d * 10.0**e for e in range(-4, 5) for d in (1, 2, 5)]
    shown = [t for t in ticks if 0.7 * low <= t <= 1.4 * high]
    if len(shown) > 1:
        axes.set_xticks(shown, [f"{t:g}" for t in shown])
        axes.minorticks_off()
