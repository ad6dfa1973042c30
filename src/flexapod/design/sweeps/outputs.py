"""Stored outputs of a sweep by name, and the layout of its store: what varies, room for the outputs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from flexapod.analysis.results.attributes import TABLES, attributes
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.element_outputs import element_forms
from flexapod.analysis.results.leg_results import absent_variables, drive_forms, leg_labels
from flexapod.analysis.results.packed_tables import as_text
from flexapod.analysis.results.summary import tip_size
from flexapod.analysis.results.variables import ACTUATOR_FORMS, SPACE_FORMS, VARIABLES, Variable, fixed_labels
from flexapod.analysis.scalars import ROBOT_DEFAULTS, ROBOT_SCALARS, Scalar
from flexapod.common import version
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_known
from flexapod.common.tables.key_paths import Step, key_text
from flexapod.common.units import DIMENSIONS
from flexapod.design.sweeps.plan import Keep
from flexapod.design.sweeps.reading import dimension_of, number
from flexapod.design.sweeps.samples import Points, Resolved
from flexapod.design.sweeps.store import FORMAT, StoredArray, StoreLayout, Values
from flexapod.model import ActuatorStudy, Study

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis.results.packed_tables import Bytes

_LABELS = {"axis": 3, "direction": 2, "quaternion": 4, "plane_axis": 2, "end": 2}
_SHAPES = ("shape", "axial_shape", "mode")  # dimensions whose size is a setting of the study


@dataclass(frozen=True, kw_only=True)
class OutputSelection:
    """Names, in order, and what the store holds of them.

    ``every``: stored instants between two that records keep; ``times`` (T,) of records [s]. ``absent``: why some
    scalars have no value at some computed points.
    """

    scalars: tuple[str, ...]
    records: tuple[str, ...]
    arrays: Mapping[str, StoredArray]
    every: int
    times: Array
    absent: Mapping[str, str]


def _tip(data: Dataset) -> Array:
    return np.abs(tip_size(data))


#: Of an actuator in space alone: variables whose largest size can be kept.
_SPACE_PEAKS = {
    "elevation_torque": "largest torque on the hub towards Z",
    "tip_stretch": "largest stretch of the beam",
    "tip_twist": "largest twist of the tip",
}

#: Scalars of a single actuator's simulation, from its Dataset.
ACTUATOR_SCALARS: Mapping[str, Scalar] = {
    "tip_deflection_peak": Scalar((), "m", "largest deflection of the tip", lambda d: _tip(d).max()),
    "tip_deflection_rms": Scalar(
        (), "m", "root mean square deflection of the tip", lambda d: np.sqrt(np.mean(np.square(_tip(d))))
    ),
    "tip_deflection_end": Scalar((), "m", "deflection of the tip at the end", lambda d: tip_size(d)[-1]),
    "torque_peak": Scalar((), "N m", "largest torque on the hub", lambda d: np.abs(d.torque.values).max()),
    "force_peak": Scalar((), "N", "largest axial force on the beam", lambda d: np.abs(d.force.values).max()),
    "steps": Scalar((), "1", "steps of the time integration", lambda d: float(d.attrs["steps"])),
    **{
        f"{name}_peak": Scalar((), VARIABLES[name].units, words, lambda d, name=name: np.abs(d[name].values).max())
        for name, words in _SPACE_PEAKS.items()
    },
}


def select_outputs(keep: Keep, study: Study | ActuatorStudy, resolved: Resolved) -> OutputSelection:
    """Select the outputs that are stored of every point of a sweep.

    Raises
    ------
    InputError
        A name that does not exist, or records of different sizes at different points.
    """
    table = _robot_scalars(study) if isinstance(study, Study) else _actuator_scalars(study)
    usual = ROBOT_DEFAULTS if isinstance(study, Study) else tuple(table)
    names = keep.scalars or (() if keep.records else usual)
    for name in names:
        check_known(name, table, "keep.scalars")
    whole = _records(study)
    for name in keep.records:
        check_known(name, whole, "keep.records")
    variables = {name: Variable(*table[name][:3]) for name in names} | {name: whole[name] for name in keep.records}
    if isinstance(study, Study):
        _refuse_other_causes(keep, names, variables, {*resolved.causes, cause_names(study.robot)})
    sizes, every, times = dict(_LABELS), 1, np.zeros(0)
    if isinstance(study, Study):
        sizes |= {"leg": study.robot.count, **{dim: np.size(labels) for dim, labels in leg_labels(study.robot).items()}}
    if keep.records:
        every, times = _instants(keep, resolved)
        sizes |= {"time": len(times), **_shape_sizes(resolved, variables)}
    absent = {name: table[name].absent for name in names if table[name].absent}
    arrays = {}
    for name, (dims, units, long_name) in variables.items():
        comment = {"comment": f"NaN at a computed point: {absent[name]}"} if name in absent else {}
        shape = (len(resolved.first), *(sizes[dim] for dim in dims))
        arrays[name] = StoredArray(("point", *dims), shape, {"units": units, "long_name": long_name, **comment})
    return OutputSelection(scalars=names, records=keep.records, arrays=arrays, every=every, times=times, absent=absent)


def _robot_scalars(study: Study) -> Mapping[str, Scalar]:
    """Scalars of a robot's simulation; forces of cranks are torques."""
    turns = {leg.carriage is not None and leg.carriage.kind == "crank" for leg in study.robot.legs}
    if True not in turns:
        return ROBOT_SCALARS
    names, units = ("actuator_force_peak", "actuator_force_peak_by_leg"), "mixed" if len(turns) > 1 else "N m"
    return {**ROBOT_SCALARS, **{name: ROBOT_SCALARS[name]._replace(units=units) for name in names}}


def _actuator_scalars(study: ActuatorStudy) -> Mapping[str, Scalar]:
    """Scalars that a simulation of this actuator has."""
    absent_here = set() if study.actuator.space else {f"{name}_peak" for name in _SPACE_PEAKS}
    return {name: entry for name, entry in ACTUATOR_SCALARS.items() if name not in absent_here}


def _refuse_other_causes(
    keep: Keep, scalars: tuple[str, ...], variables: Mapping[str, Variable], causes: set[tuple[str, ...]]
) -> None:
    for key, chosen in (("scalars", scalars), ("records", keep.records)):
        by_cause = [name for name in chosen if "cause" in variables[name].dims]
        if by_cause and len(causes) > 1:
            raise InputError(
                "would have other causes at other points, or than the robot of the study file",
                key=f"keep.{key}",
                value=by_cause[0],
                allowed="points whose robots are made of the same parts",
                next_step="Write what varies into the study file, at a value that changes nothing: heat.piston = 20",
            )


def _records(study: Study | ActuatorStudy) -> dict[str, Variable]:
    """Variables over time that a simulation of this kind of study has."""
    forms = drive_forms(study.robot) if isinstance(study, Study) else {}
    own = element_forms(study.robot) if isinstance(study, Study) else {}
    over_time = {name: forms.get(name, entry) for name, entry in VARIABLES.items() if "time" in entry.dims[:1]} | own
    actuator = ("length", "angle", "length_rate", "angle_rate", "mode_amplitude", "tip_position", "torque", "force")
    space = ("elevation", "elevation_rate", *_SPACE_PEAKS)
    shared = ("energy_kinetic", "energy_dissipated", "work_drive", "work_external", "closure_residual")
    if isinstance(study, ActuatorStudy):
        planar = {name: over_time[name] for name in (*actuator, *shared)} | ACTUATOR_FORMS
        return planar | ({name: over_time[name] for name in space} | SPACE_FORMS if study.actuator.space else {})
    kinematics = ("leg_length_rate", "leg_length_acceleration", "leg_angle_rigid", "platform_position")
    reactions = ("base_force_rigid", "base_moment_rigid", "held_force_rigid", "joint_moment_rigid")
    others = {
        *actuator,
        *space,
        *kinematics,
        *reactions,
        *absent_variables(study.robot),
        "sensor_reading",
        "control_input",
    }
    others |= {"work_control"} if study.control is None else set()
    return {name: entry for name, entry in over_time.items() if name not in others}


def _instants(keep: Keep, resolved: Resolved) -> tuple[int, Array]:
    """Number of output instants from one stored one to the next, and the times of the stored ones."""
    if len(resolved.instants) > 1:
        raise InputError(
            "would have other instants at other points",
            key="keep.records",
            next_step="Give all points one simulation.duration and output_step, or keep scalars only",
        )
    outputs, spacing = next(iter(resolved.instants))
    ratio = (keep.record_step or spacing) / spacing
    every = round(ratio)
    if every < 1 or abs(ratio - every) > 1e-6:
        raise InputError(
            "is not a multiple of the time between stored results",
            key="keep.record_step",
            value=keep.record_step,
            allowed=f"multiples of {spacing:g} s",
        )
    return every, spacing * np.arange(0, outputs + 1, every, dtype=np.float64)


def _shape_sizes(resolved: Resolved, variables: Mapping[str, Variable]) -> dict[str, int]:
    """Numbers of shapes, where records have them."""
    wanted = {dim for entry in variables.values() for dim in entry.dims if dim in _SHAPES}
    if not wanted:
        return {}
    counts: set[tuple[Any, Any]] = {(lateral, max(axial, default=0)) for _, _, lateral, axial, _ in resolved.settings}
    if len(counts) > 1 or 0 in next(iter(counts))[: 1 + ("axial_shape" in wanted)]:
        raise InputError(
            "has no one number of shapes at all points", key="keep.records", next_step="Leave amplitudes out"
        )
    lateral, axial = next(iter(counts))
    return {"shape": lateral, "mode": lateral, "axial_shape": axial}


DRAWN = "_drawn"  # what a tolerance drew about values that vary themselves, and own the name


def store_layout(points: Points, kept: OutputSelection, resolved: Resolved) -> StoreLayout:
    """Layout of a sweep's store: number of points, attributes and variables of its Dataset."""
    return StoreLayout(len(points), _header(points, resolved), columns(points, kept, resolved))


def _header(points: Points, resolved: Resolved) -> dict[str, Any]:
    """Attributes of the Dataset: what is in it, identified by hashes, and how its points are laid out."""
    study = attributes(points.nominal)
    return {
        "title": f"flexapod: sweep of a {'single actuator' if isinstance(points.nominal, ActuatorStudy) else 'robot'}",
        "flexapod_sweep_format": FORMAT,
        "flexapod_version": version.__version__,
        "flexapod_sources": version.sources(),
        "study": study["study"],
        "study_file": study["study_file"],
        "study_hash": study["study_hash"],
        **({TABLES: as_text(cast("Bytes", study[TABLES]))} if TABLES in study else {}),
        "sweep": points.plan.text,
        "sweep_file": points.plan.file or "",
        "sweep_hash": points.plan.hash,
        "points_hash": resolved.hash,
        "axes": json.dumps(axes(points)),
    }


def axes(points: Points) -> list[dict[str, Any]]:
    """Axes of the grid of points, the last fastest: name, number of values, keys that vary with it."""
    plan = points.plan
    found: list[dict[str, Any]] = [
        {"name": key_text(block.keys[0]), "count": block.count, "keys": [key_text(key) for key in block.keys]}
        for block in plan.blocks
    ]
    if plan.hypercube:
        keys = [key_text(entry.key) for entry in plan.hypercube.ranges]
        found.append({"name": "sample", "count": plan.hypercube.count, "keys": keys})
    if plan.draws:
        found.append({"name": "draw", "count": plan.draws.count, "keys": []})
    return found


def columns(points: Points, kept: OutputSelection, resolved: Resolved) -> dict[str, StoredArray]:
    """Arrays of varied values, labels of dimensions, and arrays of stored outputs."""
    given = _varied(points)
    drawn = _scattered(points, resolved)
    varied = given | {f"{name}{DRAWN}" if name in given else name: column for name, column in drawn.items()}
    used = {
        dim: size
        for column in (*varied.values(), *kept.arrays.values())
        for dim, size in zip(column.dims, column.shape, strict=True)
    }
    robot = getattr(points.nominal, "robot", None)
    own = {} if robot is None else leg_labels(robot)
    for dim, (labels, words) in ({dim: (own[dim], dim) for dim in own if dim in used} | fixed_labels(used)).items():
        values = np.asarray(own.get(dim, labels))
        varied[dim] = StoredArray((dim,), values.shape, {"long_name": words}, values)
    if "time" in used:
        varied["time"] = StoredArray(("time",), kept.times.shape, {"units": "s", "long_name": "time"}, kept.times)
    return varied | dict(kept.arrays)


def _varied(points: Points) -> dict[str, StoredArray]:
    """Values by key of blocks and hypercube."""
    at, plan = np.unravel_index(np.arange(len(points)), points.plan.shape), points.plan
    found = {}
    for position, (block, values) in enumerate(zip(plan.blocks, points.columns, strict=True)):
        for key, column in zip(block.keys, values, strict=True):
            found[key_text(key)] = _column(key, column, at[position], points)
    if plan.hypercube is not None and points.cube is not None:
        for entry, column in zip(plan.hypercube.ranges, points.cube.T, strict=True):
            found[key_text(entry.key)] = _column(entry.key, column.tolist(), at[len(plan.blocks)], points)
    return found


def _column(key: tuple[Step, ...], values: Any, at: Values, points: Points) -> StoredArray:
    plain = np.asarray(_plain(values, key, points))
    attributes = {"long_name": key_text(key)}
    items = [key, *((*key, number) for number in range(1, 1 + plain.shape[1] if plain.ndim > 1 else 1))]
    found = {dimension_of(item, points.dimensions) for item in items} - {None}
    if len(found) == 1 and plain.dtype.kind != "U":  # forces and moments in one list have no unit in common
        attributes["units"] = DIMENSIONS[str(found.pop())].unit or "1"
    dims = _dims(key, plain.shape[1:], each=key[-1] == "joints")
    return StoredArray(("point", *dims), (len(at), *plain.shape[1:]), attributes, plain[at])


def _plain(values: Any, key: tuple[Step, ...], points: Points) -> list[Any]:
    """Values as numbers in SI where all are numbers of one shape, else as text."""

    def si(value: object, key: tuple[Step, ...]) -> Any:
        if isinstance(value, list):
            return [si(item, (*key, at)) for at, item in enumerate(value, start=1)]
        return number(value, key, points.dimensions)

    try:
        found = [si(value, key) for value in values]
        np.array(found, dtype=float)
    except (ValueError, InputError):
        return [str(value) for value in values]
    return found


def _scattered(points: Points, resolved: Resolved) -> dict[str, StoredArray]:
    """Values by key of tolerances: one of every point, or of every point and leg, joint or axis."""
    found = {}
    draws = points.plan.draws
    for tolerance, group, values in zip(
        draws.tolerances if draws else (), points.leaves, resolved.scattered, strict=True
    ):
        key = tolerance.key
        numbers = [[step for step in leaf.key if isinstance(step, int)] for leaf in group]
        given = sum(isinstance(step, int) for step in key)
        shape = tuple(len({n[i] for n in numbers}) for i in range(given, len(numbers[0])))
        dimension = dimension_of(group[0].key, points.dimensions) or "number"
        attributes = {"long_name": key_text(key), "units": DIMENSIONS[dimension].unit or "1"}
        whole = (len(points), *shape)
        dims = _dims(key, shape, each=_of_each_leg(key))
        found[key_text(key)] = StoredArray(("point", *dims), whole, attributes, values.reshape(whole))
    return found


def _of_each_leg(key: tuple[Step, ...]) -> bool:
    """Test whether what scatters under a key has one value or row of its own for each leg."""
    return key[-1] == "joints" or (key[0] == "leg" and not isinstance(key[1], int))


def _dims(key: tuple[Step, ...], shape: tuple[int, ...], *, each: bool) -> tuple[str, ...]:
    """Names of the dimensions of what stands under a key: legs where there is one of `each`, axes, or own names."""
    dims: list[str] = []
    for position, size in enumerate(shape):
        usual = "leg" if each and position == 0 else "axis" if size == 3 else ""
        dims.append(usual if usual and usual not in dims else f"{key_text(key)} {position + 1}")
    return tuple(dims)
