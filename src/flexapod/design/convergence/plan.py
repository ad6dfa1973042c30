"""Plan of a convergence study: its runs, whether they can be run, and the time they are expected to take."""

from __future__ import annotations

import math
from dataclasses import replace

from flexapod.analysis.checks.checks import check_actuator_path, check_path
from flexapod.analysis.results.arguments import FileLike, read_subject
from flexapod.analysis.results.time_history import Report
from flexapod.common.errors import InputError
from flexapod.design.convergence.trials import Setting, Trials, setting_of
from flexapod.model import ActuatorStudy, Study
from flexapod.model.study.simulation import SOLID

COUNTS: dict[str, tuple[int, ...]] = {
    "shapes": (1, 2, 3, 4, 6, 8, 12),
    "elements": (1, 2, 3, 4, 6),
    "segments": (1, 2, 4, 8),
}
COARSEST = 4  # the first step, in output steps


def estimate(trials: Trials, accuracy: float = 1e-2) -> tuple[int, float]:
    """Number of settings and seconds that `converge` is expected to take, from one short run.

    Without the time that shapes take that are compiled for the first time, a few seconds each.
    """
    check_accuracy(accuracy)
    base = base_setting(trials.study)
    o = base.output_step
    trials.run(replace(base, step=first_step(base)))
    finer = round(math.log2(COARSEST * 16 * math.sqrt(max(1.0, 1e-2 / accuracy))))
    steps = [replace(base, step=first_step(base) / 2**i) for i in range(finer + 1)]
    ahead = [*steps, *(s for _, s in discretisations(trials.study, base, o / 4)), setting_of(trials.study)]
    return len(dict.fromkeys(ahead)) + 2, trials.plan(ahead)


def check_accuracy(accuracy: object) -> None:
    """Refuse what is not a relative error.

    Raises
    ------
    InputError
        Not between 1e-6 and 0.5.
    """
    if isinstance(accuracy, bool) or not isinstance(accuracy, int | float) or not 1e-6 <= accuracy <= 0.5:
        raise InputError(
            "is not a relative error that can be asked for",
            key="accuracy",
            value=accuracy,
            allowed="1e-6 to 0.5; 0.01 is one per cent of the largest deviation",
        )


def checked_trials(
    study: Study | ActuatorStudy | FileLike, trials: Trials | None, progress: Report | None = None
) -> Trials:
    """Check that a study can be run, and return its runs, which report to `progress`.

    Raises
    ------
    InputError
        What `flexapod.run` would refuse, or a fixed platform.
    """
    study = read_subject(study) if trials is None else trials.study
    if isinstance(study, ActuatorStudy):
        check_actuator_path(study)
    elif isinstance(study, Study):
        if study.robot.platform_fixed:
            raise InputError(
                "leaves no deviation of the platform whose error could be compared",
                file=study.path,
                key="platform.fixed",
                value=True,
                allowed="a platform that moves",
                next_step="`modes` with more shapes, or runs with half the step, show how legs converge",
            )
        check_path(study)
    else:
        raise InputError(
            "is not a study", key="study", value=type(study).__name__, allowed="the result of flexapod.load"
        )
    found = trials or Trials(study)
    found.report = progress
    return found


def base_setting(study: Study | ActuatorStudy) -> Setting:
    """Setting of the step study: that of the file, or assumed modes where its legs are rigid."""
    own = setting_of(study)
    modes = own.modes or 3
    return replace(own, fidelity="assumed-modes", modes=modes) if own.fidelity == "rigid" else own


def first_step(base: Setting) -> float:
    """The step that the halving begins with [s]."""
    return COARSEST * base.output_step


def discretisations(study: Study | ActuatorStudy, base: Setting, step: float) -> list[tuple[str, Setting]]:
    """Family and setting of all shapes, elements and segments, each coarse to fine, all with one step.

    Pistons of sections, and those that shear, have no elements and segments.
    """
    alone = base.fidelity == SOLID or bool(nonuniform_key(study))
    fidelity = {"shapes": _shaped(base), "elements": "beam-fem", "segments": "finite-segment"}
    per = {"elements": 2}  # shapes of an element
    return [
        (family, replace(base, fidelity=fidelity[family], modes=n * per.get(family, 1), step=step, tolerance=None))
        for family, counts in COUNTS.items()
        if family == "shapes" or not alone
        for n in counts
    ]


def nonuniform_key(study: Study | ActuatorStudy) -> str | None:
    """Key by which pistons are other than uniform beams, which half of the fidelities do not know; None of others."""
    pistons = [leg.piston for leg in study.robot.legs] if isinstance(study, Study) else []
    return next((name for name in ("sections", "shear") if any(getattr(one, name) for one in pistons)), None)


def _shaped(base: Setting) -> str:
    """The fidelity whose shapes are counted: a solid, another model than a beam, is compared with itself."""
    return SOLID if base.fidelity == SOLID else "assumed-modes"


def finest_basis(base: Setting) -> Setting:
    """The setting with the most shapes."""
    return replace(base, fidelity=_shaped(base), modes=max(COUNTS["shapes"]))
