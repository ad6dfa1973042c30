"""Scalars of a robot's simulation for a sweep: from the record, without building a Dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.plausibility import leg_stress
from flexapod.analysis.results.bodies import flexible_axes
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.analysis.results.leg_results import drive_forces
from flexapod.analysis.results.legs import bending_amplitudes_of_leg, bending_basis, lateral_amplitudes
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.robot_results import cause_results
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.ranking import first_largest
from flexapod.kinematics.rotations import difference, matrix, quaternion
from flexapod.model import Study
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.solve.system import System
from flexapod.solve.time.recording import Counters


class Scalar(NamedTuple):
    """A quantity of a point: dimensions beside `point`, SI unit, meaning, and how it follows from a run.

    ``absent``: why a computed point may have no such number; empty: it always has one.
    """

    dims: tuple[str, ...]
    units: str
    long_name: str
    value: Callable[..., Array | float]
    absent: str = ""


@dataclass(frozen=True)
class RobotRun:
    """A finished simulation of a robot; every quantity is computed on request, once."""

    study: Study
    system: System
    record: Record
    counters: Counters
    path: RigidPath
    """At the stored instants."""

    @cached_property
    def com_rigid(self) -> Array:
        """Centre of mass on the rigid path, (T, 3) [m]."""
        return self.path.place(self.study.robot.com)

    @cached_property
    def com_deviation(self) -> Array:
        """Deviation of the centre of mass, (T, 3) [m]."""
        return self.record.pose[:, :3] - self.com_rigid

    @cached_property
    def turn(self) -> Array:
        """Rotation matrices of the payload, (T, 3, 3)."""
        return matrix(self.record.pose[:, 3:])

    @cached_property
    def tool_deviation(self) -> Array:
        """Deviation of the tool, (T, 3) [m]."""
        robot = self.study.robot
        return self.record.pose[:, :3] + self.turn @ (robot.tool - robot.com) - self.path.place(robot.tool)

    @cached_property
    def rotation_deviation(self) -> Array:
        """Angle between flexible and rigid platform, (T,) [rad]."""
        return np.linalg.norm(difference(self.record.pose[:, 3:], quaternion(self.path.rotation)), axis=1)

    @cached_property
    def actuator_force(self) -> Array:
        """Force of every drive on what it moves, (T, legs) [N, of cranks N m]."""
        return drive_forces(self.study.robot, self.system, self.record)

    @cached_property
    def lateral(self) -> Array:
        """Lateral amplitudes, (T, legs, 2, k) [m]."""
        return lateral_amplitudes(self.system.kernel.shapes, self.record.q)

    @cached_property
    def tip_deflection(self) -> Array:
        """Distance of the pistons' tips from the cylinders' axes, (T, legs) [m]."""
        return np.linalg.norm(self.lateral @ bending_basis(self.system.kernel.shapes).tip, axis=-1)

    @cached_property
    def stress(self) -> Array:
        """Largest stress in every piston over time, (legs,) [Pa]; NaN of a piston without section and material."""
        axes = flexible_axes(self.study.robot, self.system, self.record)
        compression = np.einsum("tli,tli->tl", self.record.lam[..., :3], axes)
        found, shapes = np.full(axes.shape[1], np.nan), self.system.kernel.shapes
        for i, leg in enumerate(self.study.robot.legs):
            free = self.record.q[:, i, shapes.l_index] - leg.cylinder.mouth
            bent = bending_amplitudes_of_leg(leg, shapes, self.record.q[:, i])
            stress = leg_stress(leg, bending_basis(shapes), bent, free, compression[:, i])
            found[i] = np.nan if stress is None else stress.max()
        return found

    @property
    def strain(self) -> Array:
        """Largest strain in every piston over time, (legs,)."""
        return self.stress / np.array([leg.piston.E or np.nan for leg in self.study.robot.legs])

    @property
    def cause_share(self) -> Array:
        """Share of every cause in the deviation at its peak, along its direction, (causes,); zero without deviation."""
        deviation = self.com_deviation
        at = first_largest(np.linalg.norm(deviation, axis=1))
        size = float(deviation[at] @ deviation[at])
        if size == 0.0:
            return np.zeros(len(cause_names(self.study.robot)))
        one = _instant(self.record, at)
        path = RigidPath(self.study, one.time)
        shares = LazyArrays(cause_results(self.system, path, one))["deviation_by_cause"]
        return shares[0].sum(axis=1) @ deviation[at] / size

    @property
    def first_frequency(self) -> float:
        """Lowest frequency at home, loads just before t = 0, commands of the drives held [Hz]; NaN if there is none."""
        home = kinematics.home_pose(self.study.robot)
        try:
            return float(robot_modes(self.study.robot, self.study.simulation, home, self.study.load).frequency[0])
        except InputError:  # nothing can move, or a drive that cannot be locked
            return np.nan


def _instant(record: Record, at: int) -> Record:
    """The record at one instant alone."""
    arrays = {f.name: getattr(record, f.name) for f in fields(record)}
    one = {name: value[at : at + 1] for name, value in arrays.items() if isinstance(value, np.ndarray)}
    return replace(record, **one)  # type: ignore[arg-type]


def _size(vectors: Array) -> Array:
    return np.linalg.norm(vectors, axis=1)


def _peak(values: Array) -> Array:
    return np.abs(values).max(axis=0)


def _rms(values: Array) -> Array:
    return np.sqrt(np.mean(np.square(values), axis=0))


def _deviation(point: str, words: str) -> dict[str, Scalar]:
    name = f"{point}_deviation"

    def of(run: RobotRun) -> Array:
        return getattr(run, name)

    axis = ("axis",)
    return {
        f"{name}_peak": Scalar((), "m", f"largest deviation of {words}", lambda run: _size(of(run)).max()),
        f"{name}_rms": Scalar((), "m", f"root mean square deviation of {words}", lambda run: _rms(_size(of(run)))),
        f"{name}_start": Scalar(
            (), "m", f"deviation of {words} at t = 0 (from equilibrium: the sag)", lambda run: _size(of(run)[:1])[0]
        ),
        f"{name}_peak_by_axis": Scalar(axis, "m", f"largest deviation of {words}", lambda run: _peak(of(run))),
        f"{name}_rms_by_axis": Scalar(axis, "m", f"root mean square deviation of {words}", lambda run: _rms(of(run))),
        f"{name}_start_by_axis": Scalar(axis, "m", f"deviation of {words} at t = 0", lambda run: of(run)[0]),
    }


def _by_leg(
    name: str, units: str, words: str, largest: Callable[[RobotRun], Array], absent: str = ""
) -> dict[str, Scalar]:
    return {
        name: Scalar((), units, f"largest {words}, of all legs", lambda run: largest(run).max(), absent),
        f"{name}_by_leg": Scalar(("leg",), units, f"largest {words}", largest, absent),
    }


_NO_SECTION = "a piston or strut is given by EI, EA and rhoA, without section or material"


#: Scalars of a robot's simulation, by name.
ROBOT_SCALARS: Mapping[str, Scalar] = {
    **_deviation("com", "the centre of mass"),
    **_deviation("tool", "the tool"),
    "rotation_deviation_peak": Scalar(
        (), "rad", "largest angle from the rigid to the flexible platform", lambda run: run.rotation_deviation.max()
    ),
    "com_excursion_by_axis": Scalar(
        ("axis",), "m", "peak-to-peak travel of the centre of mass on the rigid path",
        lambda run: np.ptp(run.com_rigid, axis=0),
    ),
    "cause_share": Scalar(
        ("cause",), "1", "share of a cause in the deviation of the centre of mass at its peak",
        lambda run: run.cause_share,
    ),
    **_by_leg("actuator_force_peak", "N", "size of the drive force", lambda run: _peak(run.actuator_force)),
    **_by_leg("tip_deflection_peak", "m", "deflection of a leg's tip", lambda run: _peak(run.tip_deflection)),
    **_by_leg("stress_peak", "Pa", "axial plus bending stress in a leg", lambda run: run.stress, _NO_SECTION),
    **_by_leg("strain_peak", "1", "axial plus bending strain in a leg", lambda run: run.strain, _NO_SECTION),
    "first_frequency": Scalar(
        (), "Hz", "lowest natural frequency at home, commands of the drives held", lambda run: run.first_frequency,
        "rigid legs on held strokes cannot vibrate, a pure force drive cannot be locked",
    ),
    "steps": Scalar((), "1", "steps of the time integration", lambda run: float(run.counters.steps)),
}  # fmt: skip

#: Kept where a sweep file names nothing; the first is the one that summaries and figures show.
ROBOT_DEFAULTS = (
    "com_deviation_peak",
    "com_deviation_rms",
    "com_deviation_peak_by_axis",
    "tool_deviation_peak",
    "actuator_force_peak",
    "tip_deflection_peak",
    "steps",
)
