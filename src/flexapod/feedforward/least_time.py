"""The least time between two poses, drives within their limits and little vibration left, Eqs. (T22.14)-(T22.19)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics
from flexapod.arrays import Array
from flexapod.control import StateSpace
from flexapod.errors import ComputationError, InputError
from flexapod.feedforward.drive_loads import DriveLimits, Given, limits_of
from flexapod.feedforward.switching import Switched, switched
from flexapod.feedforward.table import named, saved
from flexapod.feedforward.vibration import LinearPath, followed, forces, linear_path, vibration_along
from flexapod.kinematics import Law
from flexapod.model import CsvMotion, Study
from flexapod.results.arguments import FileLike, PoseLike, RobotLike, as_pose, as_study
from flexapod.results.path import RigidPath
from flexapod.results.poses import coordinates_of
from flexapod.review.checks import check_path
from flexapod.runtime.threads import one_thread
from flexapod.units import to_si
from flexapod.words import text

__all__ = ["Fastest", "fastest", "time_optimal"]

ROWS = 48  # of the table of the way: cubic acceleration between them
LOOKS = 4  # instants between two rows at which limits hold
POSES = 13  # along the way, at which matrices are made
SIDES = 16  # of the polygon in which the amplitude of a mode stays
ROUNDS = 4  # in which limits follow the way
WITHIN, HOPELESS = 1.002, 1.1  # of a limit
FINE = 5e-3  # of the time
SHARE = 0.9  # of the bound for vibration that the way is made for: linear in its places
PERIODS = 6


@dataclass(frozen=True, kw_only=True)
class Fastest:
    """A study that goes from pose to pose in the least time, and what that costs.

    ``duration``, ``unbounded`` [s]: with and without the bound for vibration; ``residual`` [m]: what is left by the
    linear model, with it and without; ``used``: largest share of the limits of drives, by the rigid robot.
    """

    study: Study
    duration: float
    unbounded: float
    residual: tuple[float, float]
    bound: float
    used: float

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect in words."""
        return (
            f"the way takes {text(self.duration, 's', 4)}, the least in which drives use {100 * self.used:.0f} % of "
            f"their limits at most, by the rigid robot, and the tool vibrates by at most {text(self.bound, 'm')} "
            f"afterwards: by {text(self.residual[0], 'm')}, by the linear model with all modes. Without that bound it "
            f"would take {text(self.unbounded, 's', 4)} and leave {text(self.residual[1], 'm')}"
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
    residual: Given = "1 um",
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
    """
    if isinstance(subject, StateSpace):
        return switched(subject, np.asarray(end, dtype=float), limit, robust=robust)
    limits = {"speed": speed, "acceleration": acceleration, "force": force}
    return fastest(subject, start, end, residual=residual, out=out, **limits).study


def fastest(
    subject: RobotLike,
    start: PoseLike = None,
    end: PoseLike = None,
    *,
    residual: Given = "1 um",
    speed: Given = None,
    acceleration: Given = None,
    force: Given = None,
    out: FileLike | None = None,
) -> Fastest:
    """As `time_optimal` of a robot, with what it costs."""
    study = as_study(subject)
    limits, bound = limits_of(study, speed, acceleration, force), to_si(residual, "length", key="residual")
    if bound <= 0:
        raise InputError("is not a bound", key="residual", value=residual, allowed="above 0 m")
    way = _Way(study, limits, *_ends(study, start, end))
    low, place = way.without_vibration()
    rough = way.study(low, place)
    duration, place = way.bounded(low, place, bound)
    own = way.study(duration, place)
    check_path(own)
    period = PERIODS / way.first
    left = [vibration_along(x, t, t + period).after(t) for x, t in ((own, duration), (rough, low))]
    told = Fastest(
        study=own, duration=duration, unbounded=low, residual=(left[0], left[1]), bound=bound,
        used=way.used(duration, place),
    )  # fmt: skip
    told = replace(told, study=own.replace(notes=(*study.notes, told.sentence)))
    return told if out is None else replace(told, study=saved(told.study, Path(out)))


def _ends(study: Study, start: PoseLike, end: PoseLike) -> tuple[Array, Array]:
    """Coordinates (6,) of both poses about the motion's pivot."""
    robot, motion = study.robot, study.motion
    if robot.platform_fixed:
        raise InputError("has a platform that is fixed: nothing moves", key="robot.platform.fixed", value=True)
    last = kinematics.coordinates(motion, np.array([motion.end_time])).position[0]
    first, there = (coordinates_of(robot, as_pose(robot, pose), motion.pivot)[0] for pose in (start, end))
    there = last if end is None else there
    if np.abs(there - first).max() < 1e-12:
        raise InputError("is where the way starts", key="end", value=str(end), allowed="another pose than the start")
    return first, there


class _Way:
    """A way from pose to pose: its law, drives along it, what it makes the robot do."""

    def __init__(self, study: Study, limits: DriveLimits, first: Array, last: Array) -> None:
        from scipy.interpolate import BSpline

        self.origin, self.limits, self.first_pose, self.change = study, limits, first, last - first
        self.axes = kinematics.commanded_axes(study.robot, study.motion)
        knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, ROWS + 1), [1.0] * 3])
        bend = BSpline(knots, np.eye(ROWS + 3)[:, 1:-1], 3)  # (T22.18)  accelerations are 0 at both ends
        self.bases = bend.antiderivative(2), bend.antiderivative(1), bend
        self.looks = np.linspace(0.0, 1.0, LOOKS * ROWS + 1)

    def law(self, c: Array, T: float, tau: Array) -> Law:
        """Share of the way at instants tau T, with rates, (any,)."""
        s, v, a = (basis(tau) @ c for basis in self.bases)
        return Law(s, v / T, a / T**2)

    def poses(self, share: Law, t: Array) -> kinematics.Poses:
        """Poses of the rigid robot at shares of the way."""
        law = Law(*(np.multiply.outer(part, self.change) for part in share))
        law = Law(law.position + self.first_pose, law.rate, law.acceleration)
        return kinematics.poses_of_law(self.origin.robot, self.origin.motion, law, t)

    def shares(self, share: Law, t: Array) -> tuple[Array, Array]:
        """Of the drives' limits, as `DriveLimits.shares`."""
        return self.limits.shares(RigidPath(self.origin, t, self.poses(share, t)))

    def used(self, T: float, c: Array) -> float:
        """Largest share of the limits."""
        found = self.shares(self.law(c, T, self.looks), T * self.looks)
        return float(max(np.abs(x).max() for x in found))

    def study(self, T: float, c: Array) -> Study:
        """The study that goes this way."""
        time = np.linspace(0.0, T, ROWS + 1)
        pose = self.first_pose + np.multiply.outer(self.law(c, T, time / T).position, self.change)
        own = self.origin.motion
        pose = np.where(self.axes, pose, 0.0)
        motion = CsvMotion(time=time, pose=pose, hold=own.hold, pivot=own.pivot, independent=named(self.axes))
        simulation = self.origin.simulation.replace(duration=None)
        return self.origin.replace(motion=motion, simulation=simulation)

    def smooth(self) -> Array:
        """Coefficients of a quintic way, to start from."""
        tau = np.linspace(0.0, 1.0, 4 * ROWS)
        wanted = 60 * tau * (1 - tau) * (1 - 2 * tau)
        return np.linalg.lstsq(self.bases[2](tau), wanted, rcond=None)[0]

    def rows(self, T: float, c: Array) -> tuple[Array, Array]:
        """What drives use, |G c + g| of their limits about a way, Eq. (T22.17)."""
        now, t = self.law(c, T, self.looks), T * self.looks
        _, strong = self.shares(now, t)
        more, none = now._replace(acceleration=now.acceleration + 1 / T**2), np.zeros_like(now.rate)
        slope = self.shares(more, t)[1] - strong  # by s'', linear but for friction
        rest = strong - slope * T**2 * now.acceleration[:, None]
        fast = np.abs(self.shares(Law(now.position, none + 1 / T, none), t)[0]).max(axis=1)
        bend = self.bases[2](self.looks)
        G = [fast[:, None] * self.bases[1](self.looks), *(part[:, None] * bend for part in slope.T)]
        return np.concatenate(G), np.concatenate([none, *rest.T])

    def solved(self, T: float, c: Array, effect: tuple[Array, Array] | None = None, bound: float = 0.0) -> Array:
        """Coefficients that use least of the limits, with no more vibration than the bound, Eqs. (T22.17), (T22.19)."""
        from scipy.optimize import linprog

        G, g = self.rows(T, c)
        n, m = G.shape[1], 0 if effect is None else len(effect[0])
        ends = np.pad([self.bases[1](1.0), self.bases[0](1.0)], ((0, 0), (0, m + 1)))
        width = ((0, 0), (0, m))
        sides = np.concatenate([np.pad(G, width), np.pad(-G, width)])
        above = [np.column_stack([sides, -np.ones(len(sides))])]
        most = [np.append(-g, g)]
        if effect is not None:
            turn = np.exp(2j * np.pi * np.arange(SIDES) / SIDES) / np.cos(np.pi / SIDES)
            of = np.real(turn[:, None, None] * effect[0]).reshape(-1, n) / bound
            above += [np.column_stack([of, np.tile(-np.eye(m), (SIDES, 1)), np.zeros(SIDES * m)])]
            above += [np.concatenate([np.zeros(n), np.ones(m), [0.0]])[None]]
            most += [-np.real(turn[:, None] * effect[1]).ravel() / bound, np.ones(1)]
        found = linprog(
            np.append(np.zeros(n + m), 1.0), A_ub=np.concatenate(above), b_ub=np.concatenate(most), A_eq=ends,
            b_eq=[0.0, 1.0], bounds=[(None, None)] * n + [(0, None)] * (m + 1), method="highs",
        )  # fmt: skip
        if found.status != 0:
            raise ComputationError(f"the way was not found: {found.message}")
        return found.x[:n]

    def keeps(self, T: float, c: Array) -> Array | None:
        """A way within the limits in a time, from another one; None where there is none."""
        for _ in range(ROUNDS):
            c = self.solved(T, c)
            if self.used(T, c) <= WITHIN:
                return c
        return None

    def without_vibration(self) -> tuple[float, Array]:
        """The least time and its way, whatever vibrates."""
        c = self.smooth()
        high = 0.1
        while self.used(high, c) > 1.0:
            high *= 2
            if high > 1e4:
                raise ComputationError(
                    "no time is enough: at rest on the way drives are beyond their limits already",
                    next_step="Raise the limits, or take weight off.",
                )
        low, best = 0.0, (high, c)
        while high - low > FINE * high:
            T = 0.5 * (low + high)
            found = self.keeps(T, best[1])
            low, high = (T, high) if found is None else (low, T)
            best = best if found is None else (T, found)
        return best

    @cached_property
    def first(self) -> float:
        """Lowest frequency at both ends [Hz]."""
        return float(np.nanmin(self.at(1.0, self.smooth()).modes.frequency[:, 0]))

    def at(self, T: float, c: Array) -> LinearPath:
        """The linear model along a way."""
        t = np.linspace(0.0, T, POSES)
        return linear_path(self.origin, t, self.poses(self.law(c, T, t / T), t))

    def effect(self, T: float, c: Array) -> tuple[Array, Array]:
        """Amplitudes at the tool (modes, any) [m] left by each coefficient, and by rates, at the end, Eq. (T22.19)."""
        at = self.at(T, c)

        def acting(t: Array) -> Array:
            now = self.law(c, T, t / T)
            none = np.zeros_like(now.rate)
            bend = forces(at, self.poses(Law(now.position, none, none + 1.0), t))
            rate = forces(at, self.poses(Law(now.position, now.rate, none), t))
            return np.concatenate([bend[..., None] * (self.bases[2](t / T) / T**2)[:, None], rate[..., None]], axis=2)

        z, v = followed(at, acting)[1][-1]
        return _amplitudes(at, z, v)

    def bounded(self, low: float, c: Array, bound: float) -> tuple[float, Array]:
        """The least time and its way with at most so much vibration left."""
        best = self.quiet(low, c, bound)
        if best is not None:
            return low, best
        high, step = low + 0.5 / self.first, 0.5 / self.first
        while (found := self.quiet(high, c, bound)) is None:
            low, step = high, 1.5 * step
            high = low + step
            if high > 1e4:
                raise ComputationError("no time is enough for so little vibration", next_step="Allow more (residual).")
        best = (high, found)
        while high - low > FINE * high:
            T = 0.5 * (low + high)
            found = self.quiet(T, best[1], bound)
            low, high = (T, high) if found is None else (low, T)
            best = best if found is None else (T, found)
        return best

    def quiet(self, T: float, c: Array, bound: float) -> Array | None:
        """A way within limits and bound in a time; None where there is none."""
        effect = self.effect(T, c)
        for _ in range(ROUNDS):
            c = self.solved(T, c, effect, SHARE * bound)
            effect, used = self.effect(T, c), self.used(T, c)
            if used <= WITHIN and np.abs(effect[0] @ c + effect[1]).sum() <= bound:
                return c
            if used > HOPELESS:
                break
        return None


def _amplitudes(at: LinearPath, z: Array, v: Array) -> tuple[Array, Array]:
    """Complex amplitudes at the tool of all modes at the last pose, of motions and rates (d, c); the last apart."""
    from scipy.linalg import eigh

    squares, shapes = eigh(at.K[-1], at.M[-1])
    w = np.sqrt(np.abs(squares))
    size = np.linalg.norm(at.tool[-1] @ shapes, axis=0)
    to = shapes.T @ at.M[-1]
    found = size[:, None] * (to @ z + 1j * (to @ v) / w[:, None])
    return found[:, :-1], found[:, -1]
