"""A motion that brings the tool of an elastic robot onto its path in motion, Eqs. (T22.23)-(T22.24)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.arguments import FileLike, RobotLike, as_study
from flexapod.commissioning.feedforward.command_table import saved
from flexapod.commissioning.feedforward.correction_series import knots_of, lasts, refuse, refuse_beyond, static_series
from flexapod.commissioning.feedforward.loaded_path import LoadedPath
from flexapod.commissioning.feedforward.stable_inversion import Ahead, elastic_commands
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.model import CsvMotion, Study

__all__ = ["Elastic", "elastic_compensation"]

RAMP = 0.2  # of the time kept before and after, in which commands begin and end


@dataclass(frozen=True, kw_only=True)
class Elastic:
    """A study whose commands make up for weight, load and elastic motion, and what they bring.

    ``miss`` (before, after) [m]: of the pivot in motion, beside its static deviation, at most, by the linear model with
    all modes; ``turned`` [rad] likewise; ``early``, ``late`` [s]: how long commands act before the path and after it.
    """

    study: Study
    miss: tuple[float, float]
    turned: tuple[float, float]
    early: float
    late: float

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect in words."""
        return (
            f"commands make up for what weight, load and the robot's elastic motion do: in motion it misses the "
            f"wanted path by {text(self.miss[1], 'm')} and {text(self.turned[1], 'rad')} at most in place of "
            f"{text(self.miss[0], 'm')} and {text(self.turned[0], 'rad')}, by the linear model with all modes. They "
            f"act {text(self.early, 's')} before the path begins and {text(self.late, 's')} after its end: the motion "
            f"takes {text(self.early + self.late, 's')} more, and the path begins at t = {text(self.early, 's', 6)}. "
            "Deviations in results are those from the commands, which lie beside the wanted path"
        )

    def __repr__(self) -> str:
        return f"Elastic({self.sentence})"


def elastic_compensation(
    study: RobotLike, *, corrections: int = 2, as_built: bool = True, out: FileLike | None = None
) -> Elastic:
    """As `compensate` by stable inversion, with what it brings."""
    study = as_study(study)
    known = study if as_built else study.replace(robot=study.robot.replace(geometry=None, heat=None))
    refuse(known, corrections, inertia=True)
    check_path(study)
    path = LoadedPath(known)
    _refuse_others(study, path)
    moving = study.motion.end_time - study.motion.hold
    series = static_series(path, corrections, knots_of(study, moving))
    found = elastic_commands(study, moving)
    time, value, early, late = _kept(found, moving)
    inside = np.clip(time, 0.0, moving)
    pose = path.wanted(inside).position + series(inside).position + value
    motion = CsvMotion(time=time + early, pose=pose, hold=study.motion.hold, pivot=study.motion.pivot)
    duration = study.simulation.duration
    simulation = study.simulation.replace(duration=None if duration is None else duration + early + late)
    made = study.replace(motion=motion, simulation=simulation)
    refuse_beyond(made)
    told = Elastic(
        study=made,
        miss=_largest(found, slice(0, 3)),
        turned=_largest(found, slice(3, 6)),
        early=early,
        late=late,
    )
    told = replace(told, study=made.replace(notes=(*study.notes, told.sentence)))
    return told if out is None else replace(told, study=saved(told.study, out))


def _largest(found: Ahead, part: slice) -> tuple[float, float]:
    """Largest size of a part of what is missed, without commands and with them."""
    before, after = (float(np.linalg.norm(x[:, part], axis=1).max()) for x in (found.before, found.after))
    return before, after


def _kept(found: Ahead, moving: float) -> tuple[Array, Array, float, float]:
    """Instants from the first command on, ends included, corrections that begin and end there, and both times [s]."""
    step = found.time[1] - found.time[0]
    early, late = (np.ceil(x / (1 - RAMP) / step) * step for x in (found.early, found.late))
    early, late = min(early, -found.time[0]), min(late, found.time[-1] - moving)
    inner = found.time[(found.time > -early + 0.5 * step) & (found.time < moving + late - 0.5 * step)]
    time = np.concatenate([[-early], inner, [moving + late]])
    value = np.stack([np.interp(time, found.time, column) for column in found.value.T], axis=1)
    ramp = np.ones(len(time))
    for way, span in ((time + early, early), (moving + late - time, late)):
        if span > 0:
            x = np.clip(way / (RAMP * span), 0.0, 1.0)
            ramp = ramp * x**3 * (10 - 15 * x + 6 * x**2)
    return time, value * ramp[:, None], float(early), float(late)


def _refuse_others(study: Study, path: LoadedPath) -> None:
    wrong = {"robot.type": not path.axes.all(), "load": not lasts(study)}
    for key, bad in wrong.items():
        if bad:
            raise InputError(
                "has no elastic motion that this inverts",
                file=study.path,
                key=key,
                allowed="robots of six motions under a load that stays; order 0 or 2 takes more",
            )
