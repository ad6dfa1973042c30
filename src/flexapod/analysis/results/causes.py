"""The deviation of the payload by cause, Eqs. (T8.1)-(T8.8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod import kinematics
from flexapod.analysis.results.cause_labels import CAUSES
from flexapod.analysis.results.elongations import (
    elongations,
    frame_names,
    gap_elongations,
    has_gap,
    part_names,
    tip_displacements,
)
from flexapod.analysis.results.legs import stretch
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.closures import Task, close_nearby
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, FREE, Limbs
from flexapod.kinematics.robot import cache_per_robot
from flexapod.kinematics.screws import screws
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.springs import Place
from flexapod.model import Robot
from flexapod.solve.batch import RestStates
from flexapod.solve.frames import plate_frames
from flexapod.solve.statics import cause_rows
from flexapod.solve.statics.ideal_robot import is_hexapod
from flexapod.solve.statics.lost_motion import before_friction, places_with_friction
from flexapod.solve.system import System

CHI, L = COORDINATES.index("chi"), COORDINATES.index("l")


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Errors of the coordinates that drives and joints hold, by cause, each (T, legs, 8) [m, rad]: `COORDINATES`.

    Of a leg UPS that is its length. They add up to what straight legs would need to reach the flexible platform, less
    what they have on the rigid path, exactly. `by_cause`: in the order of `cause_names`.
    """

    by_cause: Mapping[str, Array]

    @property
    def total(self) -> Array:
        """Their sum, Eq. (T8.5)."""
        return np.sum(list(self.by_cause.values()), axis=0)

    @property
    def cause_array(self) -> Array:
        """The causes in their order, (T, causes, legs, 8)."""
        return np.stack(list(self.by_cause.values()), axis=1)


@cache_per_robot
def cause_names(robot: Robot) -> tuple[str, ...]:
    """Names of all causes of deviation in a robot: pistons, drives, compliant parts, differences from nominal."""
    rubs = ("friction",) * ("drive" in places_with_friction(robot))
    built = dict.fromkeys(part.cause for part in kinematics.built_parts(robot))
    return (*CAUSES, *part_names(robot), *rubs, *frame_names(robot), *built)


def errors_of(system: System, path: RigidPath, record: Record | RestStates) -> Errors:
    """Errors by cause along a recorded path, or at rest at its instants, Eqs. (T8.2)-(T8.4), (T15.14)."""
    robot, shapes = path.robot, system.kernel.shapes
    found = kinematics.rigid_limbs(robot)
    q = np.zeros((*record.q.shape[:2], len(COORDINATES)))
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            q[..., k] = record.q[..., shapes.index(name)]
    command = np.stack([path.legs.coordinate(name)[0] for name in COORDINATES], axis=-1)
    (_, *at), *frames = plate_frames(system, robot, record.q, record.pose)
    before, built = _straight(robot, found, at, q), _built(path, command)
    more, done = {}, ()
    for name, *at in frames:  # frame after frame to where the legs have it
        after = _straight(robot, found, at, q)
        more[name], before = before - after, after  # (T24.9)
    for name, (parts, longer) in built.items():  # joint after joint to its real place
        done, after = (*done, *parts), before
        if any(part.base.any() or part.platform.any() for part in parts):
            after = _straight(robot, kinematics.built_limbs(robot, found, done), at, q)
        more[name], before = before - after + longer, after  # (T16.7)
    counts, own, axial = found.given, command.copy(), np.zeros_like(q)
    own[..., (CHI, L)] = q[..., (CHI, L)]
    axial[..., L] = stretch(shapes, record.q)  # (T8.2)
    bending, drive = before - (own + axial), own - command  # (T8.3)-(T8.4)
    for _, longer in built.values():
        drive = drive - longer
    causes: dict[str, Array] = dict(zip(CAUSES, (axial, bending, drive), strict=True))
    behind: tuple[tuple[Sequence[Place], Array], ...] = ((("nut",), drive), (("base", "platform"), bending))
    inside = {
        place: np.array([leg.closed_about == place for leg in robot.legs]) for place in ("stroke", "joint-to-joint")
    }
    ends = inside["joint-to-joint"]  # (T23.56)
    played = gap_elongations(system, record.q)
    drive[..., L] += axial[..., L] * ends
    axial[..., L] *= ~ends
    for places, whole in behind:  # (T15.14)
        for name, give in elongations(robot, system, record.q, places, played).items():
            seen = ends if whole is bending else ends | inside["stroke"]
            if name not in causes:
                causes[name] = np.zeros(q.shape)
            causes[name][..., L] += give * ~seen
            whole[..., L] -= give
            drive[..., L] += give * seen
    if "drive" in places_with_friction(robot):
        _of_friction(robot, system, record, causes)
    for name, error in _across(robot, found, system, record, q).items():
        causes[name], bending[:] = causes[name] + error, bending - error
    return Errors(by_cause={name: np.where(counts, part, 0.0) for name, part in (causes | more).items()})


def _of_friction(robot: Robot, system: System, record: Record | RestStates, causes: dict[str, Array]) -> None:
    """Move elongations by friction of the drives from the parts before it to a cause of its own, Eq. (T19.17)."""
    causes["friction"] = np.zeros_like(causes["drive"])
    if isinstance(record, RestStates):  # bristles are straight
        return
    length = record.q[..., system.kernel.shapes.l_index]
    for i, leg in enumerate(robot.legs):
        for name, softness in before_friction(leg, length[:, i]).items():
            lag = record.friction[:, i, -1] * softness
            causes[name][:, i, L] += lag
            causes["friction"][:, i, L] -= lag


def _built(path: RigidPath, command: Array) -> dict[str, tuple[tuple[kinematics.BuiltPart, ...], Array]]:
    """Differences from nominal by cause, and their change of the commanded coordinates, (T, legs, 8)."""
    robot, still, t = path.robot, np.zeros_like(command), path.time
    parts = kinematics.built_parts(robot)
    found = {}
    for cause in dict.fromkeys(part.cause for part in parts):
        own = tuple(part for part in parts if part.cause == cause)
        found[cause] = (
            own,
            sum(kinematics.added(part, t, kinematics.Law(command, still, still)).position for part in own),
        )
        for part in filter(kinematics.is_plate, own):
            found[cause][1][..., L] += kinematics.plate_grows(part, t, path.poses, robot).position
    return found


def _across(robot: Robot, found: Limbs, system: System, record: Record | RestStates, q: Array) -> dict[str, Array]:
    """Errors of held coordinates by compliance across the legs, (T, legs, 8) by part, Eqs. (T15.15), (T25.15).

    Of legs UPS that is of second order, and left to bending.
    """
    shapes, errors = system.kernel.shapes, {}
    moves = tip_displacements(robot, system, record.q)
    for name, end in (("base_joint", "u"), ("platform_joint", "e")):
        if shapes.has(f"{end}1") and not shapes.holds(Flexures):
            at = shapes.index(f"{end}1")
            moves[name] = record.q[..., at : at + 2], np.zeros((*record.q.shape[:-1], 2))
    if found.plain or not moves:
        return errors
    chain, taken = screws(found, q).columns, closure_coordinates(found)
    z, y = chain[..., :3, L], chain[..., 3:, COORDINATES.index("beta")]
    x, spin = np.cross(y, z), q[..., COORDINATES.index("spin"), None]
    x, y = np.cos(spin) * x + np.sin(spin) * y, np.cos(spin) * y - np.sin(spin) * x
    for name, (shift, slope) in moves.items():
        moved = shift[..., :1] * x + shift[..., 1:] * y
        turned = slope[..., :1] * y - slope[..., 1:] * x
        error = np.zeros_like(q)
        for i, own in enumerate(taken):
            step = np.concatenate([moved[:, i], turned[:, i]], axis=-1)[:, : own.sum(), None]
            error[:, i, own] = np.linalg.solve(chain[:, i, : own.sum()][..., own], step)[..., 0]
        if error.any():
            errors[name] = error
    return errors


def _straight(robot: Robot, found: Limbs, platform: Sequence[Array], q: Array) -> Array:
    """Coordinates of straight legs that reach a platform, (T, 3) and (T, 3, 3), the carriages where they are."""
    at = kinematics.Poses.at_rest(*platform)
    if found.plain:
        q = q.copy()
        q[..., L] = kinematics.leg_lengths(found.base, found.platform, at.position, at.rotation)
        return q
    needed = close_nearby(found, Task(closure_coordinates(found), np.zeros(6, dtype=bool), np.zeros(3)), q, at).q
    needed[..., CHI] = q[..., CHI]
    return needed


def closure_coordinates(found: Limbs) -> NDArray[np.bool_]:
    """The coordinates that a closure determines, (legs, 8), whether or not something holds them."""
    taken = np.zeros(found.state.shape, dtype=bool)
    taken[:, [COORDINATES.index(name) for name in ("alpha", "beta", "l")]] = True
    taken[found.pose_closure, COORDINATES.index("gamma1") :] = True
    spins = found.pose_closure & (found.state[:, COORDINATES.index("spin")] == FREE)
    taken[spins, COORDINATES.index("spin")], taken[spins, COORDINATES.index("gamma3")] = True, False
    return taken


def shares_and_sums(system: System, path: RigidPath, record: Record) -> tuple[Array, Array]:
    """Displacement of the payload by cause and leg in a simulation, (T, causes, legs, 3), and their sums (T, 3) [m].

    By compiled loops of legs UPS, where the equations are compiled. World axes, also where the base moves.
    """
    robot, turn = path.robot, None if path.base is None else path.base.rotation
    if not cause_rows.serves(system.kernel, robot):
        shares = deviation_by_cause(path, errors_of(system, path, record))
        shares = shares if turn is None else np.einsum("txy,tcly->tclx", turn, shares)
        return shares, shares.reshape(len(shares), -1, 3).sum(axis=1)
    moved = cause_rows.Moved(
        time=record.time,
        q=record.q,
        pose=record.pose,
        turn=record.attitude,
        command=path.lengths,
        played=gap_elongations(system, record.q) if has_gap(system) else None,
        rubs=record.friction[..., -1] if "drive" in places_with_friction(robot) else None,
    )
    moves = None if is_hexapod(robot) else _by_error(path)[:, :, L]
    return cause_rows.deviation_by_cause(system, path, moved, cause_names(robot), turn, moves)


def deviation_by_cause(path: RigidPath, errors: Errors) -> Array:
    """Displacement of the payload's centre of mass by cause and leg, to first order, Eqs. (T8.6)-(T8.7).

    Returns
    -------
    ndarray, shape (T, causes, legs, 3)
        Time, cause, leg, world axis [m].

    Raises
    ------
    ComputationError
        If a pose is exactly singular.
    """
    return np.einsum("tclk,tlkx->tclx", errors.cause_array, _by_error(path))  # (T8.7)


def _by_error(path: RigidPath) -> Array:
    """Displacement of the centre of mass for unit errors of what is held, (T, legs, 8, 3), Eq. (T8.6)."""
    robot, poses = path.robot, path.poses
    found = kinematics.rigid_limbs(robot)
    if not is_hexapod(robot):
        return path.displacement_by_error[..., :3]
    moves = np.zeros((len(poses), *found.state.shape, 3))
    jacobian = path.drive_jacobian(robot.com)
    try:
        inverse = np.linalg.solve(jacobian.swapaxes(1, 2), np.eye(6, 3))
    except np.linalg.LinAlgError:
        raise ComputationError(
            "a pose on the path is singular: lengths do not determine it", next_step="See `flexapod check`."
        ) from None
    moves[:, found.state == DRIVEN] = inverse
    return moves
