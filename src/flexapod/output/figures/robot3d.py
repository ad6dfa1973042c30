"""The robot in space: drawn with base, legs, platform and payload, at an instant of a result and in its modes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from flexapod.analysis.results.attributes import motion_end
from flexapod.common.arguments import number
from flexapod.output.figures.style import NOTE, PAGE, SMALL, figure, house_style, readable_color, require_variables
from flexapod.output.scene.robot_scene import mode_scene, scene
from flexapod.output.scene.skeleton import Scene, convex_hull
from flexapod.output.scene.style import colors_of_legs

CYLINDER = "#8A8F98"
BASE = "#4A4F57"
INSIDE = "#222222"
PLATFORM = "#2F6690"
#: Size and mark of joints by their letter; hinges are short lines along their axes.
JOINTS = {"U": (14, "o"), "S": (18, "o"), "F": (16, "s")}
_WIDTH = 2.6  # of pistons, where they are thickest
_SHORT = 0.2  # of the longest: axes that have no room for numbers
#: Widths of robots against their diagonals, at an angle and along an axis: wider ones are drawn smaller, as their words
#: would run over the edge.
_WIDEST = (0.75, 0.65)
_ASIDE, _NEAR = 0.045, 0.12  # of the robot's size: numbers beside their joints, and joints that stand as a pair
_STEEP = 0.8  # sine of the slope beyond which a number would lie on the leg
_LOW = 0.6  # heights against widths: names of axes keep a distance that shrinks with them
_NEEDLE = 45  # distance of the name of the one axis that is left, in a measure that shrinks with the room
_FREE: Any = {"axes.titley": None}  # titles go above what is drawn
_GRID: Any = {"grid.color": "#E4E4E4", "grid.linewidth": 0.6}
_NUMBER: dict[str, Any] = {"fontsize": NOTE, "path_effects": [withStroke(linewidth=2.0, foreground="white")]}


def axes_3d(fig: Figure, place: SubplotSpec, *, turn: float = -62, tilt: float = 16) -> Any:
    """3D axes with equal scales on all three directions, seen from `turn` and `tilt` [deg]."""
    with matplotlib.rc_context(_FREE | _GRID):
        made: Any = fig.add_subplot(place, projection="3d", computed_zorder=False)
    made.set_proj_type("ortho")
    made.view_init(elev=tilt, azim=turn)
    made.set_facecolor("none")  # names of axes reach into the next place
    for axis in (made.xaxis, made.yaxis, made.zaxis):
        axis.set_pane_color((1, 1, 1, 0))
    return made


def set_title(axes: Any, words: str, **style: Any) -> None:
    """A title clear of what is drawn, which may reach above the axes."""
    with matplotlib.rc_context(_FREE):
        axes.set_title(words, **style)


def fit_view(axes: Any, scenes: Sequence[Scene], zoom: float = 1.0) -> None:
    """Limits that hold all scenes, in equal scale, with world axes in mm."""
    points = np.concatenate([s.points for s in scenes])
    low, high = points.min(axis=0), points.max(axis=0)
    low, high = low - 0.06 * (high - low).max(), high + 0.06 * (high - low).max()
    low[2] = min(low[2], 0.0)
    axes.set(xlim=1e3 * np.array([low[0], high[0]]), ylim=1e3 * np.array([low[1], high[1]]))
    axes.set_zlim(1e3 * low[2], 1e3 * high[2])
    size, turn = high - low, np.radians(axes.azim)
    short = size < _SHORT * size.max()
    across = abs(size[0] * np.sin(turn)) + abs(size[1] * np.cos(turn))  # as it is seen
    least = 1.0 if short.any() else min(1.0, _WIDEST[axes.elev == 0] * np.linalg.norm(size) / across)
    axes.set_box_aspect(size, zoom=least * zoom)
    axes.tick_params(labelsize=SMALL, pad=0)
    pads = (0, 0, 2) if short.any() or size[2] > _LOW * size.max() else (10, 10, 2 if axes.elev else 7)
    for name, axis, pad, bare in zip("xyz", (axes.xaxis, axes.yaxis, axes.zaxis), pads, short, strict=True):
        axis.get_major_locator().set_params(nbins=4)
        if bare:
            axis.set_ticks([])
        else:
            axis.set_label_text(f"{name} [mm]", fontsize=NOTE)
            axis.labelpad = _NEEDLE if short.sum() == 2 else pad


def draw_robot(axes: Any, s: Scene, *, numbers: bool = True) -> None:
    """Draw a robot: grey cylinders, coloured pistons, translucent platform, cross-hair at the centre of mass."""
    _plate(axes, s.skeleton.robot.base_joints, BASE, 0.12)
    _segments(axes, s.guides, BASE, 2.0, 3)
    legs, radii, places = colors_of_legs(len(s.base)), s.radii, label_positions(s.base, s.points, axes.azim, axes.elev)
    for i in range(len(s.base)):
        if not np.array_equal(s.base[i], s.mouth[i]):
            _bar(axes, s.base[i], s.mouth[i], color=CYLINDER, linewidth=6, zorder=3)
        axes.add_collection3d(_piston(s.piston[i], radii[i], legs[i]))
        if numbers:
            axes.text(
                *(1e3 * places[i]),
                str(i + 1),
                color=readable_color(legs[i]),
                ha="center",
                va="center",
                zorder=9,
                **_NUMBER,
            )
    _segments(axes, s.heads, INSIDE, 1.2, 4)  # pistons in bushings, inside of their cylinders
    if len(s.heads):
        axes.scatter(*(1e3 * s.heads[:, 1].T), s=16, marker="D", color=INSIDE, depthshade=False, zorder=5)
    _plate(axes, s.platform, PLATFORM, 0.35)
    for points, end, color in ((s.base, 0, BASE), (s.platform, 1, PLATFORM)):
        kinds = np.array([joints[end] for joints in s.skeleton.joints])
        for kind, (size, marker) in JOINTS.items():
            if (kinds == kind).any():
                axes.scatter(
                    *(1e3 * points[kinds == kind].T), s=size, marker=marker, color=color, depthshade=False, zorder=6
                )
    _segments(axes, s.hinges, "#222222", 3.2, 6)
    if s.skeleton.robot.payload is None:
        return
    _bar(axes, s.centre, s.com, color="#333333", linewidth=1.2, linestyle=(0, (4, 2)), zorder=6)
    x, y, z = 1e3 * s.com
    axes.plot(
        [x], [y], [z], marker="o", markersize=10, clip_on=False, color="white", markeredgecolor="#333333", zorder=7
    )
    axes.plot([x], [y], [z], marker="+", markersize=9, clip_on=False, color="#333333", zorder=8)


def label_positions(joints: np.ndarray, points: np.ndarray, turn: float, tilt: float) -> np.ndarray:
    """Places (n, 3) [m] of the numbers of joints (n, 3) as they are seen from `turn` and `tilt` [deg].

    Each lies outside of the joints, away from a neighbour that is near, and beside the leg; how far, in shares of the
    size of `points`.
    """
    a, b = np.radians(turn), np.radians(tilt)
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    up = np.array([-np.sin(b) * np.cos(a), -np.sin(b) * np.sin(a), np.cos(b)])
    seen = joints @ np.stack([right, up], axis=1)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    way = _unit(seen - seen.mean(axis=0))
    for i, place in enumerate(seen):
        apart = place - np.delete(seen, i, axis=0)
        gaps = np.linalg.norm(apart, axis=1)
        if len(gaps) and 0 < gaps.min() < _NEAR * size:
            way[i] += _unit(apart[gaps.argmin()])
    level = np.stack([np.where(way[:, 0] < 0, -1.0, 1.0), np.full(len(way), 0.3)], axis=1)
    way = np.where(_unit(way)[:, 1:] > _STEEP, level, way)  # above a joint stands its leg
    return joints + _ASIDE * size * _unit(way) @ np.stack([right, up])


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1; those without a direction point down."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > 1e-9, vectors / np.maximum(length, 1e-9), [0.0, -1.0])


def draw_ghost(axes: Any, s: Scene) -> None:
    """Draw a robot in pale lines, for comparison."""
    _segments(axes, np.concatenate([s.base[:, None], s.piston], axis=1), "#BDBDBD", 1.0, 1)
    loop = s.platform[convex_hull(s.platform)]
    closed = 1e3 * np.vstack([loop, loop[:1]])
    axes.plot(*closed.T, color="#BDBDBD", linewidth=1.0, zorder=1)
    axes.plot(*(1e3 * s.com[:, None]), marker="o", markersize=6, color="#BDBDBD", zorder=1)
    axes.plot(*(1e3 * np.stack([s.centre, s.com]).T), color="#BDBDBD", linewidth=1.0, zorder=1)


def _plate(axes: Any, points: np.ndarray, color: str, alpha: float) -> None:
    polygon = 1e3 * points[convex_hull(points)]
    axes.add_collection3d(Poly3DCollection([polygon], facecolors=color, alpha=alpha, edgecolors="none", zorder=2))
    closed = np.vstack([polygon, polygon[:1]])
    axes.plot(*closed.T, color=color, linewidth=1.6, zorder=5 if alpha > 0.2 else 2)


def _segments(axes: Any, lines: np.ndarray, color: str, width: float, above: int) -> None:
    """Straight lines (n, 2, 3)."""
    if len(lines):
        axes.add_collection3d(Line3DCollection(list(1e3 * lines), colors=color, linewidths=width, zorder=above))


def _piston(line: np.ndarray, radii: np.ndarray, color: str) -> Line3DCollection:
    """A piston, thinner where its sections are."""
    share = np.nan_to_num(radii / radii.max(), nan=1.0)
    widths = _WIDTH * (share[:-1] + share[1:]) / 2
    pairs = 1e3 * np.stack([line[:-1], line[1:]], axis=1)
    return Line3DCollection(list(pairs), colors=color, linewidths=widths, capstyle="round", zorder=4)


def _bar(axes: Any, start: np.ndarray, end: np.ndarray, **style: Any) -> None:
    axes.plot(*(1e3 * np.stack([start, end]).T), solid_capstyle="butt", **style)


#: Of robots in space and in a plane: a view at an angle, one along an axis, and that axis.
_VIEWS: dict[str | None, tuple[dict[str, float], dict[str, float], str]] = {
    None: ({}, {"turn": 0, "tilt": 0}, "x"),
    "xy": ({"tilt": 40}, {"turn": -90, "tilt": 90}, "z"),
    "yz": ({"turn": -28}, {"turn": 0, "tilt": 0}, "x"),
    "zx": ({}, {"turn": -90, "tilt": 0}, "y"),
}


@house_style
@require_variables("com_position", "platform_quaternion")
def robot_3d(data: xr.Dataset, time: float | None = None) -> Figure:
    """The robot at an instant, with its pose at the start in pale lines: in space and seen along X, true to scale.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation.
    time : float, optional
        Instant [s]; left out: the end of the motion.
    """
    time = motion_end(data) if time is None else number(time, "time", "time")
    time = float(data.time[-1] if time is None else data.time.sel(time=time, method="nearest"))
    now, start = scene(data, time), scene(data, float(data.time[0]))
    fig = figure(PAGE, 4.5)
    fig.set_layout_engine("none")  # 3D axes have no extents that a layout could use
    places = fig.add_gridspec(1, 2, width_ratios=(1.15, 1), left=0.0, right=0.96, bottom=0.07, top=0.93, wspace=0.1)
    oblique, straight, along = _VIEWS[_plane(now)]
    left, right = axes_3d(fig, places[0], **oblique), axes_3d(fig, places[1], **straight)
    moved = time > float(data.time[0])
    for axes in (left, right):
        if moved:
            draw_ghost(axes, start)
        draw_robot(axes, now, numbers=axes is left)
        fit_view(axes, [now, start], zoom=1.0)
    right.set(**{f"{along}ticks": [], f"{along}label": ""})
    set_title(left, f"At t = {time:.2f} s; pale: at the start" if moved else "At the start")
    set_title(right, f"Seen along {along.upper()}; deflections to scale")
    return fig


@house_style
@require_variables("platform_shape", "leg_shape")
def modes_3d(modes: xr.Dataset, show: Sequence[int] | None = None, size: float = 0.1) -> Figure:
    """Modes of the locked robot, drawn on it, with the robot at rest in pale lines.

    Parameters
    ----------
    modes : xarray.Dataset
        Result of `flexapod.modes`.
    show : sequence of int, optional
        Labels of the modes; left out: the first six.
    size : float
        Largest displacement drawn, as a share of the robot's height.
    """
    labels = [int(m) for m in (modes.mode.values[:6] if show is None else show)]
    columns = min(3, len(labels))
    rows = -(-len(labels) // columns)
    fig = figure(PAGE / 3 * columns, 2.9 * rows)
    fig.set_layout_engine("none")
    places = fig.add_gridspec(
        rows, columns, left=0.0, right=1.0, bottom=0.0, top=1 - 0.11 / rows, hspace=0.14, wspace=0.0
    )
    rest = mode_scene(modes, labels[0], 1.0, phase=0.0)
    for i, label in enumerate(labels):
        axes = axes_3d(fig, places[divmod(i, columns)], **_VIEWS[_plane(rest)][0])
        moved = mode_scene(modes, label, size * rest.height)
        draw_ghost(axes, rest)
        draw_robot(axes, moved, numbers=True)
        fit_view(axes, [rest, moved], zoom=1.15)
        axes.set(xlabel="", ylabel="", zlabel="")
        axes.tick_params(labelbottom=False, labelleft=False, labelright=False)
        set_title(axes, _title(modes.sel(mode=label), label), fontsize=NOTE)
    return fig


def _plane(s: Scene) -> str | None:
    """The plane of a planar robot, and that of x and z for legs that lie along x."""
    x, y, _ = np.ptp(np.vstack([s.base, s.platform]), axis=0)
    return s.skeleton.robot.plane or ("zx" if y < 1e-6 * x else None)


def _title(mode: xr.Dataset, label: int) -> str:
    damping = 100 * float(mode.damping_ratio)
    kind = f"{mode.kind.item()}, " if "kind" in mode else ""
    return f"Mode {label}: {float(mode.frequency):.1f} Hz\n{kind}damping {damping:.2g} %"
