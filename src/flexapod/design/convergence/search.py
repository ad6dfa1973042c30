"""The convergence study: steps halved until the finest is good enough, then shapes, elements, the cheapest setting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from flexapod.analysis.results.arguments import FileLike
from flexapod.analysis.results.time_history import Report
from flexapod.common.errors import ComputationError, InputError
from flexapod.design.convergence.family import ABOVE, FAMILIES, Findings
from flexapod.design.convergence.plan import (
    base_setting,
    check_accuracy,
    checked_trials,
    discretisations,
    finest_basis,
    first_step,
)
from flexapod.design.convergence.table import as_dataset
from flexapod.design.convergence.trials import Setting, Trial, Trials, setting_of
from flexapod.model import ActuatorStudy, Study

if TYPE_CHECKING:
    from xarray import Dataset

ALIKE = 1.10  # costs within 10 % are the same: timings vary by as much


@dataclass(frozen=True, kw_only=True)
class StepChoice:
    """A step [s], the number of them, and the relative error they cause."""

    step: float
    steps: int
    error: float


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Fidelity and shapes, the seconds a step takes with them, and the relative error they cause."""

    setting: Setting
    per_step: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A setting with its expected error (both parts added) and cost [s]."""

    setting: Setting
    error: float
    cost: float


def candidates(steps: Sequence[StepChoice], shapes: Sequence[Discretisation], accuracy: float) -> list[Candidate]:
    """Settings whose two errors together keep the accuracy, cheapest first; of equally cheap ones the most accurate.

    Parameters
    ----------
    steps, shapes : sequences
        What can be combined; failed runs have an error of NaN and never qualify.
    accuracy : float
        Allowed relative error.
    """
    left = [
        Candidate(
            setting=replace(d.setting, step=s.step, tolerance=None),
            error=s.error + d.error,
            cost=s.steps * d.per_step,
        )
        for s in steps
        for d in shapes
        if s.error + d.error <= accuracy
    ]
    ordered = []
    while left:
        cheapest = min(c.cost for c in left)
        best = min((c for c in left if c.cost <= ALIKE * cheapest), key=lambda c: c.error)
        ordered.append(best)
        left.remove(best)
    return ordered


CHECKS = 3  # candidates that are checked before none is recommended
ENOUGH = 50  # shapes whose error is this fraction of the accuracy are as good as exact


def choose(trials: Trials, found: Findings) -> None:
    """Check the cheapest combinations of step and discretisation against the best one; the first that holds is it."""
    steps, shapes = _step_choices(found), _shape_choices(found)
    reference = _best(trials, steps, shapes, found)
    if reference is None:
        return
    found.set_reference(reference, min(s.error for s in steps) + _error_of(reference, shapes))
    main = found.quantities[0]
    tried = candidates(steps, shapes, found.accuracy)[:CHECKS]
    for candidate in tried:
        trial = trials.run(candidate.setting)
        if found.error_with_own(trial, main) <= found.accuracy:
            found.add("recommended", trial)
            return
    found.note("missed" if tried else "nothing to try", accuracy=found.accuracy)


def _step_choices(found: Findings) -> list[StepChoice]:
    family, main = found.family("step"), found.quantities[0]
    pairs = zip(family.trials, family.bounds(main), strict=True)
    return [
        StepChoice(step=t.setting.step or 0.0, steps=t.steps, error=float(bound))
        for t, bound in pairs
        if not t.failure and (t.setting.step or 0.0) <= t.setting.output_step
    ]


def _shape_choices(found: Findings) -> list[Discretisation]:
    main, choices = found.quantities[0], []
    for name in FAMILIES:
        if name == "step":
            continue
        family = found.family(name)
        choices += [
            Discretisation(setting=t.setting, per_step=t.seconds / t.steps, error=float(bound))
            for t, bound in zip(family.trials, family.bounds(main), strict=True)
            if not t.failure
        ]
    return choices


def _best(trials: Trials, steps: list[StepChoice], shapes: list[Discretisation], found: Findings) -> Trial | None:
    """The finest step with the cheapest discretisation whose error does not count beside the accuracy."""
    if not (steps and shapes):
        found.note("too few runs")
        return None
    good = [d for d in shapes if d.error <= found.accuracy / ENOUGH] or [min(shapes, key=lambda d: d.error)]
    finest = min(s.step for s in steps)
    known = [d for d in good if replace(d.setting, step=finest) in trials]
    cheapest = min(known or good, key=lambda d: (d.per_step, d.error)).setting
    trial = trials.run(replace(cheapest, step=finest))
    if trial.failure:
        found.note("no reference", failure=trial.failure)
        return None
    return trial


def _error_of(reference: Trial, shapes: list[Discretisation]) -> float:
    of = reference.setting
    return next(d.error for d in shapes if (d.setting.fidelity, d.setting.modes) == (of.fidelity, of.modes))


FINER = 20  # the finest step may be wrong by this fraction of the accuracy
NEAR = 0.3  # and its order must be this near to 2
FEWEST, MOST = 5, 16  # steps tried
LONGEST_RUN = 15.0  # no step is halved once more if that would take longer [s]
LONGEST_SHAPES = 5.0  # nor are shapes compared with a step with which the largest number takes longer [s]
SHARE = 0.5  # of the accuracy that the step of the comparison of shapes may use
NOTHING = 1e-12  # size that is rounding [m]


def halve_steps(trials: Trials, base: Setting, found: Findings) -> None:
    """Halve the step until the finest is good enough, Eq. (T12.3), or the next would take too long."""
    setting = replace(base, step=2 * first_step(base))
    for count in range(1, MOST + 1):
        setting = replace(setting, step=(setting.step or 0.0) / 2)
        found.add("step", trials.run(setting))
        if count < FEWEST:
            continue
        if all(trial.failure for trial in found.trials["step"]):
            raise ComputationError(
                f"no step gives a result: {found.trials['step'][-1].failure}",
                next_step="See `flexapod check` and `flexapod run`.",
            )
        if count == FEWEST:
            _floor(trials, setting, found)
        if _fine_enough(found):
            return
        ahead = replace(setting, step=(setting.step or 0.0) / 2)
        if count == MOST or trials.cost(ahead) > LONGEST_RUN:
            found.note("coarse step", step=setting.step or 0.0, cost=trials.cost(ahead))
            return


def _floor(trials: Trials, setting: Setting, found: Findings) -> None:
    """Measure what rounding and Newton's residual test leave: the same run in chunks twice as long."""
    one, other = trials.run(setting), trials.run(replace(setting, output_step=2 * setting.output_step))
    found.set_floor(one, other)
    largest = one.peak(found.quantities[0])
    if largest < NOTHING:
        raise InputError(
            "deflects nothing: there is no error to compare",
            key="study",
            allowed="a motion, load, gravity or initial deflection that bends or stretches a leg",
        )


def _fine_enough(found: Findings) -> bool:
    family = found.family("step")
    main = found.quantities[0]
    own, order, last = family.own_error(main), family.order(main), family.errors(main)
    at_floor = len(last) > 1 and last[-2] <= ABOVE * found.floor[main]
    return at_floor or (own * FINER <= found.accuracy and abs(order - 2.0) <= NEAR)


def shape_study_step(trials: Trials, base: Setting, found: Findings) -> float:
    """The coarsest step that uses half of the accuracy, or what the time allows with the largest number of shapes."""
    family, main = found.family("step"), found.quantities[0]
    known = [
        (trial.setting.step or 0.0, bound)
        for trial, bound in zip(family.trials, family.bounds(main), strict=True)
        if not trial.failure and (trial.setting.step or 0.0) <= base.output_step
    ]
    good = [step for step, bound in known if bound <= SHARE * found.accuracy]
    if not known:
        raise ComputationError(
            "no step as short as output_step gives a result",
            next_step="See `flexapod run`, or give a shorter output_step.",
        )
    step = max(good) if good else min(step for step, _ in known)
    most = finest_basis(base)
    while step < base.output_step and trials.steps(replace(most, step=step)) * trials.per_step(most) > LONGEST_SHAPES:
        step *= 2
    return step


class ConvergenceStopped(KeyboardInterrupt):
    """The user stopped the study; `dataset` holds what was computed, marked as partial."""

    def __init__(self, dataset: Dataset) -> None:
        self.dataset = dataset
        super().__init__(f"stopped after {dataset.sizes['setting']} settings")


def converge(
    study: Study | ActuatorStudy | FileLike,
    *,
    accuracy: float = 1e-2,
    progress: Report | None = None,
    trials: Trials | None = None,
) -> Dataset:
    """Errors, observed orders and cost of a study over step, shapes, elements and segments.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
        From `flexapod.load` or `flexapod.preset`, or the file.
    accuracy : float
        Relative error that the recommended setting keeps: largest difference between two curves over the largest
        value, of the deviation of the centre of mass (robot) or of the tip deflection (actuator), Eq. (T12.1).
    progress : callable, optional
        Called with what is being computed, in words, and the share that is done.
    trials : Trials, optional
        Runs of this study to share with another call.

    Returns
    -------
    xarray.Dataset
        A row per setting along ``setting``, grouped by ``family``; what each family tells along ``group``; the
        recommended lines of [simulation] in the attribute ``recommended`` ("" if none was found), words in ``notes``.

    Raises
    ------
    InputError
        An accuracy that is none, a study that `flexapod.run` refuses, or one without any deflection.
    ComputationError
        No step gives a result.
    ConvergenceStopped
        By Ctrl-C, with what was computed.

    Examples
    --------
    >>> study = fx.preset("paper-actuator").replace(simulation={"modes": 1, "step": 2e-3, "duration": 0.1})
    >>> data = fx.converge(study, accuracy=0.2)
    >>> data.error_tip.dims
    ('setting',)
    """
    check_accuracy(accuracy)
    trials = checked_trials(study, trials, progress)
    found = Findings(quantities=trials.quantities, accuracy=accuracy)
    try:
        _search(trials, found)
    except KeyboardInterrupt:
        if not any(found.trials.values()):
            raise
        raise ConvergenceStopped(as_dataset(trials.study, found, partial=True)) from None
    return as_dataset(trials.study, found)


def _search(trials: Trials, found: Findings) -> None:
    own = setting_of(trials.study)
    base = replace(base_setting(trials.study), tolerance=None)
    if base.fidelity != own.fidelity:
        found.note("rigid legs")
    halve_steps(trials, base, found)
    found.shape_step = shape_study_step(trials, base, found)
    settings = discretisations(trials.study, base, found.shape_step)
    trials.plan([*(setting for _, setting in settings), own])
    for family, setting in settings:
        found.add(family, trials.run(setting))
    found.add("file", trials.run(own))
    choose(trials, found)
