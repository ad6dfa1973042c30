"""The nodes of a drawn robot: made once, then only moved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import viser

from flexapod import model
from flexapod.analysis.results.bodies import CYLINDER
from flexapod.app.browser.legend import rgb
from flexapod.common.arrays import Array
from flexapod.common.quantities import number, text
from flexapod.kinematics.rotations import exponential, quaternion
from flexapod.output.scene.geometry import (
    ROUNDING,
    Instant,
    orientation,
    path_segments,
    plate,
    round_down,
    tube,
    tube_faces,
)
from flexapod.output.scene.skeleton import STATIONS, Scene, Skeleton
from flexapod.output.scene.style import colors_of_legs


class SceneNodes:
    """A scene that remembers the names of what is added to it by ``add_...``."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene, self._names = scene, set[str]()

    def __getattr__(self, method: str) -> Any:
        def add(name: str, *args: Any, **more: Any) -> Any:
            self._names.add(name)
            return getattr(self._scene, method)(name, *args, **more)

        return add

    def replaces(self, before: frozenset[str]) -> frozenset[str]:
        """Remove those of `before` that were not added again; the names of now."""
        for name in before - self._names:
            handle = self._scene.get_handle_by_name(name)
            if handle is not None:  # it may have gone with its parent
                handle.remove()
        return frozenset(self._names)


Add = Callable[[str, Any], Any]

_CYLINDER, _BASE, _PLATFORM, _PAYLOAD = rgb("#8A8F98"), rgb("#4A4F57"), rgb("#2F6690"), rgb("#F2F2F2")
_GHOST, _RIGID, _FLEXIBLE = rgb("#9A9A9A"), rgb("#6E6E6E"), rgb("#C2185B")
LABELS = np.array([1.15, 1.15, 1.0])
"""Where the numbers of the legs stand, in their base joints' places."""
_HINGE = rgb("#222222")
_LEAST = 0.004  # of the robot's size: least radius of a drawn piston
_HERE = (0.0, 0.0, 0.0)
_NOTHING = np.zeros((1, 2, 3))


def add_grid(scene: SceneNodes | viser.SceneApi, width: float, plane: Literal["xy", "xz"], position: Array) -> Any:
    """A square grid whose lines are 10, 20, 50 mm ... apart."""
    cell = 1e-3 * round_down(1e3 * width / 30)
    return scene.add_grid(
        "/grid",
        width,
        width,
        plane=plane,
        position=position,
        cell_size=cell,
        section_size=5 * cell,
        cell_color=(228, 228, 228),
        section_color=(195, 195, 195),
    )


class RobotParts:
    """Base, rails and cranks, legs, platform with its payload, frames and labels."""

    def __init__(self, scene: SceneNodes, add: Add, skeleton: Skeleton) -> None:
        self._skeleton, robot = skeleton, skeleton.robot
        self._colors: Array = np.zeros((len(robot.legs), 3), dtype=int)
        self._mouth = np.array([[leg.cylinder.mouth] for leg in robot.legs])
        self._radius, self._least = _radii(robot, skeleton.size), _LEAST * skeleton.size
        self._moving = self._skeleton.guided if robot.base_mount is None else range(len(robot.legs))
        self._plates: list[Any] = [None, None]  # on mounts
        self._joints = self._make_base(scene, add)
        self._platform = self._make_platform(scene, add)
        self._cylinders, self._pistons = self._make_legs(scene)
        looks = (
            ("/guides", skeleton.home.guides, _BASE, 3.0),
            ("/hinges", skeleton.home.hinges, _HINGE, 6.0),
            ("/heads", skeleton.home.heads, _HINGE, 5.0),
        )
        self._guides, self._hinges, self._heads = (
            scene.add_line_segments(name, _floats(lines), color, thickness=width, thickness_units="screen")
            if len(lines)
            else None
            for name, lines, color, width in looks
        )

    def draw(self, points: Scene, colors: Array) -> None:
        """Move everything to the points of a robot; colours (legs, 3) of the pistons."""
        self._platform.position, self._platform.wxyz = points.centre, quaternion(points.rotation)
        along = points.piston[:, 0] - points.base
        turns = orientation(np.where(self._mouth > 0, along, points.piston[:, 1] - points.base))
        thick = np.where(np.isnan(points.radii), self._radius[:, None], np.maximum(points.radii, self._least))
        vertices = _thickened(tube(points.piston, 1.0), points.piston, thick)
        for i in range(len(self._pistons)):
            self._cylinders[i].wxyz = turns[i]
            self._pistons[i].vertices = vertices[i]
            if (colors[i] != self._colors[i]).any():
                self._pistons[i].color = tuple(int(c) for c in colors[i])
        self._colors = np.array(colors)
        for i in self._moving:
            self._joints[i].position = self._cylinders[i].position = points.base[i]
        for mesh, moved in zip(self._plates, points.plates, strict=True):
            if mesh is not None:
                mesh.position, mesh.wxyz = moved[:3], quaternion(exponential(moved[3:]))
        lines_of = (self._guides, points.guides), (self._hinges, points.hinges), (self._heads, points.heads)
        for handle, lines in lines_of:
            if handle is not None:
                handle.points = _floats(lines)

    def _make_base(self, scene: SceneNodes, add: Add) -> list[Any]:
        robot, size, joints = self._skeleton.robot, self._skeleton.size, []
        floor = float(robot.base_joints[:, 2].min()) - 0.03 * size
        vertices, faces = plate(robot.base_joints - [0.0, 0.0, 0.02 * size], 0.012 * size)
        base = scene.add_mesh_simple("/base", vertices, faces, color=_BASE, opacity=0.55, flat_shading=True)
        self._plates[0] = base if robot.base_mount is not None else None
        add("grid", add_grid(scene, 4 * size, "xy", np.array([0.0, 0.0, floor])))
        add("frames", scene.add_frame("/frame", axes_length=0.25 * size, axes_radius=0.006 * size))
        add("frames", scene.add_label("/frame/name", "W (world)", position=_HERE, anchor="top-center"))
        for i, joint in enumerate(robot.base_joints):
            joints.append(_joint(scene, f"/joint_{i + 1}", self._skeleton.joints[i][0], 1.5 * self._radius[i], _BASE))
            joints[i].position = joint
            outward = self._skeleton.home.base[i] * LABELS
            add("labels", scene.add_label(f"/leg_{i + 1}", f"leg {i + 1}", position=outward, anchor="top-center"))
        return joints

    def _make_platform(self, scene: SceneNodes, add: Add) -> Any:
        robot, size, load = self._skeleton.robot, self._skeleton.size, self._skeleton.robot.payload
        frame = scene.add_frame("/platform", show_axes=False)
        vertices, faces = plate(robot.platform_joints, 0.012 * size)
        mounted = "/platform" if robot.platform_mount is None else "/platform/mounted"
        self._plates[1] = scene.add_frame(mounted, show_axes=False) if robot.platform_mount is not None else None
        scene.add_mesh_simple(f"{mounted}/plate", vertices, faces, color=_PLATFORM, opacity=0.8, flat_shading=True)
        for i, joint in enumerate(robot.platform_joints):
            letter, radius = self._skeleton.joints[i][1], 1.4 * float(self._radius[i])
            _joint(scene, f"{mounted}/joint_{i + 1}", letter, radius, _PLATFORM).position = joint
        axes = scene.add_frame("/platform/axes", axes_length=0.18 * size, axes_radius=0.005 * size)
        add("frames", axes)
        add("frames", scene.add_label("/platform/axes/name", "P (platform)", anchor="top-center"))
        if load is None:
            return frame
        stem = np.stack([robot.platform_joints.mean(axis=0), load.com])[None]
        scene.add_line_segments("/platform/stem", stem, _BASE, thickness=2.0, thickness_units="screen")
        scene.add_icosphere("/platform/payload", 0.055 * size, color=_PAYLOAD, opacity=0.2, position=load.com)
        scene.add_icosphere("/platform/com", 0.009 * size, color=rgb("#111111"), position=load.com)
        words, below = f"centre of mass, {number(load.mass)} kg", load.com - np.array([0.0, 0.0, 0.07 * size])
        add("labels", scene.add_label("/platform/mass", words, position=below, anchor="top-left"))
        if np.linalg.norm(load.tool - load.com) > 1e-6:
            scene.add_icosphere("/platform/tool", 0.012 * size, color=_FLEXIBLE, position=load.tool)
            add("labels", scene.add_label("/platform/tool_name", "tool", position=load.tool, anchor="top-left"))
        return frame

    def _make_legs(self, scene: SceneNodes) -> tuple[list[Any], list[Any]]:
        cylinders, pistons, faces = [], [], tube_faces(STATIONS)
        robot, home = self._skeleton.robot, self._skeleton.home
        for i, (leg, color) in enumerate(zip(robot.legs, colors_of_legs(robot.count), strict=True)):
            node = scene.add_frame(f"/cylinder_{i + 1}", show_axes=False, position=home.base[i])
            mouth, radius = leg.cylinder.mouth, CYLINDER * float(self._radius[i])
            if mouth > 0:
                seen = None if leg.guide is None else 0.45  # into it, where a piston stands in bushings
                size = radius if leg.cylinder.diameter is None else 0.5 * leg.cylinder.diameter
                place = (0.0, 0.0, 0.5 * mouth)
                scene.add_cylinder(f"/cylinder_{i + 1}/body", size, mouth, _CYLINDER, opacity=seen, position=place)
            cylinders.append(node)
            empty = np.zeros((STATIONS * 8, 3))
            pistons.append(scene.add_mesh_simple(f"/piston_{i + 1}", empty, faces, color=rgb(color)))
        return cylinders, pistons


def _joint(scene: SceneNodes, name: str, letter: str, radius: float, color: tuple[int, int, int]) -> Any:
    """A joint by its letter: a ball, a block where it is fixed; of a hinge, whose axis is drawn too, a small ball."""
    if letter == "F":
        return scene.add_box(name, color, (2 * radius, 2 * radius, 2 * radius))
    return scene.add_icosphere(name, radius * (0.7 if letter in ("R", "") else 1.0), color=color)


def _floats(lines: Array) -> Any:
    return lines.astype(np.float32)


def _radii(robot: model.Robot, size: float) -> Array:
    """Radii of the pistons (legs,) [m]; a thickness to see by where the study gives no diameter."""
    given = [leg.piston.width if leg.piston.sections or leg.piston.diameter else None for leg in robot.legs]
    return np.array([0.012 * size if d is None else max(0.5 * d, _LEAST * size) for d in given])


def _thickened(vertices: Array, lines: Array, radius: Array) -> Array:
    """Tubes of radius 1 around lines (legs, n, 3), made as thick as `radius` (legs, n)."""
    sides = vertices.shape[1] // lines.shape[1]
    centre = np.repeat(lines, sides, axis=1)
    return centre + np.repeat(radius, sides, axis=1)[:, :, None] * (vertices - centre)


class Ghost:
    """The rigid robot in pale lines."""

    def __init__(self, scene: SceneNodes, add: Add, skeleton: Skeleton) -> None:
        joints, size = skeleton.robot.platform_joints, skeleton.size
        vertices, faces = plate(joints, 0.004 * size)
        self._frame = scene.add_frame("/ghost", show_axes=False)
        mesh = scene.add_mesh_simple(
            "/ghost/plate", vertices, faces, color=_GHOST, opacity=0.35, flat_shading=True, cast_shadow=False
        )
        stem = np.stack([joints.mean(axis=0), skeleton.com])[None]
        line = scene.add_line_segments("/ghost/stem", stem, _GHOST, thickness=1.5, thickness_units="screen")
        com = scene.add_icosphere("/ghost/com", 0.007 * size, color=_GHOST, opacity=0.8, position=skeleton.com)
        legs = np.zeros((len(joints), 2, 3))
        self._legs = scene.add_line_segments("/ghost_legs", legs, _GHOST, thickness=2.0, thickness_units="screen")
        for handle in (mesh, line, com, self._legs):
            add("rigid ghost", handle)

    def draw(self, points: Scene) -> None:
        """Move it to the points of a rigid robot."""
        self._frame.position, self._frame.wxyz = points.centre, quaternion(points.rotation)
        self._legs.points = _floats(np.stack([points.base, points.platform], axis=1))


class Deviation:
    """Both paths of the centre of mass or the tool, and its deviation as an arrow with its length."""

    def __init__(self, scene: SceneNodes, add: Add, size: float) -> None:
        self.size = size
        self._rigid = scene.add_line_segments("/path_rigid", _NOTHING, _RIGID, thickness=2.0, thickness_units="screen")
        self._bent = scene.add_line_segments(
            "/path_flexible", _NOTHING, _FLEXIBLE, thickness=2.0, thickness_units="screen"
        )
        self._arrow = scene.add_arrows(
            "/deviation", _NOTHING, _FLEXIBLE, shaft_radius=0.004 * size, head_radius=0.01 * size
        )
        self._words = scene.add_label("/deviation_length", "", position=_HERE, anchor="bottom-left")
        for part, handle in (("paths", self._rigid), ("paths", self._bent)):
            add(part, handle)
        for handle in (self._arrow, self._words):
            add("deviation arrow", handle)

    def paths(self, rigid: Array, flexible: Array) -> None:
        """Draw both paths (T, 3), the flexible one with its deviation magnified."""
        self._rigid.points = path_segments(rigid).astype(np.float32)
        self._bent.points = path_segments(flexible).astype(np.float32)

    def draw(self, now: Instant) -> None:
        """The arrow from the rigid to the drawn point; in words the true length."""
        start, end = now.start, now.end
        length = float(np.linalg.norm(end - start))
        self._arrow.points = np.stack([start, end])[None].astype(np.float32)
        self._arrow.head_length = round(min(0.03 * self.size, 0.5 * length), 4)
        deviation = float(np.linalg.norm(now.deviation))
        self._words.text = f"deviation {text(deviation, 'm')}" if deviation > ROUNDING * self.size else "no deviation"
        self._words.position = start + np.array([0.0, 0.0, 0.02 * self.size])
