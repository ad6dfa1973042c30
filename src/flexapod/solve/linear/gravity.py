"""What a base that is accelerated does to a robot: gravity changed by as much, Eq. (T18.4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS, columns
from flexapod.solve.batch import RestStates, residual
from flexapod.solve.system import System

__all__ = ["gravity_forces"]


def gravity_forces(system: System, x: RestStates, command: Array, wrench: Array) -> Array:
    """Forces (P, size, 3) on all coordinates per unit acceleration of the base along x, y, z, Eq. (T18.4).

    In axes that move with the base it is gravity changed by the acceleration; residuals are linear in gravity.
    """

    def forces(gravity: Array) -> Array:
        legs, payload, _ = residual(_in_gravity(system, gravity), x, command, np.zeros_like(command), wrench)
        return np.concatenate([legs.reshape(len(x), system.legs * system.n), payload], axis=1)

    none = forces(np.zeros(3))
    return np.stack([forces(axis) - none for axis in np.eye(3)], axis=2)


def _in_gravity(system: System, gravity: Array) -> System:
    leg_p, payload_p = system.leg_p.copy(), system.payload_p.copy()
    leg_p[:, columns(LEG_PARAMETERS, "gravity")] = gravity
    payload_p[columns(PAYLOAD_PARAMETERS, "gravity")] = gravity
    return replace(system, leg_p=leg_p, payload_p=payload_p)
