"""Modes at many poses: frequencies, and shapes where they are asked for; a pose that has none keeps the reason."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model, rigid
from flexapod.rigid.rotations import matrix, quaternion
from flexapod.solve.modes import LockedPoses, ManyModes, RobotModes, locked_poses, modes_of
from flexapod.study.mode_shapes import STATIONS, mode_values
from flexapod.study.names import VARIABLES, Variable, dataset
from flexapod.study.poses import batches, coordinates_of
from flexapod.study.reach import NO_MASS, REACHED, Codes, equilibrium_codes, flags, rigid_codes
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["modes_at_poses", "poses_of"]

FORMS = {
    **{name: Variable(("pose", *VARIABLES[name].dims), *VARIABLES[name][1:])
       for name in ("frequency", "damping_ratio", "kind", "platform_shape", "leg_shape", "leg_stretch", "com_sag")},
    "platform_position": Variable(("pose", "axis"), "m", "origin of the platform frame"),
    "platform_quaternion": Variable(("pose", "quaternion"), "1", "orientation of the platform, platform to world"),
    "pose_from_home": Variable(("pose", "coordinate"), "mixed", "rigid pose from home [m, rad]"),
    "reason": Variable(("pose",), "1", "why a pose has no modes: a code"),
}  # fmt: skip


def modes_at_poses(
    study: model.Study, path: rigid.Poses, wrench: Array, *, shapes: bool, attrs: Mapping[str, object]
) -> Dataset:
    """Modes at P poses; see `flexapod.modes`.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    """
    robot, P = study.robot, len(path)
    reason = rigid_codes(robot, path, from_home=False)
    within = np.flatnonzero(reason == REACHED)
    values: dict[str, Array | Codes] = {}
    for part in batches(len(within)) if within.size else [slice(0, 0)]:
        chosen = within[part]
        some = poses_of(path, chosen)
        locked = locked_poses(robot, study.simulation, some, wrench)
        modes = modes_of(locked, shapes=shapes)
        reason[chosen] = _codes(locked, modes)
        rows = _shape_rows(robot, locked, modes, some, wrench) if shapes else _rows(robot, locked, modes, some)
        for name, row in rows.items():
            target = values.setdefault(name, _empty(row, P))
            target[chosen[locked.at[modes.positive]]] = row
    values |= {"pose_from_home": coordinates_of(robot, path), "reason": reason}
    coords = {"pose": np.arange(P), "coordinate": list(model.AXES)}
    coords |= {"mode": np.arange(1, values["frequency"].shape[1] + 1)}
    data = dataset(values, coords | ({"station": STATIONS} if shapes else {}), attrs, FORMS)
    data.reason.attrs |= flags()
    return data


def poses_of(path: rigid.Poses, chosen: np.ndarray) -> rigid.Poses:
    """Some poses of a path, at rest."""
    return rigid.Poses.at_rest(path.position[chosen], path.rotation[chosen])


def _codes(locked: LockedPoses, modes: ManyModes) -> Codes:
    codes = equilibrium_codes(locked.equilibria.code)
    codes[locked.at[~modes.positive]] = NO_MASS
    return codes


def _empty(row: Array, count: int) -> Array:
    """Of the kind of a row, for all poses: NaN, or empty words."""
    if row.dtype.kind == "U":
        return np.full((count, *row.shape[1:]), "", dtype="U32")
    return np.full((count, *row.shape[1:]), np.nan)


def _rows(robot: model.Robot, locked: LockedPoses, modes: ManyModes, path: rigid.Poses) -> dict[str, Array]:
    """Frequencies and places of the poses that have modes."""
    at = locked.at[modes.positive]
    pose = locked.equilibria.states.pose[at]
    R, com = matrix(pose[:, 3:]), robot.payload.com
    return {
        "frequency": modes.frequency[modes.positive],
        "platform_position": pose[:, :3] - R @ com,
        "platform_quaternion": quaternion(R),
        "com_sag": pose[:, :3] - path.point(com)[0][at],
    }


def _shape_rows(
    robot: model.Robot, locked: LockedPoses, modes: ManyModes, path: rigid.Poses, wrench: Array
) -> dict[str, Array]:
    """Everything, pose by pose."""
    found = []
    for k, at in enumerate(locked.at):
        if not modes.positive[k]:
            continue
        one = RobotModes(
            frequency=modes.frequency[k],
            damping_ratio=modes.damping_ratio[k],
            shapes=modes.shapes[k],
            equilibrium=locked.equilibria.one(int(at)),
            system=locked.system,
        )
        found.append(mode_values(robot, one, poses_of(path, np.array([at])), wrench))
    if not found:
        return {"frequency": np.zeros((0, modes.frequency.shape[1]))}
    return {name: np.stack([values[name] for values in found]) for name in found[0]}
