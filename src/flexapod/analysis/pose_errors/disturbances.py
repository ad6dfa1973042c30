"""Vibration of a robot at rest by its disturbances: a Dataset, rows of an error budget, and words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.checks.checks import path_remarks
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.results.arguments import PoseLike, RobotLike, as_pose, at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.mode_shapes import mode_values
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.quantities import along_axes, cleared
from flexapod.common.ranking import EQUALS, first_largest
from flexapod.common.resources import one_thread
from flexapod.kinematics import Poses
from flexapod.model import Disturbance, Study
from flexapod.solve.linear.random_vibration import Source, random_vibration, sources_of, with_error
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.eigenproblem import count_real
from flexapod.solve.modal.modes import the_modes
from flexapod.solve.statics.locked_robot import LockedPoses

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.solve.linear.random_vibration import LinearRobot

BEYOND = "the floor's spectrum ends at"
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
    study = at_pose(robot)
    path = as_pose(study.robot, pose)
    locked = _locked(study, path)
    model, sources = _linear(study, locked)
    found, error = with_error(model, sources)
    count = count_real(model.omega[None])
    modes = mode_values(study.robot, the_modes(locked, loops=False), path)
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
    remarks = [*study.warnings, *path_remarks(study.robot, np.zeros(1), path), *_beyond(study, modes["frequency"])]
    return dataset(values, labels, attributes(study, remarks) | {"estimated_error": error})


def _locked(study: Study, path: Poses) -> LockedPoses:
    if study.disturbance is None:
        raise InputError(
            "is missing: nothing shakes the robot",
            key="disturbance",
            allowed="floor, wrench, force_noise",
            next_step='Add to the study: [disturbance] floor = "VC-C"',
        )
    if study.robot.platform_fixed:
        raise InputError("has no tool that moves: the platform is fixed", key="robot.platform.fixed", value=True)
    return locked_poses(study.robot, study.simulation, path, study.load)


def _linear(study: Study, locked: LockedPoses) -> tuple[LinearRobot, list[Source]]:
    from flexapod.solve.linear.random_vibration import linear_robot  # what checks do not load

    model = linear_robot(locked)
    return model, sources_of(study.disturbance or Disturbance(), model)


def _beyond(study: Study, frequency: Array) -> list[str]:
    """Doubt where the robot resonates above what is known of the floor."""
    floor = None if study.disturbance is None else study.disturbance.floor
    if floor is None or frequency[0] <= floor.frequency[-1]:
        return []
    return [
        f"the lowest mode lies at {frequency[0]:.4g} Hz, but {BEYOND} {floor.frequency[-1]:.4g} Hz: "
        "no resonance is in its vibration"
    ]


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


def vibration_words(study: Study) -> tuple[str, ...]:
    """Vibration of the tool at home in sentences; none without disturbances."""
    if study.disturbance is None:
        return ()
    try:
        return words_of(vibration(study), "at home")
    except (InputError, ComputationError) as error:
        return (f"the vibration at home by disturbances cannot be said: {error}",)


def words_of(data: Dataset, where: str) -> tuple[str, ...]:
    """How much the tool shakes, along which axis most, by what and in which mode; doubts."""
    rms = data.vibration_rms.values
    shown = [cleared(size, rms[:3].max()) for size in rms[:3]]
    sizes = along_axes(shown)
    most = int((rms[:3] > (1 - 1e-6) * rms[:3].max()).argmax())
    if not rms[most] > 0:
        return (f"disturbances do not move the tool {where}",)
    sources, f = data.vibration_by_source.values[:, most], data.frequency.values
    alike = np.abs(f - f[:, None]) < 1e-3 * f
    modes = alike @ data.vibration_by_mode.values[:, most]
    culprit = first_largest(modes, EQUALS)
    return (
        f"disturbances shake the tool {where} by {sizes} (rms, relative to the base), along {'xyz'[most]} most by the "
        f"{data.source.values[first_largest(sources, EQUALS)]}, {100 * modes[culprit] / rms[most]:.0f} % of it in "
        f"the mode at {f[culprit]:.4g} Hz ({data.kind.values[culprit]})",
        *(line for line in data.attrs["warnings"].splitlines() if BEYOND in line),
    )
