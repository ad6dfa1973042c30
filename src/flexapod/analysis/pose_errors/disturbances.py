"""Vibration of a robot at rest by its disturbances: a Dataset, rows of an error budget, and what matters of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.checks.checks import pose_remarks
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.results.arguments import PoseLike, RigidPose, RobotLike, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.mode_shapes import mode_values
from flexapod.analysis.results.remarks import FLOOR_ENDS, remark
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.ranking import EQUALS, first_largest
from flexapod.common.resources import one_thread
from flexapod.kinematics import RigidPoses
from flexapod.model import Disturbance, Study
from flexapod.solve.linear.random_vibration import Source, random_vibration, sources_of, vibration_with_error
from flexapod.solve.modal.eigenproblem import count_real
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import single_pose_modes
from flexapod.solve.statics.locked_robot import LockedPoses

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.solve.linear.random_vibration import LinearRobot

HOW = "spectra through the linear model about the static equilibrium"


@one_thread()
def vibration(robot: RobotLike, pose: PoseLike = None) -> Dataset:
    """Random vibration of the tool relative to the base at a pose, by the study's disturbances.

    About the static equilibrium, commands of the drives held; loads as of `modes`. Spectra are one-sided.

    Parameters
    ----------
    robot : Study or path
        With `disturbance`.
    pose : pose, optional
        As for `modes`; default home.

    Returns
    -------
    xarray.Dataset
        Of the tool along and about world x, y, z (`component`): `vibration_rms`, `vibration_covariance`;
        `vibration_psd` over `spectrum_frequency` [Hz], which is fine where the robot resonates, and
        `vibration_cumulative`, the rms of what is at each frequency and above. `vibration_by_source`: rms, whose
        squares add up; `vibration_by_mode`: what each mode takes of the rms, with its sign, adding up to it;
        `frequency`, `damping_ratio`, `kind` of the modes. Attribute `estimated_error` of the largest rms by the
        integral over frequency, relative.

    Raises
    ------
    InputError
        No disturbance, a pose out of reach, a platform that is fixed, something that vibrates without damping, noise
        of drives that hold their positions.
    ComputationError
        No equilibrium at this pose.

    Examples
    --------
    >>> text = fx.preset("machine-hexapod").source_text
    >>> study = fx.loads(chr(10).join(['disturbance = { floor = "VC-C" }', text]))
    >>> data = fx.vibration(study)
    >>> data.vibration_rms.dims, data.vibration_psd.dims
    (('component',), ('spectrum_frequency', 'component'))
    """
    study = study_at_pose(robot)
    at = RigidPose(study.robot, pose)
    locked = _locked(study, at)
    model, sources = _linear(study, locked)
    found, error = vibration_with_error(model, sources)
    count = count_real(model.omega[None])
    modes = mode_values(study.robot, single_pose_modes(locked, loops=False), at.poses)
    values = {
        "vibration_rms": found.rms,
        "vibration_covariance": found.covariance,
        "vibration_psd": found.psd,
        "vibration_cumulative": found.cumulative,
        "vibration_by_source": found.by_source,
        "vibration_by_mode": found.by_mode[:count],
        **{name: modes[name] for name in ("frequency", "damping_ratio", "kind")},
    }
    labels = {"spectrum_frequency": found.frequency, "source": list(found.sources), "mode": np.arange(1, count + 1)}
    remarks = [*study.warnings, *pose_remarks(at), *_beyond(study, modes["frequency"])]
    return dataset(values, labels, attributes(study, remarks) | {"estimated_error": error})


def _locked(study: Study, at: RigidPoses) -> LockedPoses:
    if study.disturbance is None:
        raise InputError(
            "is missing: nothing shakes the robot",
            key="disturbance",
            allowed="floor, wrench, force_noise",
            next_step='Add to the study: [disturbance] floor = "VC-C"',
        )
    if study.robot.platform_fixed:
        raise InputError("has no tool that moves: the platform is fixed", key="robot.platform.fixed", value=True)
    return ElasticRobot(study.robot, study.simulation, study.load).lock(at)


def _linear(study: Study, locked: LockedPoses) -> tuple[LinearRobot, list[Source]]:
    from flexapod.solve.linear.random_vibration import linear_robot  # what checks do not load

    model = linear_robot(locked)
    return model, sources_of(study.disturbance or Disturbance(), model)


def _beyond(study: Study, frequency: Array) -> list[str]:
    """Doubt where the robot resonates above what is known of the floor."""
    floor = None if study.disturbance is None else study.disturbance.floor
    if floor is None or frequency[0] <= floor.frequency[-1]:
        return []
    return [remark("floor", frequency=frequency[0], end=floor.frequency[-1])]


def vibration_rows(study: Study, locked: LockedPoses) -> list[ErrorRow]:
    """Rows of an error budget at one pose; none without disturbances. Raises as `vibration`."""
    if study.disturbance is None:
        return []
    found = random_vibration(*_linear(study, locked))
    each = zip(found.sources, found.by_input, found.by_source, strict=True)
    return [
        ErrorRow(name, "random", "", by_input if name == "force noise" else whole[None], HOW)
        for name, by_input, whole in each
    ]


@dataclass(frozen=True, kw_only=True)
class Shaking:
    """Vibration of the tool: `rms` (3,) [m], that along the `axis` with `most`, and what does it.

    `source`: the disturbance that does most of it along that axis; `frequency` [Hz] and `kind` of the mode with most
    of it, `per_cent` of the rms; `doubts` about it in words.
    """

    rms: tuple[float, ...]
    axis: str
    most: float
    source: str
    frequency: float
    kind: str
    per_cent: float
    doubts: tuple[str, ...]


def home_shaking(study: Study) -> Shaking | str | None:
    """Vibration of the tool at home, or why that cannot be said; None without disturbances."""
    if study.disturbance is None:
        return None
    try:
        return shaking(vibration(study))
    except (InputError, ComputationError) as error:
        return str(error)


def shaking(data: Dataset) -> Shaking:
    """Vibration of the tool, from the result of `vibration`: size, axis, source and mode of most of it."""
    rms = data.vibration_rms.values
    most = int((rms[:3] > (1 - 1e-6) * rms[:3].max()).argmax())
    sources, f = data.vibration_by_source.values[:, most], data.frequency.values
    alike = np.abs(f - f[:, None]) < 1e-3 * f
    modes = alike @ data.vibration_by_mode.values[:, most]
    culprit = first_largest(modes, EQUALS)
    return Shaking(
        rms=tuple(rms[:3].tolist()),
        axis="xyz"[most],
        most=float(rms[most]),
        source=str(data.source.values[first_largest(sources, EQUALS)]),
        frequency=float(f[culprit]),
        kind=str(data.kind.values[culprit]),
        per_cent=float(100 * modes[culprit] / rms[most]) if rms[most] > 0 else 0.0,
        doubts=tuple(line for line in data.attrs["warnings"].splitlines() if FLOOR_ENDS in line),
    )
