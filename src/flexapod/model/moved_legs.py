"""Legs whose joints are elsewhere: directions that were given by words are those that the words mean there."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.axes import NO_PLACE, axis_of, normal_of
from flexapod.common.tables.base import array_of
from flexapod.model.leg.joint import Carriage, Joint, arm_of
from flexapod.model.leg.leg import Leg


def moved_legs(*, legs: Any, base_joints: Any, platform_joints: Any, plane: Any = None, **_: Any) -> Any:
    """Legs of a robot with these fields, at its joints; as they are where one of these is not what a robot may have.

    Raises
    ------
    InputError
        A word means nothing at a joint: it lies on the axis.
    """
    try:
        base, platform = (array_of((None, 3))(places) for places in (base_joints, platform_joints))
    except ValueError:
        return legs
    if not len(legs) == len(base) == len(platform) or not all(isinstance(leg, Leg) for leg in legs):
        return legs
    normal = normal_of(plane if isinstance(plane, str) else None)
    return tuple(_moved(leg, one, other, normal) for leg, one, other in zip(legs, base, platform, strict=True))


def _moved(leg: Leg, base: Array, platform: Array, normal: Array) -> Leg:
    found: dict[str, object] = {}
    for name, place in (("base_joint", base), ("carriage", base), ("platform_joint", platform)):
        part: Joint | Carriage | None = getattr(leg, name)
        axis = None if part is None else _meant(part, place, normal)
        if part is not None and part.source_table is not None and axis is not None:
            arm = _arm(part, axis, place, normal) if isinstance(part, Carriage) else {}
            found[name] = part.replace(axis=axis, **arm).attach_source(part.source_table)  # the words are the same
    return leg.replace(**found) if found else leg


def _meant(part: Joint | Carriage, place: Array, normal: Array) -> Array | None:
    """The direction at a place of an axis that was given by a word, and is still that; None of another one."""
    key = part.kind if isinstance(part, Carriage) else "axis"
    if (
        part.source_table is None
        or "axis" in part.source_table.changed
        or not isinstance(part.source_table.data.get(key), str)
    ):
        return None
    found = axis_of(part.source_table.data[key], place, normal)
    if found is None:
        raise InputError(NO_PLACE, key=f"leg.{key}", value=part.source_table.data[key], allowed="a vector, or vertical")
    return found


def _arm(crank: Carriage, axis: Array, base: Array, normal: Array) -> dict[str, Array]:
    """The arm of a crank that was given by its radius, and is still that."""
    if crank.arm is None or crank.source_table is None or "radius" not in crank.source_table.data:
        return {}
    return (
        {}
        if "arm" in crank.source_table.changed
        else {"arm": arm_of(float(np.linalg.norm(crank.arm)), axis, base, normal)}
    )
