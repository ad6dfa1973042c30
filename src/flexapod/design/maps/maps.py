"""A map: quantities over a grid of poses as a Dataset."""

from __future__ import annotations

import time
from collections.abc import Mapping
from numbers import Integral
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import model
from flexapod.analysis.checks.reachability import flags
from flexapod.analysis.checks.resource_limits import check_map
from flexapod.analysis.checks.stability import instability_remarks
from flexapod.analysis.error_budget.rows import names_of_rows
from flexapod.analysis.pose_values import PoseRequest, batch_values
from flexapod.analysis.results.arguments import LoadLike, RobotLike, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.poses import BATCH, poses_about_home
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.common.units import quantities
from flexapod.design.maps.findings import grid_variables
from flexapod.design.maps.grid import UNITS, Axes, Grid, build_grid
from flexapod.kinematics import RigidPoses
from flexapod.kinematics.rotations import blocks
from flexapod.solve.modal.eigenproblem import count_real
from flexapod.solve.modal.elastic_robot import ElasticRobot

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis.results.time_history import Report

DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
FREQUENCIES = 6


@one_thread()
def workspace_map(
    robot: RobotLike,
    axes: Axes | None = None,
    *,
    at: Mapping[str, float | str] | str | None = None,
    direction: str | ArrayLike = "z",
    acceleration: ArrayLike | None = None,
    frequencies: int = FREQUENCIES,
    budget: bool = False,
    load: LoadLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
    progress: Report | None = None,
) -> Dataset:
    """Frequencies, stiffness, deviations, forces and margins over a line, slice or volume of poses, drives held.

    Parameters
    ----------
    robot : Robot, Study or path
    axes : mapping, optional
        One to three of surge, sway, heave [m], roll, pitch, yaw [rad] from home, each with its values, or None for as
        far as the robot reaches; default: surge and heave, or the first two that the robot can do.
    at : mapping, optional
        Fixed coordinates by name, or in words, ``"roll=5deg"``.
    direction : str or array_like (3,)
        Of `stiffness`: x, y, z, or a vector in world axes.
    acceleration : array_like (3,), optional
        Of the platform [m/s^2] for `dynamic_deviation`; default: 1 m/s^2 in whichever direction is worst.
    frequencies : int
        How many of the lowest.
    budget : bool
        Also `error_worst` and `error_by_part`, from an error budget of each pose: 1 ms a pose, with disturbances 25 ms.
        A vibration without damping has no size, and is not in the first.
    load, fidelity, modes, axial_modes, basis
        As for `flexapod.modes`.
    progress : callable, optional
        Told in words what is done, and its share.

    Returns
    -------
    xarray.Dataset
        Dimensions as the axes; `reason` is a code, 0 where a pose is reached; else all other variables are NaN.

    Raises
    ------
    InputError
        Axes, direction or acceleration that are none; rigid legs on prescribed strokes; a pure force drive.

    Examples
    --------
    >>> data = fx.workspace_map(fx.preset("machine-hexapod"), {"heave": [-0.05, 0, 0.05]})
    >>> data.stiffness.dims, (1e-6 * data.stiffness).round(0).values.tolist()  # N/um, along z
    (('heave',), [250.0, 253.0, 254.0])
    """
    study = study_at_pose(robot, load)
    study = model.override(study, fidelity=fidelity, modes=modes, axial_modes=axial_modes, basis=basis)
    poses = build_grid(study.robot, axes, at)
    a = _acceleration(acceleration)
    wanted = PoseRequest(direction=_unit(direction), acceleration=a, frequencies=_count(frequencies), budget=budget)
    check_map(poses.size, wanted.frequencies)
    began = time.perf_counter()
    data = _described(study, poses, wanted, _computed(study, poses, wanted, progress))
    data.attrs["wall_time"] = time.perf_counter() - began
    return data


def _acceleration(given: ArrayLike | None) -> Array | None:
    a = quantities(given, "acceleration", key="acceleration")
    return None if a is None else _vector("acceleration", a)


def _described(study: model.Study, poses: Grid, wanted: PoseRequest, values: dict[str, Array]) -> Dataset:
    count = count_real(values["frequency"])
    values["frequency"] = values["frequency"][..., :count]
    coords = {**poses.values, "mode": np.arange(1, count + 1)}
    if wanted.budget:
        coords["part"] = np.array(names_of_rows(study))
    data = dataset(values, coords, _attributes(study, poses, wanted), grid_variables(tuple(poses.values)))
    for name in poses.values:
        data[name].attrs |= {"units": UNITS[name], "long_name": f"{name} from home"}
    data.reason.attrs |= flags()
    if "loop_growth" in data:
        path, rates = poses_about_home(study.robot, poses.coordinates()), np.nan_to_num(data.loop_growth.values.ravel())
        data.attrs["warnings"] = "\n".join([*study.warnings, *instability_remarks(study.robot, path, rates)])
    return data


def _computed(study: model.Study, poses: Grid, wanted: PoseRequest, progress: Report | None) -> dict[str, Array]:
    table, robot = poses.coordinates(), study.robot
    elastic = ElasticRobot(robot, study.simulation, study.load)
    parts = []
    for part in blocks(len(table), BATCH):
        rigid = RigidPoses(robot, poses_about_home(robot, table[part]))
        code, values = batch_values(study, elastic, rigid, wanted)
        parts.append(values | {"reason": code})
        if progress is not None:
            progress(f"computing {len(table)} poses", part.stop / len(table))
    together = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return {name: rows.reshape(*poses.shape, *rows.shape[1:]) for name, rows in together.items()}


def _count(frequencies: int) -> int:
    if isinstance(frequencies, bool) or not isinstance(frequencies, Integral) or frequencies < 1:
        raise InputError("is not a number of modes", key="frequencies", value=frequencies, allowed="1 or more, whole")
    return int(frequencies)


def _unit(direction: str | ArrayLike) -> Array:
    if isinstance(direction, str):
        if direction not in DIRECTIONS:
            raise InputError(
                "is not a direction", key="direction", value=direction, allowed="x, y, z, or three numbers, world axes"
            )
        return np.array(DIRECTIONS[direction])
    vector = _vector("direction", direction)
    if not vector.any():
        raise InputError(
            "has no direction", key="direction", value=vector.tolist(), allowed="a vector that is not zero"
        )
    vector = vector / np.abs(vector).max()  # so that no square is too small or too large for a number
    return vector / np.linalg.norm(vector)


def _vector(key: str, given: ArrayLike) -> Array:
    try:
        vector = floats(given)
    except ValueError:
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError("is not a vector", key=key, value=given, allowed="three finite numbers, world axes")
    return vector


def _attributes(study: model.Study, poses: Grid, wanted: PoseRequest) -> dict[str, object]:
    s, at = study.simulation, dict(zip(model.AXES, poses.at.tolist(), strict=True))
    acceleration = "worst" if wanted.acceleration is None else wanted.acceleration
    return attributes(study, study.warnings) | {
        "fidelity": s.fidelity,
        "basis": s.lateral_basis if s.lateral_shapes else "none",
        "modes": s.lateral_shapes,
        "axes": " ".join(poses.values),
        **{f"at_{name}": value for name, value in at.items() if name not in poses.values},
        "stiffness_direction": wanted.direction,
        "acceleration": acceleration,
    }
