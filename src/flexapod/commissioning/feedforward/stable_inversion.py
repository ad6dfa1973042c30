"""Motions that compensate elastic motion, with commands before and after the path, Eqs. (T22.23)-(T22.24)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.arguments import FileLike, RobotLike, as_study
from flexapod.commissioning.feedforward.command_table import save_study
from flexapod.commissioning.feedforward.correction_series import (
    check_correctable,
    check_workspace,
    correction_knots,
    static_series,
)
from flexapod.commissioning.feedforward.loaded_path import LoadedPath, is_permanent
from flexapod.commissioning.feedforward.modal_path import LinearPath, inertial_loads, integrate_modes, linear_path
from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.kinematics import Law, Poses
from flexapod.kinematics.trajectory import turning_axes
from flexapod.model import CsvMotion, Study
from flexapod.solve.statics.stiffness import tool_motion

POSES = 41  # along the path with what comes before and after
PERIODS = 4  # of the first mode before and after the path, at first
MODE, TIMES = 6, 4  # commands reach up to so many times the frequency of that mode
EACH = 8  # instants in a period of that
ROUNDS = 3
ENOUGH = 1e-4  # of the elastic motion: what may be missed
EDGE = 1e-3  # of the largest command: what may be cut off at the ends
MOST = 2**15
SHIFT = 12.0  # time constants in the whole time by which what rings is made to decay


@dataclass(frozen=True, kw_only=True)
class ElasticCommands:
    """Corrections (n, 6) of the pose at even instants ``time`` (n,) [s], 0 where the path begins.

    ``before``, ``after`` (n, 6): what the tool misses without and with them, in coordinates of the pose, by the linear
    model; ``early``, ``late`` [s]: how long they act before the path and after it.
    """

    time: Array
    value: Array
    before: Array
    after: Array
    early: float
    late: float


def elastic_commands(study: Study, moving: float) -> ElasticCommands:
    """Corrections of a path that moves for so long [s], which keep the tool of the linear robot on it.

    Elastic motion along the path, matrices as they change, is made up for by the inverse of its transfer in the
    middle of the path, (T22.23), anew until it is.
    """
    middle = linear_path(study, np.array([0.5 * moving]))
    first, reach = middle.modes.frequency[0, 0], TIMES * np.nanmax(middle.modes.frequency[0, :MODE])
    pad = PERIODS / first
    while True:
        found = _converged(study, middle, moving, pad, reach)
        cut = max(np.abs(found.value[0]).max(), np.abs(found.value[-1]).max()) / np.abs(found.value).max()
        if cut < EDGE or len(found.time) > MOST:
            return found
        pad *= 2


def _converged(study: Study, middle: LinearPath, moving: float, pad: float, reach: float) -> ElasticCommands:
    whole = moving + 2 * pad
    count = int(2 ** np.ceil(np.log2(whole * reach * EACH)))
    time = np.arange(count) * whole / count - pad
    path = _Path(study, moving, time)
    shift = SHIFT / whole
    s = (2j * np.pi * np.fft.rfftfreq(count, whole / count) + shift).astype(complex)
    inverse = _inverse(study, middle, 0.5 * moving, s, reach)
    fading = np.exp(-shift * (time - time[0]))[:, None]  # of what still rings at the end nothing is left
    before = path.elastic_motion(np.zeros((count, 6)))
    value = -path.at_rest() * path.window[:, None]
    missed = path.elastic_motion(value)
    for _ in range(ROUNDS):
        wrong = np.fft.rfft(fading * (value + missed), axis=0)
        trial = value - np.fft.irfft(np.einsum("fij,fj->fi", inverse, wrong), count, axis=0) / fading
        trial = trial * path.window[:, None]
        after = path.elastic_motion(trial)
        if _size(trial + after) > _size(value + missed):
            break
        value, missed = trial, after
        if _size(value + missed) < ENOUGH * _size(before):
            break
    acting = np.flatnonzero(np.abs(value).max(axis=1) > EDGE * np.abs(value).max())
    early, late = float(-time[acting[0]]), float(time[acting[-1]] - moving)
    return ElasticCommands(
        time=time, value=value, before=before, after=value + missed, early=max(0.0, early), late=max(0.0, late)
    )


def _size(missed: Array) -> float:
    return float(np.linalg.norm(missed))


class _Path:
    """A study's path with time before and after it, and the elastic motion of the robot on it."""

    def __init__(self, study: Study, moving: float, time: Array) -> None:
        self.study, self.time, self.moving, self.start = study, time, moving, float(time[0])
        shifted = np.linspace(0.0, time[-1] - self.start, POSES)
        self.at = linear_path(study, shifted, self._poses(Law(*(np.zeros((POSES, 6)),) * 3), shifted))
        ramp = np.clip(np.minimum(time - time[0], time[-1] - time) / (0.1 * -self.start), 0.0, 1.0)
        self.window = ramp**3 * (10 - 15 * ramp + 6 * ramp**2)

    def law(self, t: Array) -> Law:
        """The path's own coordinates at instants from the beginning of the time before it."""
        return kinematics.coordinates(self.study.motion, np.clip(t + self.start, 0.0, self.moving))

    def _poses(self, added: Law, t: Array) -> Poses:
        own, inside = self.law(t), ((t + self.start >= 0) & (t + self.start <= self.moving))[:, None]
        whole = Law(own.position, np.where(inside, own.rate, 0.0), np.where(inside, own.acceleration, 0.0))
        law = Law(*(x + y for x, y in zip(whole, added, strict=True)))
        return kinematics.poses_of_law(self.study.robot, self.study.motion, law, t)

    def at_rest(self) -> Array:
        """Quasi-static deflection of the robot by the inertia of the path, (n, 6)."""
        from scipy.interpolate import CubicSpline

        shifted, none = self.time - self.start, np.zeros((len(self.time), 6))
        parts = self.at.flat, self.at.K, _pose_rows(self.study, self.at)
        flat, K, rows = (CubicSpline(self.at.time, part)(shifted) for part in parts)
        f = inertial_loads(self.at, self._poses(Law(none, none, none), shifted))
        there = (rows @ np.linalg.solve(K, -flat.swapaxes(1, 2) @ f[..., None]))[..., 0]
        there[:, 3:] = np.linalg.solve(turning_axes(self.law(shifted).position[:, 3:]), there[:, 3:, None])[..., 0]
        return there

    def elastic_motion(self, value: Array) -> Array:
        """Elastic motion (n, 6) of the pose, in coordinates about the pivot, commands `value` (n, 6) added."""
        from scipy.interpolate import CubicSpline, make_interp_spline

        shifted = self.time - self.start
        curve = make_interp_spline(shifted, value, k=5)
        first, second = curve.derivative(), curve.derivative(2)

        def acting(t: Array) -> Array:
            return inertial_loads(self.at, self._poses(Law(curve(t), first(t), second(t)), t))[..., None]

        edges, x = integrate_modes(self.at, acting, len(self.time))
        to = CubicSpline(self.at.time, _pose_rows(self.study, self.at))(edges)
        there = np.einsum("txd,td->tx", to, x[:, 0, :, 0])
        there[:, 3:] = np.linalg.solve(turning_axes(self.law(edges).position[:, 3:]), there[:, 3:, None])[..., 0]
        return CubicSpline(edges, there)(shifted)


def _pose_rows(study: Study, at: LinearPath) -> Array:
    """Displacement of the pivot and rotation, world axes, by independent motions (P, 6, d)."""
    system, robot = at.locked.system, at.locked.robot
    at_pivot = robot.replace(payload=robot.payload.replace(tool=study.motion.pivot))
    hub = at.flat[:, system.legs * system.n :]
    return tool_motion(at_pivot, at.locked.equilibria.states.pose) @ hub


def _inverse(study: Study, at: LinearPath, instant: float, laplace: Complex, reach: float) -> Complex:
    """Pose to command by the pose that is wanted (f, 6, 6) about one pose of the path, up to a reach, Eq. (T22.24)."""
    now = kinematics.coordinates(study.motion, np.array([instant]))
    none, each = np.zeros((6, 6)), np.eye(6)
    law = Law(np.repeat(now.position, 6, axis=0), none, each)
    bend = inertial_loads(at, kinematics.poses_of_law(study.robot, study.motion, law, np.full(6, instant)))
    force, rows = at.flat[0].T @ bend.T, _pose_rows(study, at)[0]
    rows[3:] = np.linalg.solve(turning_axes(now.position[:, 3:])[0], rows[3:])
    found, hz = np.zeros((len(laplace), 6, 6), dtype=complex), laplace.imag / (2 * np.pi)
    for k in np.flatnonzero(hz < reach):
        s = laplace[k]
        x = np.linalg.solve(s**2 * at.M[0] + s * at.D[0] + at.K[0], -(s**2) * force)
        fade = 0.5 * (1 + np.cos(np.pi * np.clip(2 * hz[k] / reach - 1, 0.0, 1.0)))
        found[k] = fade * np.linalg.inv(np.eye(6) + rows @ x)
    return found


RAMP = 0.2  # of the time kept before and after, in which commands begin and end


@dataclass(frozen=True, kw_only=True)
class ElasticCompensation:
    """A study whose commands compensate weight, load and elastic motion, and their effect.

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
        """Benefit, cost and effect as text."""
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
) -> ElasticCompensation:
    """Compensate the motion of a study by stable inversion, and return it with its effect."""
    study = as_study(study)
    known = study if as_built else study.replace(robot=study.robot.replace(geometry=None, heat=None))
    check_correctable(known, corrections, inertia=True)
    check_path(study)
    path = LoadedPath(known)
    _refuse_others(study, path)
    moving = study.motion.end_time - study.motion.hold
    series, _ = static_series(path, corrections, correction_knots(study, moving))
    found = elastic_commands(study, moving)
    time, value, early, late = _trim_commands(found, moving)
    inside = np.clip(time, 0.0, moving)
    pose = path.target_law(inside).position + series(inside).position + value
    motion = CsvMotion(time=time + early, pose=pose, hold=study.motion.hold, pivot=study.motion.pivot)
    duration = study.simulation.duration
    simulation = study.simulation.replace(duration=None if duration is None else duration + early + late)
    made = study.replace(motion=motion, simulation=simulation)
    check_workspace(made)
    told = ElasticCompensation(
        study=made,
        miss=_largest(found, slice(0, 3)),
        turned=_largest(found, slice(3, 6)),
        early=early,
        late=late,
    )
    told = replace(told, study=made.replace(notes=(*study.notes, told.sentence)))
    return told if out is None else replace(told, study=save_study(told.study, out))


def _largest(found: ElasticCommands, part: slice) -> tuple[float, float]:
    """Largest size of a part of what is missed, without commands and with them."""
    before, after = (float(np.linalg.norm(x[:, part], axis=1).max()) for x in (found.before, found.after))
    return before, after


def _trim_commands(found: ElasticCommands, moving: float) -> tuple[Array, Array, float, float]:
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
    wrong = {"robot.type": not path.axes.all(), "load": not is_permanent(study)}
    for key, bad in wrong.items():
        if bad:
            raise InputError(
                "has no elastic motion that this inverts",
                file=study.path,
                key=key,
                allowed="robots of six motions under a load that stays; order 0 or 2 takes more",
            )
