"""The least time between two poses, with drives within their limits and little vibration, Eqs. (T22.14)-(T22.19)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.arguments import FileLike, PoseLike, RobotLike, as_pose, as_study
from flexapod.analysis.results.poses import pose_coordinates
from flexapod.commissioning.feedforward.bang_bang import Switched, bang_bang_input
from flexapod.commissioning.feedforward.command_table import check_out, save_study
from flexapod.commissioning.feedforward.loaded_path import Given, drive_limits
from flexapod.commissioning.feedforward.modal_path import PERIODS, path_vibration
from flexapod.commissioning.feedforward.second_pass import error_sentence, linear_error
from flexapod.commissioning.feedforward.straight_line import StraightLine
from flexapod.common.arguments import flag, number
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.common.resources import one_thread
from flexapod.common.units import quantity
from flexapod.control import StateSpace
from flexapod.model import Study

RESIDUAL = "1 um"  # how much vibration is left where nothing else is asked for


@dataclass(frozen=True, kw_only=True)
class LeastTime:
    """A study that goes from pose to pose in the least time, and what that costs.

    ``duration``, ``unbounded`` [s]: with and without the bound for vibration; ``residual`` [m]: what is left by the
    linear model, with it and without; ``error`` of that model on the way, over the largest distance; ``used``: largest
    share of the limits of drives, by the rigid robot; ``marched``: of those of forces, in the march of the flexible
    one; ``stiff`` [s]: the time in which the rigid robot keeps bound and limits.
    """

    study: Study
    duration: float
    unbounded: float
    residual: tuple[float, float]
    bound: float
    used: float
    marched: float
    stiff: float
    error: float

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect as text."""
        flexible = f" and {100 * self.marched:.0f} % of forces by the flexible one" if self.marched else ""
        longer = (
            f"; drives of a rigid robot would hold {text(self.stiff, 's', 4)}" if self.duration > self.stiff else ""
        )
        return (
            f"the way takes {text(self.duration, 's', 4)}, the least in which drives use {100 * self.used:.0f} % of "
            f"their limits at most, by the rigid robot{flexible}, and the tool vibrates by at most "
            f"{text(self.bound, 'm')} afterwards: by {text(self.residual[0], 'm')}, by the linear model with all "
            f"modes{longer}. Without that bound it "
            f"would take {text(self.unbounded, 's', 4)} and leave {text(self.residual[1], 'm')}; "
            f"{error_sentence(self.study, self.error)}"
        )

    def __repr__(self) -> str:
        return f"Fastest({self.sentence})"


@overload
def time_optimal(
    subject: StateSpace, start: None = ..., end: ArrayLike = ..., *, limit: float = ..., robust: bool = ...
) -> Switched: ...
@overload
def time_optimal(
    subject: RobotLike, start: PoseLike = ..., end: PoseLike = ..., *, residual: Given = ..., speed: Given = ...,
    acceleration: Given = ..., force: Given = ..., out: FileLike | None = ...,
) -> Study: ...  # fmt: skip
@one_thread()
def time_optimal(
    subject: StateSpace | RobotLike,
    start: PoseLike = None,
    end: PoseLike | ArrayLike = None,
    *,
    residual: Given = RESIDUAL,
    speed: Given = None,
    acceleration: Given = None,
    force: Given = None,
    limit: float = 1.0,
    robust: bool = False,
    out: FileLike | None = None,
) -> Study | Switched:
    """The least time from pose to pose with drives within their limits; or of a linear system of one input.

    Parameters
    ----------
    subject : Study, path or StateSpace
    start, end : pose
        As for `modes`; default: home, and where the study's motion ends. All coordinates change alike. Of a state space
        `end` are its outputs, from 0 on.
    residual : float or text
        How far the tool may vibrate once it is there [m]; by the linear model with all modes.
    speed, acceleration, force : float or text, optional
        Of every drive [m/s], [m/s^2], [N], of cranks in rad and N m; besides those of the study's screws and motors.
    limit : float
        Of the input of a state space.
    robust : bool
        Of a state space: what vibrates is left alone by frequencies that are slightly wrong, too.
    out : path, optional
        ``NAME.toml``, written with ``NAME.csv`` beside it.

    Returns
    -------
    Study or Switched
        A study whose motion is a table of poses, with what it brings in its `notes`; of a state space the switches of
        its input.

    Raises
    ------
    InputError
        No limits, poses out of reach or alike.
    ComputationError
        No time is enough.

    Examples
    --------
    >>> double = fx.control.StateSpace(
    ...     A=[[0, 1], [0, 0]], B=[[0], [1]], C=[[1, 0]], D=[[0]],
    ...     inputs=("force",), outputs=("place",), states=("place", "speed"), units={"force": "N", "place": "m"},
    ... )
    >>> fx.time_optimal(double, end=1.0)  # a mass of 1 kg, 1 m away, a force of 1 N: full ahead, full back
    Switched(1, end 2: the input switches 1 times and is over after 2 s: ...)
    """
    limits = {"speed": speed, "acceleration": acceleration, "force": force}
    flag(robust, "robust")
    if isinstance(subject, StateSpace):
        for key, value in (limits | {"start": start, "out": out, "residual": residual}).items():
            if value is not None and not (key == "residual" and isinstance(value, str) and value == RESIDUAL):
                raise InputError("is for robots", key=key, value=value, allowed="end, limit, robust of a linear system")
        return bang_bang_input(subject, end, limit, robust=robust)  # type: ignore[arg-type]
    for key, value, usual in (("limit", number(limit, "limit"), 1.0), ("robust", robust, False)):
        if value != usual:
            raise InputError("is for linear systems", key=key, value=value, allowed="speed, acceleration, force")
    return least_time(subject, start, end, residual=residual, out=out, **limits).study


def least_time(
    subject: RobotLike,
    start: PoseLike = None,
    end: PoseLike = None,
    *,
    residual: Given = RESIDUAL,
    speed: Given = None,
    acceleration: Given = None,
    force: Given = None,
    out: FileLike | None = None,
) -> LeastTime:
    """Find the least time between two poses, as `time_optimal` of a robot does, with its cost."""
    study = as_study(subject)
    if out is not None:
        check_out(study, out)
    limits, bound = drive_limits(study, speed, acceleration, force), quantity(residual, "length", key="residual")
    if bound <= 0:
        raise InputError("is not a bound", key="residual", value=residual, allowed="above 0 m")
    way = StraightLine(study, limits, *_ends(study, start, end))
    period = PERIODS / way.lowest_frequency  # refused at once where nothing vibrates
    low, place = way.least_time_within_limits()
    rough = way.motion_study(low, place)
    stiff, place = way.least_time_within_vibration(low, place, bound)
    duration, place, marched = way.least_time_of_flexible_drives(stiff, place, bound)
    own = way.motion_study(duration, place)
    check_path(own)
    found, before = (path_vibration(x, t, t + period) for x, t in ((own, duration), (rough, low)))
    told = LeastTime(
        study=own, duration=duration, unbounded=low, bound=bound,
        residual=(found.largest_after(duration), before.largest_after(low)), error=linear_error(own, found),
        used=way.largest_share(duration, place), marched=marched, stiff=stiff,
    )  # fmt: skip
    told = replace(told, study=own.replace(notes=(*study.notes, told.sentence)))
    return told if out is None else replace(told, study=save_study(told.study, Path(out)))


def _ends(study: Study, start: PoseLike, end: PoseLike) -> tuple[Array, Array]:
    """Coordinates (6,) of both poses about the motion's pivot."""
    robot, motion = study.robot, study.motion
    if robot.platform_fixed:
        raise InputError("has a platform that is fixed: nothing moves", key="robot.platform.fixed", value=True)
    last = kinematics.coordinates(motion, np.array([motion.end_time])).position[0]
    first, there = (pose_coordinates(robot, as_pose(robot, pose), motion.pivot)[0] for pose in (start, end))
    there = last if end is None else there
    if np.abs(there - first).max() < 1e-12:
        raise InputError("is where the way starts", key="end", value=str(end), allowed="another pose than the start")
    return first, there
