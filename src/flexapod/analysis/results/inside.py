"""Pistons in two bushings and cylinders that bend: what they do to the tips of the legs, and forces of the bushings."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.polynomial import polyval

from flexapod.common.arrays import Array
from flexapod.common.quantities import text
from flexapod.common.ranking import first_largest
from flexapod.mechanics.elements.kink import LEAST, kink
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Robot
from flexapod.solve.system import System

__all__ = [
    "GUIDED",
    "PARTS",
    "bushing_words",
    "guide_results",
    "is_guided",
    "off_axis",
    "part_names_inside",
    "tip_moves",
]

PARTS = ("cylinder", "guide")
GUIDED = ("guide_force", "guide_overlap")
"""Variables of guided legs."""


def part_names_inside(robot: Robot) -> tuple[str, ...]:
    """Which of `PARTS` give way in any leg of a robot."""
    there = (any(leg.cylinder.section is not None for leg in robot.legs), is_guided(robot))
    return tuple(name for name, given in zip(PARTS, there, strict=True) if given)


def is_guided(robot: Robot) -> bool:
    """Whether any piston stands in bushings."""
    return any(leg.guide is not None for leg in robot.legs)


def _pair(system: System, q: Array, name: str) -> Array:
    """Amplitudes of both directions, (..., legs, 2, k)."""
    shapes = system.kernel.shapes
    size = dict(shapes.layout)[f"{name}a"]
    return np.stack([q[..., shapes.index(f"{name}{way}") :][..., :size] for way in "ab"], axis=-2)


def _mouths(robot: Robot) -> Array:
    return np.array([leg.cylinder.mouth for leg in robot.legs])


def _lengths(robot: Robot) -> Array:
    """Of the cylinders that bend, and 1."""
    return np.where([leg.cylinder.section is not None for leg in robot.legs], _mouths(robot), 1.0)


def _tube(robot: Robot, system: System, q: Array, at: Array, derivative: int = 0) -> Array:
    """Displacement or slope by the cylinders' shapes at places ``at`` [m] from their joints, (..., legs, 2)."""
    basis = system.kernel.shapes.beam.cylinder
    if basis is None:
        return np.zeros((*q.shape[:-1], 2))
    length = _lengths(robot)
    values = np.moveaxis(basis.values(at / length, derivative), 0, -1) / length[:, None] ** derivative
    smooth = _pair(system, q, "k")[..., : basis.count]
    return np.einsum("...k,...dk->...d", np.broadcast_to(values, (*q.shape[:-1], basis.count)), smooth)


def _bent(robot: Robot, system: System, q: Array, at: Array) -> Array:
    """Displacement of the cylinders, with the kink that the heads make, Eq. (T25.19)."""
    found, basis = _tube(robot, system, q, np.maximum(at, 0.0)), system.kernel.shapes.beam.cylinder
    if basis is None or system.kernel.shapes.beam.guide is None:
        return found
    at, length, amplitude = np.maximum(at, 0.0), _lengths(robot), _pair(system, q, "k")[..., -1]
    eta = np.clip((_mouths(robot) - _overlaps(robot, system, q)) / length, LEAST, 1 - LEAST)
    share = np.stack([polyval(2 * eta - 1, row) for row in kink(basis)["share"]], axis=-1)
    smooth = (share * np.moveaxis(basis.values(at / length), 0, -1)).sum(axis=-1)
    shape = (np.maximum(at / length - eta, 0.0) ** 3 / 6 - smooth) / (eta * (1 - eta)) ** 2
    return found + shape[..., None] * amplitude


def tip_moves(robot: Robot, system: System, q: Array) -> dict[str, tuple[Array, Array]]:
    """Displacement and slope of the legs' tips by each of `PARTS`, (..., legs, 2) each, Eq. (T25.15).

    A cylinder that bends carries a straight piston through the places of its bushings, or a clamped one along its
    tangent at the mouth. What the piston leans off that is the guide's.
    """
    shapes, found, mouth = system.kernel.shapes, {}, _mouths(robot)
    free = (q[..., shapes.l_index] - mouth)[..., None]
    place, tangent = (_tube(robot, system, q, mouth, derivative) for derivative in (0, 1))
    slope = tangent
    if shapes.beam.guide is not None:
        overlap = _overlaps(robot, system, q)
        through = (place - _bent(robot, system, q, mouth - overlap)) / overlap[..., None]
        slope = np.where(np.array([leg.guide is not None for leg in robot.legs])[:, None], through, tangent)
        lean = _pair(system, q, "g")
        own = tangent + lean[..., 1] - slope
        found["guide"] = lean[..., 0] + free * own, own
    if shapes.beam.cylinder is not None:
        found["cylinder"] = place + free * slope, slope
    return found


def _overlaps(robot: Robot, system: System, q: Array) -> Array:
    """Distances of the bushings (..., legs) [m]."""
    ends = np.array([leg.cylinder.mouth + leg.piston.length for leg in robot.legs])
    return ends - q[..., system.kernel.shapes.l_index]


def off_axis(robot: Robot, system: System, q: Array, length: Array, stations: Array) -> Array:
    """Displacement of cylinders up to their mouths and of the line of the pistons beyond, (..., legs, 2, stations).

    ``length`` (legs,) of the legs, ``stations`` as shares of it; q (..., legs, n).
    """
    shapes, found = system.kernel.shapes, np.zeros((*q.shape[:-1], 2, stations.size))
    if shapes.beam.guide is None and shapes.beam.cylinder is None:
        return found
    mouth = _mouths(robot)
    place, slope = (_tube(robot, system, q, mouth, derivative) for derivative in (0, 1))
    if shapes.beam.guide is not None:
        lean = _pair(system, q, "g")
        place, slope = place + lean[..., 0], slope + lean[..., 1]
    for k, station in enumerate(stations):
        beyond = (station * length - mouth)[:, None]
        inside = _bent(robot, system, q, np.minimum(station * length, mouth))
        found[..., k] = np.where(beyond > 0, place + beyond * slope, inside)
    return found


def guide_results(robot: Robot, system: System, q: Array) -> dict[str, Array]:
    """Forces of the bushings' springs on the pistons, across the legs, and their overlap; of guided legs."""
    shapes, inner = system.kernel.shapes, system.kernel.shapes.beam.guide
    if inner is None:
        return {}
    guided, mouth = np.array([leg.guide is not None for leg in robot.legs]), _mouths(robot)
    overlap = _overlaps(robot, system, q)
    lean = _pair(system, q, "g")
    place, slope = lean[..., 0] + _tube(robot, system, q, mouth), lean[..., 1] + _tube(robot, system, q, mouth, 1)
    end = place - overlap[..., None] * slope - _bent(robot, system, q, mouth - overlap)  # (T25.1)
    if inner.count:
        end = end + _pair(system, q, "h") @ inner.tip
    stiffness = system.leg_p[:, columns(leg_parameters(shapes), "guide_stiffness")]
    force = -stiffness[..., None] * np.stack([lean[..., 0], end], axis=-2)
    return dict(zip(GUIDED, (force, np.where(guided, overlap, np.nan)), strict=True))


def bushing_words(force: Array, time: Array | None = None) -> str:
    """What glands and heads bear most, of forces (T, legs, 2) [N]; without ``time`` [s] of a single pose."""
    parts = []
    for k, name in enumerate(("glands", "heads")):
        at, leg = np.unravel_index(first_largest(force[..., k]), force.shape[:-1])
        when = "" if time is None else f" at t = {time[at]:.4g} s"
        parts.append(f"{name} bear up to {text(float(force[at, leg, k]), 'N')} across (leg {leg + 1}{when})")
    return f"The {', '.join(parts)}."
