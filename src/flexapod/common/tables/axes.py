"""Directions in words, as seen from a joint: tangential, radial, vertical; and the plane of a planar robot."""

from __future__ import annotations

from typing import Literal

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError

Plane = Literal["xy", "yz", "zx"]
NO_PLACE = "is not a direction here: the joint lies on the axis"
WORDS = ("tangential", "radial", "vertical")
_NEAR = 1e-12  # of the axis: a joint nearer to it has no radial direction


def plane_order(plane: str | None) -> tuple[int, int, int]:
    """Numbers of the two axes of a plane, in the order of its letters, and of its normal; without a plane x, y, z."""
    orders: dict[str | None, tuple[int, int, int]] = {"xy": (0, 1, 2), "yz": (1, 2, 0), "zx": (2, 0, 1)}
    return orders.get(plane, (0, 1, 2))


def normal_of(plane: str | None) -> Array:
    """The normal of a plane, (3,); without a plane z."""
    return np.eye(3)[plane_order(plane)[2]]


def axis_of(word: str, place: Array, normal: Array) -> Array | None:
    """The direction that a word means at a joint, a unit vector (3,).

    Parameters
    ----------
    word : {"tangential", "radial", "vertical"}
        Radial leads away from the axis through the origin along the normal, tangential is a quarter of a turn further;
        vertical is z.
    place : Array
        (3,) the joint [m].
    normal : Array
        (3,) unit vector.

    Returns
    -------
    Array or None
        None if the joint lies on that axis.
    """
    if word == "vertical":
        return np.array([0.0, 0.0, 1.0])
    radial = place - (place @ normal) * normal
    size = float(np.linalg.norm(radial))
    if size <= _NEAR * max(1.0, float(np.linalg.norm(place))):
        return None
    return radial / size if word == "radial" else np.cross(normal, radial / size)


def word_of(axis: Array, place: Array, normal: Array) -> str | None:
    """The word for a direction at a joint, or None."""
    found = ((word, axis_of(word, place, normal)) for word in WORDS)
    return next((word for word, meant in found if meant is not None and np.array_equal(axis, meant)), None)


def within_a_turn(angles: Array | float, key: str) -> None:
    """Refuse angles [rad] of more than a turn under `key`: they are degrees without their unit."""
    if np.abs(angles).max(initial=0.0) > 2 * np.pi:
        raise InputError(
            "is out of range",
            key=key,
            value=np.asarray(angles).tolist(),
            allowed="-2 pi to 2 pi rad",
            next_step='A number without a unit is in rad; write degrees as "120 deg"',
        )


def diagonal(value: object) -> object:
    """A diagonal matrix as its diagonal."""
    if not isinstance(value, np.ndarray) or value.ndim != 2:
        return value
    return np.diag(value) if not (value - np.diag(np.diag(value))).any() else value
