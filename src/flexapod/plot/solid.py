"""The single actuator by finite elements: what the mesh does to it, and how far it is from the assumed modes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.plot.style import FLEXIBLE, LEG_COLORS, PAGE, RIGID, figure, needs, scale, styled
from flexapod.study.words import number

__all__ = ["solid_comparison", "solid_meshes"]


@styled
@needs("tip_deflection", "frequency")
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


@styled
@needs("tip_deflection")
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
    above.set_title("Lateral deflection of the tip, in the frame of the hub")
    above.set_ylabel(f"deflection [{unit.name}]")
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
    axes.set_title("Difference from the assumed modes")
    axes.set_ylabel(f"difference [{unit.name}]")
    axes.legend(ncols=2, loc="upper left")
    axes.margins(y=0.35)


def _mesh(data: xr.Dataset) -> str:
    size, unknowns = float(data.attrs.get("element_size", np.nan)), int(data.attrs.get("unknowns", 0))
    return f"{number(1e3 * size, 2)} mm, {unknowns:,} unknowns"
