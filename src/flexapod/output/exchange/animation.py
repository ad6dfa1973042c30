"""A motion as other programs draw it: bodies that are rigid, and pistons that bend, at the instants of a result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.attributes import robot_of
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.output.scene.geometry import RobotMotion, computed_study
from flexapod.output.scene.skeleton import STATIONS, Scene, Skeleton
from flexapod.solve.sections import leg_values
from flexapod.solve.shapes import leg_shapes

if TYPE_CHECKING:
    from xarray import Dataset

SAME = 1e-6  # of a shape: how far it may change with the stroke and still count as the same
THICK = 0.02  # of the robot's size: radius of a drawn piston without a section


@dataclass(frozen=True, kw_only=True)
class RobotAnimation:
    """A robot at T instants, n legs; lengths [m], world axes.

    Cylinder i has its origin in its base joint and its z along its axis: `base` (T, n, 3), `axes` (T, n, 3, 3). The
    free part of its piston begins at `mouth` (n,) and is `free` (T, n) long; at zeta from 0 to 1 along it the piston is
    displaced along x and y of the cylinder by ``weights @ shapes``: `weights` (T, n, 2, k) and `shapes` of each leg
    (2, k, STATIONS), at home. The last shape is a line, for tips that lean in bushings. `radii` (n, STATIONS).
    `time` (T,) [s]; `centre` (T, 3), `rotation` (T, 3, 3): of the platform frame; `tip` (T, n, 3): platform joints;
    `guides` (T, m, 2, 3): rails or cranks; `changing`: shapes change with the stroke.
    """

    skeleton: Skeleton
    time: Array
    centre: Array
    rotation: Array
    base: Array
    tip: Array
    axes: Array
    mouth: Array
    free: Array
    weights: Array
    shapes: list[Array]
    radii: Array
    guides: Array
    changing: bool


def motion_result(study: model.Study, data: Dataset | None) -> Dataset:
    """A result of the study, which is simulated where none is given; refuses what is no motion of its robot."""
    if data is None:
        return simulate(study)
    if "com_position_rigid" not in getattr(data, "data_vars", ()):
        raise InputError("is not a motion", key="data", allowed="a result of flexapod.simulate")
    own, robot = robot_of(data), study.robot
    if own.type != robot.type or not all(
        a.shape == b.shape and np.allclose(a, b)
        for a, b in ((own.base_joints, robot.base_joints), (own.platform_joints, robot.platform_joints))
    ):
        raise InputError("is of another robot", key="data", value=own.type, allowed=f"a result of this {robot.type}")
    return data


def robot_animation(study: model.Study, data: Dataset | None, scale: float) -> RobotAnimation:
    """The robot of `motion_result` a study, deflections `scale` times larger."""
    data = motion_result(study, data)
    motion = RobotMotion(study, data)
    scenes = [motion.instant_at(t, scale).flexible for t in motion.time]
    base, tip = (np.array([getattr(x, name) for x in scenes]) for name in ("base", "platform"))
    mouth = np.array([leg.cylinder.mouth for leg in study.robot.legs])
    moved = scale * data.tip_deflection.values
    length = np.linalg.norm(tip - base, axis=-1)
    along = np.sqrt(length**2 - (moved**2).sum(axis=-1))
    seen = computed_study(study, data)
    weights, shapes, changing = _bending(seen, data, scale, moved, along - mouth)
    return RobotAnimation(
        skeleton=motion.skeleton,
        time=motion.time,
        centre=np.array([x.centre for x in scenes]),
        rotation=np.array([x.rotation for x in scenes]),
        base=base,
        tip=tip,
        axes=_leaning(np.array([_pointed(x) for x in scenes]), moved, along, length),
        mouth=mouth,
        free=along - mouth,
        weights=weights,
        shapes=shapes,
        radii=_radii(motion.skeleton),
        guides=np.array([x.guides for x in scenes]),
        changing=changing,
    )


def _bending(
    study: model.Study, data: Dataset, scale: float, moved: Array, free: Array
) -> tuple[Array, list[Array], bool]:
    """Weights (T, n, 2, k), shapes of each leg (2, k, STATIONS), and whether these change with the stroke."""
    legs, zeta = study.robot.legs, np.linspace(0.0, 1.0, STATIONS)
    line = np.broadcast_to(zeta, (2, 1, STATIONS))
    if "lateral_amplitude" not in data:
        return moved[..., None], [line] * len(legs), False
    basis, weights = leg_shapes(study.robot, study.simulation), scale * data.lateral_amplitude.values
    shapes, changing = [], False
    for i, leg in enumerate(legs):
        home = float(study.robot.home_lengths[i]) - leg.cylinder.mouth
        found = leg_values(leg, basis, np.array([home, free[:, i].min(), free[:, i].max()]), zeta)
        changing |= bool(np.ptp(found, axis=-1).max() > SAME * np.abs(found).max())
        shapes.append(np.concatenate([found[..., 0], line], axis=1))
    tips = np.stack([np.einsum("tdk,dk->td", weights[:, i], shapes[i][:, :-1, -1]) for i in range(len(legs))], axis=1)
    return np.concatenate([weights, (moved - tips)[..., None]], axis=-1), shapes, changing


def _pointed(scene: Scene) -> Array:
    """Axes of legs whose z points along their chords, (n, 3, 3)."""
    chord = scene.platform - scene.base
    axis = chord / np.linalg.norm(chord, axis=1, keepdims=True)
    return kinematics.leg_rotations(scene.frames, *kinematics.joint_angles(scene.frames, axis[None]))[0]


def _leaning(axes: Array, moved: Array, along: Array, length: Array) -> Array:
    """Axes of cylinders from which the tip at (`moved`, `along`) lies on the z of `axes`: turned by the least angle."""
    x, y = moved[..., 0] / length, moved[..., 1] / length
    z = along / length
    k = 1 / (1 + z)
    rows = [[1 - k * x * x, -k * x * y, -x], [-k * x * y, 1 - k * y * y, -y], [x, y, z]]
    return axes @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _radii(skeleton: Skeleton) -> Array:
    found = skeleton.home.radii
    return np.where(np.isfinite(found), found, THICK * skeleton.size)
