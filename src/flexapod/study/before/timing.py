"""Checks of the times of a study: duration, output step, step and jumps must fit each other."""

from __future__ import annotations

from flexapod.errors import InputError
from flexapod.model import ActuatorStudy, Study
from flexapod.study.before.room import check_memory


def check_outputs(study: Study | ActuatorStudy) -> list[str]:
    """Refuse a study whose results could not be stored even once after the start; remark on what is left out.

    Raises
    ------
    InputError
        The duration is shorter than the time between stored results, or so long that the memory does not hold them.
    """
    simulation, duration = study.simulation, study.duration
    stored = simulation.stored_step
    name = "output_step" if stored == simulation.output_step else "step"
    remarks = check_memory(study)
    outputs = simulation.outputs(duration)
    if not outputs:
        raise InputError(
            "is longer than the simulation",
            key=f"simulation.{name}",
            value=stored,
            allowed=f"at most the duration of {duration:g} s",
            next_step=f"Give simulation.{name} a value below it, or a longer simulation.duration",
        )
    if name == "step":
        remarks.append(
            f"simulation.step = {stored:g} s is longer than output_step = {simulation.output_step:g} s: "
            "results are stored at every step"
        )
    end = outputs * stored
    if duration - end > 1e-6 * stored:
        remarks.append(
            f"the duration of {duration:g} s is not a multiple of simulation.{name} = {stored:g} s: "
            f"results end at t = {end:g} s"
        )
    return remarks
