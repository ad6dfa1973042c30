"""Paper's robot with ball joints that carry moments: equilibria along the roll, legs clamped to the platform.

Map and figure show where, over the roll and the place of the payload, such robots reach the paper's three
figures.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from xarray import Dataset

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.common.quantities import number
from flexapod.mechanics.leg.layout import Shapes
from flexapod.output.figures.style import COLUMN, SMALL, figure, house_style, readable_color
from flexapod.output.scene.style import AXIS_COLORS
from flexapod.solve.system import State
from flexapod.verification.paper.claim import PAPER_DEVIATION
from flexapod.verification.paper.equilibrium_path import locked_equilibrium, system_of
from flexapod.verification.paper.trials import nothing

SHARE = 0.06  # of the travel: the third figure that the paper prints
SLOPE = 0.1  # of the tip: beyond, the bending of the legs is larger than the theory is made for
STATIONS = np.linspace(0.0, 1.0, 41)


def equilibria_at_rolls(
    rolls: Sequence[float], study: model.Study, columns: Sequence[str], _: float | None
) -> dict[str, Array]:
    """Columns by name of the equilibrium at each roll [deg], from home on.

    `deviation` (roll, axis) [m] of the centre of mass at rest; `off_axis` [m], the farthest tip from its cylinder's
    axis, and its `slope`; `shortening` [m] of a leg by bending; `leg_force` [N]; `stress` [Pa] of a linear elastic
    piston. NaN beyond the last equilibrium that continues the one before.
    """
    values, system, state = nothing(columns, roll=len(rolls)), system_of(study), None
    for k, roll in enumerate(rolls):
        found, sag = locked_equilibrium(study, system, [0.0, 0.0, 0.0, np.deg2rad(roll), 0.0, 0.0], state)
        if not found.found:
            break
        state = found.state
        for name, value in _values(study.robot, system.kernel.shapes, sag, state).items():
            values[name][k] = value
    return values


def _values(robot: model.Robot, shapes: Shapes, sag: Array, x: State) -> dict[str, Any]:
    first = shapes.index("a")
    lateral = x.q[:, first : first + 2 * shapes.beam.a.count].reshape(len(x.q), 2, -1)
    free = x.q[:, shapes.index("l")] - np.array([leg.cylinder.mouth for leg in robot.legs])
    slope = lateral @ shapes.beam.a.tip_slope / free[:, None]
    short = 0.5 * np.einsum("idk,kj,idj->i", lateral, shapes.beam.a.slope_tip, lateral) / free
    curvature = lateral @ shapes.beam.a.values(STATIONS, 2) / free[:, None, None] ** 2
    thrust = np.abs(x.drive[:, 0])
    return {
        "deviation": np.abs(sag),
        "off_axis": np.linalg.norm(lateral @ shapes.beam.a.tip, axis=1).max(),
        "slope": np.linalg.norm(slope, axis=1).max(),
        "shortening": short.max(),
        "leg_force": thrust.max(),
        "stress": _stress(robot, np.linalg.norm(curvature, axis=1).max(axis=1), thrust),
    }


def _stress(robot: model.Robot, bent: Array, thrust: Array) -> float:
    """Largest stress [Pa] of round pistons: E d / 2 times the curvature, and the thrust over the section."""
    stress = [
        0.5 * (p.E or np.nan) * (p.diameter or np.nan) * k + f * (p.E or np.nan) / p.EA
        for p, k, f in zip((leg.piston for leg in robot.legs), bent, thrust, strict=True)
    ]
    return float(max(stress))


def travel_share(found: Dataset) -> Array:
    """Deviation in z over the travel of the rigid centre of mass in z, (..., arm, roll); NaN at home."""
    travel = found.arm * np.sin(np.deg2rad(found["roll"]))
    z = found.deviation.sel(axis="z")
    return (z / travel.where(found["roll"] > 0)).transpose(*z.dims).values


_TITLES = {
    "diameters": "Circles as diameters, six legs",
    "radii": "Circles as radii, six legs",
    "diameters-one": "Diameters, one leg",
    "radii-one": "Radii, one leg",
}


@house_style
def clamped_legs_figure(found: xr.Dataset) -> Figure:
    """Curves of the roll and the arm d on which a robot deviates by a printed figure, a panel a reading.

    Parameters
    ----------
    found : xarray.Dataset
        Of the table `variants.clamped_legs`.
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
                      color=readable_color("#333333"), backgroundcolor="#F7F7F7")  # fmt: skip
    steep = float(roll[np.argmax((found.slope.values > SLOPE).any(axis=0))])
    axes.axvspan(steep, roll[-1], color="#999999", alpha=0.12, linewidth=0)
    axes.plot([], [], color="#999999", alpha=0.4, linewidth=6, label=f"slopes of the legs above {SLOPE:g}")
    axes.set_xlim(0, roll[-1])
    stress = found.stress.sel(arm=found.arm.values[len(found.arm) // 2])
    for value in (1e9, 3e9):
        at = np.interp(value, stress.values, roll, right=np.nan)
        if np.isfinite(at):
            axes.annotate(f"{1e-9 * value:.0f} GPa", (at, 0.02), xycoords=("data", "axes fraction"), rotation=90,
                          ha="right", va="bottom", fontsize=SMALL, color=readable_color("#8C564B"))  # fmt: skip
            axes.axvline(at, color="#8C564B", linewidth=0.8, linestyle=":")
