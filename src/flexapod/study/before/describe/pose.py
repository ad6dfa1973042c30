"""Stiffness, frequencies and residual vibration of a robot at poses of its path, in numbers to print."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexapod import model, rigid
from flexapod.errors import FlexapodError
from flexapod.solve.modes import locked_poses, robot_modes, the_modes
from flexapod.solve.parts import part_stiffness
from flexapod.solve.springs import loss_frequency, springs_along, viscous
from flexapod.solve.stiffness import compliance, stiffness_of
from flexapod.study.after.kinds import mode_kinds
from flexapod.study.before.estimates import residual_vibration
from flexapod.typing import Array

__all__ = [
    "ModeLine",
    "PoseDescription",
    "StiffnessDescription",
    "VibrationToExpect",
    "describe_pose",
    "vibration_to_expect",
]

SHOWN = 6
ROUNDING = 1e-12  # of the largest compliance: below it a plane holds the platform
BAND = 1e-6  # amplitude at which the tool counts as settled [m]
HIGHEST = 2e3  # [Hz]: no motion of a machine excites a mode above
PER_PERIOD, FEWEST, MOST = 12, 2000, 100_000  # instants of the motion: of a period of the highest mode, of all


@dataclass(frozen=True, kw_only=True)
class ModeLine:
    """A mode of the locked robot: `frequency` [Hz] undamped, `damping_ratio`, `kind` in words."""

    frequency: float
    damping_ratio: float
    kind: str


@dataclass(frozen=True, kw_only=True)
class StiffnessDescription:
    """Stiffness at the tool: `least`, `most` [N/m] along, `turning_least`, `turning_most` [N m/rad] about a direction.

    Against a force alone (the platform free to turn) and a moment alone; `softest` (3,): direction of `least`, world.
    """

    least: float
    most: float
    softest: tuple[float, ...]
    turning_least: float
    turning_most: float


@dataclass(frozen=True, kw_only=True)
class PoseDescription:
    """The robot at one pose, drives locked, about its static equilibrium.

    `sag` [m] of the centre of mass, `stiffness`, `modes`: the lowest. None and empty where there is no such thing;
    `problem` then says why. `parts`: of legs with more than ideal parts, by name and leg [N/m], inf where it has none.
    `dampers`: of loss factors, by part [N s/m], at `loss_frequency` [Hz].
    """

    name: str
    time: float
    sag: float | None = None
    stiffness: StiffnessDescription | None = None
    modes: tuple[ModeLine, ...] = ()
    problem: str | None = None
    parts: Mapping[str, tuple[float, ...]] | None = None
    dampers: Mapping[str, float] | None = None
    loss_frequency: float | None = None


@dataclass(frozen=True, kw_only=True)
class VibrationToExpect:
    """Residual vibration of the tool after the motion (T8.14)-(T8.18).

    `amplitude` [m]: all modes in phase; `frequency` [Hz] and `share` of the largest; `settling` [s] until the sum is
    below `band` [m], inf without damping; `left_out` [Hz]: the lowest mode that is not in it, because the motion is too
    long to be sampled for it; None where none is.
    """

    amplitude: float
    frequency: float
    share: float
    settling: float
    band: float
    left_out: float | None


def describe_pose(study: model.Study, name: str, time: float) -> PoseDescription:
    """The robot at rest at an instant of its path."""
    robot, simulation = study.robot, study.simulation
    path = _at_rest(study, time)
    parts: dict[str, Any] = {"parts": _parts(robot, path)}
    try:
        locked = locked_poses(robot, simulation, path, study.load, time)
        if frequency := loss_frequency(robot):
            parts |= {"loss_frequency": frequency, "dampers": _dampers(robot, frequency)}
        found, stiffness = the_modes(locked), _stiffness(stiffness_of(robot, locked).total)
    except FlexapodError as error:
        return PoseDescription(name=name, time=time, problem=str(error), **parts)
    sag = found.equilibrium.state.pose[:3] - path.point(robot.com)[0][0]
    lines = zip(found.frequency, found.damping_ratio, mode_kinds(found), strict=True)
    modes = tuple(ModeLine(frequency=float(f), damping_ratio=float(ratio), kind=kind) for f, ratio, kind in lines)
    return PoseDescription(
        name=name, time=time, sag=float(np.linalg.norm(sag)), stiffness=stiffness, modes=modes[:SHOWN], **parts
    )


def _parts(robot: model.Robot, path: rigid.Poses) -> dict[str, tuple[float, ...]] | None:
    if not any(springs_along(leg) for leg in robot.legs):
        return None
    found = part_stiffness(robot, rigid.inverse_kinematics(robot, path).length[0])
    return {name: tuple(values.tolist()) for name, values in found.items()}


def _dampers(robot: model.Robot, frequency: float) -> dict[str, float]:
    """Dampers that stand for loss factors, at home [N s/m], by part; of the first leg that has it."""
    found: dict[str, float] = {}
    for leg, length in zip(robot.legs, robot.home_lengths, strict=True):
        for spring in springs_along(leg):
            if spring.loss:
                found.setdefault(spring.name, viscous(spring, 1 / float(spring.at_length(length)), frequency))
    return found


def _stiffness(total: Array) -> StiffnessDescription:
    give = compliance(total)[0]
    shift, vectors = np.linalg.eigh(give[:3, :3])
    turning = np.linalg.eigvalsh(give[3:, 3:])
    most, turning_most = (values[values > ROUNDING * values[-1]][0] for values in (shift, turning))  # others are held
    softest = vectors[:, -1] * np.sign(vectors[np.abs(vectors[:, -1]).argmax(), -1])
    return StiffnessDescription(
        least=float(1 / shift[-1]),
        most=float(1 / most),
        softest=tuple(softest.tolist()),
        turning_least=float(1 / turning[-1]),
        turning_most=float(1 / turning_most),
    )


def _at_rest(study: model.Study, time: float) -> rigid.Poses:
    moving = rigid.poses(study.robot, study.motion, np.array([time]))
    return rigid.Poses.at_rest(moving.position, moving.rotation)


def vibration_to_expect(study: model.Study, end: float) -> VibrationToExpect | None:
    """Residual vibration after the motion that ends at `end` [s]; None where nothing can vibrate."""
    robot = study.robot
    try:
        modes = robot_modes(robot, study.simulation, _at_rest(study, end), study.load, end)
    except FlexapodError:
        return None
    wanted = modes.frequency[(modes.frequency > 0) & (modes.frequency <= HIGHEST) & (modes.damping_ratio < 1)]
    count = int(np.clip(np.ceil(PER_PERIOD * wanted.max(initial=0.0) * end), FEWEST, MOST))
    t = np.linspace(0.0, end, count + 1)
    path = rigid.poses(robot, study.motion, t)
    found = residual_vibration(robot, modes, t, path, BAND, from_rest=study.initial.start != "moving")
    if not found.frequency.size:
        return None
    largest = int(found.amplitude.argmax())
    return VibrationToExpect(
        amplitude=found.total,
        frequency=float(found.frequency[largest]),
        share=float(found.amplitude[largest] / found.total) if found.total > 0 else 0.0,
        settling=found.time_to_band(),
        band=BAND,
        left_out=min(set(wanted.tolist()) - set(found.frequency.tolist()), default=None),
    )
