"""Search for the best of a design by sequential quadratic programming (SLSQP of SciPy), feasibility first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from flexapod.analysis.results.arguments import PoseLike
from flexapod.analysis.scalar_outputs import StudyValues
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError, check_kind
from flexapod.common.tables.key_paths import parse_key
from flexapod.design.optimisation.problem import DesignProblem, Limit
from flexapod.design.variants import Variants

STEP = 1e-4  # of differences, of the ranges
KEPT = 1e-6  # what a margin may be below 0, of the limit
ACTIVE = 1e-4  # largest margin of a limit that holds the optimum
PENALTY = 10.0  # of a point without values, in sizes of the limits
MOST_STEPS = 60

Follows = Callable[[dict[str, object]], Mapping[str, object]]


@dataclass(frozen=True, kw_only=True)
class Point:
    """A place in the unit box of the variables, and the row of each list; outputs by name, NaN without values."""

    place: Array
    rows: tuple[int, ...]
    outputs: Mapping[str, float]


@dataclass
class Evaluation:
    """Outputs of the design at places of the unit box, each computed once; `calls` counts the studies."""

    problem: DesignProblem
    variants: Variants
    pose: PoseLike
    follows: Follows | None = None
    calls: int = 0
    _known: dict[tuple[bytes, tuple[int, ...]], Point] = field(default_factory=dict)

    def values(self, place: Array, rows: tuple[int, ...]) -> dict[str, object]:
        """Values by key of a place, ties and what follows included."""
        found: dict[str, object] = {}
        for choice, row in zip(self.problem.choices, rows, strict=True):
            found |= choice.rows[row][1]
        for variable, part in zip(self.problem.variables, place.tolist(), strict=True):
            value = variable.low + part * (variable.high - variable.low)
            found[variable.key] = value
            for tied in variable.ties:
                found[tied] = self.variants.numbers(tied)[0].value * value / variable.start
        if self.follows is None:
            return found
        more = self.follows(dict(found))
        check_kind(more, Mapping, "follows", "a function that returns values by key")
        return found | dict(more)

    def at(self, place: Array, rows: tuple[int, ...]) -> Point:
        """Outputs of a place."""
        mark = (place.tobytes(), rows)
        if mark not in self._known:
            self.calls += 1
            keys = {parse_key(key, what="key"): value for key, value in self.values(place, rows).items()}
            try:
                outputs = StudyValues(self.variants.study_with(keys), self.pose).values(self.problem.outputs)
            except FlexapodError:
                outputs = dict.fromkeys(self.problem.outputs, np.nan)
            self._known[mark] = Point(place=place.copy(), rows=rows, outputs=outputs)
        return self._known[mark]

    def slopes(self, place: Array, rows: tuple[int, ...]) -> dict[str, Array]:
        """Derivatives of the outputs by the places of the variables, by central differences inside of the box."""
        found = {name: np.zeros(len(place)) for name in self.problem.outputs}
        for k in range(len(place)):
            ends = []
            for sign in (-1, 1):
                beside = place.copy()
                beside[k] = np.clip(place[k] + sign * STEP, 0.0, 1.0)
                ends.append(beside)
            low, high = (self.at(end, rows).outputs for end in ends)
            for name, slope in found.items():
                slope[k] = (high[name] - low[name]) / (ends[1][k] - ends[0][k])
        return {name: np.nan_to_num(slope) for name, slope in found.items()}


@dataclass(frozen=True, kw_only=True)
class Best:
    """Best point of a search; not `kept` where some limit cannot be kept. `slopes` are those there."""

    point: Point
    kept: bool
    slopes: Mapping[str, Array]


def least_margin(point: Point, limits: Sequence[Limit]) -> float:
    """Least margin of the limits at a point; -PENALTY where it has no values."""
    found = [limit.margin(point.outputs[limit.output]) for limit in limits]
    return min((x if np.isfinite(x) else -PENALTY for x in found), default=np.inf)


def search(evaluation: Evaluation, limits: Sequence[Limit], rows: tuple[int, ...], start: Array) -> Best:
    """The best place with these rows of the lists: the limits first, then the objective."""
    begin = evaluation.at(start, rows)
    if least_margin(begin, limits) < -KEPT:
        begin = _most_margin(evaluation, limits, begin)
    kept = least_margin(begin, limits) >= -KEPT and np.isfinite(begin.outputs[evaluation.problem.objective])
    if kept and len(start):
        begin = _least_objective(evaluation, limits, begin)
    return Best(point=begin, kept=bool(kept), slopes=evaluation.slopes(begin.place, rows))


def _solved(
    begin: Array, objective: tuple[Callable[[Array], float], Callable[[Array], Array]],
    rows: Sequence[tuple[Callable[[Array], float], Callable[[Array], Array]]], bounds: Sequence[tuple[float, float]],
) -> None:  # fmt: skip
    from scipy.optimize import minimize

    value, slope = objective
    constraints = [{"type": "ineq", "fun": fun, "jac": jac} for fun, jac in rows]
    minimize(
        value, begin, jac=slope, method="SLSQP", bounds=bounds, constraints=constraints,
        options={"maxiter": MOST_STEPS, "ftol": 1e-9},
    )  # fmt: skip


def _rows(evaluation: Evaluation, limits: Sequence[Limit], rows: tuple[int, ...], n: int, slack: bool):
    """Functions and slopes of the margins, each scaled by its own limit; with a slack variable behind, if asked."""

    def pair(limit: Limit):
        size = abs(limit.value) or 1.0

        def value(x: Array) -> float:
            found = limit.margin(evaluation.at(np.clip(x[:n], 0, 1), rows).outputs[limit.output])
            return (found if np.isfinite(found) else -PENALTY) + (x[n] if slack else 0.0)

        def slope(x: Array) -> Array:
            own = limit.sense * evaluation.slopes(np.clip(x[:n], 0, 1), rows)[limit.output] / size
            return np.append(own, 1.0) if slack else own

        return value, slope

    return [pair(limit) for limit in limits]


def _most_margin(evaluation: Evaluation, limits: Sequence[Limit], begin: Point) -> Point:
    """The point at which the worst of the limits is kept best; the search ends where all are kept."""
    n, rows, best = len(begin.place), begin.rows, [begin]

    class Enough(Exception):
        pass

    def value(x: Array) -> float:
        here = evaluation.at(np.clip(x[:n], 0, 1), rows)
        if least_margin(here, limits) > least_margin(best[0], limits):
            best[0] = here
        if least_margin(best[0], limits) >= 0:
            raise Enough
        return float(x[n])

    slope = np.append(np.zeros(n), 1.0)
    x = np.append(begin.place, -least_margin(begin, limits))
    bounds = [*[(0.0, 1.0)] * n, (0.0, 2 * PENALTY)]
    try:
        if n:
            _solved(x, (value, lambda x: slope), _rows(evaluation, limits, rows, n, slack=True), bounds)
    except Enough:
        pass
    return best[0]


def _least_objective(evaluation: Evaluation, limits: Sequence[Limit], begin: Point) -> Point:
    """The best point that keeps all limits, of those that the search sees."""
    problem, n, rows, best = evaluation.problem, len(begin.place), begin.rows, [begin]
    size = abs(begin.outputs[problem.objective]) or 1.0

    def value(x: Array) -> float:
        here = evaluation.at(np.clip(x, 0, 1), rows)
        found = problem.sense * here.outputs[problem.objective] / size
        old = problem.sense * best[0].outputs[problem.objective] / size
        if np.isfinite(found) and found < old and least_margin(here, limits) >= -KEPT:
            best[0] = here
        return found if np.isfinite(found) else PENALTY

    def slope(x: Array) -> Array:
        return problem.sense * evaluation.slopes(np.clip(x, 0, 1), rows)[problem.objective] / size

    _solved(begin.place, (value, slope), _rows(evaluation, limits, rows, n, slack=False), [(0.0, 1.0)] * n)
    return best[0]


def best_of_lists(evaluation: Evaluation, limits: Sequence[Limit], start: Array | None = None) -> Best:
    """The best of all combinations of the lists' rows."""
    problem = evaluation.problem
    begin = start
    if begin is None:
        begin = np.array([(v.start - v.low) / (v.high - v.low) for v in problem.variables])
    found = [
        search(evaluation, limits, rows, begin)
        for rows in product(*(range(len(choice.rows)) for choice in problem.choices))
    ]
    kept = [one for one in found if one.kept]
    if kept:
        return min(kept, key=lambda one: problem.sense * one.point.outputs[problem.objective])
    return max(found, key=lambda one: least_margin(one.point, limits))


def multipliers(best: Best, problem: DesignProblem, limits: Sequence[Limit]) -> Array:
    """Change of the objective for one unit more of each limit's value, (limits,) [SI]; 0 of limits that do not hold it.

    Of the conditions of Karush, Kuhn and Tucker, with the bounds that the place lies on.
    """
    from scipy.optimize import nnls

    found = np.zeros(len(limits))
    place = best.point.place
    active = [
        k for k, one in enumerate(limits) if best.kept and abs(one.margin(best.point.outputs[one.output])) < ACTIVE
    ]
    if not active or not len(place):
        return found
    columns = [limits[k].sense * best.slopes[limits[k].output] for k in active]
    sizes = [float(np.linalg.norm(column)) or 1.0 for column in columns]
    walls = [np.eye(len(place))[k] for k in np.flatnonzero(place < 1e-9)]
    walls += [-np.eye(len(place))[k] for k in np.flatnonzero(place > 1 - 1e-9)]
    matrix = np.stack([*(column / size for column, size in zip(columns, sizes, strict=True)), *walls], axis=1)
    target = problem.sense * best.slopes[problem.objective]
    scale = float(np.linalg.norm(target)) or 1.0
    solved = nnls(matrix, target / scale)[0] * scale
    for k, part, size in zip(active, solved, sizes, strict=False):
        found[k] = problem.sense * limits[k].sense * part / size
    return found
