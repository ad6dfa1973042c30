"""Elements from outside on trial in numbers, in a robot at home: what is none there is told with class and file."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.trial import refused
from flexapod.model import Robot
from flexapod.solve.batch import Rates, matrices_at_rest, residual
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.system import System

__all__ = ["try_elements"]

RATE = 1e-3  # m/s, 1/s: of all coordinates of legs that are tried in motion


def try_elements(robot: Robot, system: System) -> None:
    """Refuse elements with tables of their own whose equations are no number at home, at rest or in motion.

    Legs without the element are tried as well: they have its equations with the numbers of `Physics.absent`.

    Raises
    ------
    InputError
        With class and file, the leg, and which energy or force it is.
    """
    if not any(leg.elements for leg in robot.legs):
        return
    x, none = rigid_rest(system, robot, kinematics.home_pose(robot)), np.zeros(6)
    still = np.zeros((1, system.legs, system.ports.size))
    m = matrices_at_rest(system, x, none)
    found = [m.M, m.D, m.K]
    for rate in (0.0, RATE):
        v = np.full(x.q.shape, rate)
        rates = Rates(v=v, v_dot=np.zeros_like(v), u=np.zeros((1, 6)), u_dot=np.zeros((1, 6)))
        found.append(residual(system, x, still, still, none, rates)[0])
        bad = ~np.all([np.isfinite(part[0]).reshape(system.legs, -1).all(axis=1) for part in found], axis=0)
        for i in np.flatnonzero(bad):
            for slot, parts in _without_number(system, x.q[0, i], v[0, i], system.leg_p[i]):
                raise _refused(slot, robot, int(i), parts)


def _without_number(system: System, *values: Array) -> Iterator[tuple[Slot, list[str]]]:
    """Elements from outside with parts that are no number for coordinates, rates and parameters of a leg."""
    from flexapod.mechanics.leg.kernel_functions import parts_of_elements

    for slot, parts in parts_of_elements(system.kernel.shapes, values).items():
        if parts:
            yield slot, parts


def _refused(slot: Slot, robot: Robot, i: int, parts: list[str]) -> Exception:
    there = slot.of(robot.legs[i]) is not None
    hook = "energy" if {"kinetic", "gravity", "strain", "dissipation"} & set(parts) else "damping_force"
    which = f"of leg {i + 1} at home" if there else f"in leg {i + 1}, which is without it"
    names = ", ".join(parts)
    return refused(
        slot.kind, hook, f"{names}: {which} a value or a derivative is no number",
        allowed="what has finite values and first and second derivatives, at rest too",
        next_step=None if there else "Say numbers for a leg without it in `absent`: there they are 0 without one",
    )  # fmt: skip
