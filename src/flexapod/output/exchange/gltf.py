"""A motion as one GLB file: a node for each rigid body, and pistons that bend as morph targets.

The file is binary glTF 2.0; its arrays are accessors of one buffer (`Glb`).
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod import model
from flexapod.common.arguments import number
from flexapod.common.arrays import Array
from flexapod.common.version import __version__
from flexapod.kinematics.rotations import quaternion
from flexapod.output.exchange.animation import RobotAnimation, robot_animation
from flexapod.output.exchange.formats import Content
from flexapod.output.scene.geometry import orientation, plate, tube, tube_faces
from flexapod.output.scene.skeleton import STATIONS
from flexapod.output.scene.style import LEG_COLORS

if TYPE_CHECKING:
    from xarray import Dataset

_FLOAT, _UINT = 5126, 5125
_KINDS = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4"}
VERTICES, TRIANGLES = 34962, 34963
Entry = dict[str, Any]


class Glb:
    """A file that grows: lists of `nodes`, `meshes`, `materials`, and what was stored in the buffer."""

    def __init__(self, generator: str) -> None:
        self._asset = {"version": "2.0", "generator": generator}
        self._bytes = bytearray()
        self._views: list[Entry] = []
        self._accessors: list[Entry] = []
        self.nodes: list[Entry] = []
        self.meshes: list[Entry] = []
        self.materials: list[Entry] = []
        self.samplers: list[Entry] = []
        self.channels: list[Entry] = []

    def add(self, kind: str, entry: Entry) -> int:
        """Put an entry at the end of the list `kind`; its place."""
        entries = getattr(self, kind)
        entries.append(entry)
        return len(entries) - 1

    def store(self, values: ArrayLike, target: int | None = None, name: str | None = None) -> int:
        """Store numbers, (n,) or (n, 2 to 4), as float32, indices as uint32; the accessor.

        Bounds are given for vertices, and for numbers that stand alone, as instants do.
        """
        found: NDArray[Any] = np.asarray(values)
        found = np.ascontiguousarray(found, dtype="<u4" if target == TRIANGLES else "<f4")
        view: Entry = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": found.nbytes}
        self._views.append(view | ({} if target is None else {"target": target}))
        self._bytes += found.tobytes()
        entry: Entry = {
            "bufferView": len(self._views) - 1,
            "componentType": _UINT if target == TRIANGLES else _FLOAT,
            "count": len(found),
            "type": _KINDS[found.shape[1:]],
        }
        if found.shape[1:] in ((), (3,)) and target != TRIANGLES:
            entry |= {"min": np.atleast_1d(found.min(0)).tolist(), "max": np.atleast_1d(found.max(0)).tolist()}
        self._accessors.append(entry | ({} if name is None else {"name": name}))
        return len(self._accessors) - 1

    def animate(self, node: int, path: str, time: int, values: ArrayLike, name: str | None = None) -> None:
        """Let a node's "translation", "rotation", "scale" or "weights" follow values at the instants `time`."""
        output = self.store(values, name=name)
        sampler = self.add("samplers", {"input": time, "output": output, "interpolation": "LINEAR"})
        self.channels.append({"sampler": sampler, "target": {"node": node, "path": path}})

    def content(self, root: int, animation: str) -> bytes:
        """The file, whose scene is the node `root`."""
        body: Entry = {
            "asset": self._asset, "scene": 0, "scenes": [{"nodes": [root]}], "nodes": self.nodes, "meshes": self.meshes,
            "materials": self.materials, "accessors": self._accessors, "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._bytes)}],
        }  # fmt: skip
        if self.channels:
            body["animations"] = [{"name": animation, "samplers": self.samplers, "channels": self.channels}]
        text = json.dumps(body, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + len(self._bytes)
        head = struct.pack("<4sII", b"glTF", 2, whole) + struct.pack("<I4s", len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(self._bytes), b"BIN\0") + bytes(self._bytes)


SIDES = 16  # of a drawn rod
WIDER = 1.5  # a cylinder than its piston
LARGEST = 1e9  # factor on deflections: the format's numbers have 32 bits
GREY, PLATE = "#9AA3AB", "#5B6B78"
UP: list[float] = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # x y z w: z up to y up
STILL = 1e-12  # m: what moves less stands


def gltf(study: model.Study, *, data: Dataset | None = None, magnify: float = 1.0) -> Content:
    """The motion of a result of the study, which is simulated where none is given, deflections `magnify` times larger.

    Metres, y up. Nodes `cylinder_i` stand in the base joints, their children `piston_i` begin at the mouth and are one
    unit long, scaled to the length of the free part; weights of their morph targets are the amplitudes of their shapes.
    """
    magnify = number(magnify, "magnify", above=0.0, most=LARGEST)
    robot = robot_animation(study, data, magnify)
    file = Glb(f"flexapod {__version__}")
    time = file.store(robot.time, name="time")
    nodes = [_base(file, robot), _payload(file, robot, time)]
    for i in range(len(robot.mouth)):
        nodes.append(_leg(file, robot, time, i))
    nodes += _carriages(file, robot, time)
    root = file.add("nodes", {"name": "robot", "rotation": UP, "children": [x for x in nodes if x is not None]})
    left = ["forces, energies and all other results: they are in the Dataset", "friction, oil, motors"]
    left += ["how the shapes of pistons change with the stroke: they are those at home"] * robot.changing
    left += ["how the base plate moves on its mount: its joints do"] * (study.robot.base_mount is not None)
    return Content(files={"": file.content(root, "motion")}, left_out=tuple(left))


def _material(file: Glb, name: str, colour: str) -> int:
    for place, known in enumerate(file.materials):
        if known["name"] == name:
            return place
    rgb = [(int(colour[k : k + 2], 16) / 255) ** 2.2 for k in (1, 3, 5)]  # linear
    pbr = {"baseColorFactor": [*rgb, 1.0], "metallicFactor": 0.2, "roughnessFactor": 0.6}
    return file.add("materials", {"name": name, "doubleSided": True, "pbrMetallicRoughness": pbr})


def _plate(file: Glb, points: Array, robot: RobotAnimation, name: str, colour: str) -> int:
    vertices, faces = plate(points, 0.02 * robot.skeleton.size)
    primitive = {
        "attributes": {"POSITION": file.store(vertices, VERTICES)},
        "indices": file.store(faces.ravel(), TRIANGLES),
        "material": _material(file, name, colour),
    }
    return file.add("meshes", {"name": name, "primitives": [primitive]})


def _rod(file: Glb, line: Array, radii: Array, material: int) -> Entry:
    """A rod around points (n, 3) on the z axis with radii (n,)."""
    ring = tube(np.stack([0 * line, 0 * line, line], axis=-1), 1.0, SIDES)
    out = ring * [1, 1, 0]
    vertices = out * np.repeat(radii, SIDES)[:, None] + ring * [0, 0, 1]
    return {
        "attributes": {"POSITION": file.store(vertices, VERTICES), "NORMAL": file.store(out, VERTICES)},
        "indices": file.store(tube_faces(len(line), SIDES).ravel(), TRIANGLES),
        "material": material,
    }


def _base(file: Glb, robot: RobotAnimation) -> int:
    rails = robot.guides[0].reshape(-1, 3)
    mesh = _plate(file, robot.base[0] if not len(rails) else robot.skeleton.robot.base_joints, robot, "base", GREY)
    if not len(rails) or not _still(robot.guides):
        return file.add("nodes", {"name": "base", "mesh": mesh})
    lines = {"mode": 1, "attributes": {"POSITION": file.store(rails, VERTICES)}, "material": 0}
    file.meshes[mesh]["primitives"].append(lines)
    return file.add("nodes", {"name": "base", "mesh": mesh})


def _payload(file: Glb, robot: RobotAnimation, time: int) -> int:
    mesh = _plate(file, robot.skeleton.robot.platform_joints, robot, "payload", PLATE)
    node = file.add("nodes", {"name": "payload", "mesh": mesh})
    _place(file, node, time, robot.centre, "platform_position")
    _turn(file, node, time, robot.rotation, "platform_quaternion")
    return node


def _leg(file: Glb, robot: RobotAnimation, time: int, i: int) -> int:
    """Nodes of a leg: the cylinder, and in it the piston."""
    number, mouth, radii = i + 1, float(robot.mouth[i]), robot.radii[i]
    colour = _material(file, f"leg_{number}", LEG_COLORS[i % len(LEG_COLORS)])
    weights, shapes, names = _bending(robot, i)
    zeta = np.linspace(0.0, 1.0, STATIONS)
    rod = _rod(file, zeta, radii, colour)
    moved = np.repeat(shapes, SIDES, axis=1)  # (targets, vertices, 3)
    rod["targets"] = [{"POSITION": file.store(x, VERTICES)} for x in moved]
    extras = {"weights": [0.0] * len(moved), "extras": {"targetNames": names}} if len(moved) else {}
    if not len(moved):
        del rod["targets"]
    mesh = file.add("meshes", {"name": f"piston_{number}", "primitives": [rod], **extras})
    piston = file.add("nodes", {"name": f"piston_{number}", "mesh": mesh, "translation": [0.0, 0.0, mouth]})
    ones = np.ones_like(robot.free[:, i])
    file.animate(piston, "scale", time, np.stack([ones, ones, robot.free[:, i]], axis=1))
    if len(moved):
        file.animate(piston, "weights", time, weights.ravel(), f"lateral_amplitude_{number}")
    node = file.add("nodes", {"name": f"cylinder_{number}", "children": [piston]})
    if mouth > 0:
        tubes = _rod(file, np.array([0.0, mouth]), WIDER * radii[[0, 0]], _material(file, "cylinder", GREY))
        file.nodes[node]["mesh"] = file.add("meshes", {"name": f"cylinder_{number}", "primitives": [tubes]})
    _place(file, node, time, robot.base[:, i])
    _turn(file, node, time, robot.axes[:, i])
    return node


def _bending(robot: RobotAnimation, i: int) -> tuple[Array, Array, list[str]]:
    """Weights (T, targets), displacements along x or y at the stations (targets, STATIONS, 3), names of the targets."""
    weights, shapes = robot.weights[:, i], robot.shapes[i]
    moving = np.abs(weights).max(axis=0) > 0
    found, names = [], []
    for d, k in np.argwhere(moving):
        found.append(np.outer(shapes[d, k], np.eye(3)[d]))
        names.append(f"lateral_amplitude {'xy'[d]} {k + 1}" if k + 1 < shapes.shape[1] else f"tip_deflection {'xy'[d]}")
    return weights[:, moving], np.array(found).reshape(-1, STATIONS, 3), names


def _carriages(file: Glb, robot: RobotAnimation, time: int) -> list[int]:
    """Cranks turn about their shafts; what slides is a short piece around its base joint."""
    nodes, size = [], 0.03 * robot.skeleton.size
    turning = not _still(robot.guides)
    for c, i in enumerate(robot.skeleton.guided):
        start, end = robot.guides[:, c, 0], robot.guides[:, c, 1]
        reach = float(np.linalg.norm((end - start)[0]))
        line = np.array([0.0, reach]) if turning else np.array([-size, size])
        rod = _rod(file, line, np.full(2, 0.5 * size), _material(file, "cylinder", GREY))
        mesh = file.add("meshes", {"name": f"carriage_{i + 1}", "primitives": [rod]})
        node = file.add("nodes", {"name": f"carriage_{i + 1}", "mesh": mesh})
        _place(file, node, time, start if turning else robot.base[:, i])
        _spin(file, node, time, orientation(end - start))
        nodes.append(node)
    return nodes


def _still(values: Array) -> bool:
    return bool(np.ptp(values, axis=0).max(initial=0.0) < STILL)


def _place(file: Glb, node: int, time: int, places: Array, name: str | None = None) -> None:
    if _still(places):
        file.nodes[node]["translation"] = places[0].tolist()
    else:
        file.animate(node, "translation", time, places, name)


def _turn(file: Glb, node: int, time: int, turns: Array, name: str | None = None) -> None:
    _spin(file, node, time, quaternion(turns), name)


def _spin(file: Glb, node: int, time: int, found: Array, name: str | None = None) -> None:
    """Let a node turn by quaternions (T, 4), w first, each the one of two that is near the one before."""
    signs = np.where((found[1:] * found[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    found = (found * np.concatenate([[1.0], np.cumprod(signs)])[:, None])[:, [1, 2, 3, 0]]
    if _still(found):
        file.nodes[node]["rotation"] = found[0].tolist()
    else:
        file.animate(node, "rotation", time, found, name)
