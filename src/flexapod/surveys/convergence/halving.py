"""The step: halved until the finest is good enough; and the step with which shapes are compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from flexapod.errors import ComputationError, InputError
from flexapod.study.words import text
from flexapod.surveys.convergence.family import ABOVE
from flexapod.surveys.convergence.findings import Findings
from flexapod.surveys.convergence.plan import first_step, largest
from flexapod.surveys.convergence.trials import Setting, Trials

FINER = 20  # the finest step may be wrong by this fraction of the accuracy
NEAR = 0.3  # and its order must be this near to 2
FEWEST, MOST = 5, 16  # steps tried
LONGEST_RUN = 15.0  # no step is halved once more if that would take longer [s]
LONGEST_SHAPES = 5.0  # nor are shapes compared with a step with which the largest number takes longer [s]
SHARE = 0.5  # of the accuracy that the step of the comparison of shapes may use
NOTHING = 1e-12  # size that is rounding [m]


def halve_steps(trials: Trials, base: Setting, found: Findings) -> None:
    """Halve the step until the finest is good enough, Eq. (T12.3), or the next would take too long."""
    for count, setting in enumerate(_halved(base), start=1):
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
            found.notes.append(
                f"The step was halved no further than {text(setting.step or 0.0, 's')}: the next run would take about "
                f"{trials.cost(ahead):.0f} s. Errors of steps are as uncertain as the finest one's own error."
            )
            return


def _halved(base: Setting) -> Iterator[Setting]:
    step = first_step(base)
    while True:
        yield replace(base, step=step)
        step /= 2


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


def step_of_shapes(trials: Trials, base: Setting, found: Findings) -> float:
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
    most = largest(base)
    while step < base.output_step and trials.steps(replace(most, step=step)) * trials.per_step(most) > LONGEST_SHAPES:
        step *= 2
    return step
