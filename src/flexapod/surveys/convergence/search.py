"""The convergence study: steps halved until the finest is good enough, then shapes and elements, then a check."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from flexapod.model import ActuatorStudy, Study
from flexapod.study.arguments import FileLike
from flexapod.study.record import Report
from flexapod.surveys.convergence.choice import choose
from flexapod.surveys.convergence.findings import Findings
from flexapod.surveys.convergence.halving import halve_steps, step_of_shapes
from flexapod.surveys.convergence.plan import base_setting, check_accuracy, checked_trials, discretisations
from flexapod.surveys.convergence.table import as_dataset
from flexapod.surveys.convergence.trials import Trials, setting_of

if TYPE_CHECKING:
    from xarray import Dataset


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
        found.notes.append("The file's legs are rigid and have no deviation: steps are studied with assumed modes.")
    halve_steps(trials, base, found)
    found.shape_step = step_of_shapes(trials, base, found)
    settings = discretisations(base, found.shape_step)
    trials.plan([*(setting for _, setting in settings), own])
    for family, setting in settings:
        found.add(family, trials.run(setting))
    found.add("file", trials.run(own))
    choose(trials, found)
