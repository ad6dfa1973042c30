"""Friction of drives that slide steadily, as catalogues have it."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.model import ScrewFriction, StrokeFriction

__all__ = ["steady_friction"]


def steady_friction(friction: ScrewFriction | StrokeFriction, rate: Array) -> Array:
    """Torque of a screw [N m] or force of a stroke [N] at a rate of sliding [rad/s, m/s], with its sign, Eq. (T19.19).

    Nothing where it rests.
    """
    sliding, _, _, excess, slower, viscous, _ = friction.numbers
    return np.asarray(np.sign(rate) * sliding * (1 + excess * np.exp(-((rate * slower) ** 2))) + viscous * rate)
