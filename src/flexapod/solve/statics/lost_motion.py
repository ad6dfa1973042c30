"""Lost motion of a robot at rest by friction at its limits, Eqs. (T19.13)-(T19.15)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.robot import cache_per_robot
from flexapod.mechanics.elements.registry import kinds_of, slots_of
from flexapod.mechanics.elements.springs import springs_before_piston, twist_share
from flexapod.model import ForceDrive, Leg, Robot
from flexapod.solve.batch import matrices_at_rest
from flexapod.solve.friction import bristle_parameters, sliding_jacobian
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.stiffness import displacement, tool_motion


def reversal(locked: LockedPoses) -> dict[str, Array]:
    """Half the reversal error of the tool by friction, by place, (p, legs, 6) [m, rad], Eqs. (T19.13)-(T19.14).

    At the equilibria found; bounds, whichever way joints and drives slide. Empty without friction.
    """
    system, at = locked.system, locked.equilibria.states[locked.at]
    shapes, legs, found = system.kernel.shapes, system.legs, {}
    if not shapes.friction_parameters or any(basis.border.size for basis in locked.motions.bases):
        return found
    if locked.simulation.friction == "stuck":
        locked = replace(locked, m=matrices_at_rest(system, at, locked.acts.wrench))
    tool, rates, (p, force) = (
        tool_motion(locked.robot, at.pose),
        sliding_jacobian(system, at.q),
        bristle_parameters(system, at.lam),
    )
    limit, first = force * (1 + p[..., 3]), 0  # (T19.13)
    for slot, count in shapes.friction_elements:
        here = slice(first, first + count)
        loads = np.zeros((*at.q.shape, legs, count))
        for i in range(legs):
            loads[:, i, :, i] = (limit[:, i, here, None] * rates[:, i, here]).swapaxes(-1, -2)
        columns = legs * count
        moved = tool @ displacement(locked, loads.reshape(*at.q.shape, columns), np.zeros((len(tool), 6, columns)))
        each = np.moveaxis(moved.reshape(len(tool), 6, legs, count), 1, 2)
        together = p[:, here, 7][:, :1] > 0  # (T19.14)
        found[slot.rubs_at] = np.where(together, np.sqrt((each**2).sum(axis=-1)), np.abs(each).sum(axis=-1))
        first += count
    return found


@cache_per_robot
def places_with_friction(robot: Robot) -> tuple[str, ...]:
    """Names of the places with friction in a robot, in the order of `reversal`."""
    kinds = (kind for kind in kinds_of(robot.legs) if any(map(kind.has_friction, robot.legs)))
    return tuple(slot.rubs_at for kind in kinds for slot in slots_of(kind, robot.legs))


def before_friction(leg: Leg, length: Array) -> dict[str, Array]:
    """Compliance [m/N] by which the friction of a leg's drive makes each part before it yield, Eq. (T19.15).

    "drive": the loop, servo or feedback. None where the stroke is held.
    """
    if leg.drive.friction is None or (leg.drive.holds and leg.holds_stroke):
        return {}
    found = {spring.name: spring.at_length(length) for spring in springs_before_piston(leg)}
    loop = found.pop("drive", None)
    if isinstance(leg.drive, ForceDrive) and leg.drive.feedback is not None and leg.drive.feedback.stiffness:
        loop = np.full_like(length, 1 / leg.drive.feedback.stiffness)
    if leg.screw is not None:  # the twist alone gives; what all have together is shared by compliance
        share = twist_share(leg, length) if found else 0.0
        found = {name: softness * share for name, softness in found.items()}
    return found if loop is None else found | {"drive": loop}


def lost_motion(robot: Robot, length: Array) -> Array:
    """Half of what each leg of a length (legs,) [m] lags by the friction of its drive, to and fro, Eq. (T19.15)."""
    found = np.zeros(robot.count)
    for i, leg in enumerate(robot.legs):
        if leg.drive.friction is not None:
            force = leg.drive.friction.static / (1.0 if leg.screw is None else leg.screw.per_turn)
            found[i] = force * np.sum(list(before_friction(leg, length[i : i + 1]).values()))
    return found
