"""Elongations of the legs by part, Eqs. (T15.3) and (T15.14), and deflections of guides and cylinders.

Guides and cylinders that bend move the tips of the legs; forces of the bushings follow.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial.polynomial import polyval

from flexapod.analysis.results.element_outputs import columns_by_name
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.element import Physics, SeriesSprings
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.kink import LEAST, kink
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.springs import Place, Spring, servo_spring, springs_along
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Robot, ServoDrive
from flexapod.solve.system import System

PARTS = ("cylinder", "guide")
GUIDED = ("guide_force", "guide_overlap")
"""Variables of guided legs."""


def guide_part_names(robot: Robot) -> tuple[str, ...]:
    """Names of those of `PARTS` that are compliant in any leg of a robot."""
    there = (any(leg.cylinder.section is not None for leg in robot.legs), is_guided(robot))
    return tuple(name for name, given in zip(PARTS, there, strict=True) if given)


def is_guided(robot: Robot) -> bool:
    """Test whether any leg guides its piston by bushings."""
    return any(leg.guide is not None for leg in robot.legs)


def _pair(system: System, q: Array, name: str) -> Array:
    """Amplitudes of both directions, (..., legs, 2, k)."""
    shapes = system.kernel.shapes
    size = dict(shapes.layout)[f"{name}a"]
    return np.stack([q[..., shapes.index(f"{name}{way}") :][..., :size] for way in "ab"], axis=-2)


def _mouths(robot: Robot) -> Array:
    return np.array([leg.cylinder.mouth for leg in robot.legs])


def _lengths(robot: Robot) -> Array:
    """Lengths of the cylinders that bend, 1 for the others, (legs,) [m]."""
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


def _cylinder_deflection(robot: Robot, system: System, q: Array, at: Array) -> Array:
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


def tip_displacements(robot: Robot, system: System, q: Array) -> dict[str, tuple[Array, Array]]:
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
        through = (place - _cylinder_deflection(robot, system, q, mouth - overlap)) / overlap[..., None]
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


def axis_deflections(robot: Robot, system: System, q: Array, length: Array, stations: Array) -> Array:
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
        inside = _cylinder_deflection(robot, system, q, np.minimum(station * length, mouth))
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
    end = place - overlap[..., None] * slope - _cylinder_deflection(robot, system, q, mouth - overlap)  # (T25.1)
    if inner.count:
        end = end + _pair(system, q, "h") @ inner.tip
    stiffness = system.leg_p[:, columns(leg_parameters(shapes), "guide_stiffness")]
    force = -stiffness[..., None] * np.stack([lean[..., 0], end], axis=-2)
    return dict(zip(GUIDED, (force, np.where(guided, overlap, np.nan)), strict=True))


def part_names(robot: Robot) -> tuple[str, ...]:
    """Names of the compliant parts of any leg, in their order: springs along it, cylinder, guide, turning nuts."""
    springs = dict.fromkeys(spring.name for leg in robot.legs for spring in springs_along(leg))
    turning = ("unkeyed",) if any(leg.turning for leg in robot.legs) else ()
    return tuple(dict.fromkeys([*springs, *guide_part_names(robot), *turning]))


def frame_names(robot: Robot) -> tuple[str, ...]:
    """Names of the mounts on which frames of a robot stand."""
    return tuple(name for name in ("platform_mount", "base_mount") if getattr(robot, name) is not None)


def elongations(
    robot: Robot,
    system: System,
    q: Array,
    places: Sequence[Place] = ("base", "nut", "platform"),
    played: Array | None = None,
) -> dict[str, Array]:
    """Elongation of the legs by each spring along them at some places, (..., legs) [m], by name.

    Springs in series, a servo's among them, share the elongation of their coordinate by their compliances at the leg's
    length. `played`: `gap_elongations`, where it is known.
    """
    shapes = system.kernel.shapes
    found = {name: np.zeros(q.shape[:-1]) for name in part_names(robot)}
    length, played = q[..., shapes.l_index], gap_elongations(system, q) if played is None else played
    for i, leg in enumerate(robot.legs):
        springs = springs_along(leg)
        if leg.gives and isinstance(leg.drive, ServoDrive):
            springs.append(servo_spring(leg.drive.stiffness, leg.drive.damping))
        gives = _gives(system, q[..., i, :])
        if leg.turning and "nut" in places:  # (T23.41)
            found["unkeyed"][..., i] = leg.turning * q[..., i, shapes.index("spin")]
            gives["nut"] = gives["nut"] - found["unkeyed"][..., i]
        if "nut" in gives:
            gives["nut"] = gives["nut"] - played[..., i]
        for at, give in gives.items():
            if at not in places:
                continue
            here = [spring for spring in springs if spring.at == at]
            for spring, share in zip(here, _shares(here, length[..., i]), strict=True):
                if spring.name != "drive":
                    found[spring.name][..., i] += share * give
    return found


def gap_elongations(system: System, q: Array) -> Array:
    """Elongation of legs by their play where it is a gap, at most half of it, (..., legs) [m], Eq. (T16.26)."""
    shapes = system.kernel.shapes
    if not has_gap(system):
        return np.zeros(q.shape[:-1])
    p, now = columns_by_name(system.leg_p, leg_parameters(shapes)), columns_by_name(q, shapes.layout)
    still, springs = columns_by_name(np.zeros_like(q), shapes.layout), SeriesSprings(1.0, now.l, 0.0)
    for element in shapes.elements:
        springs = element.in_series(springs, p, now, still)
    apart = past = now.r - springs.nut
    for element in shapes.elements:
        past, _ = element.gap_deflection(past, still.r, p)
    return past - apart


def has_gap(system: System) -> bool:
    """Test whether an element of the legs makes a gap of the play before their strokes."""
    shapes = system.kernel.shapes
    return shapes.has("r") and any(map(_opens, shapes.elements))


def _opens(slot: Slot) -> bool:
    return slot.kind.gap_deflection.__func__ is not Physics.gap_deflection.__func__  # type: ignore[attr-defined]


def _gives(system: System, q: Array) -> dict[Place, Array]:
    """Elongation of a leg by the springs at each of the three places, (...,) [m], by place."""
    shapes = system.kernel.shapes
    places: dict[Place, str] = {} if shapes.holds(Flexures) else {"base": "u3", "platform": "e3"}
    found: dict[Place, Array] = {at: q[..., shapes.index(name)] for at, name in places.items() if shapes.has(name)}
    if shapes.has("r"):
        found["nut"] = q[..., shapes.l_index] - q[..., shapes.index("r")]
    return found


def _shares(springs: list[Spring], length: Array) -> list[Array]:
    softness = [spring.at_length(length) for spring in springs]
    whole = sum(softness)
    return [x / whole for x in softness]
