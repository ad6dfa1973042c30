"""The paper's pictures as it prints them: one actuator with its symbols, all forces in one panel, bands to scale."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon

from flexapod.analysis.results.attributes import motion_end, robot_study
from flexapod.common.quantities import number, rounded_up, scale, text
from flexapod.output.figures.legs import actuator_forces
from flexapod.output.figures.robot3d import CYLINDER
from flexapod.output.figures.style import (
    COLUMN,
    LINE_STYLES,
    NOTE,
    PAGE,
    SMALL,
    TEXT,
    figure,
    house_style,
    mark_end,
    readable_color,
    require_variables,
)
from flexapod.output.scene.robot_scene import mode_scene
from flexapod.output.scene.style import AXIS_COLORS, FLEXIBLE, LEG_COLORS, RIGID
from flexapod.verification.paper.claim import force_gaps

BENT = 0.18  # of the length of a leg: how far its mode is drawn off the line of its joints


@house_style
def actuator_symbols() -> Figure:
    """The actuator as in Fig. 1 of the paper, not to scale, with the symbols of chapter T9 of the theory.

    Hub of inertia J_h and radius R_h, turned by theta under the torque T; beam of EI, rho and whole length L_t, L(t)
    of it outside; deflection u(x, t); tip body of mass m_e and inertia J.
    """
    fig = figure(PAGE, 3.6)
    axes: Any = fig.subplots()
    axes.set_aspect("equal")
    axes.axis("off")
    angle = np.deg2rad(24)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])

    def at(x: float | np.ndarray, u: float | np.ndarray = 0.0) -> np.ndarray:
        return np.multiply.outer(x, along) + np.multiply.outer(u, across)

    x = np.linspace(0.8, 4.6, 80)
    bent = 0.55 * (1.5 * ((x - 0.8) / 3.8) ** 2 - 0.5 * ((x - 0.8) / 3.8) ** 3)
    axes.add_patch(Circle((0, 0), 0.34, facecolor="#D5D8DC", edgecolor="#4A4F57", zorder=1))
    axes.add_patch(Polygon([at(-0.5, 0.2), at(0.8, 0.2), at(0.8, -0.2), at(-0.5, -0.2)], facecolor="#D5D8DC",
                           edgecolor="#4A4F57", zorder=2))  # fmt: skip
    axes.plot(*at(np.array([-1.3, 0.8])).T, color=FLEXIBLE, linewidth=3.5, zorder=3)
    axes.plot(*at(x, bent).T, color=FLEXIBLE, linewidth=3.5, zorder=3, solid_capstyle="butt")
    axes.plot(*at(np.array([0.8, 5.3])).T, color="#777777", linewidth=0.9, linestyle=(0, (5, 3)), zorder=1)
    axes.plot(*at(4.6, bent[-1]), "o", color=LEG_COLORS[1], markersize=11, zorder=4)
    axes.plot(0, 0, "o", color="#333333", markersize=4, zorder=5)
    _frame(axes, at)
    _dimension(axes, at(0.0, -0.62), at(0.8, -0.62), "$R_h$")
    _dimension(axes, at(0.8, -0.62), at(4.6, -0.62), "$L(t)$")
    _dimension(axes, at(2.9, 0.0), at(2.9, float(np.interp(2.9, x, bent))), "$u(x, t)$", side=0.16)
    for words, place in (
        ("$m_e$, $J$", at(4.6, bent[-1] + 0.3)),
        ("$EI$, $\\rho$, $L_t$", at(2.6, 0.85)),
        ("$J_h$", at(-0.75, 0.38)),
    ):
        axes.annotate(words, place, fontsize=TEXT, ha="center", va="center")
    axes.set(xlim=(-1.9, 5.9), ylim=(-1.35, 3.3))
    return fig


def _frame(axes: Any, at: Callable[..., np.ndarray]) -> None:
    """World axes X, Y, the hub's x, y, its angle, the torque."""
    arrow = {"arrowstyle": "-|>", "color": "#333333", "linewidth": 1.0}
    for end, name in (((1.9, 0.0), "$X$"), ((0.0, 1.9), "$Y$")):
        axes.annotate("", end, (0, 0), arrowprops=arrow)
        axes.annotate(name, end, xytext=(4, 2), textcoords="offset points", fontsize=TEXT)
    for end, name in ((at(5.5), "$x$"), (at(0.0, 1.3), "$y$")):
        axes.annotate("", end, at(5.2) if name == "$x$" else (0, 0), arrowprops=arrow)
        axes.annotate(name, end, xytext=(4, 0), textcoords="offset points", fontsize=TEXT)
    axes.add_patch(Arc((0, 0), 2.9, 2.9, theta1=0, theta2=24, color="#333333"))
    axes.annotate("$\\theta(t)$", (1.5, 0.22), fontsize=TEXT)
    axes.annotate("", (0.1, -0.62), (-0.6, 0.1), arrowprops=arrow | {"connectionstyle": "arc3,rad=0.45"})
    axes.annotate("$T$", (-0.75, -0.6), fontsize=TEXT)


def _dimension(axes: Any, start: np.ndarray, end: np.ndarray, words: str, side: float = 0.0) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "<->", "color": "#555555", "shrinkA": 0, "shrinkB": 0})
    middle = 0.5 * (start + end) + (np.array([side, -0.3]) if side else np.array([0.06, -0.22]))
    axes.annotate(words, middle, fontsize=TEXT, va="center", ha="left" if side else "center")


@house_style
@require_variables("tip_deflection", "length", "angle_rate")
def actuator_free(results: Mapping[str, xr.Dataset]) -> Figure:
    """The single actuator under several readings of its motion: tip, length outside the hub, rate of the hub.

    Parameters
    ----------
    results : mapping of names to xarray.Dataset
        Results of `flexapod.simulate_actuator`, e.g. with prescribed rates and set free with the same rates.
    """
    fig = figure(PAGE, 5.6)
    panels = fig.subplots(3, 1, sharex=True, height_ratios=(1.7, 1, 1))
    unit = scale(xr.concat([d.tip_deflection for d in results.values()], "reading", join="outer"), "m")
    for i, (name, data) in enumerate(results.items()):
        style = {"color": (RIGID, FLEXIBLE, *LEG_COLORS)[i], "linewidth": (4.5, 1.3)[min(i, 1)], "label": name}
        panels[0].plot(data.time, unit(data.tip_deflection), **style)
        panels[1].plot(data.time, data.length, **style)
        panels[2].plot(data.time, data.angle_rate, **style)
    panels[0].axhline(0, color="#555555", linewidth=0.7)
    titles = ("Lateral deflection of the tip, in the frame of the hub", "Length outside the hub", "Rate of the hub")
    labels = (f"deflection [{unit.name}]", "free length [m]", "rate [rad/s]")
    for axes, title, label in zip(panels, titles, labels, strict=True):
        axes.set_title(title)
        axes.set_ylabel(label)
    panels[-1].set_xlabel("time [s]")
    fig.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(results))
    fig.align_ylabels(panels)
    return fig


@house_style
@require_variables("actuator_force_rigid", "actuator_force")
def forces_rigid(data: xr.Dataset) -> Figure:
    """Drive forces leg by leg with a word at the spikes of the difference.

    Parameters
    ----------
    data : xarray.Dataset
        With rigid legs and a fixed step.
    """
    fig = actuator_forces(data)
    away, _ = force_gaps(data)
    for axes in fig.axes:
        if not axes.get_title(loc="left"):
            most = text(rounded_up(away), "N", 2)
            axes.annotate(f"elsewhere at\nmost {most}", (0.78, 0.97), xycoords="axes fraction", va="top",
                          ha="center", fontsize=SMALL, color=readable_color("#333333"))  # fmt: skip
    return fig


@house_style
@require_variables("actuator_force_rigid", "actuator_force")
def forces_overlaid(data: xr.Dataset) -> Figure:
    """Drive forces of all legs in one panel, Newton-Euler below the multibody model (Fig. 8 of the paper).

    Parameters
    ----------
    data : xarray.Dataset
        With `actuator_force_rigid` and `actuator_force` (time, leg).
    """
    fig = figure(PAGE, 4.2)
    axes = fig.subplots()
    unit = scale(data.actuator_force_rigid, "N")
    for i, leg in enumerate(data.leg.values):
        below, above = (unit(data[name].sel(leg=leg)) for name in ("actuator_force_rigid", "actuator_force"))
        axes.plot(data.time, below, color=RIGID, linewidth=5, label="Newton-Euler" if i == 0 else None)
        axes.plot(data.time, above, color=LEG_COLORS[i], linestyle=LINE_STYLES[i], linewidth=1.3, label=f"leg {leg}")
    axes.set_title("Drive forces: coloured by leg the multibody model, pale below it Newton-Euler")
    axes.set_ylabel(f"force [{unit.name}]")
    axes.set_xlabel("time [s]")
    mark_end(axes, motion_end(data), "motion ends")
    fig.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=7, handlelength=2.4)
    return fig


@house_style
@require_variables("com_deviation", "com_position", "com_position_rigid")
def path_bands(data: xr.Dataset, printed: Mapping[str, float]) -> Figure:
    """Path of the centre of mass with a band of the printed deviation, and the deviation on the scale of the print.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a robot.
    printed : mapping of axis to float
        Deviation that the paper prints [m], for the axes to show.
    """
    fig = figure(COLUMN * 2, 5.0, gap=0.06)
    grid = fig.subplots(2, len(printed), sharex=True, squeeze=False, height_ratios=(1.3, 1.0))
    end, time = motion_end(data), data.time.values
    for (above, below), (axis, band) in zip(grid.T, printed.items(), strict=True):
        rigid, flexible = (1e3 * data[f"com_position{x}"].sel(axis=axis).values for x in ("_rigid", ""))
        gap = 1e3 * data.com_deviation.sel(axis=axis).values
        label = "printed deviation, to either side"
        above.fill_between(time, rigid - 1e3 * band, rigid + 1e3 * band, color="#F2C9A0", linewidth=0, label=label)
        above.plot(time, rigid, color="#8A8A8A", linewidth=3.0, label="rigid legs")
        above.plot(time, flexible, color=FLEXIBLE, linewidth=1.1, label="flexible legs")
        above.set_title(f"Path in {axis.upper()}, band of {1e3 * band:g} mm")
        below.axhspan(-1e3 * band, 1e3 * band, color="#F2C9A0", linewidth=0)
        below.plot(time, gap, color=AXIS_COLORS[axis], linewidth=1.3)
        below.set_ylim(-1.25e3 * band, 1.25e3 * band)
        largest = float(np.abs(gap).max()) / 1e3
        words = f"largest {text(largest, 'm')}:\nthe print is {number(band / largest, 2)} times that"
        below.annotate(
            words, (0.03, 0.85), xycoords="axes fraction", va="top", fontsize=NOTE, color=readable_color("#333333")
        )
        below.set_title(f"Flexible minus rigid, {axis.upper()}")
        below.set_xlabel("time [s]")
        mark_end(above, end, "motion ends")
        mark_end(below, end)
    grid[0, 0].set_ylabel("position of the\ncentre of mass [mm]")
    grid[1, 0].set_ylabel("deviation [mm]")
    fig.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return fig


@house_style
@require_variables("leg_shape", "frequency")
def piston_mode(modes: xr.Dataset, mode: int) -> Figure:
    """One leg alone in a mode, the one that bends most, seen across its bending (Fig. 10 B of the paper).

    Parameters
    ----------
    modes : xarray.Dataset
        Result of `flexapod.modes`.
    mode : int
        Label on the `mode` dimension.
    """
    one, rest = modes.sel(mode=mode), mode_scene(modes, mode, 1.0, phase=0.0)
    shape = one.leg_shape.values  # (leg, direction, station)
    leg = int(np.argmax(np.abs(shape).max(axis=(1, 2))))
    _, _, directions = np.linalg.svd(shape[leg].T, full_matrices=False)
    across, station = directions[0] @ shape[leg], one.station.values
    mouth = robot_study(modes).robot.legs[leg].cylinder.mouth
    length = float(np.linalg.norm(rest.platform[leg] - rest.base[leg]))
    drawn = 1e3 * BENT * length * across / np.abs(across).max()
    fig = figure(PAGE, 2.9)
    axes = fig.subplots()
    along = 1e3 * length * station
    axes.plot(along, 0 * along, color=RIGID, linewidth=1.2, linestyle=(0, (5, 3)), label="at rest")
    inside = along <= 1e3 * mouth * (1 + 1e-9)
    thick: dict[str, Any] = {"color": CYLINDER, "linewidth": 9, "solid_capstyle": "butt", "label": "cylinder"}
    axes.plot(along[inside], drawn[inside], **thick)
    axes.plot(along, drawn, color=FLEXIBLE, linewidth=3, label="piston, size arbitrary")
    axes.plot(along[[0, -1]], drawn[[0, -1]], "o", color="#333333", markersize=6)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_yticks([])
    axes.set_xlabel("along the leg, from the universal joint [mm]")
    axes.set_title(f"Leg {leg + 1} in mode {mode}: {float(one.frequency):.1f} Hz")
    fig.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return fig
