"""Optimisation of a study as a Dataset: the best values, what holds them, what a limit costs, and the front."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.analysis.results.arguments import PoseLike, RobotLike, as_study
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import check_progress
from flexapod.analysis.results.variables import Variable, dataset
from flexapod.analysis.scalar_outputs import OUTPUTS, StudyValues
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.design.optimisation.problem import DesignProblem, Front, Limit, read_problem
from flexapod.design.optimisation.search import (
    Best,
    Evaluation,
    Follows,
    best_of_lists,
    least_margin,
    multipliers,
)
from flexapod.design.variants import Variants
from flexapod.model import Study
from flexapod.solve.modal.structural_damping import hold_loss_frequency

if TYPE_CHECKING:
    from xarray import Dataset

SIZED = ("leg.drive", "leg.cylinder")  # parts whose masses are numbers of their own in a file
FORMS = {
    "optimum": Variable(("variable",), "mixed", "best value [SI]"),
    "start": Variable(("variable",), "mixed", "value in the study [SI]"),
    "low": Variable(("variable",), "mixed", "lower bound [SI]"),
    "high": Variable(("variable",), "mixed", "upper bound [SI]"),
    "chosen": Variable(("list",), "1", "row of the list that is best"),
    "objective": Variable((), "mixed", "value of the objective [SI]"),
    "objective_start": Variable((), "mixed", "value of the objective before [SI]"),
    "output": Variable(("constraint",), "1", "output that is limited"),
    "sense": Variable(("constraint",), "1", "least or most"),
    "limit": Variable(("constraint",), "mixed", "limit [SI]"),
    "reached": Variable(("constraint",), "mixed", "value of the output [SI]"),
    "kept": Variable(("constraint",), "1", "1 where the limit is kept"),
    "multiplier": Variable(("constraint",), "mixed", "change of the objective for one unit more of the limit [SI]"),
    "target": Variable(("point",), "mixed", "most, or least, of the front's output [SI]"),
    "front_output": Variable(("point",), "mixed", "the front's output [SI]"),
    "front_objective": Variable(("point",), "mixed", "objective, NaN where the target cannot be met [SI]"),
    "front_optimum": Variable(("point", "variable"), "mixed", "values of the variables [SI]"),
}


@one_thread()
def optimise(
    study: RobotLike,
    design: Mapping[str, Any] | str | Path,
    *,
    pose: PoseLike = None,
    follows: Follows | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Dataset:
    """Optimise numbers of a study within bounds and limits.

    Parameters
    ----------
    study : Study or path
        Of a robot.
    design : mapping or path
        Tables of a design file: `variables`, `objective`, `constraints`, `front`.
    pose : pose, optional
        Of the outputs at a pose, as for `modes`; default home.
    follows : callable, optional
        Gives further values by key from those of the variables, such as the mass of a screw from its diameter.
    progress : callable, optional
        Told in words what is done, and its share.

    Returns
    -------
    xarray.Dataset
        `optimum` (variable), `chosen` (list), `objective`; of each constraint `limit`, `reached`, `kept`, and
        `multiplier`, what one unit more of the limit costs. Attributes: `status` "kept" or "cannot", `calls`,
        and the study at the optimum, as of other results. Of a front also `target`, `front_objective`, `front_output`,
        `front_optimum` (point).

    Raises
    ------
    InputError
        A design that is none, before anything is computed, or a study that has no value of an output.

    Examples
    --------
    >>> design = {
    ...     "variables": [{"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm"}],
    ...     "objective": {"minimise": "piston_mass"},
    ...     "constraints": {"first_frequency": {"least": "25 Hz"}},
    ... }
    >>> print((1e3 * fx.optimise(fx.preset("paper-robot"), design).optimum).round(3).item())  # mm
    31.124
    """
    whole = as_study(study)
    if whole.robot.platform_fixed:
        raise InputError("has a platform that is fixed: its tool does not move", key="study")
    if follows is not None and not callable(follows):
        raise InputError("cannot be called", key="follows", value=follows, allowed="a function of values by key")
    check_progress(progress)
    variants = Variants(whole)
    problem = read_problem(design, variants)
    evaluation = Evaluation(problem, variants, pose, follows)
    with hold_loss_frequency(whole.robot, whole.simulation):
        begin = _start(evaluation)
        best = best_of_lists(evaluation, problem.limits)
        front = _front(evaluation, problem.front, best, progress) if problem.front and best.kept else None
    return _described(whole, evaluation, begin, best, front)


def _start(evaluation: Evaluation) -> Mapping[str, float]:
    """Outputs of the study as it is, which must be there."""
    evaluation.calls += 1
    found = StudyValues(evaluation.variants.study, evaluation.pose).values(evaluation.problem.outputs)
    for name, value in found.items():
        if not np.isfinite(value):
            raise InputError("has no value of this output", key="study", value=name)
    return found


def _front(
    evaluation: Evaluation, front: Front, best: Best, progress: Callable[[str, float], None] | None
) -> dict[str, np.ndarray]:
    """Best objectives for targets of a second output, from the one that the best has to the least that can be had."""
    problem = evaluation.problem
    other = DesignProblem(
        variables=problem.variables, choices=problem.choices, objective=front.output, sense=1, limits=problem.limits,
        front=front,
    )  # fmt: skip
    inner = Evaluation(_with_outputs(other, problem), evaluation.variants, evaluation.pose, evaluation.follows)
    least = best_of_lists(inner, problem.limits, best.point.place)
    evaluation.calls += inner.calls
    end, begin = least.point.outputs[front.output], best.point.outputs[front.output]
    targets = np.linspace(begin, end, front.count)
    rows, place = [], best.point.place
    for k, target in enumerate(targets.tolist()):
        if progress is not None:
            progress("targets", k / front.count)
        limits = (*problem.limits, Limit(front.output, target, -1))
        starts = [place, least.point.place] if k else [place]
        found = [best_of_lists(evaluation, limits, start) for start in starts]
        kept = [one for one in found if one.kept]
        one = min(kept, key=lambda x: problem.sense * x.point.outputs[problem.objective]) if kept else None
        rows.append(one)
        place = one.point.place if one else place
    none = np.full(len(problem.variables), np.nan)
    return {
        "target": targets,
        "front_output": np.array([one.point.outputs[front.output] if one else np.nan for one in rows]),
        "front_objective": np.array([one.point.outputs[problem.objective] if one else np.nan for one in rows]),
        "front_optimum": np.array([_values(problem, one.point.place) if one else none for one in rows]),
    }


def _with_outputs(one: DesignProblem, other: DesignProblem) -> DesignProblem:
    """A problem that asks for the outputs of another one, too: its objective as a limit that is always kept."""
    free = Limit(other.objective, -np.inf, 1)
    return DesignProblem(
        variables=one.variables, choices=one.choices, objective=one.objective, sense=one.sense,
        limits=(*one.limits, free), front=one.front,
    )  # fmt: skip


def _values(problem: DesignProblem, place: np.ndarray) -> np.ndarray:
    return np.array([v.low + part * (v.high - v.low) for v, part in zip(problem.variables, place, strict=True)])


def _described(
    study: Study, evaluation: Evaluation, begin: Mapping[str, float], best: Best, front: dict[str, np.ndarray] | None
) -> Dataset:
    problem, point, limits = evaluation.problem, best.point, evaluation.problem.limits
    found = study.with_values(evaluation.values(point.place, point.rows))
    reached = np.array([point.outputs[limit.output] for limit in limits])
    costs = multipliers(best, problem, limits)
    values = {
        "optimum": _values(problem, point.place),
        "start": np.array([v.start for v in problem.variables]),
        "low": np.array([v.low for v in problem.variables]),
        "high": np.array([v.high for v in problem.variables]),
        "chosen": np.array(
            [c.rows[row][0] for c, row in zip(problem.choices, point.rows, strict=True)], dtype=str
        ),
        "objective": point.outputs[problem.objective],
        "objective_start": begin[problem.objective],
        "output": np.array([limit.output for limit in limits], dtype=str),
        "sense": np.array(["least" if limit.sense > 0 else "most" for limit in limits], dtype=str),
        "limit": np.array([limit.value for limit in limits]),
        "reached": reached,
        "kept": np.array([int(least_margin(point, [limit]) >= -1e-6) for limit in limits]),
        "multiplier": costs,
        **(front or {}),
    }  # fmt: skip
    words = {
        "status": "kept" if best.kept else "cannot",
        "calls": evaluation.calls,
        "objective_name": problem.objective,
        "objective_units": OUTPUTS[problem.objective].units,
        "verb": "least" if problem.sense > 0 else "most",
        "front_name": problem.front.output if problem.front else "",
    }
    remarks = [*found.warnings, *_remarks(problem, evaluation.follows)]
    coords = {
        "variable": np.array([v.key for v in problem.variables], dtype=str),
        "list": np.array([c.name for c in problem.choices], dtype=str),
    }
    return dataset(values, coords, attributes(found, remarks) | words, FORMS)


def _remarks(problem: DesignProblem, follows: Follows | None) -> list[str]:
    keys = [v.key for v in problem.variables] + [key for c in problem.choices for key in c.rows[0][1]]
    if follows is not None or not any(key.startswith(SIZED) for key in keys):
        return []
    return [
        "Masses and inertias of drives and cylinders stay as written. What follows from a size is a function, follows."
    ]
