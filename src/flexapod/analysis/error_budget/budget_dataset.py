"""The error budget as a Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.checks.checks import pose_remarks
from flexapod.analysis.checks.stability import loop_remarks_at
from flexapod.analysis.error_budget.along_motion import along_motion
from flexapod.analysis.error_budget.rows import budget_rows
from flexapod.analysis.error_budget.rules import Budget
from flexapod.analysis.error_budget.text import sentences
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RigidPose, RobotLike, as_study, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Progress
from flexapod.analysis.results.variables import dataset
from flexapod.common.arguments import flag
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.model import Study
from flexapod.solve.modal.elastic_robot import ElasticRobot

if TYPE_CHECKING:
    from xarray import Dataset


@one_thread()
def budget(
    robot: RobotLike,
    pose: PoseLike = None,
    *,
    motion: bool = False,
    load: LoadLike = None,
    progress: Progress | None = None,
) -> Dataset:
    """Error budget of the tool, at a pose or along the motion: contributions of all parts, and their sums.

    Parameters
    ----------
    robot : Robot, Study or path
        For a motion a whole study.
    pose : pose, optional
        As for `modes`; default home.
    motion : bool
        Along the study's motion in place of a pose: the pose of the largest static deviation, and what is dynamic.
    load : Load, wrench or array_like (6,), optional
        At the tool, in place of the study's; at rest as just before t = 0.
    progress : callable, optional
        Of the simulation of a motion: called with simulated and whole time [s].

    Returns
    -------
    xarray.Dataset
        At the tool, along and about world x, y, z (`component`): `budget` (part, kind, component), of which
        `budget_by_leg` are the shares of the legs; `budget_total`, `budget_residual` (kind, component): by the rule of
        each kind, and what the rows leave of it. `share` of each part in the sum of sizes; `nature` of a part:
        calibratable, repeatable, drifting or empty; `how` (part, kind) it was computed. `worst`, `rss`: totals over all
        kinds; `pose_accuracy` (state, component); `repeatability_unidirectional`, `repeatability_bidirectional`. Of a
        motion `worst_time` of the pose and `peak_time` (component). In words: attribute `summary`, a line each.

    Raises
    ------
    InputError
        A pose out of reach, a pose and a motion, a platform that is fixed, a pure force drive.
    ComputationError
        There is no equilibrium, or the pose is singular.

    Examples
    --------
    >>> data = fx.budget(fx.preset("machine-hexapod"))
    >>> print((100 * data.share.sel(part=["base_joints tolerance", "heat_piston", "base_joint"])).round(1).values)  # %
    [33.9  4.9  1.3]
    """
    flag(motion, "motion")
    if motion and pose is not None:
        raise InputError("is given together with a motion", key="pose", next_step="Choose either of the two")
    study = as_study(robot, load=load) if motion else study_at_pose(robot, load)
    if study.robot.platform_fixed:
        raise InputError("has a platform that is fixed: its tool does not move", key="robot")
    elastic = ElasticRobot(study.robot, study.simulation, study.load)
    if motion:
        found = along_motion(RigidPath(study), elastic, progress)
        remarks, times = found.remarks, {"worst_time": found.time, "peak_time": found.peaks}
        table, where = found.budget, f"at the pose of t = {found.time:.4g} s, the worst of the motion,"
    else:
        at, times = RigidPose(study.robot, pose), {}
        remarks = [*study.warnings, *pose_remarks(at)]
        locked = elastic.lock(at)
        table, whole, missing = budget_rows(study, locked)
        remarks += [*missing, *loop_remarks_at(locked)]
        table, where = Budget(rows=table, whole={"systematic": whole}), "at home" if pose is None else "at the pose"
    words = {"where": where, "summary": "\n".join(sentences(table, where))}
    return _budget_dataset(study, table, times, words, remarks)


def _budget_dataset(study: Study, found: Budget, times: dict, words: dict[str, str], remarks: list[str]) -> Dataset:
    parts, kinds, n = found.parts, found.kinds, study.robot.count
    by_leg = np.zeros((len(parts), len(kinds), n, 6))
    how = np.full((len(parts), len(kinds)), "", dtype=object)
    for row in found.rows:
        by_leg[parts.index(row.part), kinds.index(row.kind)] += row.by_leg if len(row.by_leg) == n else np.nan
        how[parts.index(row.part), kinds.index(row.kind)] = row.how
    nature = {row.part: row.nature for row in reversed(found.rows) if row.nature}
    values = {
        "budget": np.array([[found.part_error(part, kind) for kind in kinds] for part in parts]).reshape(
            -1, len(kinds), 6
        ),
        "budget_by_leg": by_leg,
        "budget_total": np.array([found.total(kind) for kind in kinds]),
        "budget_residual": np.array([found.residual(kind) for kind in kinds]),
        "nature": np.array([nature.get(part, "") for part in parts], dtype=str),
        "how": how.astype(str),
        "share": np.array([found.shares[part] for part in parts]),
        "worst": found.worst,
        "rss": found.rss,
        "pose_accuracy": np.array([found.accuracy(calibrated=x) for x in (False, True)]),
        "repeatability_unidirectional": found.unidirectional,
        "repeatability_bidirectional": found.bidirectional,
        **times,
    }
    labels = {"part": list(parts), "kind": list(kinds)}
    return dataset(values, labels, {**attributes(study, remarks), **words})
