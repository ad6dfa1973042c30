"""Modes at many poses: frequencies, and shapes on request; a pose without modes has the reason."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.reachability import (
    CUT_OFF,
    FALLS_THROUGH,
    NO_MASS,
    REACHED,
    Codes,
    equilibrium_codes,
    flags,
    rigid_codes,
)
from flexapod.analysis.checks.stability import instability_remarks
from flexapod.analysis.results.mode_shapes import STATIONS, mode_values
from flexapod.analysis.results.poses import BATCH, pose_coordinates
from flexapod.analysis.results.variables import COORDINATES, VARIABLES, Variable, dataset
from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.rotations import blocks, quaternion
from flexapod.solve.modal.eigenproblem import count_real
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import ManyModes, modes_of
from flexapod.solve.statics.assembly_mode import assembly_changes, platform_poses
from flexapod.solve.statics.locked_robot import LockedPoses

if TYPE_CHECKING:
    from xarray import Dataset

FORMS = {
    **{name: Variable(("pose", *VARIABLES[name].dims), *VARIABLES[name][1:])
       for name in ("frequency", "damping_ratio", "kind", "payload_share", "leg_share",
                    "platform_shape", "leg_shape", "leg_stretch", "com_sag")},
    "platform_position": Variable(("pose", "axis"), "m", "origin of the platform frame"),
    "platform_quaternion": Variable(("pose", "quaternion"), "1", "orientation of the platform, platform to world"),
    "pose_from_home": Variable(("pose", "coordinate"), "mixed", "rigid pose from home [m, rad]"),
    "reason": Variable(("pose",), "1", "why a pose has no modes: a code"),
    "cut_off": Variable(("pose",), "1", "a singularity lies between home and this pose, or in it"),
}  # fmt: skip
OF_POSES = ("pose_from_home", "reason", "cut_off")  # whatever comes of the search for an equilibrium


def modes_at_poses(study: model.Study, path: kinematics.Poses, *, shapes: bool, attrs: Mapping[str, object]) -> Dataset:
    """Modes at P poses; see `flexapod.modes`.

    A pose that a singularity cuts off from home is out of reach to a map, but has modes of its own: they are computed,
    and `cut_off` says so. One whose equilibrium lies on the other side of a singularity than the pose itself has none.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    """
    robot, P, rigid = study.robot, len(path), kinematics.RigidPoses(study.robot, path)
    elastic = ElasticRobot(robot, study.simulation, study.load)
    reason = rigid_codes(rigid, from_home=True)
    cut_off = reason == CUT_OFF
    reason[cut_off] = REACHED
    within = np.flatnonzero(reason == REACHED)
    values: dict[str, Array | Codes | Mask] = {}
    growth = np.zeros(P)
    for part in blocks(len(within), BATCH):
        chosen = within[part]
        some = rigid.resting(chosen)
        locked = elastic.lock(some)
        modes = modes_of(locked, shapes=shapes)
        growth[chosen[locked.at]] = 0.0 if modes.growth is None else modes.growth
        reason[chosen] = codes = rest_codes(locked, modes)
        kept = codes[locked.at] == REACHED
        rows = (_shape_rows if shapes else _rows)(robot, locked, modes, some.poses, kept)
        for name, row in rows.items():
            target = values.setdefault(name, _empty(row, P))
            target[chosen[locked.at[kept]]] = row
    count = count_real(np.asarray(values["frequency"], dtype=np.float64))
    values = {name: row[:, :count] if "mode" in FORMS[name].dims else row for name, row in values.items()}
    values |= {"pose_from_home": pose_coordinates(robot, path), "reason": reason, "cut_off": cut_off}
    coords = {"pose": np.arange(P), "coordinate": list(model.AXES)}
    coords |= {"mode": np.arange(1, count + 1)}
    data = dataset(values, coords | ({"station": STATIONS} if shapes else {}), attrs, FORMS)
    data.reason.attrs |= flags()
    said = [data.attrs["warnings"], *instability_remarks(robot, path, np.where(reason == REACHED, growth, 0.0))]
    data.attrs["warnings"] = "\n".join(filter(None, said))
    return data


def rest_codes(locked: LockedPoses, modes: ManyModes) -> Codes:
    """Codes (P,) of what the search for equilibria and modes says of P rigid poses within the legs' reach."""
    codes = equilibrium_codes(locked.equilibria.code)
    codes[locked.at[~modes.positive]] = NO_MASS
    start, at_rest = locked.start[locked.at], locked.equilibria.states[locked.at]
    codes[locked.at[assembly_changes(locked.system, locked.robot, start, at_rest)]] = FALLS_THROUGH
    return codes


def _empty(row: Array, count: int) -> Array:
    """Array for all poses of the kind of a row, filled with NaN or empty texts."""
    if row.dtype.kind == "U":
        return np.full((count, *row.shape[1:]), "", dtype="U32")
    return np.full((count, *row.shape[1:]), np.nan)


def _rows(
    robot: model.Robot, locked: LockedPoses, modes: ManyModes, path: kinematics.Poses, kept: Mask
) -> dict[str, Array]:
    """Frequencies and places of the poses that have modes."""
    at, com = locked.at[kept], robot.com
    pose = locked.equilibria.states.pose[at]
    rest = platform_poses(robot, pose)
    return {
        "frequency": modes.frequency[kept],
        "platform_position": rest.position,
        "platform_quaternion": quaternion(rest.rotation),
        "com_sag": pose[:, :3] - path.point(com)[0][at],
    }


def _shape_rows(
    robot: model.Robot, locked: LockedPoses, modes: ManyModes, path: kinematics.Poses, kept: Mask
) -> dict[str, Array]:
    """Variables of the modes with their shapes, pose by pose."""
    found = []
    for k in np.flatnonzero(kept).tolist():
        found.append(dict(mode_values(robot, modes.one(locked, k), locked.rigid.resting(locked.at[k : k + 1]).poses)))
    if not found:
        return _no_rows(modes.frequency.shape[1], len(robot.legs))
    return {name: np.stack([values[name] for values in found]) for name in found[0]}


def _no_rows(count: int, legs: int) -> dict[str, Array]:
    """Variables of the modes without any pose; ``count`` modes."""
    sizes = {
        "mode": count,
        "leg": legs,
        "station": len(STATIONS),
        **{dim: np.asarray(labels).size for dim, (labels, _) in COORDINATES.items()},
    }
    return {
        name: np.zeros((0, *(sizes[dim] for dim in form.dims[1:])), dtype="U32" if name == "kind" else float)
        for name, form in FORMS.items()
        if name not in OF_POSES
    }
