"""A single actuator whose tip follows what its rigid beam would do, by (T20.25) and (T22.20)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from flexapod import kinematics
from flexapod.analysis.linear import linearize
from flexapod.commissioning.feedforward.command_table import saved
from flexapod.commissioning.feedforward.noncausal_filter import Inverse, answer, inverse
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.model import ActuatorStudy, CsvLaw, MotionLaw, RateLaw
from flexapod.solve.shapes import home

__all__ = ["TipStudy", "tip_inversion"]

Drives = Literal["given", "force"]
ROWS = 4000  # of a table at most


@dataclass(frozen=True, kw_only=True)
class TipStudy:
    """An actuator study whose tip follows the path of the rigid beam, and what that costs.

    ``inverse``: input of the linear beam; ``miss`` (before, after) [m]: of the tip, at most, by the linear model;
    ``longer`` [s]: of the whole motion.
    """

    study: ActuatorStudy
    drives: Drives
    inverse: Inverse
    miss: tuple[float, float]

    @property
    def longer(self) -> float:
        """By how much longer the hub or its motor acts than the tip moves [s]."""
        return self.inverse.before + self.inverse.after

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect in words."""
        what = "the hub's motor pushes" if self.drives == "force" else "the hub turns"
        early, late = (f"{text(x, 's')}" for x in (self.inverse.before, self.inverse.after))
        return (
            f"{what} so that the tip follows the path of the rigid beam: from {early} before the tip moves to {late} "
            f"after it has arrived, so that the motion takes {text(self.longer, 's')} more. By the linear model the "
            f"tip misses by {text(self.miss[1], 'm')} at most in place of {text(self.miss[0], 'm')}"
        )

    def __repr__(self) -> str:
        return f"TipStudy({self.sentence})"


def tip_inversion(study: ActuatorStudy, drives: Drives = "given", out: str | Path | None = None) -> TipStudy:
    """A study whose tip follows the path that a rigid beam would have; see `compensate`."""
    law, moving = _refuse(study, drives)
    turned = linearize(study, inputs="command:rotation", outputs="tip:rotation")
    pushed = linearize(study, inputs="drive:rotation", outputs="tip:rotation", drives="force")
    used, length = turned if drives == "given" else pushed, home(study.actuator)["extension"]
    found = inverse(used, moving, lambda t: length * kinematics.motion_law(law, t).acceleration)
    wanted = kinematics.motion_law(law, np.clip(found.time, 0.0, moving))
    bend = np.where((found.time >= 0) & (found.time <= moving), wanted.acceleration, 0.0)
    own, new = (
        np.abs(answer(system, found.time, value)[0] - length * wanted.position).max()
        for system, value in ((turned, bend), (used, found.value))
    )
    made = TipStudy(study=study, drives=drives, inverse=found, miss=(float(own), float(new)))
    return _told(made, law, out)


def _told(made: TipStudy, law: MotionLaw, out: str | Path | None) -> TipStudy:
    """The study that does it, with what it brings."""
    from scipy.interpolate import CubicSpline

    study, found = made.study, made.inverse
    time = found.time - found.time[0]
    some = np.unique(np.linspace(0, len(time) - 1, min(len(time), ROWS + 1)).astype(int))
    duration = None if study.simulation.duration is None else study.simulation.duration + made.longer
    simulation = study.simulation.replace(duration=duration or float(time[-1]))
    if made.drives == "force":
        motion = study.motion.replace(rotation=None)
        load = study.load.replace(torque=CsvLaw(time=time[some], value=found.value[some]))
    else:
        angle = CubicSpline(time, found.value).antiderivative(2)(time)
        motion, load = study.motion.replace(rotation=CsvLaw(time=time[some], value=angle[some])), study.load
    notes = (*study.notes, made.sentence)
    told = replace(made, study=study.replace(motion=motion, load=load, simulation=simulation, notes=notes))
    return told if out is None else replace(told, study=saved(told.study, out))


def _refuse(study: ActuatorStudy, drives: str) -> tuple[MotionLaw, float]:
    """The law of the hub, and how long it moves [s]; what has no linear model is refused."""
    actuator, motion = study.actuator, study.motion
    if not isinstance(drives, str) or drives not in ("given", "force"):
        raise InputError("is not a way to take drives", key="drives", value=drives, allowed='"given", "force"')
    if motion.rotation is None or isinstance(motion.rotation, RateLaw) or motion.rotation.law == "spin-up":
        raise InputError(
            "does not bring the hub from rest to rest",
            file=study.path,
            key="motion.rotation",
            allowed='a profile, as { law = "smooth", amplitude = "20 deg", duration = "2 s" }, or a table',
        )
    extension = motion.extension
    moves = extension is not None and np.ptp(kinematics.motion_law(extension, np.linspace(0, study.duration, 101))[0])
    wrong = {
        "actuator.space": actuator.space,
        "actuator.gravity": actuator.gravity != 0,
        "motion.extension": bool(moves) or extension is None,
        "load": study.load.wrench is not None,
        "simulation.fidelity": not study.simulation.lateral_shapes,
    }
    for key, bad in wrong.items():
        if bad:
            raise InputError(
                "has no linear model that stays what it is along the motion",
                file=study.path,
                key=key,
                allowed="a beam that bends in its plane, of a length that stays, without gravity and loads",
            )
    law = motion.rotation
    return law, float(law.time[-1] if isinstance(law, CsvLaw) else law.duration)
