"""The registry of scalar outputs of a study, by name and unit: at a pose, of an error budget, of the motion, of parts.

Sensitivities, optimisations and sweeps ask here what a name means; a value is computed when it is asked for, and what
several values need is computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.checks.reachability import REACHED, flags
from flexapod.analysis.error_budget.rows import budget_rows_by_pose
from flexapod.analysis.error_budget.rules import PLACE, Budget
from flexapod.analysis.pose_values import PoseRequest, Values, batch_values
from flexapod.analysis.pose_variables import FURTHER_VARIABLES, GRID_VARIABLES
from flexapod.analysis.results.arguments import PoseLike, as_pose
from flexapod.analysis.results.leg_results import damped_angles
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import collect
from flexapod.analysis.scalars import ROBOT_SCALARS, RobotRun
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, check_known
from flexapod.model import Study
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.statics.locked_robot import single_equilibrium
from flexapod.solve.time.robot_march import prepare

AXES = "xyz"


class StudyValues:
    """Scalar outputs of one study at a pose; what several of them need is computed once, when it is asked for."""

    def __init__(self, study: Study, pose: PoseLike = None) -> None:
        self.study: Study = study
        self.pose: PoseLike = pose

    def values(self, names: Iterable[str]) -> dict[str, float]:
        """Numbers of these outputs, SI; NaN where the study has none.

        Raises
        ------
        FlexapodError
            The pose is out of reach, there is no equilibrium, or a simulation stopped.
        """
        return {name: float(OUTPUTS[name].value(self)) for name in names}

    @cached_property
    def _elastic(self) -> ElasticRobot:
        return ElasticRobot(self.study.robot, self.study.simulation, self.study.load)

    @cached_property
    def _rigid(self) -> kinematics.RigidPoses:
        return kinematics.RigidPoses(self.study.robot, as_pose(self.study.robot, self.pose))

    def _batch(self, axis: int) -> Values:
        wanted = PoseRequest(direction=np.eye(3)[axis], acceleration=None, frequencies=1)
        code, values = batch_values(self.study, self._elastic, self._rigid, wanted)
        if code[0] != REACHED:
            known = flags()
            words = dict(zip(known["flag_values"], str(known["flag_meanings"]).split(), strict=False))  # type: ignore[call-overload]
            raise ComputationError(f"the pose has no values: {str(words.get(code[0], code[0])).replace('_', ' ')}")
        return {name: rows[0] for name, rows in values.items()}

    @cached_property
    def at_pose(self) -> Values:
        """Values of the pose by the names of maps, stiffness along z."""
        return self._batch(2)

    def stiffness(self, axis: int) -> float:
        """Stiffness at the tool against a force along a world axis [N/m]."""
        return float((self.at_pose if axis == 2 else self._batch(axis))["stiffness"])

    @cached_property
    def budget(self) -> Budget:
        """The error budget of the pose."""
        locked = self._elastic.lock(self._rigid)
        single_equilibrium(locked)
        ((table, whole, _),) = budget_rows_by_pose(self.study, locked)
        return Budget(rows=table, whole={"systematic": whole})

    @cached_property
    def run(self) -> RobotRun:
        """The simulated motion."""
        path = RigidPath(self.study)
        check_path(self.study, path)
        march = prepare(self.study)
        record = collect(march.chunks, damped_angles(march.system), self.study.duration, None)
        if record.interrupted:
            raise KeyboardInterrupt
        if record.failure is not None:
            raise ComputationError(f"the simulation stopped at t = {record.time[-1]:.6g} s: {record.failure}")
        return RobotRun(self.study, march.system, record, march.counters, path.at(record.time))


@dataclass(frozen=True, kw_only=True)
class ScalarOutput:
    """Unit, meaning and value of an output; `of` what it is computed: "pose", "budget", "motion" or "parts".

    `smooth`: why it has no derivative; empty of one that has.
    """

    units: str
    long_name: str
    of: str
    value: Callable[[StudyValues], float | Array]
    smooth: str = ""


def _pose_outputs() -> dict[str, ScalarOutput]:
    table = {name: form for name, form in (GRID_VARIABLES | FURTHER_VARIABLES).items() if form.dims == ()}
    del table["reason"], table["stiffness"], table["error_worst"]

    def reader(name: str) -> Callable[[StudyValues], float | Array]:
        return lambda found: found.at_pose.get(name, np.array(np.nan))

    def along(axis: int) -> Callable[[StudyValues], float]:
        return lambda found: found.stiffness(axis)

    return {
        "first_frequency": ScalarOutput(
            units="Hz", long_name="first natural frequency, commands of the drives held", of="pose",
            value=lambda found: found.at_pose["frequency"][0],
        ),
        **{
            f"stiffness_{axis}": ScalarOutput(
                units="N m-1", long_name=f"stiffness at the tool along {axis}", of="pose", value=along(k)
            )
            for k, axis in enumerate(AXES)
        },
        **{
            name: ScalarOutput(units=form.units, long_name=form.long_name, of="pose", value=reader(name))
            for name, form in table.items()
        },
    }  # fmt: skip


def _place(vector: Array) -> float:
    return float(np.linalg.norm(vector[PLACE]))


def _budget_outputs() -> dict[str, ScalarOutput]:
    def entry(words: str, value: Callable[[Budget], float]) -> ScalarOutput:
        return ScalarOutput(units="m", long_name=words, of="budget", value=lambda found: value(found.budget))

    words = "of the tool's place"
    return {
        "error_worst": entry(FURTHER_VARIABLES["error_worst"].long_name, lambda found: _place(found.worst)),
        "pose_accuracy": entry(f"pose accuracy {words}", lambda found: _place(found.accuracy(calibrated=False))),
        "pose_accuracy_calibrated": entry(
            f"pose accuracy {words} after a calibration", lambda found: _place(found.accuracy(calibrated=True))
        ),
        "repeatability_unidirectional": entry(
            f"repeatability {words}, approached from one side", lambda found: _place(found.unidirectional)
        ),
        "repeatability_bidirectional": entry(
            f"repeatability {words}, approached from both sides", lambda found: _place(found.bidirectional)
        ),
    }


def _motion_outputs() -> dict[str, ScalarOutput]:
    """Scalars of a simulation without dimensions; that of home has the name of one above."""
    found = {}
    for name, scalar in ROBOT_SCALARS.items():
        if scalar.dims or name == "first_frequency":
            continue
        peak = name.endswith("_peak")
        why = "the instant of a peak jumps from one step to the next" if peak else ""
        why = "a count does not change gradually" if name == "steps" else why
        found[name] = ScalarOutput(
            units=scalar.units, long_name=scalar.long_name, of="motion", smooth=why,
            value=lambda values, scalar=scalar: scalar.value(values.run),
        )  # fmt: skip
    return found


#: Scalar outputs of a robot's study, by name.
OUTPUTS: Mapping[str, ScalarOutput] = {
    **_pose_outputs(),
    **_budget_outputs(),
    **_motion_outputs(),
    "piston_mass": ScalarOutput(
        units="kg", long_name="mass of all pistons and struts", of="parts",
        value=lambda found: sum(leg.piston.mass for leg in found.study.robot.legs),
    ),
    "leg_mass": ScalarOutput(
        units="kg", long_name="mass of all legs, cylinders and pistons", of="parts",
        value=lambda found: sum(leg.piston.mass + leg.cylinder.mass for leg in found.study.robot.legs),
    ),
}  # fmt: skip

DEFAULTS = ("first_frequency", "stiffness_least", "static_deviation_size", "pose_accuracy", "pose_accuracy_calibrated")


def check_output(name: object, key: str = "outputs") -> str:
    """The name of an output; others are refused, with the one that was meant.

    Raises
    ------
    InputError
        There is no such output.
    """
    check_known(str(name), OUTPUTS, key)
    return str(name)
