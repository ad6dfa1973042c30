"""Where robots with welded ball joints reach the paper's three figures: over the roll and the place of the payload."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexapod.common.quantities import number
from flexapod.output.figures.style import COLUMN, SMALL, figure, ink, styled
from flexapod.output.scene.colours import AXIS_COLORS
from flexapod.verification.paper.claim import PAPER_DEVIATION
from flexapod.verification.paper.clamped_legs import SHARE, SLOPE, travel_share

_TITLES = {
    "diameters": "Circles as diameters, six legs",
    "radii": "Circles as radii, six legs",
    "diameters-one": "Diameters, one leg",
    "radii-one": "Radii, one leg",
}


@styled
def welded_figure(found: xr.Dataset) -> Figure:
    """Curves of the roll and the arm d on which a robot deviates by a printed figure, a panel a reading.

    Parameters
    ----------
    found : xarray.Dataset
        From `welded.welded_map`.
    """
    names = [str(name) for name in found.reading.values]
    fig = figure(2 * COLUMN, 7.0)
    grid = fig.subplots(2, 2, sharex=True, sharey=True)
    for axes, name in zip(grid.ravel(), names, strict=True):
        _curves(axes, found.sel(reading=name))
        axes.set_title(_TITLES.get(name, name))
    for axes in grid[-1]:
        axes.set_xlabel("roll [deg]")
    for axes in grid[:, 0]:
        axes.set_ylabel("centre of mass from the\nplatform's centre, d [mm]")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=4)
    return fig


def _curves(axes: Axes, found: xr.Dataset) -> None:
    arm, roll = 1e3 * found.arm.values, found["roll"].values
    wanted = [
        (f"y {1e3 * limit:.0f} mm" if axis == "y" else f"z {1e3 * limit:.0f} mm",
         found.deviation.sel(axis=axis).values / limit, AXIS_COLORS[axis], "-")
        for axis, limit in PAPER_DEVIATION.items()
    ]  # fmt: skip
    wanted.append((f"z {100 * SHARE:.0f} % of its travel", travel_share(found) / SHARE, "#333333", "--"))
    missing = []
    for label, values, color, style in wanted:
        known = np.isfinite(values) & (roll[None, :] > 0)
        if not (values[known] >= 1).any():
            missing.append(f"{label}: not reached,\nat most {number(100 * float(values[known].max()), 2)} % of that")
        axes.contour(roll, arm, np.where(known, values, np.nan), levels=[1.0], colors=[color], linestyles=style)
        axes.plot([], [], color=color, linestyle=style, label=label)
    if missing:
        axes.annotate("\n".join(missing), (0.03, 0.97), xycoords="axes fraction", va="top", fontsize=SMALL,
                      color=ink("#333333"), backgroundcolor="#F7F7F7")  # fmt: skip
    steep = float(roll[np.argmax((found.slope.values > SLOPE).any(axis=0))])
    axes.axvspan(steep, roll[-1], color="#999999", alpha=0.12, linewidth=0)
    axes.plot([], [], color="#999999", alpha=0.4, linewidth=6, label=f"slopes of the legs above {SLOPE:g}")
    axes.set_xlim(0, roll[-1])
    stress = found.stress.sel(arm=found.arm.values[len(found.arm) // 2])
    for value in (1e9, 3e9):
        at = np.interp(value, stress.values, roll, right=np.nan)
        if np.isfinite(at):
            axes.annotate(f"{1e-9 * value:.0f} GPa", (at, 0.02), xycoords=("data", "axes fraction"), rotation=90,
                          ha="right", va="bottom", fontsize=SMALL, color=ink("#8C564B"))  # fmt: skip
            axes.axvline(at, color="#8C564B", linewidth=0.8, linestyle=":")
