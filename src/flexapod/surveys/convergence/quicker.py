"""A fixed step in place of a tolerance that made a run slow: tried, not guessed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.errors import FlexapodError
from flexapod.study.record import Progress
from flexapod.study.simulation import run
from flexapod.study.words import number
from flexapod.surveys.convergence.family import relative_difference
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

SLOW = 2.0  # time integration from which another step is looked for [s]
SAME = 1e-3  # relative difference up to which two results are the same
WORTH = 4.0  # times faster, at least; all steps that are tried take half the time of the run together


@dataclass(frozen=True, kw_only=True)
class Quicker:
    """A fixed `step` [s] that was `times` faster and gave the same but for `difference` of the largest deviation."""

    step: float
    times: float
    difference: float

    @property
    def words(self) -> str:
        """The finding in one sentence."""
        return (
            f'step = "{number(1e3 * self.step, 4)} ms" in place of the tolerance is {self.times:.2g} times faster, '
            f"with the same result to {self.difference:.1g} of the largest deviation (measured)"
        )


def quicker(
    study: model.Study | model.ActuatorStudy, data: Dataset, *, slow: float = SLOW, progress: Progress | None = None
) -> Quicker | None:
    """The longest fixed step that gives the same result much faster than the study's tolerance did.

    Steps are halved from the output step on while they promise to be `WORTH` times faster, each computed whole.

    Parameters
    ----------
    study : Study or ActuatorStudy
    data : xarray.Dataset
        Its result, whole.
    slow : float
        Wall time of the integration [s] below which nothing is tried.
    progress : callable, optional
        As for `flexapod.run`.

    Returns
    -------
    Quicker or None
        None where the study has no tolerance, was not slow, or no such step was found.

    Raises
    ------
    Interrupted
        By Ctrl-C.
    """
    took = float(data.attrs["wall_time"])
    if study.simulation.tolerance is None or took < slow or data.attrs["partial"]:
        return None
    each, step = took / max(int(data.attrs["steps"]), 1), study.simulation.output_step
    wanted = _curve(data)
    while WORTH * each * study.duration / step <= took:
        tried = _tried(study, step, progress)
        if tried is not None and (difference := relative_difference(_curve(tried), wanted)) <= SAME:
            times = took / max(float(tried.attrs["wall_time"]), 1e-9)
            return Quicker(step=step, times=times, difference=difference) if times >= WORTH else None
        step /= 2
    return None


def _tried(study: model.Study | model.ActuatorStudy, step: float, progress: Progress | None) -> Dataset | None:
    """The whole result with a fixed step, if there is one."""
    try:
        data = run(model.override(study, step=step), progress=progress)
    except FlexapodError:
        return None
    return None if data.attrs["partial"] else data


def _curve(data: Dataset) -> Array:
    """What is compared: the deviation of the centre of mass, or of a single actuator the deflection of its tip."""
    if "com_deviation" in data:
        return data["com_deviation"].values
    return data["tip_deflection"].values.reshape(data.sizes["time"], -1)
