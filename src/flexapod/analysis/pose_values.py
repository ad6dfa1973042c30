"""What a map shows of the poses of a batch: rigid measures, and those about the static equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import buckling_loads
from flexapod.analysis.checks.reachability import REACHED, Codes, leg_limits, rigid_codes, slider_limits
from flexapod.analysis.error_budget.rows import names_of_rows, rows_of_poses
from flexapod.analysis.error_budget.rules import Budget
from flexapod.analysis.modes_at_poses import codes_at_rest, poses_of
from flexapod.analysis.results.bodies import clearance, largest_turns, turns
from flexapod.common.arrays import Array, Mask
from flexapod.common.ranking import EQUALS, alike
from flexapod.kinematics.rotations import matrix
from flexapod.solve.batch import port_forces
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modes import modes_of
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.static_loads import at_drives
from flexapod.solve.statics.stiffness import compliance, displacement, stiffness_of, tool_motion

Values = dict[str, Array]


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What is asked of each pose.

    ``direction`` (3,) unit vector of the stiffness; ``acceleration`` (3,) [m/s^2], None:
    1 m/s^2 in whichever direction is worst; ``frequencies``: how many of the lowest;
    ``budget``: whether error budgets are.
    """

    direction: Array
    acceleration: Array | None
    frequencies: int
    budget: bool = False


def batch_values(study: model.Study, path: kinematics.Poses, wanted: Wanted) -> tuple[Codes, Values]:
    """Codes (P,) and, of each variable, the values (P, ...) at the poses of a batch; NaN out of reach.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move, no compliance), or a pure force drive.
    """
    code = rigid_codes(study.robot, path, from_home=True)
    within = np.flatnonzero(code == REACHED)
    some = (
        poses_of(path, within) if within.size else kinematics.home_pose(study.robot)
    )  # for what it refuses, and shapes
    locked = locked_poses(study.robot, study.simulation, some, study.load)
    modes = modes_of(locked)
    values = {
        "frequency": modes.frequency[:, : wanted.frequencies],
        **_elastic(study.robot, some, locked, wanted),
        **{name: row[locked.at] for name, row in _rigid(study.robot, some).items()},
    }
    if modes.growth is not None:
        values["loop_growth"] = modes.growth
    if wanted.budget:
        values |= _budgets(study, locked)
    if within.size:
        code[within] = codes_at_rest(locked, modes)
    at, result = within[locked.at] if within.size else within, {}
    for name, rows in values.items():
        result[name] = np.full((len(path), *rows.shape[1:]), np.nan)
        result[name][at] = rows[: len(at)]
        result[name][code != REACHED] = np.nan
    return code, result


def _rigid(robot: model.Robot, path: kinematics.Poses) -> Values:
    """Margins of strokes, pistons and joints, and distance to a singularity, (P,)."""
    found, (length, place, *_) = kinematics.singularity(robot, path), kinematics.reach(robot, path)
    limits, mouth, piston = leg_limits(robot)
    ways = slider_limits(robot)
    stroke = np.minimum(length - limits[:, 0], limits[:, 1] - length)
    stroke = np.minimum(stroke, np.minimum(place - ways[:, 0], ways[:, 1] - place))
    inside = np.minimum(piston, mouth + piston - length)
    axes, largest = kinematics.leg_axes(robot, path), largest_turns(robot)
    turned = turns(robot, axes, path.rotation)
    nearest = clearance(robot, path.place(robot.platform_joints), axes, length)
    limited = np.isfinite(largest)
    margin = {"joint_margin": (largest - turned)[:, limited].min(axis=1)} if limited.any() else {}
    return margin | {
        "condition": found.condition,
        "smallest_singular_value": found.smallest_singular_value,
        "stroke_margin": _least_where(np.isfinite(limits[:, 1]) | np.isfinite(ways[:, 1]), stroke),
        "guided_length": _least_where(mouth > 0, inside),
        "base_joint_angle": turned[..., 0].max(axis=1),
        "platform_joint_angle": turned[..., 1].max(axis=1),
        "leg_clearance": np.full(len(path), np.nan) if nearest is None else nearest.gap,
        "nearest_legs": np.full((len(path), 2), np.nan) if nearest is None else nearest.legs + 1.0,
    }


def _least_where(legs: Mask, values: Array) -> Array:
    """Least value of the legs that count, (P,); NaN where none does."""
    return values[:, legs].min(axis=1) if legs.any() else np.full(len(values), np.nan)


def _elastic(robot: model.Robot, path: kinematics.Poses, locked: LockedPoses, wanted: Wanted) -> Values:
    """Stiffness, deviations and forces about the equilibria that were found, (p, ...)."""
    rigid_pose, states = poses_of(path, locked.at), locked.equilibria.states[locked.at]
    give = compliance(stiffness_of(robot, locked).total)[:, :3, :3]
    principal, axes = np.linalg.eigh(give)
    softest = axes[:, :, -1]
    sign = np.sign(
        np.take_along_axis(softest, alike(np.abs(softest), axis=1, same=EQUALS).argmax(axis=1)[:, None], axis=1)
    )
    tool = states.pose[:, :3] + matrix(states.pose[:, 3:]) @ (robot.tool - robot.com)
    sag = tool - rigid_pose.point(robot.tool)[0]
    force = _drive_forces(robot, locked)
    u = wanted.direction
    with np.errstate(divide="ignore"):  # out of its plane a planar robot does not give way
        stiffness = 1 / np.einsum("i,pij,j->p", u, give, u)  # (T7.18)
    return {
        "stiffness": stiffness,
        "stiffness_least": 1 / principal[:, -1],
        "softest_direction": softest * sign,
        "static_deviation": sag,
        "static_deviation_size": np.linalg.norm(sag, axis=1),
        "dynamic_deviation": _dynamic(robot, rigid_pose, locked, wanted.acceleration),
        "actuator_force": force,
        "largest_force": np.abs(force).max(axis=1),
        "euler_share": _euler_share(robot, rigid_pose, locked, force),
    }


def _budgets(study: model.Study, locked: LockedPoses) -> Values:
    """Worst case of the tool's place, and what each part does to it, (p, ...) [m], Eqs. (T17.6) and (T17.8)."""
    found = [Budget(rows=table, whole={"systematic": whole}) for table, whole, _ in rows_of_poses(study, locked)]
    parts = names_of_rows(study)
    return {
        "error_worst": np.array([float(np.linalg.norm(one.worst[:3])) for one in found]),
        "error_by_part": np.array([[one.sizes.get(part, np.nan) for part in parts] for one in found]).reshape(
            -1, len(parts)
        ),
    }


def _drive_forces(robot: model.Robot, locked: LockedPoses) -> Array:
    """Force of every drive at rest, (p, legs) [N, N m]: constraint, or given force and spring, Eq. (T8.8)."""
    part = locked.equilibria.states[locked.at], locked.command[locked.at], locked.acts.force[locked.at]
    return at_drives(locked.system, robot, port_forces(locked.system, *part))


def _euler_share(robot: model.Robot, path: kinematics.Poses, locked: LockedPoses, force: Array) -> Array:
    """Largest thrust of a leg over its Euler load (T8.11), (p,); 0 where no leg is pushed."""
    thrust = np.einsum(
        "pli,pli->pl", locked.equilibria.states.lam[locked.at][..., :3], kinematics.leg_axes(robot, path)
    )
    along = np.array([leg.driven == "stroke" for leg in robot.legs])
    pushed, length = np.where(along, np.maximum(force, thrust), thrust), kinematics.reach(robot, path).length
    return np.maximum(pushed / buckling_loads(robot, length), 0.0).max(axis=1)


def _dynamic(robot: model.Robot, path: kinematics.Poses, locked: LockedPoses, acceleration: Array | None) -> Array:
    """Deviation of the tool under the inertial forces of payload and legs, (p,) [m], Eq. (T7.19)."""
    answer = _answer(robot, path, locked)  # of the tool, per m/s^2 along each axis
    if acceleration is None:
        return np.linalg.norm(answer, ord=2, axis=(1, 2))
    return np.linalg.norm(answer @ acceleration, axis=1)


def _answer(robot: model.Robot, path: kinematics.Poses, locked: LockedPoses) -> Array:
    """Displacement of the tool while the platform accelerates along x, y, z without turning, from rest, (p, 3, 3)."""
    zero, m = np.zeros((len(path), 3)), locked.m
    inertia, payload = [], []
    for unit in np.eye(3):
        moving = kinematics.Poses(
            position=path.position, rotation=path.rotation, velocity=zero, omega=zero, alpha=zero,
            acceleration=np.broadcast_to(unit, zero.shape),
        )  # fmt: skip
        rates = rigid_motion(locked.system, robot, moving)[1]
        inertia.append((m.M @ rates.v_dot[..., None])[..., 0])
        payload.append((m.payload_M[..., :6] @ rates.u_dot[..., None])[..., 0])
    y = displacement(locked, -np.stack(inertia, axis=-1), -np.stack(payload, axis=-1))
    return (tool_motion(robot, locked.equilibria.states.pose[locked.at]) @ y)[:, :3]
