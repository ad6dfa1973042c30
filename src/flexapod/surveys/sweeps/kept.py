"""What is kept of every point: scalars and whole records by name, with dimensions and units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.errors import InputError, closest
from flexapod.model import ActuatorStudy, Study
from flexapod.study.after.causes import cause_names
from flexapod.study.after.leg_results import absent, leg_labels
from flexapod.study.names import ACTUATOR_FORMS, VARIABLES, Variable
from flexapod.surveys.sweeps.plan import Keep
from flexapod.surveys.sweeps.points import Resolved
from flexapod.surveys.sweeps.scalars import ROBOT_DEFAULTS, ROBOT_SCALARS, Scalar
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["ACTUATOR_SCALARS", "Kept", "kept"]

_LABELS = {"axis": 3, "direction": 2, "quaternion": 4, "plane_axis": 2, "end": 2}
_SHAPES = ("shape", "axial_shape", "mode")  # dimensions whose size is a setting of the study


@dataclass(frozen=True, kw_only=True)
class Kept:
    """Names, in order, with their dimensions beside `point`, units and meaning; sizes of those dimensions.

    ``every``: stored instants between two that records keep; ``times`` (T,) of records [s]. ``absent``: why some
    scalars have no value at some computed points.
    """

    scalars: tuple[str, ...]
    records: tuple[str, ...]
    variables: Mapping[str, Variable]
    sizes: Mapping[str, int]
    every: int
    times: Array
    absent: Mapping[str, str]

    def shape(self, name: str) -> tuple[int, ...]:
        """Shape of a value of one point."""
        return tuple(self.sizes[dim] for dim in self.variables[name].dims)


def _tip(data: Dataset) -> Array:
    return np.abs(data.tip_deflection.values)


#: Scalars of a single actuator's simulation, from its Dataset.
ACTUATOR_SCALARS: Mapping[str, Scalar] = {
    "tip_deflection_peak": Scalar((), "m", "largest deflection of the tip", lambda d: _tip(d).max()),
    "tip_deflection_rms": Scalar(
        (), "m", "root mean square deflection of the tip", lambda d: np.sqrt(np.mean(np.square(_tip(d))))
    ),
    "tip_deflection_end": Scalar((), "m", "deflection of the tip at the end", lambda d: d.tip_deflection.values[-1]),
    "torque_peak": Scalar((), "N m", "largest torque on the hub", lambda d: np.abs(d.torque.values).max()),
    "force_peak": Scalar((), "N", "largest axial force on the beam", lambda d: np.abs(d.force.values).max()),
    "steps": Scalar((), "1", "steps of the time integration", lambda d: float(d.attrs["steps"])),
}


def kept(keep: Keep, study: Study | ActuatorStudy, resolved: Resolved) -> Kept:
    """What to keep of the points of a sweep.

    Raises
    ------
    InputError
        A name that does not exist, or records of different sizes at different points.
    """
    robot = isinstance(study, Study)
    table = ROBOT_SCALARS if robot else ACTUATOR_SCALARS
    names = keep.scalars or (() if keep.records else ROBOT_DEFAULTS if robot else tuple(ACTUATOR_SCALARS))
    for name in names:
        _known(name, table, "keep.scalars")
    whole = _records(study)
    for name in keep.records:
        _known(name, whole, "keep.records")
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
    return Kept(
        scalars=names, records=keep.records, variables=variables, sizes=sizes, every=every, times=times, absent=absent
    )


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


def _known(name: str, table: Mapping[str, object], key: str) -> None:
    if name not in table:
        raise InputError("is not known", key=key, value=name, allowed=", ".join(table), next_step=closest(name, table))


def _records(study: Study | ActuatorStudy) -> dict[str, Variable]:
    """Variables over time that a simulation of this kind of study has."""
    over_time = {name: entry for name, entry in VARIABLES.items() if "time" in entry.dims[:1]}
    actuator = ("length", "angle", "length_rate", "angle_rate", "mode_amplitude", "tip_position", "torque", "force")
    shared = ("energy_kinetic", "energy_dissipated", "work_drive", "work_external", "closure_residual")
    if isinstance(study, ActuatorStudy):
        return {name: over_time[name] for name in (*actuator, *shared)} | ACTUATOR_FORMS
    kinematics = ("leg_length_rate", "leg_length_acceleration", "leg_angle_rigid", "platform_position")
    reactions = ("base_force_rigid", "base_moment_rigid", "held_force_rigid", "joint_moment_rigid")
    others = {*actuator, *kinematics, *reactions, *absent(study.robot)}
    return {name: entry for name, entry in over_time.items() if name not in others}


def _instants(keep: Keep, resolved: Resolved) -> tuple[int, Array]:
    """Stored instants between two kept ones, and the times of these."""
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
