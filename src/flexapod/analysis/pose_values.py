"""Values of a map at a batch of poses: rigid measures, and those about the static equilibrium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import buckling_loads
from flexapod.analysis.checks.reachability import REACHED, Codes, leg_limits, rigid_codes, slider_limits
from flexapod.analysis.error_budget.rows import budget_rows_by_pose, names_of_rows
from flexapod.analysis.error_budget.rules import TERMS, Budget, error_terms
from flexapod.analysis.modes_at_poses import rest_codes
from flexapod.analysis.results.bodies import clearance, joint_angle_limits, joint_angles
from flexapod.common.arrays import Array, Mask
from flexapod.common.ranking import EQUALS, is_largest
from flexapod.kinematics.rotations import matrix
from flexapod.solve.batch import port_forces
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import modes_of
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.static_loads import drive_values
from flexapod.solve.statics.stiffness import compliance, displacement, stiffness_of, tool_motion

Values = dict[str, Array]


@dataclass(frozen=True, kw_only=True)
class PoseRequest:
    """Quantities that are computed at each pose.

    ``direction`` (3,) unit vector of the stiffness; ``acceleration`` (3,) [m/s^2], None:
    1 m/s^2 in whichever direction is worst; ``frequencies``: how many of the lowest;
    ``budget``: whether error budgets are; ``terms``: their terms by part as of `rules.error_terms`, and what the
    systematic ones add up to; ``compliance``: that of the tool along and about world axes.
    """

    direction: Array
    acceleration: Array | None
    frequencies: int
    budget: bool = False
    terms: bool = False
    compliance: bool = False


def batch_values(
    study: model.Study, elastic: ElasticRobot, rigid: kinematics.RigidPoses, wanted: PoseRequest
) -> tuple[Codes, Values]:
    """Codes (P,) and, of each variable, the values (P, ...) at the poses of a batch; NaN out of reach.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move, no compliance), or a pure force drive.
    """
    code = rigid_codes(rigid, from_home=True)
    within = np.flatnonzero(code == REACHED)
    home = kinematics.RigidPoses(rigid.robot, kinematics.home_pose(rigid.robot))  # for what it refuses, and shapes
    some = rigid.resting(within) if within.size else home
    locked = elastic.lock(some)
    modes = modes_of(locked)
    values = {
        "frequency": modes.frequency[:, : wanted.frequencies],
        **_elastic(locked, wanted),
        **{name: row[locked.at] for name, row in _rigid(some).items()},
    }
    if modes.growth is not None:
        values["loop_growth"] = modes.growth
    if wanted.budget or wanted.terms:
        values |= _budgets(study, locked, wanted)
    if within.size:
        code[within] = rest_codes(locked, modes)
    at, result = within[locked.at] if within.size else within, {}
    for name, rows in values.items():
        result[name] = np.full((len(code), *rows.shape[1:]), np.nan)
        result[name][at] = rows[: len(at)]
        result[name][code != REACHED] = np.nan
    return code, result


def _rigid(at: kinematics.RigidPoses) -> Values:
    """Margins of strokes, pistons and joints, and distance to a singularity, (P,)."""
    robot, path, found, (length, place, *_) = at.robot, at.poses, at.singularity, at.reach
    limits, mouth, piston = leg_limits(robot)
    ways = slider_limits(robot)
    stroke = np.minimum(length - limits[:, 0], limits[:, 1] - length)
    stroke = np.minimum(stroke, np.minimum(place - ways[:, 0], ways[:, 1] - place))
    inside = np.minimum(piston, mouth + piston - length)
    axes, largest = at.directions, joint_angle_limits(robot)
    turned = joint_angles(robot, axes, path.rotation)
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


def _elastic(locked: LockedPoses, wanted: PoseRequest) -> Values:
    """Stiffness, deviations and forces about the equilibria that were found, (p, ...)."""
    at, states = locked.rigid.resting(locked.at), locked.equilibria.states[locked.at]
    robot = at.robot
    whole = compliance(stiffness_of(robot, locked).total)
    give = whole[:, :3, :3]
    principal, axes = np.linalg.eigh(give)
    softest = axes[:, :, -1]
    sign = np.sign(
        np.take_along_axis(softest, is_largest(np.abs(softest), axis=1, same=EQUALS).argmax(axis=1)[:, None], axis=1)
    )
    tool = states.pose[:, :3] + matrix(states.pose[:, 3:]) @ (robot.tool - robot.com)
    sag = tool - at.poses.point(robot.tool)[0]
    force = _drive_forces(robot, locked)
    u = wanted.direction
    with np.errstate(divide="ignore"):  # out of its plane a planar robot does not give way
        stiffness = 1 / np.einsum("i,pij,j->p", u, give, u)  # (T7.18)
    more = {"compliance": np.einsum("pii->pi", whole)} if wanted.compliance else {}
    return more | {
        "stiffness": stiffness,
        "stiffness_least": 1 / principal[:, -1],
        "softest_direction": softest * sign,
        "static_deviation": sag,
        "static_deviation_size": np.linalg.norm(sag, axis=1),
        "dynamic_deviation": _dynamic(at, locked, wanted.acceleration),
        "actuator_force": force,
        "largest_force": np.abs(force).max(axis=1),
        "euler_share": _euler_share(at, locked, force),
    }


def _budgets(study: model.Study, locked: LockedPoses, wanted: PoseRequest) -> Values:
    """Worst case of the tool's place, and what each part does to it, (p, ...) [m], Eqs. (T17.6) and (T17.8)."""
    tables = [(table, whole) for table, whole, _ in budget_rows_by_pose(study, locked)]
    parts = names_of_rows(study)
    terms: Values = {}
    if wanted.terms:
        terms["error_terms"] = np.array([error_terms(table, parts) for table, _ in tables]).reshape(
            -1, len(TERMS), len(parts), 6
        )
        terms["systematic"] = np.array([whole for _, whole in tables]).reshape(-1, 6)
    if not wanted.budget:
        return terms
    found = [Budget(rows=table, whole={"systematic": whole}) for table, whole in tables]
    return terms | {
        "error_worst": np.array([float(np.linalg.norm(one.worst[:3])) for one in found]),
        "error_by_part": np.array([[one.sizes.get(part, np.nan) for part in parts] for one in found]).reshape(
            -1, len(parts)
        ),
    }


def _drive_forces(robot: model.Robot, locked: LockedPoses) -> Array:
    """Force of every drive at rest, (p, legs) [N, N m]: constraint, or given force and spring, Eq. (T8.8)."""
    part = locked.equilibria.states[locked.at], locked.command[locked.at], locked.acts.force[locked.at]
    return drive_values(locked.system, robot, port_forces(locked.system, *part))


def _euler_share(at: kinematics.RigidPoses, locked: LockedPoses, force: Array) -> Array:
    """Largest thrust of a leg over its Euler load (T8.11), (p,); 0 where no leg is pushed."""
    thrust = np.einsum("pli,pli->pl", locked.equilibria.states.lam[locked.at][..., :3], at.directions)
    along = np.array([leg.driven == "stroke" for leg in at.robot.legs])
    pushed = np.where(along, np.maximum(force, thrust), thrust)
    return np.maximum(pushed / buckling_loads(at.robot, at.reach.length), 0.0).max(axis=1)


def _dynamic(at: kinematics.RigidPoses, locked: LockedPoses, acceleration: Array | None) -> Array:
    """Deviation of the tool under the inertial forces of payload and legs, (p,) [m], Eq. (T7.19)."""
    answer = _answer(at, locked)  # of the tool, per m/s^2 along each axis
    if acceleration is None:
        return np.linalg.norm(answer, ord=2, axis=(1, 2))
    return np.linalg.norm(answer @ acceleration, axis=1)


def _answer(at: kinematics.RigidPoses, locked: LockedPoses) -> Array:
    """Displacement of the tool while the platform accelerates along x, y, z without turning, from rest, (p, 3, 3)."""
    robot, path = at.robot, at.poses
    zero, m = np.zeros((len(path), 3)), locked.m
    inertia, payload = [], []
    for unit in np.eye(3):
        moving = kinematics.Poses(
            position=path.position, rotation=path.rotation, velocity=zero, omega=zero, alpha=zero,
            acceleration=np.broadcast_to(unit, zero.shape),
        )  # fmt: skip
        rates = rigid_motion(locked.system, kinematics.RigidPoses(robot, moving))[1]
        inertia.append((m.M @ rates.v_dot[..., None])[..., 0])
        payload.append((m.payload_M[..., :6] @ rates.u_dot[..., None])[..., 0])
    y = displacement(locked, -np.stack(inertia, axis=-1), -np.stack(payload, axis=-1))
    return (tool_motion(robot, locked.equilibria.states.pose[locked.at]) @ y)[:, :3]
