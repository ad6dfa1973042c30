"""How far the parts between the ends of a leg give way, by name, Eqs. (T15.3) and (T15.14)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexapod.analysis.results.element_outputs import by_name
from flexapod.analysis.results.inside import part_names_inside
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.element import SeriesSprings
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.springs import Place, Spring, of_servo, springs_along
from flexapod.mechanics.leg.layout import leg_parameters
from flexapod.model import Robot, ServoDrive
from flexapod.solve.system import System

__all__ = ["elongations", "frame_names", "in_gap", "part_names"]


def part_names(robot: Robot) -> tuple[str, ...]:
    """Names of what gives way in any leg, in their order: springs along it, cylinder and guide; and turning nuts."""
    springs = dict.fromkeys(spring.name for leg in robot.legs for spring in springs_along(leg))
    turning = ("unkeyed",) if any(leg.turning for leg in robot.legs) else ()
    return tuple(dict.fromkeys([*springs, *part_names_inside(robot), *turning]))


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
    """What each spring along the legs at some places adds to their lengths, (..., legs) [m], by name.

    Springs in series, a servo's among them, share the elongation of their coordinate by their compliances at the leg's
    length. `played`: `in_gap`, where it is known.
    """
    shapes = system.kernel.shapes
    found = {name: np.zeros(q.shape[:-1]) for name in part_names(robot)}
    length, played = q[..., shapes.l_index], in_gap(system, q) if played is None else played
    for i, leg in enumerate(robot.legs):
        springs = springs_along(leg)
        if leg.gives and isinstance(leg.drive, ServoDrive):
            springs.append(of_servo(leg.drive.stiffness, leg.drive.damping))
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


def in_gap(system: System, q: Array) -> Array:
    """How far the play of legs that is a gap has let them go, (..., legs) [m], at most half of it; Eq. (T16.26)."""
    shapes = system.kernel.shapes
    if not shapes.has("r"):
        return np.zeros(q.shape[:-1])
    p, now = by_name(system.leg_p, leg_parameters(shapes)), by_name(q, shapes.layout)
    still, springs = by_name(np.zeros_like(q), shapes.layout), SeriesSprings(1.0, now.l, 0.0)
    for element in shapes.elements:
        springs = element.in_series(springs, p, now, still)
    apart = past = now.r - springs.nut
    for element in shapes.elements:
        past, _ = element.past(past, still.r, p)
    return past - apart


def _gives(system: System, q: Array) -> dict[Place, Array]:
    """What the springs at the three places add to a leg's length, (...,) [m], by place."""
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
