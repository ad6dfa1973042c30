"""The ladder: the same robot or beam with every fidelity, error against cost."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.arguments import FileLike
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import Report
from flexapod.common.errors import InputError
from flexapod.common.units import quantities
from flexapod.design.convergence.family import relative_difference
from flexapod.design.convergence.plan import checked_trials, nonuniform_key
from flexapod.design.convergence.search import ConvergenceStopped
from flexapod.design.convergence.table import SettingRow, reference_words, rows_dataset
from flexapod.design.convergence.trials import QUANTITIES, Setting, Trial, Trials, setting_of
from flexapod.model import ActuatorStudy, Study

if TYPE_CHECKING:
    from xarray import Dataset

#: Fidelity, basis and lateral shapes per plane of each rung; beam elements have two shapes each.
RUNGS: tuple[tuple[str, str, int], ...] = (
    ("rigid", "tip-load", 0),
    ("lumped", "tip-load", 0),
    *(("finite-segment", "tip-load", n) for n in (2, 4, 8)),
    *(("assumed-modes", basis, k) for basis in ("clamped-free", "tip-load") for k in (1, 2, 3, 6)),
    *(("beam-fem", "tip-load", 2 * n) for n in (1, 2, 3, 6)),
    *(("solid-fem", "tip-load", k) for k in (1, 2, 3, 6)),  # off by what a beam leaves out, shear above all
)
REFERENCE = ("assumed-modes", "tip-load", 12)
SECOND = ("assumed-modes", "tip-load", 8)  # how far the reference is from it bounds its own error
PER_OUTPUT = 4  # steps in an output step where neither the study nor the caller gives a step


def ladder(
    study: Study | ActuatorStudy | FileLike,
    *,
    step: float | None = None,
    progress: Report | None = None,
    trials: Trials | None = None,
) -> Dataset:
    """Error and cost of every fidelity, all with one fixed step, against the same shapes in great number.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
        From `flexapod.load` or `flexapod.preset`, or the file; its fidelity does not matter.
    step : float, optional
        Fixed step [s]; default: that of the study, or a quarter of its output step.
    progress : callable, optional
        Called with what is being computed, in words, and the share that is done.
    trials : Trials, optional
        Runs of this study to share with another call.

    Returns
    -------
    xarray.Dataset
        A row per rung along ``setting``; attributes ``reference`` and ``reference_error`` say what errors are measured
        against and how far it is itself from a coarser one. Errors of the step are in all alike and do not show.

    Raises
    ------
    InputError
        A study that `flexapod.run` refuses.
    ConvergenceStopped
        By Ctrl-C, with what was computed.

    Examples
    --------
    >>> study = fx.preset("paper-actuator").replace(simulation={"modes": 1, "step": 2e-3, "duration": 0.1})
    >>> data = fx.ladder(study)
    >>> [str(name) for name in data.fidelity.values[:2]]
    ['rigid', 'finite-segment']
    """
    trials = checked_trials(study, trials, progress)
    settings, reference, second = rungs(trials.study, step)
    trials.plan([reference, second, *settings])
    done: list[Trial] = []
    best, near = trials.run(reference), trials.run(second)
    try:
        for setting in settings:
            done.append(trials.run(setting))
    except KeyboardInterrupt:
        if not done:
            raise
        raise ConvergenceStopped(_dataset(trials, done, best, near, partial=True)) from None
    return _dataset(trials, done, best, near, partial=False)


def rungs(study: Study | ActuatorStudy, step: float | None = None) -> tuple[list[Setting], Setting, Setting]:
    """Settings of the rungs that a study has, of the reference, and of the one that bounds its error."""
    if name := nonuniform_key(study):
        raise InputError(
            "is not known to half of the fidelities",
            key=f"leg.piston.{name}",
            allowed=f"pistons {'without sections' if name == 'sections' else 'that do not shear'}; "
            "`flexapod converge` varies steps and shapes of this study",
        )
    own = setting_of(study)
    step = quantities(step, "time", key="step")
    base = replace(own, tolerance=None, step=step or own.step or own.output_step / PER_OUTPUT)

    def setting(fidelity: str, basis: str, modes: int) -> Setting:
        return replace(base, fidelity=fidelity, basis=basis, modes=modes)

    left = _left_out(study)
    found = [setting(*rung) for rung in RUNGS if rung[0] not in left]
    return found, setting(*REFERENCE), setting(*SECOND)


def _left_out(study: Study | ActuatorStudy) -> set[str]:
    """Fidelities that mean nothing here: a lumped beam that does not stretch, solids without a section."""
    if isinstance(study, ActuatorStudy):
        return {"lumped"} if study.actuator.section is not None else {"lumped", "solid-fem"}
    alike = len({(leg.piston.diameter, leg.piston.inner_diameter) for leg in study.robot.legs}) == 1
    return set() if alike and study.robot.legs[0].piston.diameter is not None else {"solid-fem"}


def _dataset(trials: Trials, done: list[Trial], best: Trial, near: Trial, *, partial: bool) -> Dataset:
    names = trials.quantities
    none = dict.fromkeys(names, np.nan)
    rows = [
        SettingRow(family="ladder", trial=t, error={q: _error(t, best, q) for q in names}, order=none, reference=False)
        for t in done
    ]
    attrs = {
        **attributes(trials.study, trials.study.warnings),
        "title": "flexapod: every fidelity",
        "quantity": QUANTITIES[names[0]],
        "step": best.setting.step,
        "reference": reference_words(best.setting),
        **{f"reference_error_{q}": _error(near, best, q) for q in names},
        "notes": f"The reference failed: {best.failure}" if best.failure else "",
        "partial": int(partial),
    }
    data = rows_dataset(rows, names, attrs)
    per_step = data.seconds / data.steps.where(data.steps > 0)
    return data.assign(seconds_per_step=per_step.assign_attrs(units="s", long_name="time of a step"))


def _error(trial: Trial, reference: Trial, quantity: str) -> float:
    if trial.failure or reference.failure:
        return float("nan")
    return relative_difference(*trial.common_values(reference, quantity))
