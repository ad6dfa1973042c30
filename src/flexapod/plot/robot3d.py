"""The robot in space: at an instant of a result, and in its modes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexapod.plot.draw3d import draw_ghost, draw_robot, head, space, view
from flexapod.plot.style import NOTE, PAGE, figure, needs, styled
from flexapod.scene.robot import mode_scene, motion_end, scene
from flexapod.scene.skeleton import Scene

__all__ = ["modes_3d", "robot_3d"]

#: Of robots in space and in a plane: a view at an angle, one along an axis, and that axis.
_VIEWS: dict[str | None, tuple[dict[str, float], dict[str, float], str]] = {
    None: ({}, {"turn": 0, "tilt": 0}, "x"),
    "xy": ({"tilt": 40}, {"turn": -90, "tilt": 90}, "z"),
    "yz": ({"turn": -28}, {"turn": 0, "tilt": 0}, "x"),
    "zx": ({}, {"turn": -90, "tilt": 0}, "y"),
}


@styled
def robot_3d(data: xr.Dataset, time: float | None = None) -> Figure:
    """The robot at an instant, with its pose at the start in pale lines: in space and seen along X, true to scale.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation.
    time : float, optional
        Instant [s]; left out: the end of the motion.
    """
    if time is None:
        time = motion_end(data)
    time = float(data.time[-1] if time is None else data.time.sel(time=time, method="nearest"))
    now, start = scene(data, time), scene(data, float(data.time[0]))
    fig = figure(PAGE, 4.5)
    fig.set_layout_engine("none")  # 3D axes have no extents that a layout could use
    places = fig.add_gridspec(1, 2, width_ratios=(1.15, 1), left=0.0, right=0.96, bottom=0.07, top=0.93, wspace=0.1)
    oblique, straight, along = _VIEWS[_plane(now)]
    left, right = space(fig, places[0], **oblique), space(fig, places[1], **straight)
    moved = time > float(data.time[0])
    for axes in (left, right):
        if moved:
            draw_ghost(axes, start)
        draw_robot(axes, now, numbers=axes is left)
        view(axes, [now, start], zoom=1.0)
    right.set(**{f"{along}ticks": [], f"{along}label": ""})
    head(left, f"At t = {time:.2f} s; pale: at the start" if moved else "At the start")
    head(right, f"Seen along {along.upper()}; deflections to scale")
    return fig


@styled
@needs("platform_shape", "leg_shape")
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
        axes = space(fig, places[divmod(i, columns)], **_VIEWS[_plane(rest)][0])
        moved = mode_scene(modes, label, size * rest.height)
        draw_ghost(axes, rest)
        draw_robot(axes, moved, numbers=True)
        view(axes, [rest, moved], zoom=1.15)
        axes.set(xlabel="", ylabel="", zlabel="")
        axes.tick_params(labelbottom=False, labelleft=False, labelright=False)
        head(axes, _title(modes.sel(mode=label), label), fontsize=NOTE)
    return fig


def _plane(s: Scene) -> str | None:
    """The plane of a planar robot, and that of x and z for legs that lie along x."""
    x, y, _ = np.ptp(np.vstack([s.base, s.platform]), axis=0)
    return s.skeleton.robot.plane or ("zx" if y < 1e-6 * x else None)


def _title(mode: xr.Dataset, label: int) -> str:
    damping = 100 * float(mode.damping_ratio)
    kind = f"{mode.kind.item()}, " if "kind" in mode else ""
    return f"Mode {label}: {float(mode.frequency):.1f} Hz\n{kind}damping {damping:.2g} %"
