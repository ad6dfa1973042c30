"""Errors of the machine as built and warm at the tool, part by part, to first order."""

from __future__ import annotations

import numpy as np

from flexapod import rigid
from flexapod.model import Robot
from flexapod.study.accuracy.sensitivity import Sensitivity
from flexapod.typing import Array

__all__ = ["systematic"]


def systematic(robot: Robot, at: Sensitivity, t: float = 0.0) -> dict[str, Array]:
    """Displacement and rotation of the tool by part and leg, (n, 6), at the first pose and an instant [s]."""
    found, still = {}, np.zeros_like(at.q[:1])
    for part in rigid.built_parts(robot):
        size = part.size(np.array([t])).position[0, :, None]
        more = rigid.added(part, np.array([t]), rigid.Law(at.q[:1], still, still)).position[0]
        found[part.name] = (
            np.einsum("nj,njx->nx", size * part.base, at.base[0])
            + np.einsum("nj,njx->nx", size * part.platform, at.platform[0])
            + np.einsum("nk,nkx->nx", more, at.coordinate[0])
        )
    return found
