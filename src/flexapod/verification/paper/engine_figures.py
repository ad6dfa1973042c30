"""The robot by several programs: drive forces and path of the payload, one laid over the other (Figs. 8 and 9)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.analysis.results.attributes import motion_end
from flexapod.common.errors import InputError
from flexapod.common.quantities import Scale, scale, text
from flexapod.output.figures.legs import force_panels
from flexapod.output.figures.style import COLUMN, NOTE, figure, mark_end, needs, styled
from flexapod.output.scene.colours import FLEXIBLE, LEG_COLORS, RIGID

# From broad and pale to fine and dark: all show where they coincide.
_BAND: dict[str, Any] = {"color": RIGID, "linewidth": 6.5, "solid_capstyle": "butt"}
_LINES: tuple[dict[str, Any], ...] = (
    {"color": LEG_COLORS[4], "linewidth": 2.8, "solid_capstyle": "butt"},
    {"color": FLEXIBLE, "linewidth": 0.9},
    {"color": LEG_COLORS[3], "linewidth": 0.9, "linestyle": "--"},
)


@styled
@needs("actuator_force_rigid", "actuator_force")
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


@styled
@needs("com_position", "com_position_rigid", "com_deviation")
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
