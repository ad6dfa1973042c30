"""Simulations: a study in, a Dataset out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.checks.plausibility import robot_warnings
from flexapod.analysis.checks.stability import loop_remarks, step_warnings
from flexapod.analysis.controller_settings import (
    Noise,
    PerChannel,
    control_attributes,
    control_coords,
    control_remarks,
    control_results,
    sampled_controller,
)
from flexapod.analysis.description.drive_limits import drive_warnings
from flexapod.analysis.results.arguments import LoadLike, RobotLike, StartLike, as_study, read_subject
from flexapod.analysis.results.attributes import attributes, march_attributes
from flexapod.analysis.results.element_outputs import element_forms
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.analysis.results.leg_results import damped_angles, drive_forms, force_error, force_warnings
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.robot_results import payload_results, rigid_force_results, robot_coords, robot_results
from flexapod.analysis.results.time_history import Progress, Record, check_progress, collect, result_or_interrupt
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array
from flexapod.common.resources import one_thread
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.time.robot_march import RobotMarch, prepare

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis.controller_settings import AnyController
    from flexapod.solve.time.sampled_control import SampledController


@dataclass(frozen=True, kw_only=True)
class RobotSimulation:
    """A simulation of a robot before its results have names: study, path, robot, march, record, remarks."""

    study: model.Study
    path: RigidPath
    elastic: ElasticRobot
    march: RobotMarch
    record: Record
    remarks: list[str]
    sampled: SampledController | None = None

    @cached_property
    def recorded_path(self) -> RigidPath:
        """The path at the recorded instants."""
        return self.path.at(self.record.time)

    def values(self) -> LazyArrays:
        """The variables of the Dataset as plain arrays, each computed on request."""
        path = self.recorded_path
        found = robot_results(self.march.system, path, self.record) | rigid_force_results(
            path, self.march.system.kernel
        )
        return LazyArrays(found | control_results(self.sampled, self.record))

    @cached_property
    def force_error(self) -> float | None:
        """Estimated error of the legs' forces over their peak, where steps follow a tolerance."""
        return force_error(self.study.robot, self.march.system, self.record)

    def _tool_deviation(self) -> Array:
        """Deviation of the tool, (T, 3) [m]."""
        return LazyArrays(payload_results(self.recorded_path, self.record))["tool_deviation"]

    def warnings(self) -> list[str]:
        """Remarks on the study, its path and its results."""
        found = force_warnings(self.study, self.force_error)
        found += step_warnings(self.study, self.elastic, self.record.smallest_step, self._tool_deviation)
        found += robot_warnings(self.study.robot, self.march.system, self.record)
        found += drive_warnings(self.study.robot, self.march.system, self.record)
        return [*self.study.warnings, *self.remarks, *found]

    def dataset(self) -> Dataset:
        """Results of the simulation as a Dataset."""
        march, system = self.march, self.march.system
        attrs = {
            **attributes(self.study, self.warnings()),
            **march_attributes(self.study, march.counters, self.record, compiled=system.kernel.library is not None),
            "impact_energy": march.impact,
        }
        if (error := self.force_error) is not None:
            attrs["estimated_force_error"] = error
        attrs |= control_attributes(self.sampled)
        robot = self.study.robot
        coords = robot_coords(robot, system, self.record) | control_coords(self.sampled)
        return dataset(self.values(), coords, attrs, drive_forms(robot) | element_forms(robot))


@one_thread()
def run_simulation(
    study: model.Study, progress: Progress | None = None, sampled: SampledController | None = None
) -> RobotSimulation:
    """Check and integrate a robot study, with its controller or another one; what `simulate` does, without a Dataset.

    A record that stopped early says so: ``record.failure``, ``record.interrupted``.

    Raises
    ------
    InputError, ComputationError
        As `simulate`.
    """
    path, elastic = RigidPath(study), ElasticRobot(study.robot, study.simulation, study.load)
    return simulate_path(path, elastic, progress, sampled)


def simulate_path(
    path: RigidPath, elastic: ElasticRobot, progress: Progress | None = None, sampled: SampledController | None = None
) -> RobotSimulation:
    """Check and integrate a study on its rigid path; as `run_simulation`."""
    check_progress(progress)
    study, sampled = path.study, sampled or sampled_controller(path.study)
    remarks = [*check_path(study, path), *loop_remarks(path, elastic), *control_remarks(sampled)]
    march = prepare(study, sampled=sampled, elastic=elastic, path=path.series)
    record = collect(march.chunks, damped_angles(march.system), study.duration, progress)
    return RobotSimulation(
        study=study, path=path, elastic=elastic, march=march, record=record, remarks=remarks, sampled=sampled
    )


@one_thread()
def simulate(
    robot: RobotLike,
    motion: model.Motion | None = None,
    *,
    load: LoadLike = None,
    initial: StartLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    duration: float | None = None,
    output_step: float | None = None,
    rho_inf: float | None = None,
    controller: AnyController | None = None,
    sample: float | str | None = None,
    delay_samples: int | None = None,
    quantise: PerChannel = None,
    saturate: PerChannel = None,
    noise: Noise = None,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Dataset:
    """Motion of a robot with elastic legs against the rigid one.

    Parameters
    ----------
    robot : Robot, Study or path
        A robot with its motion, a whole study, or its file.
    motion, load, initial : optional
        In place of the study's: a Motion; a Load, or Fx Fy Fz [N], Mx My Mz [N m] at the tool, world axes; an Initial,
        or "equilibrium", "straight", "moving".
    fidelity, modes, axial_modes, basis, tolerance, step, duration, output_step, rho_inf : optional
        In place of those of [simulation]; times in s.
    controller, sample, delay_samples, quantise, saturate, noise, seed : optional
        A sampled controller and its settings, as of `study.controlled.sampled_controller`; in place of [control].
    progress : callable, optional
        Called with simulated and whole time [s].

    Returns
    -------
    xarray.Dataset
        The variables of the table `results.names`, SI units. ``partial = 1`` in the attributes if the integration
        stopped before its end; ``failure`` then says why.

    Raises
    ------
    InputError
        The path leaves a stroke, pulls a piston out or is singular; settings do not fit.
    ComputationError, Interrupted
        There is no equilibrium to start from, or the first steps fail; Ctrl-C, with what was computed.

    Examples
    --------
    >>> data = fx.simulate(fx.preset("paper-robot"), fidelity="lumped")
    >>> data.com_deviation.dims, data.com_deviation.units
    (('time', 'axis'), 'm')
    >>> print((1e6 * abs(data.com_deviation).max("time")).round(1).values)  # um, x y z
    [ 4.4  9.4 19.3]
    """
    study = model.override(
        as_study(robot, motion, load, initial), fidelity=fidelity, modes=modes, axial_modes=axial_modes, basis=basis,
        tolerance=tolerance, step=step, duration=duration, output_step=output_step, rho_inf=rho_inf,
    )  # fmt: skip
    sampled = sampled_controller(study, controller, sample, delay_samples, quantise, saturate, noise, seed)
    found = run_simulation(study, progress, sampled)
    return result_or_interrupt(found.dataset, found.record)


@one_thread()
def run(
    study: RobotLike | model.ActuatorStudy | model.Actuator,
    motion: model.Motion | model.ActuatorMotion | None = None,
    *,
    progress: Progress | None = None,
) -> Dataset:
    """Rigid and flexible results of a study, of a robot or of a single actuator.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
        From `flexapod.load` or `flexapod.preset`, or the file; also a robot or an actuator with its `motion`.
    motion : Motion, optional
        In place of the study's.
    progress : callable, optional
        Called with simulated and whole time [s].

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError, ComputationError, Interrupted
        As `simulate`.

    Examples
    --------
    >>> data = fx.run(fx.preset("paper-actuator"))  # of a robot or of a single actuator
    >>> print(f"{1e3 * float(abs(data.tip_deflection).max()):.1f} mm")
    13.7 mm
    """
    study = read_subject(study)
    if isinstance(study, model.ActuatorStudy | model.Actuator):
        return simulate_actuator(study, motion, progress=progress)  # type: ignore[arg-type]
    found = run_simulation(as_study(study, motion), progress)  # type: ignore[arg-type]
    return result_or_interrupt(found.dataset, found.record)
