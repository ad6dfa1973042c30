"""A result in motion, for the report: points of every frame, and the traces that join them."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexapod import model
from flexapod.analysis.results.summary import POINT_WORDS, has_separate_tool
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import number, scale, zero_rounding_lines
from flexapod.common.resources import one_thread
from flexapod.output.scene.geometry import BeamMotion, RobotMotion
from flexapod.output.scene.robot_scene import mode_scene
from flexapod.output.scene.skeleton import STATIONS, Scene, Skeleton, convex_hull
from flexapod.output.scene.style import FLEXIBLE, RIGID, colors_of_legs

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
    from flexapod.model import ActuatorStudy, Study
else:
    analysis = LazyModule("flexapod.analysis")

MOST_POINTS = 1500  # of a curve: more than a page is wide

FRAMES = 241
MODES = 6
MODE_SIZE = 0.1  # largest displacement of a mode, as a share of the robot's height
EVERY = 3  # of the points of a drawn piston
FILLED = 1.6  # size of the drawn box, which nearly fills its place
FLAT = 0.15  # least extent of the box, as a share of the largest
BELOW = 0.06  # of the box's height, free below the base: numbers of the legs and of the axes stay apart
#: From where robots in space and in a plane are seen.
_EYES = {None: (1.5, -1.7, 0.5), "xy": (0.2, -0.9, 2.1), "yz": (2.1, -0.9, 0.4), "zx": (0.9, -2.1, 0.4)}
CYLINDER, DEVIATION, INSIDE = "#8A8F98", "#D55E00", "#222222"
Traces = list[dict[str, Any]]


def replay(study: Study | ActuatorStudy, data: Dataset, modes: Dataset | None = None) -> dict[str, Any]:
    """Frames and traces of a robot's or an actuator's result, as the page's script reads them.

    With `modes`, a result of `flexapod.modes` of the same robot, its lowest modes can be played too.

    ``points``: (frame, point, direction) in mm, packed; ``time`` [s] and ``values`` of the frames, of the tool where it
    is another point than the centre of mass; ``traces`` in the form of plotly, where ``take`` numbers the points that a
    line joins (-1: a gap); ``modes``: their points at rest and displaced; ``words`` and ``mouse``: what is drawn and
    how it is looked at.
    """
    return _actuator(study, data) if isinstance(study, model.ActuatorStudy) else _robot(study, data, modes)


@one_thread()
def locked_modes(study: Study | ActuatorStudy) -> Dataset | None:
    """Modes of a robot at home while its commands stand still; None for an actuator, and where there are none."""
    if isinstance(study, model.ActuatorStudy):
        return None

    try:
        return analysis.modes(study)
    except FlexapodError:
        return None


def _chosen(count: int) -> NDArray[np.intp]:
    """Stored instants that become frames, evenly over the whole."""
    return np.unique(np.linspace(0, count - 1, min(count, FRAMES)).round().astype(int))


def _robot(study: Study, data: Dataset, modes: Dataset | None) -> dict[str, Any]:
    motion = RobotMotion(study, data)
    chosen, factor = _chosen(len(motion.time)), motion.automatic_scale()
    times = motion.time[chosen]
    point = "tool" if has_separate_tool(data) else "com"
    frames = np.array([_points(at.flexible, at.rigid) for at in (motion.instant_at(time, factor) for time in times)])
    played = [] if modes is None else _modes(modes)
    everything = [frames, *(part for mode in played for part in mode["ends"])]
    deviation = data[f"{point}_deviation"].values[chosen]
    numbers = zero_rounding_lines(np.vstack([deviation.T, np.linalg.norm(deviation, axis=1)])).T
    return {
        **_frames(times, frames, f"deflections and deviation drawn {number(factor)} times larger"),
        **_values(f"deviation of the {POINT_WORDS[point]}", numbers, (*"xyz", "distance")),
        "mouse": "Drag to turn, scroll to come nearer",
        "traces": [*_paths(frames, POINT_WORDS[point]), *_robot_traces(motion.skeleton, point)],
        "layout": _space(np.concatenate([part.reshape(-1, 3) for part in everything]), study.robot.plane),
        "modes": [{"title": mode["title"], "ends": [plotly_array(part) for part in mode["ends"]]} for mode in played],
    }


def _points(flexible: Scene, rigid: Scene) -> Array:
    """Points of a frame in mm: base joints, pistons, both platforms, rails, cranks, hinges, heads, centres, tools.

    Of both: of the flexible robot, then of the rigid one. Where carriages or a mount move base joints, those at home
    come first.
    """
    pistons = flexible.piston[:, ::EVERY].reshape(-1, 3)
    centres = [flexible.centre, flexible.com, rigid.centre, rigid.com]
    tools = [at.centre + at.rotation @ at.skeleton.tool for at in (flexible, rigid)]
    lines = np.concatenate([flexible.guides, flexible.hinges, flexible.heads]).reshape(-1, 3)
    robot = flexible.skeleton.robot
    ring = robot.base_joints[: None if len(flexible.guides) or robot.base_mount else 0]
    parts = (ring, flexible.base, pistons, flexible.platform, rigid.platform, lines)
    return 1e3 * np.vstack([*parts, *centres, *tools])


def _modes(modes: Dataset) -> list[dict[str, Any]]:
    """The lowest modes: title, points at rest and displaced."""
    labels = [int(label) for label in modes.mode.values[:MODES]]
    rest = mode_scene(modes, labels[0], 1.0, phase=0.0)
    size = MODE_SIZE * rest.height
    found = []
    for label in labels:
        mode = modes.sel(mode=label)
        title = f"Mode {label}: {float(mode.frequency):.4g} Hz, {mode.kind.item()}"
        moved = mode_scene(modes, label, size)
        found.append({"title": title, "ends": (_points(rest, rest), _points(moved, rest))})
    return found


def _ring(joints: Array, first: int) -> list[int]:
    """Numbers of the points of a ring of joints (legs, 3), the one after the other; its points begin at `first`."""
    return [first + int(i) for i in convex_hull(joints)]


def _robot_traces(skeleton: Skeleton, point: str) -> Traces:
    """Lines between the points of `_points`, in its order; the deviation is that of a point: ``com`` or ``tool``."""
    robot, line = skeleton.robot, len(range(0, STATIONS, EVERY))
    legs, home = len(robot.legs), skeleton.home
    rails, hinges, heads = len(home.guides), len(home.hinges), len(home.heads)
    feet = legs if rails or robot.base_mount else 0
    still, ring = (feet, 0) if rails else (0, feet)  # feet of rigid legs, and the base as it is drawn
    pistons = [list(range(feet + legs + i * line, feet + legs + (i + 1) * line)) for i in range(legs)]
    start = feet + legs + legs * line
    base, platform = _ring(robot.base_joints, ring), _ring(robot.platform_joints, start)
    rigid = [point + legs for point in platform]
    guides, axes = start + 2 * legs, start + 2 * legs + 2 * rails
    inside = axes + 2 * hinges
    centre, com, rigid_centre, rigid_com, tool, rigid_tool = range(inside + 2 * heads, inside + 2 * heads + 6)
    apart = point == "tool"
    ghost = [point for i in range(legs) for point in (still + i, start + legs + i, -1)]
    ghost += [*rigid, rigid[0], -1, rigid_com, rigid_centre, *[rigid_tool] * apart]
    cylinders = [point for i in range(legs) for point in (feet + i, pistons[i][0], -1)]
    colored = [
        _line(piston, color, 7, name=f"leg {i}", showlegend=False)
        for i, (piston, color) in enumerate(zip(pistons, colors_of_legs(legs), strict=True), start=1)
    ]
    return [
        _line([*base, base[0]], "#4A4F57", 3, name="base", showlegend=False),
        *([_line(_pairs(guides, rails), "#4A4F57", 3, name="rails and cranks", showlegend=False)] if rails else []),
        *([_line(_pairs(axes, hinges), "#222222", 8, name="hinges", showlegend=False)] if hinges else []),
        _line(ghost, RIGID, 2, name="rigid legs"),
        _line(cylinders, CYLINDER, 13, name="cylinders", showlegend=False),
        *([_line(_pairs(inside, heads), INSIDE, 4, name="pistons in bushings", showlegend=False)] if heads else []),
        *(
            [_dots(list(range(inside + 1, inside + 2 * heads, 2)), INSIDE, 4, symbol="diamond", showlegend=False)]
            if heads
            else []
        ),
        *colored,
        _plate(platform),
        _line([*platform, platform[0]], "#2F6690", 4, name="platform", showlegend=False),
        _line([com, centre, *[tool] * apart], "#333333", 3, name="payload", showlegend=False),
        _line([rigid_tool, tool], DEVIATION, 7, name=f"deviation of the {POINT_WORDS[point]}"),
        _dots([com], FLEXIBLE, 4, name="centre of mass, flexible"),
        _dots([rigid_com], CYLINDER, 4, name="centre of mass, rigid", symbol="circle-open"),
        *(_tool(tool, rigid_tool) if apart else []),
        {
            **_dots(list(range(feet, feet + legs)), "#333333", 3, showlegend=False),
            "mode": "markers+text",
            "hoverinfo": "skip",
        }
        | {"text": [str(i + 1) for i in range(legs)], "textposition": "bottom center"},
    ]


def _pairs(first: int, count: int) -> list[int]:
    """Lines from a point to the next one, `count` times."""
    return [point for i in range(first, first + 2 * count, 2) for point in (i, i + 1, -1)]


def _tool(flexible: int, rigid: int) -> Traces:
    """Dots at the tool of both robots, by the numbers of their points."""
    return [
        _dots([flexible], FLEXIBLE, 5, name="tool, flexible", symbol="diamond"),
        _dots([rigid], CYLINDER, 5, name="tool, rigid", symbol="diamond-open"),
    ]


def _paths(frames: Array, name: str) -> Traces:
    """Paths of the last two points of all frames, the tool as drawn; they do not move with time."""
    return [
        _fixed(frames[:, -1], RIGID, 4, name=f"path of the {name}, rigid"),
        _fixed(frames[:, -2], FLEXIBLE, 3, name=f"path of the {name}, flexible"),
    ]


def _actuator(study: ActuatorStudy, data: Dataset) -> dict[str, Any]:
    motion = BeamMotion(study, data)
    chosen, factor = _chosen(len(motion.time)), motion.automatic_scale()
    times = motion.time[chosen]
    shown = [motion.frame_at(time, factor)[1:] for time in times]
    frames = 1e3 * np.array([np.vstack([bent, line[[0, -1]], np.zeros((1, 3))]) for bent, line in shown])
    space = study.actuator.space
    frames = frames if space else frames[:, :, [0, 2]]
    bent = list(range(frames.shape[1] - 3))
    start, end, pivot = range(len(bent), len(bent) + 3)
    traces = [
        _line([start, end], RIGID, 7, name="rigid beam"),
        _line(bent, FLEXIBLE, 3, name="flexible beam"),
        _dots([pivot], CYLINDER, 14, name="hub", symbol="square"),
        _dots([bent[-1]], DEVIATION, 8, name="tip"),
    ]
    words = f"deflection drawn {number(factor)} times larger"
    values = _values("deflection of the", motion.deflection[chosen, None], ("tip",))
    mouse = "Drag to turn, scroll to come nearer" if space else "Drag over it to zoom, double-click to see all again"
    if space:
        traces.append(_fixed(frames[:, bent[-1]], DEVIATION, 2, name="path of the tip"))
    layout = _space(frames.reshape(-1, 3), None) if space else _plane(frames)
    return {**_frames(times, frames, words), **values, "mouse": mouse, "traces": traces, "layout": layout, "modes": []}


def _frames(times: Array, frames: Array, words: str) -> dict[str, Any]:
    return {"time": [round(float(t), 6) for t in times], "points": plotly_array(frames), "words": words}


def _values(what: str, values: Array, names: Sequence[str]) -> dict[str, Any]:
    """Numbers beside the frames (frame, name), in the unit in which they read well."""
    unit = scale(values, "m")
    shown = unit(values)
    places = 3 - int(np.floor(np.log10(max(np.abs(shown).max(), 1e-9))))
    return {"what": what, "names": list(names), "unit": unit.name, "values": np.round(shown, places).tolist()}


def _line(take: Sequence[int], color: str, width: float, **more: Any) -> dict[str, Any]:
    style = {"mode": "lines", "line": {"color": color, "width": width}, "hoverinfo": "skip"}
    return {**style, "take": list(take), **more}


def _dots(take: Sequence[int], color: str, size: float, symbol: str = "circle", **more: Any) -> dict[str, Any]:
    marker = {"color": color, "size": size, "symbol": symbol}
    return {"mode": "markers", "marker": marker, "hoverinfo": "skip", "take": list(take), **more}


def _plate(points: Sequence[int]) -> dict[str, Any]:
    """A translucent surface over the joints of the platform, which follow each other around it."""
    fan = range(1, len(points) - 1)
    corners = {"i": [0 for _ in fan], "j": list(fan), "k": [i + 1 for i in fan]}
    look = {"color": "#2F6690", "opacity": 0.35, "hoverinfo": "skip", "showlegend": False, "flatshading": True}
    return {"type": "mesh3d", "take": list(points), **corners, **look}


def _fixed(points: Array, color: str, width: float, **more: Any) -> dict[str, Any]:
    x, y, z = ([float(f"{v:.6g}") for v in part] for part in points.T)
    return {**_line([], color, width, **more), "x": x, "y": y, "z": z}


def _space(points: Array, plane: str | None) -> dict[str, Any]:
    """3D axes in mm with equal scales that hold all frames, so that nothing jumps."""
    low, high = _limits(points)
    low[2] -= BELOW * float((high - low)[2])
    thin = np.maximum(FLAT * float((high - low).max()) - (high - low), 0.0) / 2
    low, high = low - thin, high + thin
    span = high - low
    axes = {
        f"{name}axis": {"title": {"text": f"{name} [mm]"}, "range": [float(low[i]), float(high[i])], "tickvals": ends}
        for i, name in enumerate("xyz")
        for ends in [_round_ends(float(low[i]), float(high[i]))]
    }
    ratio = {name: FILLED * float(span[i] / span.max()) for i, name in enumerate("xyz")}
    camera = {"eye": dict(zip("xyz", _EYES[plane], strict=True)), "projection": {"type": "orthographic"}}
    return {"scene": {**axes, "aspectmode": "manual", "aspectratio": ratio, "camera": camera, "dragmode": "turntable"}}


def _round_ends(low: float, high: float) -> list[float]:
    """A round number near either end: the label of the axis stands in the middle, and would cover one there."""
    digit = 10.0 ** np.floor(np.log10((high - low) / 2))
    step = next(size * digit for size in (5, 2, 1) if size * digit <= (high - low) / 2)
    return [float(np.ceil(low / step) * step), float(np.floor(high / step) * step)]


def _plane(points: Array) -> dict[str, Any]:
    """2D axes in mm with equal scales, no wider than what moves in them."""
    low, high = _limits(points.reshape(-1, 2))
    fitted = {"zeroline": False, "constrain": "domain"}
    x, y = (
        {**fitted, "title": {"text": f"{name} [mm]"}, "range": [float(low[i]), float(high[i])]}
        for i, name in enumerate("XY")
    )
    return {"xaxis": x, "yaxis": {**y, "scaleanchor": "x", "scaleratio": 1}}


def _limits(points: Array) -> tuple[Array, Array]:
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.04 * float((high - low).max())
    return low - margin, high + margin


def plotly_array(values: Array) -> dict[str, str]:
    """Numbers as plotly reads them: base64 of 32 bit floats, seven digits."""
    flat = np.ascontiguousarray(values, dtype="<f4")
    made = {"dtype": "f4", "bdata": base64.b64encode(flat.tobytes()).decode("ascii")}
    return made | ({"shape": ", ".join(map(str, flat.shape))} if flat.ndim > 1 else {})
