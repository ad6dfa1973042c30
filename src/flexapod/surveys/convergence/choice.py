"""From errors and costs to one recommended setting, checked by running it."""

from __future__ import annotations

from dataclasses import replace

from flexapod.surveys.convergence.family import FAMILIES
from flexapod.surveys.convergence.findings import Findings
from flexapod.surveys.convergence.recommend import Discretisation, Step, candidates
from flexapod.surveys.convergence.trials import Trial, Trials

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
    words = "no combination keeps it" if not tried else "the checked combinations miss it"
    found.notes.append(
        f"No setting is recommended for an accuracy of {found.accuracy:g}: {words}. Ask for less, or look at the table."
    )


def _step_choices(found: Findings) -> list[Step]:
    family, main = found.family("step"), found.quantities[0]
    pairs = zip(family.trials, family.bounds(main), strict=True)
    return [
        Step(step=t.setting.step or 0.0, steps=t.steps, error=float(bound))
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


def _best(trials: Trials, steps: list[Step], shapes: list[Discretisation], found: Findings) -> Trial | None:
    """The finest step with the cheapest discretisation whose error does not count beside the accuracy."""
    if not (steps and shapes):
        found.notes.append("No setting is recommended: too few runs succeeded.")
        return None
    good = [d for d in shapes if d.error <= found.accuracy / ENOUGH] or [min(shapes, key=lambda d: d.error)]
    finest = min(s.step for s in steps)
    known = [d for d in good if replace(d.setting, step=finest) in trials]
    cheapest = min(known or good, key=lambda d: (d.per_step, d.error)).setting
    trial = trials.run(replace(cheapest, step=finest))
    if trial.failure:
        found.notes.append(f"No setting is recommended: the reference failed ({trial.failure}).")
        return None
    return trial


def _error_of(reference: Trial, shapes: list[Discretisation]) -> float:
    of = reference.setting
    return next(d.error for d in shapes if (d.setting.fidelity, d.setting.modes) == (of.fidelity, of.modes))
