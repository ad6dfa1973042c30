"""Points, meshes and numbers that the scene draws, from studies and results; nothing here knows a browser."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexapod import kinematics, model
from flexapod.analysis.results.summary import has_separate_tool, tip_size
from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.output.scene.robot_scene import beam_values, leg_lines
from flexapod.output.scene.skeleton import STATIONS, Scene, Skeleton, convex_hull

if TYPE_CHECKING:
    from xarray import Dataset

S = TypeVar("S", model.Study, model.ActuatorStudy)
Faces = NDArray[np.uint32]

BEAM_POINTS = 2 * STATIONS - 1  # of the drawn beam of a single actuator
ROUNDING = 1e-11  # of the size: below, a deflection is the rounding of positions
SHARE = 0.12  # of the robot's size: the largest drawn deflection where the factor is automatic


@dataclass(frozen=True, kw_only=True)
class Instant:
    """Drawing of one instant [m]: the flexible robot, deflections magnified, the rigid one, the true deviation.

    `index` of the stored instant; `start`, `end` (3,): the point whose deviation is shown, rigid and as drawn;
    `deviation` (3,): of that point, flexible minus rigid, not magnified.
    """

    index: int
    flexible: Scene
    rigid: Scene
    start: Array
    end: Array
    deviation: Array


class RobotMotion:
    """The arrays of a robot's result that the scene draws, taken out of the Dataset once.

    `time` (T,): stored instants [s]; `tool_apart`: whether the tool is another point than the centre of mass.
    """

    def __init__(self, study: model.Study, data: Dataset) -> None:
        self.skeleton: Skeleton = Skeleton(study.robot)
        self.time: Array = data.time.values
        self._com, self._deviation = data.com_position_rigid.values, data.com_deviation.values
        self._tool_deviation = data.tool_deviation.values
        self._arm = study.robot.tool - study.robot.com
        self.tool_apart: bool = has_separate_tool(data)
        self._turn = data.rotation_deviation.values
        self._rotation = matrix(data.platform_quaternion_rigid.values)
        if "base_motion_displacement" in data:
            self._seen_from_base(data)
        self._plates = np.stack([_plate(data, "base", study.robot), _plate(data, "platform", study.robot)], axis=1)
        self._tip = data.tip_deflection.values
        self._amplitude = data.lateral_amplitude.values if "lateral_amplitude" in data else None
        self._study = computed_study(study, data)

    def _seen_from_base(self, data: Dataset) -> None:
        """Draw all as it is seen from a base that is moved."""
        moved = np.concatenate([data.base_motion_displacement.values, data.base_motion_rotation.values], axis=1)
        given = self.skeleton.robot.base_motion
        base = kinematics.placed(moved, np.zeros(3) if given is None else given.at)
        self._com, self._rotation = base.seen(self._com, self._rotation)
        back = base.rotation.swapaxes(1, 2)
        self._deviation, self._tool_deviation, self._turn = (
            (back @ x[..., None])[..., 0] for x in (self._deviation, self._tool_deviation, self._turn)
        )

    def paths(self, scale: float, point: str = "com") -> tuple[Array, Array]:
        """Paths of a point ("com", "tool"), (T, 3) [m] each: of the rigid robot, and as drawn `scale` times off it."""
        moved = self._com + scale * self._deviation
        if point == "com":
            return self._com, moved
        arm = self._rotation @ self._arm
        return self._com + arm, moved + np.einsum("tij,tj->ti", exponential(scale * self._turn), arm)

    def index(self, time: float) -> int:
        """The stored instant nearest to `time` [s]."""
        return nearest_index(self.time, time)

    def automatic_scale(self) -> float:
        """Factor at which the largest deflection of the motion is seen: 1, 2 or 5 times a power of ten, at least 1."""
        robot = self.skeleton.robot
        moved = np.einsum("tij,kj->tki", self._rotation, robot.platform_joints - self.skeleton.com)
        moved = self._deviation[:, None] + np.cross(self._turn[:, None], moved)
        sizes = (moved, self._deviation, self._tool_deviation, self._tip)
        largest = max(float(np.linalg.norm(part, axis=-1).max()) for part in sizes)
        return visible_factor(largest, float(robot.home_lengths.mean()))

    def instant_at(self, time: float, scale: float, point: str = "com") -> Instant:
        """The robot at the stored instant nearest to `time` [s], deflections drawn `scale` times larger.

        `point`: whose deviation is shown, "com" or "tool".
        """
        i, skeleton = self.index(time), self.skeleton
        R, com = self._rotation[i], self._com[i]
        rigid = skeleton.scene_at(com - R @ skeleton.com, R, com)
        carriages = skeleton.carriages(rigid.platform)
        turned, moved = exponential(scale * self._turn[i]) @ R, com + scale * self._deviation[i]
        centre, offset = moved - turned @ skeleton.com, None
        if self._amplitude is not None:
            length, zeta = skeleton.lengths(centre, turned, carriages), np.linspace(0.0, 1.0, STATIONS)
            line = leg_lines(self._study, self._amplitude[i], length, zeta)
            leaning = self._tip[i] - line[..., -1]  # in bushings, or in a cylinder that bends
            line = line + leaning[..., None] * zeta
            offset = skeleton.lateral_offsets(scale * line, scale * self._tip[i], length)
        arm = self._arm if point == "tool" else np.zeros(3)
        return Instant(
            index=i,
            flexible=skeleton.scene_at(centre, turned, moved, offset, carriages, scale * self._plates[i]),
            rigid=rigid,
            start=com + R @ arm,
            end=moved + turned @ arm,
            deviation=(self._tool_deviation if point == "tool" else self._deviation)[i],
        )


def _plate(data: Dataset, end: str, robot: model.Robot) -> Array:
    """Displacement and turn of a plate about the origin of its axes, (T, 6) [m, rad]; zero without a mount."""
    mount = robot.base_mount if end == "base" else robot.platform_mount
    if mount is None:
        return np.zeros((data.sizes["time"], 6))
    turn = data[f"{end}_mount_rotation"].values
    moved = data[f"{end}_mount_displacement"].values - np.cross(turn, mount.at)
    return np.concatenate([moved, turn], axis=1)


class BeamMotion:
    """The beam of a single actuator's result over time, as `beam_frame` places it."""

    def __init__(self, study: model.ActuatorStudy, data: Dataset) -> None:
        self.actuator: model.Actuator = study.actuator
        self.time: Array = data.time.values
        self.length: Array = data.length.values
        elevation = data.elevation.values if study.actuator.space else 0.0
        self.axes: Array = beam_frame(study.actuator, data.angle.values, elevation)
        self.deflection: Array = tip_size(data)
        self.twist: Array = data.tip_twist.values if study.actuator.space else np.zeros(len(self.time))
        self._zeta = np.linspace(0.0, 1.0, BEAM_POINTS)
        self._offset = data.tip_deflection.values.reshape(len(self.time), -1)
        amplitude = data.mode_amplitude.values if "mode_amplitude" in data else np.zeros((len(self.time), 0))
        self._amplitude = amplitude.reshape(*self._offset.shape, -1)
        self._shapes = (
            beam_values(computed_study(study, data), self._zeta) if amplitude.size else np.zeros((0, BEAM_POINTS))
        )

    def index(self, time: float) -> int:
        """Index of the stored instant nearest to `time` [s]."""
        return nearest_index(self.time, time)

    def automatic_scale(self) -> float:
        """Factor at which the largest deflection is visible beside the mean free length: 1, 2 or 5 times 10^n."""
        largest = float(np.abs(self.deflection).max())
        return visible_factor(largest, float(self.length.mean()))

    def frame_at(self, time: float, scale: float) -> tuple[int, Array, Array]:
        """Stored instant; the beam outside the hub, bent `scale` times, and as if rigid: points (n, 3) [m]."""
        i = self.index(time)
        line = straight_beam(self.actuator, self.axes[i], self.length[i], self._zeta)
        bent = self._amplitude[i] @ self._shapes
        return i, line + scale * bent.T @ self._sideways(i), line

    def _sideways(self, i: int | slice) -> Array:
        """Directions of the deflections, (..., 1 or 2, 3)."""
        return self.axes[i][..., -self._offset.shape[1] :, :]

    def tips(self, scale: float) -> Array:
        """Path of the drawn tip, (T, 3) [m]."""
        along = (self.actuator.hub_radius + self.length)[:, None] * self.axes[:, 0]
        return along + scale * np.einsum("td,tdi->ti", self._offset, self._sideways(slice(None)))


def computed_study(study: S, data: Dataset) -> S:
    """The study with the fidelity and the shapes with which a result was computed."""
    now, then = study.simulation, data.attrs
    if (now.fidelity, now.lateral_basis, now.lateral_shapes) == (then["fidelity"], then["basis"], then["modes"]):
        return study
    basis = str(then["basis"]) if then["fidelity"] == "assumed-modes" else None
    return model.override(study, fidelity=str(then["fidelity"]), modes=int(then["modes"]) or None, basis=basis)


def nearest_index(instants: Array, time: float) -> int:
    """Place of the instant nearest to `time` in ascending ones (T,)."""
    if len(instants) == 1:
        return 0
    after = int(np.clip(np.searchsorted(instants, time), 1, len(instants) - 1))
    return after - int(time - instants[after - 1] <= instants[after] - time)


def beam_frame(actuator: model.Actuator, angle: Array | float, elevation: Array | float = 0.0) -> Array:
    """Axes of a beam, (..., 3, 3): along it, towards larger angles, towards larger elevations [rad].

    The plane of motion X, Y of a planar actuator stands upright, as x, z: its angle is drawn as an elevation.
    """
    a, e = (angle, elevation) if actuator.space else (0.0 * np.asarray(angle), angle)
    (c, s), (d, f) = (np.cos(a), np.sin(a)), (np.cos(e), np.sin(e))
    rows = [[c * d, s * d, f], [-s, c, 0.0 * f], [-c * f, -s * f, d]]
    return np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows], axis=-2)


def straight_beam(actuator: model.Actuator, axes: Array, length: float, zeta: Array) -> Array:
    """The straight beam outside the hub, (n, 3) [m], along the first of its `axes`."""
    return np.multiply.outer(actuator.hub_radius + length * zeta, axes[0])


def visible_factor(largest: float, size: float) -> float:
    """Factor that brings the largest deflection to a share of a size [m]; 1 where it is nothing but rounding."""
    return round_down(SHARE * size / largest) if largest > ROUNDING * size else 1.0


def round_down(factor: float) -> float:
    """The largest of 1, 2, 5, 10, 20 ... that is at most `factor`; 1 below 1."""
    if factor <= 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(factor) + 1e-12)
    return float(max(step for step in (1.0, 2.0, 5.0) if step * power <= factor * (1 + 1e-12)) * power)


def orientation(direction: Array) -> Array:
    """Quaternions (w x y z) that turn the z axis into directions (..., 3)."""
    d = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    q = np.stack([1 + d[..., 2], -d[..., 1], d[..., 0], 0 * d[..., 0]], axis=-1)
    norm = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(norm > 1e-9, q / np.maximum(norm, 1e-9), [0.0, 1.0, 0.0, 0.0])


def tube(line: Array, radius: float, sides: int = 8) -> Array:
    """Vertices of tubes around lines (..., n, 3): (..., n * sides, 3), a ring of `sides` at each point."""
    ahead = np.gradient(line, axis=-2)
    ahead = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    whole = line[..., -1:, :] - line[..., :1, :]
    least = np.eye(3)[np.argmin(np.abs(whole), axis=-1)]  # the world axis that is most across the line
    u = np.cross(ahead, least)
    u = u / np.linalg.norm(u, axis=-1, keepdims=True)
    v = np.cross(ahead, u)
    around = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(around)[:, None] * u[..., None, :] + np.sin(around)[:, None] * v[..., None, :]
    points = line[..., None, :] + radius * ring
    return points.reshape(*line.shape[:-2], -1, 3)


def tube_faces(count: int, sides: int = 8) -> Faces:
    """Triangles of a tube through `count` points, open at its ends, (2 * (count - 1) * sides, 3)."""
    ring, side = np.meshgrid(np.arange(count - 1), np.arange(sides), indexing="ij")
    a, b = ring * sides + side, ring * sides + (side + 1) % sides
    low, high = np.stack([a, b, a + sides], axis=-1), np.stack([b, b + sides, a + sides], axis=-1)
    return np.concatenate([low.reshape(-1, 3), high.reshape(-1, 3)]).astype(np.uint32)


def plate(points: Array, thickness: float) -> tuple[Array, Faces]:
    """A flat body over coplanar points (n, 3), `thickness` [m] across, or a bar along a line: vertices, triangles."""
    arms = points - points.mean(axis=0)
    _, sizes, (first, second, _) = np.linalg.svd(arms)
    if len(points) < 3 or sizes[1] < 1e-6 * sizes[0]:
        reach, half = np.abs(arms @ first).max() + thickness, 0.5 * thickness
        corners = [reach * s * first + half * t * second for s, t in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        points = points.mean(axis=0) + np.array(corners)
        first, second, _ = np.linalg.svd(points - points.mean(axis=0))[2]
    normal = np.cross(first, second)
    rim = points[convex_hull(points)]  # it runs around the normal
    n, half = len(rim), 0.5 * thickness * normal
    vertices = np.vstack([rim + half, rim - half])
    fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
    ring = np.arange(n)
    after = (ring + 1) % n
    side = np.vstack([np.stack([ring, ring + n, after], 1), np.stack([after, ring + n, after + n], 1)])
    return vertices, np.vstack([fan, fan[:, ::-1] + n, side]).astype(np.uint32)


def disc(radius: float, width: float, sides: int = 40) -> tuple[Array, Faces]:
    """A disc about the y axis, `width` [m] along it: vertices, triangles."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return plate(radius * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1), width)


def path_segments(points: Array, most: int = 400) -> Array:
    """A path (T, 3) as line segments (n, 2, 3), thinned to at most `most`; of one point, a segment of no length."""
    if len(points) == 1:
        return np.stack([points, points], axis=1)
    chosen = points[np.unique(np.linspace(0, len(points) - 1, min(len(points), most + 1)).astype(int))]
    return np.stack([chosen[:-1], chosen[1:]], axis=1)


def decimation_indices(values: Array, most: int) -> NDArray[np.intp]:
    """Indices of about `most` instants that show lines (lines, T): both ends, and extremes of each line by interval."""
    count = values.shape[1]
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, max(1, most // (2 * len(values))) + 1).astype(int)
    begins, interval = edges[:-1], np.repeat(np.arange(len(edges) - 1), np.diff(edges))
    keep = [np.array([0, count - 1])]
    for line in values:
        for extreme, none in ((np.minimum, np.inf), (np.maximum, -np.inf)):
            known = np.where(np.isfinite(line), line, none)
            hit = np.flatnonzero(known == extreme.reduceat(known, begins)[interval])
            keep.append(hit[np.searchsorted(hit, begins)])  # the first of each interval
    return np.unique(np.concatenate(keep))
