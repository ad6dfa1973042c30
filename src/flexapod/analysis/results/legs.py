"""Coordinates and joints of the legs by name, out of what is known of a robot of any kind."""

from __future__ import annotations

import numpy as np

from flexapod.analysis.results.variables import ANGLES
from flexapod.common.arrays import Array
from flexapod.kinematics.inverse import LegState
from flexapod.kinematics.leg_geometry import ABSENT, COORDINATES, DRIVEN, HELD, Limbs
from flexapod.kinematics.rotations import exponential
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.shapes import LateralBasis
from flexapod.model import Leg, Robot
from flexapod.solve.sections import bending_amplitudes


def bending_basis(shapes: Shapes) -> LateralBasis:
    """Shapes in which the legs bend; a planar robot's legs bend across one of their axes only."""
    return shapes.beam.a if shapes.beam.a.count else shapes.beam.b


def lateral_amplitudes(shapes: Shapes, q: Array) -> Array:
    """Lateral amplitudes (..., 2, k) [m] out of coordinates (..., n); zero across an axis about which none bends."""
    k = bending_basis(shapes).count
    found = np.zeros((*q.shape[:-1], 2, k))
    for direction, (name, basis) in enumerate((("a", shapes.beam.a), ("b", shapes.beam.b))):
        if basis.count:
            at = shapes.index(name)
            found[..., direction, :] = q[..., at : at + k]
    return found


def bending_amplitudes_of_leg(leg: Leg, shapes: Shapes, q: Array) -> Array:
    """Lateral amplitudes of a leg, (T, 2, k) [m], out of its coordinates (T, n): those of bending without shear."""
    return bending_amplitudes(leg, shapes, q) if shapes.beam.shear else lateral_amplitudes(shapes, q)


def stretch(shapes: Shapes, q: Array) -> Array:
    """Stretch of the pistons at their tips (...,) [m]: the amplitude of the static axial shape."""
    return q[..., shapes.index("c")] if shapes.beam.axial.count else np.zeros(q.shape[:-1])


def angle_names(limbs: Limbs) -> dict[str, str]:
    """Angles that legs have, by their label in results: crank, base joint, leg, platform joint."""
    there = dict(zip(COORDINATES, (limbs.state != ABSENT).any(axis=0), strict=True))
    there |= {"carriage": limbs.carriage == "crank"}
    return {label: "chi" if label == "carriage" else label for label in ANGLES if there[label]}


def drive_names(limbs: Limbs) -> list[str]:
    """Driven coordinate of each leg, "l" or "chi"; of a passive leg its length, or its carriage if it has one."""
    of_passive = np.where(limbs.state[:, COORDINATES.index("chi")] == ABSENT, "l", "chi")
    driven = limbs.state == DRIVEN
    return [
        COORDINATES[int(row.argmax())] if row.any() else str(own) for row, own in zip(driven, of_passive, strict=True)
    ]


def drive_values(limbs: Limbs, shapes: Shapes, values: Array) -> Array:
    """Value of each leg that belongs to its drive, (..., legs), out of all (..., legs, n)."""
    at = [shapes.index(name) for name in drive_names(limbs)]
    return values[..., np.arange(len(at)), at]


def screw_travel(robot: Robot) -> Array:
    """Travel by an angle of each leg's screw, (legs,) [m/rad]; 1 of other drives, whose numbers stay as they are."""
    return np.array([1.0 if leg.screw is None else leg.screw.per_turn for leg in robot.legs])


def stroke_forces(limbs: Limbs, forces: Array) -> Array:
    """Forces of drives that move strokes, (..., legs); 0 of other legs."""
    return np.where(limbs.state[:, COORDINATES.index("l")] == DRIVEN, forces, 0.0)


def held_names(limbs: Limbs) -> list[str]:
    """Coordinates that joints or struts hold in any leg."""
    return [name for name, held in zip(COORDINATES, (limbs.state == HELD).any(axis=0), strict=True) if held]


def has_strokes(robot: Robot) -> bool:
    """Test whether any leg of a robot has a stroke."""
    return any(leg.strut is None for leg in robot.legs)


def base_points(limbs: Limbs, chi: Array | None) -> Array:
    """Base joints (..., n, 3) [m], world axes, where the carriages are at `chi` (..., n) from home."""
    if not limbs.carriage or chi is None:
        return limbs.base
    way = chi[..., None] * limbs.carriage_axis
    if limbs.carriage == "slider":
        return limbs.base + way
    return limbs.base + (exponential(way) @ limbs.carriage_arm[..., None])[..., 0] - limbs.carriage_arm


def base_motion(limbs: Limbs, legs: LegState) -> tuple[Array, Array]:
    """Velocities and accelerations of the base joints, (T, n, 3) each; zero where nothing moves them."""
    zero = np.zeros((*legs.length.shape, 3))
    if not limbs.carriage:
        return zero, zero
    chi, rate, change = (part[..., None] for part in legs.coordinate("chi"))
    if limbs.carriage == "slider":
        return rate * limbs.carriage_axis, change * limbs.carriage_axis
    way = np.cross(limbs.carriage_axis, base_points(limbs, chi[..., 0]) - limbs.base + limbs.carriage_arm)
    return rate * way, change * way + rate**2 * np.cross(limbs.carriage_axis, way)
