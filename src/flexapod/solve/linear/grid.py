"""M, D, K, B, C on named motions at many poses at once: what is smooth from pose to pose, Eq. (T20.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.solve.linear.channels import PlantChannel
from flexapod.solve.linear.plant import Plant
from flexapod.solve.linear.second_order import SecondOrder, second_order
from flexapod.solve.statics.stiffness import tool_motion

__all__ = ["PoseMatrices", "grid_of"]


@dataclass(frozen=True, kw_only=True)
class PoseMatrices:
    """M z'' + D z' + K z = B u, y = C z at P poses; arrays with the pose first, ``motions`` by name.

    Motions of loops have no inertia; behind the ``free`` ones stand those that inputs impose, as commands: z'' = u.
    """

    motions: tuple[str, ...]
    free: int
    M: Array
    D: Array
    K: Array
    B: Array
    C: Array


def grid_of(
    plant: Plant, inputs: Sequence[PlantChannel], outputs: Sequence[PlantChannel], *, about: Array
) -> PoseMatrices:
    """The equations at all equilibria of a plant.

    Raises
    ------
    InputError
        Outputs that are no places.
    """
    second = second_order(plant, inputs, about=about)
    C = np.stack([_row(plant, second, channel) for channel in outputs], axis=1)
    return PoseMatrices(motions=second.names, free=second.free, M=second.M, D=second.D, K=second.K, B=second.F, C=C)


def _row(plant: Plant, second: SecondOrder, channel: PlantChannel) -> Array:
    """An output by motions, (P, d)."""
    system, flat = plant.system, second.flat
    hub = flat[:, system.legs * system.n :]
    if channel.group == "tool":
        return np.asarray((tool_motion(plant.robot, plant.x.pose)[:, channel.axis, None] @ hub)[:, 0])
    if channel.group == "com":
        return np.asarray(hub[:, channel.axis])
    if channel.group == "stroke":
        shapes = system.kernel.shapes
        at = shapes.index("chi") if plant.robot.legs[channel.leg].driven == "carriage" else shapes.l_index
        return np.asarray(flat[:, channel.leg * system.n + at])
    raise InputError(
        "is no place: at many poses outputs are places by motions", key="outputs", value=channel.name,
        allowed="tool, com, stroke", next_step="Take one pose at a time for forces and sensors",
    )  # fmt: skip
