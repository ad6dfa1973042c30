"""The single actuator by finite elements: solid ones, and a mesh that slides with the beam."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.common.quantities import number, scale
from flexapod.output.figures.style import NOTE, PAGE, figure, house_style, require_variables
from flexapod.output.scene.style import FLEXIBLE, LEG_COLORS, RIGID


@house_style
@require_variables("tip_deflection", "frequency")
def solid_meshes(meshes: Mapping[str, xr.Dataset], reference: xr.Dataset) -> Figure:
    """Response of the tip with one mesh a panel, over that of another model (Fig. 3 of the paper).

    Parameters
    ----------
    meshes : mapping of names to xarray.Dataset
        Results of `simulate_solid`, drawn two in a row: coarse and fine.
    reference : xarray.Dataset
        Result of `flexapod.simulate_actuator`, drawn pale for orientation.
    """
    columns = min(2, len(meshes))
    rows = -(-len(meshes) // columns)
    fig = figure(PAGE, 0.6 + 1.9 * rows)
    panels = np.atleast_1d(fig.subplots(rows, columns, sharex=True, sharey=True)).reshape(rows, columns)
    unit = scale(reference.tip_deflection, "m")
    for axes, (name, data) in zip(panels.flat, meshes.items(), strict=False):
        axes.plot(reference.time, unit(reference.tip_deflection), color=RIGID, linewidth=4, label="assumed modes")
        axes.plot(data.time, unit(data.tip_deflection), color=FLEXIBLE, linewidth=1.1, label="solid elements")
        axes.axhline(0, color="#555555", linewidth=0.7)
        axes.set_title(f"{name}\n{_mesh(data)}\n{float(data.frequency[0]):.3g} Hz at the start", fontsize="medium")
    for axes in panels.flat[len(meshes) :]:
        axes.set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel(f"deflection [{unit.name}]")
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    fig.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    fig.align_ylabels(panels[:, 0])
    return fig


@house_style
@require_variables("tip_deflection")
def solid_comparison(results: Mapping[str, xr.Dataset], reference: xr.Dataset) -> Figure:
    """Response of the tip by several models, and how far each is from the reference (Fig. 4 of the paper).

    Parameters
    ----------
    results : mapping of names to xarray.Dataset
        Results on the output instants of the reference, e.g. beam and solid elements.
    reference : xarray.Dataset
        By assumed modes.
    """
    fig = figure(PAGE, 4.8)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=(1.5, 1))
    unit = scale(reference.tip_deflection, "m")
    above.plot(reference.time, unit(reference.tip_deflection), color=RIGID, linewidth=5, label="assumed modes")
    for i, (name, data) in enumerate(results.items()):
        style = {"color": LEG_COLORS[i], "linestyle": ("-", (0, (4, 3)))[i % 2], "linewidth": 1.3}
        above.plot(data.time, unit(data.tip_deflection), label=name, **style)
    above.axhline(0, color="#555555", linewidth=0.7)
    above.set(title="Lateral deflection of the tip, in the frame of the hub", ylabel=f"deflection [{unit.name}]")
    fig.legend(*above.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    _differences(below, results, reference)
    below.set_xlabel("time [s]")
    fig.align_ylabels([above, below])
    return fig


def _differences(axes: Axes, results: Mapping[str, xr.Dataset], reference: xr.Dataset) -> None:
    gaps = {name: d.tip_deflection.values - reference.tip_deflection.values for name, d in results.items()}
    unit = scale(np.array([np.abs(gap).max() for gap in gaps.values()]), "m")
    for i, (name, gap) in enumerate(gaps.items()):
        largest = f"{name}: at most {number(unit.factor * np.abs(gap).max(), 2)} {unit.name}"
        axes.plot(reference.time, unit(gap), color=LEG_COLORS[i], linewidth=1.0, label=largest)
    axes.axhline(0, color="#555555", linewidth=0.7)
    axes.set(title="Difference from the assumed modes", ylabel=f"difference [{unit.name}]")
    axes.legend(ncols=2, loc="upper left")
    axes.margins(y=0.35)


def _mesh(data: xr.Dataset) -> str:
    size, unknowns = float(data.attrs.get("element_size", np.nan)), int(data.attrs.get("unknowns", 0))
    return f"{number(1e3 * size, 2)} mm, {unknowns:,} unknowns"


_WORDS = {
    "nodes": "guide touches nodes",
    "elements": "guide touches whole elements",
    "clamp": "clamp inside the element",
}
_MARKS = ("o", "s", "^")
_REFERENCE = "#333333"


@house_style
@require_variables("tip_reference", "error", "error_free_length", "clamp_shift", "error_of_stiffness")
def sliding_mesh(data: xr.Dataset) -> Figure:
    """Tip over time, error against element length with slopes, place of the clamp in an element, guide's stiffness.

    Parameters
    ----------
    data : xarray.Dataset
        Result of `flexapod.analysis.sliding_mesh.sliding_mesh`.
    """
    fig = figure(PAGE, 6.0, gap=0.06)
    panels = fig.subplots(2, 2)
    _tips(panels[0, 0], data)
    _errors(panels[0, 1], data)
    _shifts(panels[1, 0], data)
    _stiffnesses(panels[1, 1], data)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=2)
    return fig


def _guides(data: xr.Dataset) -> list[tuple[str, str, str, str]]:
    """Name, words, colour and mark of each guide."""
    names = [str(name) for name in data.guide.values]
    return [(name, _WORDS.get(name, name), LEG_COLORS[i], _MARKS[i % 3]) for i, name in enumerate(names)]


def _tips(axes: Axes, data: xr.Dataset) -> None:
    unit = scale(data.tip_reference, "m")
    axes.plot(data.time, unit(data.tip_reference), color=RIGID, linewidth=4.5, label="free length, assumed modes")
    for name, words, color, _ in _guides(data):
        axes.plot(data.time, unit(data.tip_deflection.sel(guide=name)), color=color, linewidth=1.1, label=words)
    axes.set_title(f"Tip, elements of {number(1e3 * data.attrs['shown_element_length'], 2)} mm fixed to the beam")
    axes.set(xlabel="time [s]", ylabel=f"deflection [{unit.name}]")


def _errors(axes: Axes, data: xr.Dataset) -> None:
    size = 1e3 * data.element_length
    for name, _, color, mark in _guides(data):
        axes.loglog(size, 1e2 * data.error.sel(guide=name), mark + "-", color=color, markersize=5)
    free = 1e2 * data.error_free_length
    axes.loglog(1e3 * data.free_element_length, free, "D-", color=_REFERENCE, markersize=5)
    axes.annotate(
        "elements on\nthe free length",
        (float(1e3 * data.free_element_length[0]), float(free[0])),
        xytext=(0, 8),
        textcoords="offset points",
        ha="center",
        va="bottom",
        fontsize=NOTE,
        color=_REFERENCE,
    )
    lowest = data.error.min("guide")
    axes.margins(y=0.12)
    _slope(axes, size.values, 0.45e2 * lowest.values[np.argmax(size.values)], 1)
    axes.set_title("Error of the tip, and order 1")
    axes.set(xlabel="length of an element [mm]", ylabel="root mean square error [%]")


def _slope(axes: Axes, sizes: np.ndarray, at_largest: float, order: int) -> None:
    ends = np.array([sizes.min(), sizes.max()])
    values = at_largest * (ends / ends[1]) ** order
    axes.loglog(ends, values, color="#888888", linestyle=(0, (4, 3)), linewidth=1.0)
    axes.annotate(f"order {order}", (ends[0], values[0]), xytext=(2, -12), textcoords="offset points", fontsize=NOTE,
                  color="#666666")  # fmt: skip


def _shifts(axes: Axes, data: xr.Dataset) -> None:
    for name, _, color, mark in _guides(data):
        axes.plot(data.outside_part, data.clamp_shift_law.sel(guide=name), color=color)
        axes.plot(
            data.outside_part, data.clamp_shift.sel(guide=name), mark, color=color, markersize=4, fillstyle="none"
        )
    axes.axhline(0, color=_REFERENCE, linewidth=0.9)
    axes.annotate(
        "lines: law\nmarks: from the first frequency",
        (0.03, 0.97),
        xycoords="axes fraction",
        va="top",
        fontsize=NOTE,
        color="#555555",
    )
    axes.annotate("the mouth", (0.0, 0.0), xytext=(0, -3), textcoords="offset points", va="top", fontsize=NOTE)
    axes.margins(y=0.25)
    axes.set_title("Why: where the clamp seems to be")
    axes.set(xlabel="part of the element at the mouth that is outside", ylabel="shift / element length, outwards")


def _stiffnesses(axes: Axes, data: xr.Dataset) -> None:
    axes.loglog(data.stiffness, 1e2 * data.error_of_stiffness, _MARKS[1] + "-", color=LEG_COLORS[1], markersize=5)
    axes.margins(y=0.3)
    axes.set_title("Stiffness, for whole elements")
    axes.set(xlabel="stiffness per length [N/m²]", ylabel="root mean square error [%]")
    place = {"xycoords": "axes fraction", "fontsize": NOTE, "color": "#555555"}
    axes.annotate("too soft: the clamp\nis behind the mouth", (0.02, 0.04), **place)
    axes.annotate("too stiff: the\nelement locks", (0.97, 0.3), ha="right", **place)
