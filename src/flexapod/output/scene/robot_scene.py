"""Scenes in space: the robot of a result at an instant, its modes, its motion; the modes of a beam."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.results.attributes import robot_of
from flexapod.common.arrays import Array
from flexapod.common.lazy_imports import LazyModule
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.output.scene.skeleton import STATIONS, Scene, Skeleton

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.solve import sections
    from flexapod.solve import shapes as solve_shapes
    from flexapod.solve.modal import actuator_modes
else:
    actuator_modes = LazyModule("flexapod.solve.modal.actuator_modes")
    sections = LazyModule("flexapod.solve.sections")
    solve_shapes = LazyModule("flexapod.solve.shapes")


def scene(data: Dataset, time: float = 0.0, magnify: float = 1.0) -> Scene:
    """The robot of a result at the output nearest to `time` [s]; `magnify`: factor on deflections of the pistons."""
    robot, at = Skeleton(robot_of(data)), data.sel(time=time, method="nearest")
    R, com = matrix(at.platform_quaternion.values), at.com_position.values
    centre = com - R @ robot.com
    tip, zeta = magnify * at.tip_deflection.values, np.linspace(0.0, 1.0, STATIONS)
    shape = 0.5 * (3 * zeta**2 - zeta**3)  # of a cantilever under a force at its tip
    offset = robot.lateral_offsets(tip[:, :, None] * shape, tip, robot.lengths(centre, R))
    return robot.scene_at(centre, R, com, offset)


def beam_values(study: model.ActuatorStudy, zeta: Array) -> Array:
    """Lateral shapes of a study's beam from mouth (0) to tip (1), (k, n)."""
    return solve_shapes.beam_shapes(study.actuator, study.simulation).values(zeta)


def leg_lines(study: model.Study, amplitude: Array, lengths: Array, zeta: Array) -> Array:
    """Deflection of the pistons from mouth (0) to tip (1), (legs, 2, n) [m]; amplitudes (legs, 2, k), lengths [m]."""
    basis, legs = solve_shapes.leg_shapes(study.robot, study.simulation), study.robot.legs
    free, lines = lengths - np.array([leg.cylinder.mouth for leg in legs]), np.empty((len(legs), 2, len(zeta)))
    for leg, alike in _distinct_legs(legs):
        lines[alike] = np.einsum("ndk,dkpn->ndp", amplitude[alike], sections.leg_values(leg, basis, free[alike], zeta))
    return lines


@lru_cache(maxsize=4)
def _distinct_legs(legs: tuple[model.Leg, ...]) -> list[tuple[model.Leg, list[int]]]:
    """Legs that differ, and the indices of the legs that equal each."""
    places: dict[model.Leg, list[int]] = {}
    for i, leg in enumerate(legs):
        places.setdefault(leg, []).append(i)
    return list(places.items())


def mode_scene(modes: Dataset, mode: int, size: float, phase: float = 1.0) -> Scene:
    """The robot displaced in one of its modes: `mode` is its label in `modes`, a result of `flexapod.modes`.

    `size`: largest displacement drawn [m]; `phase` between -1 and 1, 0 is the robot at rest.
    """
    robot, shape = Skeleton(robot_of(modes)), modes.sel(mode=mode)
    R = matrix(modes.platform_quaternion.values)
    centre = modes.platform_position.values
    arms = np.vstack([robot.robot.platform_joints, robot.com]) @ R.T
    step, turn = shape.platform_shape.values[:3], shape.platform_shape.values[3:]
    platform = step + np.cross(turn, arms - R @ robot.com)
    lateral = shape.leg_shape.values
    largest = max(np.linalg.norm(platform, axis=1).max(), np.linalg.norm(lateral, axis=1).max(), 1e-30)
    factor = phase * size / largest
    turned = exponential(factor * turn) @ R
    com = centre + R @ robot.com + factor * step
    centre = com - turned @ robot.com
    length = robot.lengths(centre, turned)
    place = robot.axial_distances(length) / length[:, None]
    station = modes.station.values
    offset = np.array([[np.interp(place[i], station, row) for row in rows] for i, rows in enumerate(lateral)])
    return robot.scene_at(centre, turned, com, factor * offset)


@dataclass(frozen=True, kw_only=True)
class BeamModes:
    """Modes of the beam at one free length, ascending.

    `frequency` (m,) [Hz], `damping_ratio` (m,), `kind` (m,): what moves; `shape` (m, n, 3): displacement in the axes of
    `geometry.beam_frame` at n points spread evenly from mouth to tip, its largest value 1; `twist` (m, n): turn about
    the beam, of 1 at the tip where nothing else moves; `free_length` [m].
    """

    frequency: Array
    damping_ratio: Array
    kind: tuple[str, ...]
    shape: Array
    twist: Array
    free_length: float


def beam_modes(study: model.ActuatorStudy, points: int) -> BeamModes:
    """Modes of a study's beam at its free length, about the straight beam at rest, drawn with a number of points.

    InputError: a rigid beam; ComputationError: the straight beam has buckled under its own load.
    """
    actuator, simulation = study.actuator, study.simulation
    found, zeta = actuator_modes.actuator_modes(actuator, simulation), np.linspace(0.0, 1.0, points)
    eta = 1 - (1 - zeta) * actuator.free_length / actuator.length
    shapes = solve_shapes.actuator_shapes(actuator, simulation)
    lateral = shapes.beam.a.values(zeta)
    values = {"c": (0, shapes.beam.axial.values(eta)), "b": (1, -lateral), "a": (2, lateral), "t": (3, eta[None])}
    moved = np.zeros((len(found.kind), points, 4))
    for name, at in actuator_modes.amplitude_groups(shapes).items():
        k, shape = values[name]
        moved[:, :, k] = found.shapes[:, at] @ shape
    flat = moved.reshape(len(moved), -1)
    moved /= np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, None], axis=1)[:, :, None]
    return BeamModes(
        frequency=found.frequency,
        damping_ratio=found.damping_ratio,
        kind=found.kind,
        shape=moved[:, :, :3],
        twist=moved[:, :, 3],
        free_length=actuator.free_length,
    )
