"""Studies, robots and poses from the arguments of a Python call."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics, model
from flexapod.common.arrays import floats
from flexapod.common.errors import InputError, suggest_word
from flexapod.common.units import quantities, quantity

POSE_KEYS = model.AXES
FileLike = str | Path
RobotLike = model.Study | model.Robot | FileLike
StartLike = model.Initial | str | None
PoseLike = kinematics.Poses | Mapping[str, float | str] | str | ArrayLike | None
LoadLike = model.Load | model.Wrench | ArrayLike | None

T = TypeVar("T")


def read_subject(subject: T | FileLike) -> T | model.Study | model.ActuatorStudy:
    """The study in a file, where `subject` is its path; anything else as it is."""
    return model.load(subject) if isinstance(subject, str | Path) else subject


def as_study(
    subject: RobotLike,
    motion: model.Motion | None = None,
    load: LoadLike = None,
    initial: StartLike = None,
) -> model.Study:
    """A study from a study, its file, or a robot and a motion, with another motion, load or start where given.

    Raises
    ------
    InputError
        A robot without a motion, or something that is neither robot nor study.
    """
    found = read_subject(subject)
    changes: dict[str, object] = {}
    if load is not None:
        changes["load"] = _load(load)
    if initial is not None:
        changes["initial"] = model.Initial(start=initial) if isinstance(initial, str) else initial  # type: ignore[arg-type]
    if isinstance(found, model.Study):
        changes |= {} if motion is None else {"motion": motion}
        return found.replace(**changes) if changes else found
    if not isinstance(found, model.Robot):
        raise InputError(
            "is neither a robot nor the study of one",
            key="robot",
            value=type(found).__name__,
            allowed="flexapod.load(FILE), its .robot, or FILE itself",
        )
    if motion is None:
        raise InputError("is missing", key="motion", next_step="Give a motion, e.g. study.motion, or a whole study")
    return model.Study(robot=found, motion=motion, **changes)  # type: ignore[arg-type]


def _load(load: LoadLike) -> model.Load:
    if isinstance(load, model.Load):
        return load
    kinds = (model.ConstantWrench, model.SineWrench, model.StepWrench, model.CsvWrench)
    if isinstance(load, kinds):
        return model.Load(wrench=load)
    if isinstance(load, list | tuple):
        kind = ("force", "torque")
        load = [quantities(value, kind[k // 3 % 2], key="load") for k, value in enumerate(load)]
    try:
        return model.Load(wrench=model.ConstantWrench(value=load))  # type: ignore[arg-type]
    except InputError as error:
        words = "Fx Fy Fz [N], Mx My Mz [N m], or a law"
        raise InputError(error.what, key="load", value=error.value, allowed=words) from None


def study_at_pose(subject: RobotLike, load: LoadLike = None) -> model.Study:
    """A study for calls that look at one pose: a bare robot is given a motion that stays at home."""
    still = (
        None if not isinstance(subject, model.Robot) else model.AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    )
    return as_study(subject, still, load)


def as_pose(robot: model.Robot, pose: PoseLike, *, check: bool = True) -> kinematics.Poses:
    """One pose of the platform frame at rest.

    Parameters
    ----------
    robot : model.Robot
    pose : Poses, mapping, array_like or None
        Poses with one sample; surge, sway, heave [m], roll, pitch, yaw [rad] from home by name, as (6,) or in words,
        ``"roll=10deg, heave=5mm"``; None: home.
    check : bool
        Whether the legs must reach it.

    Raises
    ------
    InputError
        Unknown names, another shape, or a pose that the legs cannot reach.
    """
    if isinstance(pose, str):
        pose = pose_from_text(pose)
    if isinstance(pose, kinematics.Poses):
        if len(pose) != 1:
            raise InputError("has several samples", key="pose", value=len(pose), allowed="one sample")
        found = kinematics.Poses.at_rest(pose.position, pose.rotation)
    else:
        values = _coordinates(pose)
        named = np.isin(POSE_KEYS, list(pose)) if isinstance(pose, Mapping) else None
        found = kinematics.poses_from_home(robot, values[None], named)
    if check:
        _check_reachable(kinematics.RigidPoses(robot, found))
    return found


class RigidPose(kinematics.RigidPoses):
    """A rigid robot at one pose, at rest, that its legs reach; parameters and refusals as of `as_pose`."""

    def __init__(self, robot: model.Robot, pose: PoseLike) -> None:
        super().__init__(robot, as_pose(robot, pose, check=False))
        _check_reachable(self)


def pose_from_text(text: str, key: str = "pose") -> dict[str, float] | None:
    """Surge, sway, heave [m], roll, pitch, yaw [rad] from ``"roll=20deg,heave=10mm"``; None, which is home, of nothing.

    Raises
    ------
    InputError
        Unknown axes, one that is given twice, something that is not a number with a unit of the right kind.
    """
    if not text.strip():
        return None
    pose: dict[str, float] = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or name not in POSE_KEYS or name in pose:
            what = "is given twice" if name in pose else "is not an axis with its value"
            hint = suggest_word(name, POSE_KEYS) or f'Write {key} "roll=20deg,heave=10mm"'
            raise InputError(what, key=key, value=part.strip(), allowed=", ".join(POSE_KEYS), next_step=hint)
        pose[name] = coordinate(name, value, f"{key} {name}")
    return pose


def coordinate(name: str, value: object, key: str) -> float:
    """A coordinate of a pose [m, rad]: a number, or text with a unit."""
    return quantity(value, "length" if name in POSE_KEYS[:3] else "angle", key=key)


def pose_numbers(pose: Any) -> Any:
    """A pose, or several, by name or in a row, with numbers in place of texts."""
    if isinstance(pose, Mapping):
        return {name: _of_axis(name, value) for name, value in pose.items()}
    if isinstance(pose, list | tuple) and len(pose) == len(POSE_KEYS):
        return [_of_axis(name, value) for name, value in zip(POSE_KEYS, pose, strict=True)]
    return pose


def _of_axis(name: str, value: object) -> object:
    """One or several values of a coordinate, with numbers in place of texts."""
    return quantities(value, "length" if name in POSE_KEYS[:3] else "angle", key=f"pose.{name}")


def _coordinates(pose: Mapping[str, float | str] | ArrayLike | None) -> np.ndarray:
    if pose is None:
        return np.zeros(6)
    if isinstance(pose, Mapping):
        unknown = [name for name in pose if name not in POSE_KEYS]
        if unknown:
            raise InputError("is not an axis", key=f"pose.{unknown[0]}", allowed=", ".join(POSE_KEYS))
    pose = pose_numbers(pose)
    if isinstance(pose, Mapping):
        pose = [pose.get(name, 0.0) for name in POSE_KEYS]
    try:
        values = floats(pose)
    except ValueError:
        values = np.full(0, np.nan)
    if values.shape != (6,) or not np.isfinite(values).all():
        raise InputError(
            "is not a pose", key="pose", value=pose,
            allowed="surge, sway, heave [m], roll, pitch, yaw [rad] from home, as names or six numbers",
        )  # fmt: skip
    return values


def _check_reachable(at: kinematics.RigidPoses) -> None:
    robot, found, now = at.robot, at.reach, np.zeros(1)
    if found.lost.any():
        raise InputError(
            kinematics.lost_words(kinematics.rigid_limbs(robot), found.gap[0]),
            key="pose",
            allowed="poses that all legs reach",
        )
    excess = [
        e
        for e in (*kinematics.strokes(robot, now, found.length), *kinematics.pull_out(robot, now, found.length))
        if e.fatal
    ]
    excess += kinematics.carriages(robot, now, found.carriage)
    if excess:
        e = excess[0]
        raise InputError(
            f"leg {e.leg} {e.kind}: {e.value:.6g} m, limit {e.limit:.6g} m",
            key="pose",
            allowed="poses within the strokes",
            next_step="Choose another pose, or widen leg.stroke",
        )
    at.refuse_folded()
