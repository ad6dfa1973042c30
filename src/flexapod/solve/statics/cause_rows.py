"""Deviation by cause of legs UPS over rows of instants by compiled loops, Eqs. (T8.1)-(T8.8).

Numbers that ``time/native/results.c`` reads: springs along the legs, joints as built, frames.
"""

from __future__ import annotations

from ctypes import byref, c_long, c_void_p
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.robot import cache_per_robot, rigid_limbs
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.mechanics.elements.springs import servo_spring, springs_along
from flexapod.model import ServoDrive
from flexapod.solve.frames import plate_frames
from flexapod.solve.result_rows import Given, Rows, result_loops, to
from flexapod.solve.statics.lost_motion import before_friction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from flexapod.common.arrays import Array
    from flexapod.kinematics import BuiltPart, Poses
    from flexapod.model import Robot
    from flexapod.solve.kernel import Kernel
    from flexapod.solve.system import System

PLACES = ("base", "nut", "platform")
INSIDE = ("", "stroke", "joint-to-joint")  # of what the loop of a drive is closed about
MOST_FRAMES = 3
L = COORDINATES.index("l")


NUMBER = np.dtype("l")  # a long of C
JOINTS = np.dtype([("base", float, 3), ("platform", float, 3), ("fixed", float), ("share", float)])
SPRING = np.dtype(
    [("softness", float, 3), ("column", float, 4), *[(name, NUMBER) for name in ("at", "cause", "yields", "twist")]]
)


class _Causes(Given):
    _fields_: ClassVar = [
        *[(name, c_long) for name in ("legs", "causes", "stages")],
        *[(x, c_void_p) for x in ("com", "joints", "frame", "moved", "cause", "spring", "first", "loop")],
        *[(name, c_void_p) for name in ("inside", "given")],
        *[(name, c_long) for name in ("friction", "size", "l", "c", "r", "u", "e")],
        *[(name, Rows) for name in ("q", "command", "played", "rubs", "longer")],
        *[(name, Rows * MOST_FRAMES) for name in ("origin", "axes")],
        *[(name, Rows) for name in ("position", "rotation", "turn", "moves")],
    ]


class Moved(NamedTuple):
    """State of a robot at T instants.

    ``time`` [s]; ``q`` (T, legs, n); ``pose`` (T, 7) and attitude ``turn`` (T, 3, 3) of the payload; ``command``
    (T, legs): lengths on the rigid path [m]; ``played`` (T, legs): elongation of legs by their gaps [m]; ``rubs``
    (T, legs): friction of the drives [N]; both None where there is none.
    """

    time: Array
    q: Array
    pose: Array
    turn: Array
    command: Array
    played: Array | None
    rubs: Array | None


def serves(kernel: Kernel, robot: Robot) -> bool:
    """Test whether compiled loops make the causes: of legs UPS, where the equations are compiled."""
    return kernel.library is not None and rigid_limbs(robot).plain


def deviation_by_cause(
    system: System,
    at: kinematics.RigidPoses,
    moved: Moved,
    names: Sequence[str],
    turn: Array | None = None,
    moves: Array | None = None,
) -> tuple[Array, Array]:
    """Displacement of the payload's centre of mass by cause and leg, (T, causes, legs, 3), and their sums (T, 3).

    Parameters
    ----------
    system : System
    at : RigidPoses
        The rigid robot at these instants.
    moved : Moved
        The flexible one.
    names : sequence of str
        Of all causes, in their order.
    turn : ndarray, shape (T, 3, 3), optional
        Attitude of a base that moves: its axes to those of the world.
    moves : ndarray, shape (T, legs, 3), optional
        Displacement of the centre of mass for unit errors of the legs; default: of six driven legs, by their Jacobian.

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    robot, shapes = at.robot, system.kernel.shapes
    legs, count, index = robot.count, len(moved.q), {name: k for k, name in enumerate(names)}
    coordinates = {"l": shapes.l_index, "c": shapes.index("c") if shapes.beam.axial.count else -1}
    flexed = shapes.holds(Flexures)
    for name, key in (("r", "r"), ("u", "u3"), ("e", "e3")):
        coordinates[name] = shapes.index(key) if shapes.has(key) and not (flexed and key in ("u3", "e3")) else -1
    springs = _springs(robot)
    table = springs.table.copy()
    table["cause"] = [index.get(name, -1) for name in springs.names]
    given: dict[str, Any] = {"played": moved.played, "rubs": moved.rubs, "turn": turn, "moves": moves}
    given["command"] = moved.command
    given |= _stages(system, at, moved, index) | springs.others | coordinates
    causes = _Causes(
        legs=legs, causes=len(names), com=robot.com, size=shapes.size, q=moved.q, spring=table,
        position=at.poses.position, rotation=at.poses.rotation,
        friction=-1 if moved.rubs is None else index["friction"],
        **{name: value for name, value in given.items() if value is not None},
    )  # fmt: skip
    shares, whole = np.empty((count, len(names), legs, 3)), np.empty((count, 3))
    if result_loops(system.kernel.compiler).deviation_by_cause(byref(causes), c_long(count), to(shares), to(whole)):
        raise ComputationError(
            "a pose on the path is singular: lengths do not determine it", next_step="See `flexapod check`."
        )
    return shares, whole


class _Stage(NamedTuple):
    """Joints (n, 3) where they are from here on, with what is added to lengths l, fixed + share l, (n,)."""

    base: Array
    platform: Array
    fixed: Array
    share: Array


class _Built(NamedTuple):
    """Differences from nominal by one cause: joints then, whether they differ, parts of a temperature over time."""

    cause: str
    stage: _Stage
    shifted: bool
    growing: tuple[BuiltPart, ...]


@cache_per_robot
def _built(robot: Robot) -> list[_Built]:
    """Differences from nominal, cause by cause."""
    nominal, parts, done, found = rigid_limbs(robot), kinematics.built_parts(robot), (), []
    for cause in dict.fromkeys(part.cause for part in parts):
        own = tuple(part for part in parts if part.cause == cause)
        done = (*done, *own)
        limbs = kinematics.built_limbs(robot, nominal, done)
        still = [part for part in own if part.time is None]
        fixed, share = np.zeros((2, robot.count))
        for part in still:
            fixed, share = fixed + part.values[0] * part.fixed[:, L], share + part.values[0] * part.share[:, L]
        shifted = any(part.base.any() or part.platform.any() for part in own)
        growing = tuple(part for part in own if part.time is not None)
        found.append(_Built(cause, _Stage(limbs.base, limbs.platform, fixed, share), shifted, growing))
    return found


def _stages(system: System, at: kinematics.RigidPoses, moved: Moved, index: dict[str, int]) -> dict[str, Any]:
    """Frames and joints, stage by stage, from those of the nominal robot to where the legs have them."""
    robot, legs, built = at.robot, rigid_limbs(at.robot), _built(at.robot)
    frames = plate_frames(system, robot, moved.q, moved.pose, moved.turn)
    last, none = len(frames) - 1, np.zeros(robot.count)
    nominal = _Stage(legs.base, legs.platform, none, none)
    numbers = [(k, int(k > 0), index.get(name, 0)) for k, (name, *_) in enumerate(frames)]
    numbers += [(last, int(one.shifted), index[one.cause]) for one in built]
    joints = np.empty((len(numbers), robot.count), dtype=JOINTS)
    for row, stage in zip(joints, [nominal] * len(frames) + [one.stage for one in built], strict=True):
        for name, values in zip(_Stage._fields, stage, strict=True):
            row[name] = values
    longer = None
    if any(one.growing for one in built):
        longer = np.zeros((len(moved.q), len(numbers), robot.count))
        for k, one in enumerate(built, start=len(frames)):
            longer[:, k] = _grown(one.growing, at.poses, moved, robot)
    return {
        "stages": len(numbers), "joints": joints, "longer": longer,
        "origin": [place for _, place, _ in frames], "axes": [R for _, _, R in frames],
        **dict(zip(("frame", "moved", "cause"), np.array(numbers, dtype=NUMBER).T, strict=True)),
    }  # fmt: skip


def _grown(parts: tuple[BuiltPart, ...], path: Poses, moved: Moved, robot: Robot) -> Array:
    """Lengths that parts of a temperature over time add, (T, legs) [m]."""
    found, t = np.zeros(moved.command.shape), moved.time
    for part in parts:
        found += part.size(t).position * (part.fixed[:, L] + part.share[:, L] * moved.command)
        if kinematics.is_plate(part):
            found += kinematics.plate_grows(part, t, path, robot).position
    return found


class _Springs(NamedTuple):
    """Springs of all legs as C reads them with their names ("": of the drive), and what else parts a drive's give."""

    table: NDArray[Any]
    names: list[str]
    others: dict[str, NDArray[Any]]


@cache_per_robot
def _springs(robot: Robot) -> _Springs:
    """Springs along the legs, and how they yield to friction: 0 not, 1 by their own compliance, 2 by the twist."""
    rows, names, counts = [], [], []
    rubbing = [before_friction(leg, np.ones(1)) for leg in robot.legs]
    for leg, rubs in zip(robot.legs, rubbing, strict=True):
        along = springs_along(leg)
        names += [spring.name for spring in along]
        if leg.gives and isinstance(leg.drive, ServoDrive):
            along.append(servo_spring(leg.drive.stiffness, leg.drive.damping))
            names.append("")
        counts.append(len(along))
        ways = 1 if leg.screw is None else 2
        for spring, name in zip(along, names[-len(along) :], strict=True):
            columns = [x for column in spring.columns for x in (column.fixed, column.slope)] or [0.0] * 4
            yields = ways * (bool(name) and spring.at == "nut" and name in rubs)
            rows.append((spring.compliance, columns, PLACES.index(spring.at), -1, yields, spring.name == "twist"))
    others = {
        "first": np.cumsum([0, *counts], dtype=NUMBER),
        "loop": np.array([rubs["drive"][0] if "drive" in rubs else 0.0 for rubs in rubbing]),
        "inside": np.array([INSIDE.index(leg.closed_about) for leg in robot.legs], dtype=NUMBER),
        "given": rigid_limbs(robot).given[:, L].astype(NUMBER),
    }
    return _Springs(np.array(rows, dtype=SPRING), names, others)
