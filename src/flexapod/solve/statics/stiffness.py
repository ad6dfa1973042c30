"""Stiffness at the tool and the legs' shares in it, Eqs. (T7.6)-(T7.8)."""

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import matrix
from flexapod.mechanics.shapes.beam_functions import check_finite
from flexapod.model import Robot
from flexapod.solve.saddle_point import inverse_each, solve_each
from flexapod.solve.statics.equilibrium import Equilibrium
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.reduction import reduced_legs
from flexapod.solve.system import System


@dataclass(frozen=True, kw_only=True)
class Stiffness:
    """Stiffness at the tool in world axes, [N/m, N, N m/rad], at one pose or, with a first axis more, at several.

    ``total`` (6, 6) is the sum of ``legs`` (legs, 6, 6), the share of each leg, and ``load`` (6, 6), what turning
    the joint forces adds; its diagonal is infinite where something holds the platform itself.
    """

    total: Array
    legs: Array
    load: Array


@dataclass(frozen=True, kw_only=True)
class PoseStiffness(Stiffness):
    """Stiffness at one pose, and the equilibrium that it is about."""

    equilibrium: Equilibrium
    system: System


def stiffness_of(robot: Robot, locked: LockedPoses) -> Stiffness:
    """Stiffness at every equilibrium that was found.

    Raises
    ------
    InputError
        Legs on prescribed strokes that cannot stretch: no compliance.
    """
    system, m, free = locked.system, locked.m, locked.system.hub_free
    _refuse_rigid(locked)
    border = system.border
    legs = np.zeros(
        (len(locked.at), system.legs, 6 + system.shared_coordinates.size, 6 + system.shared_coordinates.size)
    )
    for b in locked.motions.bases:  # (T7.6)  joint forces that a unit step of the payload meets, legs eliminated
        B, C, own = reduced_legs(system, b, m)
        legs[:, b.legs[:, None, None], border[:, None], border] = own - C.swapaxes(-1, -2) @ solve_each(B, C)
    motion = tool_motion(robot, locked.equilibria.states[locked.at].pose)
    back = np.zeros_like(motion)
    back[:, free[:, None], free] = np.linalg.inv(motion[:, free[:, None], free])
    parts = _with_mounts(system, np.concatenate([legs, m.payload_K[:, None]], axis=1))
    at_tool = back.swapaxes(-1, -2)[:, None] @ parts @ back[:, None]  # (T7.8)
    total, held = at_tool.sum(axis=1), np.flatnonzero(system.hub_held)
    total[:, held, held] = np.inf
    return Stiffness(total=total, legs=at_tool[:, :-1], load=at_tool[:, -1])


def _with_mounts(system: System, parts: Array) -> Array:
    """Shares (p, any, 6, 6) in the stiffness against steps of the payload that plates on mounts follow, Eq. (T24.7)."""
    if not system.shared_coordinates.size:
        return parts
    whole = parts.sum(axis=1)
    follow = np.zeros((len(parts), parts.shape[-1], 6))
    follow[:, :6] = np.eye(6)
    follow[:, 6:] = -np.linalg.solve(whole[:, 6:, 6:], whole[:, 6:, :6])
    return np.asarray(follow.swapaxes(1, 2)[:, None] @ parts @ follow[:, None], dtype=np.float64)


def _refuse_rigid(locked: LockedPoses) -> None:
    """Raise InputError where legs are not compliant to the payload, or nothing but the base holds it."""
    if locked.system.hub_held.all():
        raise InputError(
            "leaves no stiffness to ask for: the platform does not move",
            key="platform.fixed",
            value=True,
            allowed="a platform that the legs carry",
            next_step="`modes` shows the legs of a fixed platform",
        )
    shapes, held = locked.system.kernel.shapes, locked.system.held
    rigid = [shapes.l_index, *(shapes.index(name) for name in ("u3", "e3") if shapes.has(name))]
    cannot_stretch = shapes.beam.axial.count == 0 and bool(held[:, rigid].all(axis=1).any())
    if cannot_stretch or any(b.border.size for b in locked.motions.bases):
        raise InputError(
            "makes the robot infinitely stiff" + ("" if cannot_stretch else ", across its hinges at least"),
            key="simulation.fidelity",
            value=locked.simulation.fidelity,
            allowed='"lumped", or a bending fidelity with at least one axial shape'
            if cannot_stretch
            else "a bending fidelity with at least one axial shape",
        )


def displacement(locked: LockedPoses, loads: Array, on_payload: Array) -> Array:
    """Steps of the payload (p, 6, k) by k loads (p, legs, n, k) and (p, 6, k), of legs that are compliant.

    Behind the loads on the payload may stand those on the coordinates that legs share.
    """
    system, m, free = locked.system, locked.m, locked.system.border
    S = m.payload_K[:, free[:, None], free]
    side = np.zeros((len(on_payload), 6 + system.shared_coordinates.size, on_payload.shape[2]))
    side[:, : on_payload.shape[1]] = on_payload
    side = side[:, free]
    for b in locked.motions.bases:
        B, C, own = reduced_legs(system, b, m)
        f, width = loads[:, b.legs], C.shape[-1]
        z = solve_each(B, np.concatenate([C, b.N.swapaxes(-1, -2) @ f], axis=-1))
        less = C.swapaxes(-1, -2) @ z
        S = S + (own - less[..., :width]).sum(axis=1)
        side = side + (b.Y.swapaxes(-1, -2) @ f - less[..., width:]).sum(axis=1)
    y = np.zeros((len(side), 6 + system.shared_coordinates.size, side.shape[2]))
    y[:, free] = solve_each(S, side)
    return y[:, :6]


def compliance(total: Array) -> Array:
    """Inverses of stiffness matrices (p, 6, 6), symmetric; zero where a diagonal is infinite.

    Raises
    ------
    ComputationError
        A matrix is singular, or a number in it is not finite.
    """
    free = np.flatnonzero(~np.isposinf(np.diagonal(total, axis1=1, axis2=2)).any(axis=0))
    part, found = total[:, free[:, None], free], np.zeros_like(total)
    inverse = inverse_each(part)
    check_finite(part, inverse)
    found[:, free[:, None], free] = 0.5 * (inverse + inverse.swapaxes(-1, -2))
    return found


def tool_motion(robot: Robot, pose: Array) -> Array:
    """Tool displacement and rotation (world) per payload step (dx, theta), (P, 6, 6), at poses (P, 7), Eq. (T7.7)."""
    R, r = matrix(pose[:, 3:]), np.zeros(3) if robot.payload is None else robot.payload.tool - robot.payload.com
    cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    motion = np.zeros((len(pose), 6, 6))
    motion[:, :3, :3], motion[:, :3, 3:], motion[:, 3:, 3:] = np.eye(3), -R @ cross, R
    return motion
