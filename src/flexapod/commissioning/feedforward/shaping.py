"""Motions with little residual vibration: the pose's law, delayed and summed, Eqs. (T22.6), (T22.12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import overload

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.arguments import FileLike, PoseLike, RigidPose
from flexapod.commissioning.feedforward.command_table import check_out, save_study, tabulate_law
from flexapod.commissioning.feedforward.modal_path import PERIODS, POSES, linear_path, path_vibration
from flexapod.commissioning.feedforward.second_pass import error_sentence, linear_error
from flexapod.commissioning.feedforward.shapers import KINDS, Shaper, shaper
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError, check_known
from flexapod.common.quantities import number, text
from flexapod.common.resources import one_thread
from flexapod.common.units import quantity
from flexapod.kinematics import Law
from flexapod.model import ActuatorStudy, AxisMotion, CombinedMotion, CsvMotion, Motion, Study, WaypointMotion, load
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import ManyModes, modes_of

ON_PATH = 1e-4  # of the way: a shaped path that is no farther beside the own one is on it
LOOKS = 2001
SLOWEST, FASTEST = 0.01, 1e4  # of the first mode: frequencies that somebody may mean

Modes = int | Sequence[int | float | str | tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class ShapedStudy:
    """A shaped study and what it brings.

    ``impulses``: of its shaper; ``frequency``, ``ratio`` (modes,) for which they are made, ``ranges`` (modes, 2) [Hz]
    of these along the path, ``left`` (modes,): of the vibration of each at worst along it, over that of one impulse.
    By the linear model, before and after: ``residual`` [m] of the tool once the motion is over, ``largest`` [m] beside
    its places at rest at any time; ``error`` of the model, shaped, over that. ``longer`` [s]; ``beside`` [m]: of the
    path of the rigid tool, corners that are cut.
    """

    study: Study
    kind: str
    impulses: Shaper
    frequency: Array
    ratio: Array
    ranges: Array
    left: Array
    residual: tuple[float, float]
    largest: tuple[float, float]
    beside: float
    error: float

    @property
    def longer(self) -> float:
        """Time that shaping adds to the motion [s]."""
        return self.impulses.duration

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect as text."""
        modes = ", ".join(
            f"{number(f, 4)} Hz (on the path {number(low, 4)} to {number(high, 4)} Hz, at most {100 * rest:.1f} % left)"
            for f, (low, high), rest in zip(self.frequency, self.ranges, self.left, strict=True)
        )
        cut = f", and cuts corners of the path by up to {text(self.beside, 'm')}" if self.beside else ""
        return (
            f"the motion is shaped ({self.kind}) for {modes}: once it is over the tool vibrates by "
            f"{text(self.residual[1], 'm')} in place of {text(self.residual[0], 'm')}, and on the way it is up to "
            f"{text(self.largest[1], 'm')} in place of {text(self.largest[0], 'm')} from where it would rest, by the "
            f"linear model with all modes; it takes {text(self.longer, 's')} more{cut}; "
            f"{error_sentence(self.study, self.error)}"
        )

    def __repr__(self) -> str:
        return f"Shaped({self.sentence})"


@overload
def shape(
    motion: Study | FileLike,
    kind: str = ...,
    *,
    modes: Modes = ...,
    pose: PoseLike | str = ...,
    out: FileLike | None = ...,
) -> Study: ...
@overload
def shape(
    motion: Motion, kind: str = ..., *, modes: Modes = ..., pose: PoseLike | str = ..., out: FileLike | None = ...
) -> CsvMotion: ...
@one_thread()
def shape(
    motion: Study | Motion | FileLike,
    kind: str = "zv",
    *,
    modes: Modes = 1,
    pose: PoseLike | str = "path",
    out: FileLike | None = None,
) -> Study | CsvMotion:
    """Shape a motion so that it leaves modes at rest: the law of its pose is delayed and summed by impulses.

    The pose is shaped, never single legs, which would leave the path. Each kind takes more time and leaves less where
    frequencies are not those that it was made for: within the band in which at most 5 % are left, over the frequency,
    "zv" 0.064, "mzv" 0.10, "zvd" 0.29, "ei" 0.40, "2hei" 0.72; in periods they take 1/2, 3/4, 1, 1, 3/2.

    Parameters
    ----------
    motion : Study, path or Motion
        Of a study its motion; a motion alone has no modes: there `modes` are frequencies.
    kind : {"zv", "mzv", "zvd", "ei", "2hei"}
    modes : int or sequence
        How many of the first modes; or which, by number, by frequency [Hz] (12.5, "12.5 Hz"), or by frequency and
        damping ratio (12.5, 0.01). One shaper for each, one after the other.
    pose : pose, or "path"
        At which modes are those of the loaded robot; "path": in the middle of their range along the path.
    out : path, optional
        ``NAME.toml``, written with ``NAME.csv`` beside it; of a study.

    Returns
    -------
    Study or CsvMotion
        As what was given. The `notes` of a study say what it brings.

    Raises
    ------
    InputError
        An unknown kind, modes that there are not, a path that leaves the workspace.
    ComputationError
        No equilibrium at an instant.

    Examples
    --------
    >>> study = fx.preset("machine-hexapod")
    >>> shaped = fx.shape(study.motion, "zvd", modes=["50 Hz"])  # of the whole study: modes=1, of the first mode
    >>> print(f"{1e3 * (shaped.end_time - study.motion.end_time):.1f} ms longer")  # a period
    20.0 ms longer
    """
    check_known(kind, KINDS, "kind")
    subject = load(motion) if isinstance(motion, str | Path) else motion
    if isinstance(subject, ActuatorStudy):
        raise InputError(
            "is a single actuator, whose law is no pose", key="motion", allowed="the study or the motion of a robot"
        )
    if isinstance(subject, Study):
        return shape_study(subject, kind, modes=modes, pose=pose, out=out).study
    if not isinstance(subject, AxisMotion | CombinedMotion | WaypointMotion | CsvMotion):
        raise InputError("is neither a study nor a motion", key="motion", value=subject)
    frequency, ratio = np.array(_of_motion(modes, pose, out), dtype=float).T
    return _delayed(subject, shaper(kind, frequency, ratio), np.ones(6, dtype=bool), 1.0)


def shape_study(
    study: Study, kind: str = "zv", *, modes: Modes = 1, pose: PoseLike | str = "path", out: FileLike | None = None
) -> ShapedStudy:
    """Shape the motion of a study, as `shape` does, and return it with its effect."""
    if out is not None:
        check_out(study, out)
    for mode in _mode_list(modes):
        _frequency(mode)
    check_path(study)
    robot, motion = study.robot, study.motion
    if robot.platform_fixed:
        raise InputError("has a platform that is fixed: nothing moves", key="robot.platform.fixed", value=True)
    moving = motion.end_time - motion.hold
    at = linear_path(study, np.linspace(0.0, moving, POSES), shapes=True)
    frequency, ratio, ranges, lowest = _modes(study, modes, pose, at.modes)
    made = shaper(kind, frequency, ratio)
    axes, length = kinematics.commanded_axes(robot, motion), kinematics.rigid_limbs(robot).L_c
    table, duration = _delayed(motion, made, axes, length), study.simulation.duration
    simulation = study.simulation.replace(duration=None if duration is None else duration + made.duration)
    shaped = study.replace(motion=table, simulation=simulation)
    check_path(shaped)
    rest = max(PERIODS / ranges.min(), 1 / lowest)
    own = path_vibration(study, moving, moving + rest, at)
    new = path_vibration(shaped, moving + made.duration, moving + made.duration + rest)
    around = np.linspace(ranges[:, 0], ranges[:, 1], 101)
    found = ShapedStudy(
        study=shaped, kind=kind, impulses=made, frequency=frequency, ratio=ratio, ranges=ranges,
        left=made.residual_share(around, ratio).max(axis=0),
        residual=(own.largest_after(moving), new.largest_after(moving + made.duration)),
        largest=(own.largest, new.largest), beside=_path_offset(study, shaped, moving),
        error=linear_error(shaped, new),
    )  # fmt: skip
    told = replace(found, study=shaped.replace(notes=(*study.notes, found.sentence)))
    return told if out is None else replace(told, study=save_study(told.study, out))


def _of_motion(modes: Modes, pose: object, out: object) -> list[tuple[float, float] | None]:
    """Frequencies and damping ratios for a motion alone; InputError of what needs a study."""
    for key, value, usual in (("out", out, None), ("pose", pose, "path")):
        if value is not usual and not (isinstance(value, str) and value == usual):
            raise InputError("is for studies", key=key, value=value, next_step="Give the whole study, not its motion")
    given = [] if isinstance(modes, int) else [_frequency(mode) for mode in _mode_list(modes)]
    if not given or any(mode is None for mode in given):
        raise InputError(
            "are numbers of modes, and a motion alone has none",
            key="modes",
            value=modes,
            allowed="frequencies: [12.5, ...] in Hz",
            next_step="Give the whole study in place of its motion",
        )
    return given


def _frequency(mode: object) -> tuple[float, float] | None:
    """Frequency [Hz] and damping ratio, where that is what a mode is given by; None of a number of a mode."""
    if isinstance(mode, tuple) and len(mode) == 2:
        return quantity(mode[0], "frequency", key="modes"), quantity(mode[1], "number", key="modes")
    if isinstance(mode, str):
        return quantity(mode, "frequency", key="modes"), 0.0
    return None if isinstance(mode, int | np.integer) else (quantity(mode, "frequency", key="modes"), 0.0)


def _mode_list(modes: Modes) -> list[object]:
    """Modes one by one."""
    if isinstance(modes, int) and not isinstance(modes, bool):
        return list(range(1, modes + 1))
    if isinstance(modes, str) or not isinstance(modes, Sequence | np.ndarray):
        allowed = 'how many, or a list as [1, 3], [12.5], ["12.5 Hz"]'
        raise InputError("names no mode", key="modes", value=modes, allowed=allowed)
    return list(modes)


def _modes(study: Study, modes: Modes, pose: PoseLike | str, along: ManyModes) -> tuple[Array, Array, Array, float]:
    """Frequencies, damping ratios (m,) and ranges along the path (m, 2) of modes that are named; the lowest there."""
    at, lowest = along, float(np.nanmin(along.frequency[:, 0]))
    if not (isinstance(pose, str) and pose == "path"):
        elastic = ElasticRobot(study.robot, study.simulation, study.load)
        at = modes_of(elastic.lock(RigidPose(study.robot, pose)), shapes=True)  # type: ignore[arg-type]
    given = _mode_list(modes)
    found = []
    for mode in given:
        if (own := _frequency(mode)) is not None:
            if own[0] > 0 and not SLOWEST * lowest <= own[0] <= FASTEST * lowest:
                raise InputError(
                    f"is far from every mode: the first is at {lowest:.4g} Hz",
                    key="modes",
                    value=mode,
                    allowed=f"{SLOWEST * lowest:.3g} to {FASTEST * lowest:.3g} Hz",
                    next_step="One mode with its damping ratio is a pair in a list: [(12.5, 0.01)]",
                )
            found.append((*own, own[0], own[0]))
            continue
        k = int(mode) - 1  # type: ignore[arg-type]
        if not (0 <= k < at.frequency.shape[1] and np.isfinite(at.frequency[:, k]).all()):
            raise InputError(
                "is not a mode of this robot",
                key="modes",
                value=mode,
                allowed=f'1 to {int(np.isfinite(at.frequency).all(axis=0).sum())}, or frequencies as 12.5 or "12.5 Hz"',
            )
        f, way = at.frequency[:, k], along.frequency[:, k]
        found.append((0.5 * (f.min() + f.max()), at.ratio_of(k).mean(), way.min(), way.max()))
    if not found:
        raise InputError("names no mode", key="modes", value=modes, allowed="one at least")
    values = np.array(found)
    return values[:, 0], values[:, 1], values[:, 2:], lowest


def _delayed(motion: Motion, made: Shaper, axes: Mask, length: float) -> CsvMotion:
    """The motion's law, delayed and added up, as a table."""

    def law(t: Array) -> Law:
        parts = np.array([kinematics.coordinates(motion, t - late) for late in made.times])
        return Law(*np.einsum("i,ictx->ctx", made.amplitudes, parts))

    moving = motion.end_time - motion.hold
    inner = np.array([0.0, moving]) if isinstance(motion, CsvMotion) else kinematics.path_knots(motion, moving)
    knots = np.unique(np.add.outer(made.times, inner).round(12))
    return tabulate_law(law, knots, motion, axes, length, hold=motion.hold).motion


def _path_offset(study: Study, shaped: Study, moving: float) -> float:
    """Largest distance of the rigid tool from the unshaped path [m]; 0 where small against the way."""
    from scipy.spatial import KDTree

    def tool(of: Study, until: float, count: int) -> Array:
        return kinematics.poses(of.robot, of.motion, np.linspace(0.0, until, count)).place(of.robot.tool)

    own, new = tool(study, moving, LOOKS), tool(shaped, shaped.motion.end_time, LOOKS)
    near, found = KDTree(own).query(new)[1], np.full(len(new), np.inf)
    for begin in np.clip([near - 1, near], 0, LOOKS - 2):  # the two chords at the nearest place
        way, beside = own[begin + 1] - own[begin], new - own[begin]
        square = np.einsum("tx,tx->t", way, way)
        share = np.clip(np.einsum("tx,tx->t", way, beside) / np.where(square > 0, square, 1.0), 0.0, 1.0)
        found = np.minimum(found, np.linalg.norm(beside - share[:, None] * way, axis=1))
    most = float(found.max())
    return most if most > ON_PATH * np.linalg.norm(np.ptp(own, axis=0)) else 0.0
