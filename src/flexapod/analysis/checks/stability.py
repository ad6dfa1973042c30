"""Stability of drive loops at poses or along a motion, and fixed steps fine enough for vibration, Eq. (T8.24)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import residual_vibration
from flexapod.analysis.results.poses import coordinate_words, pose_coordinates
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.ranking import first_largest
from flexapod.model import Study
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import RobotModes, modes_of, single_pose_modes
from flexapod.solve.statics.locked_robot import LockedPoses

INSTANTS = 11


def has_drive_loops(robot: model.Robot) -> bool:
    """Test whether a robot has drive loops that can be unstable."""
    return any(leg.screw is not None and leg.screw.loops for leg in robot.legs)


def loop_remarks(path: RigidPath, elastic: ElasticRobot) -> list[str]:
    """Remark on drive loops that are unstable at instants of the motion, with the worst of them.

    Nothing where they are not, or where there are no modes.
    """
    if not has_drive_loops(path.robot):
        return []
    study = path.study
    t = np.linspace(0.0, min(study.duration, study.motion.end_time - study.motion.hold), INSTANTS)
    at_rest = RigidPath(study, t).resting()
    try:
        locked = elastic.lock(at_rest)
        rates = modes_of(locked).growth
    except FlexapodError:
        return []
    if rates is None or not rates.any():
        return []
    worst, count = first_largest(rates), int((rates > 0).sum())
    last = float(t[locked.at[worst]])
    return [remark("unstable on the way", count=count, instants=INSTANTS, worst=last, time=1 / float(rates[worst]))]


def loop_remarks_at(locked: LockedPoses) -> list[str]:
    """Remarks on loops that are unstable at the one pose of a locked robot; none where there are no modes."""
    if not has_drive_loops(locked.robot):
        return []
    try:
        rates = modes_of(locked).growth
    except FlexapodError:
        return []
    return [] if rates is None else unstable(float(rates[0]))


def unstable(rate: float) -> list[str]:
    """Remark on unstable loops whose deviations grow at a rate [1/s]; none at 0."""
    return [remark("unstable", time=1 / rate)] if rate else []


def instability_remarks(robot: model.Robot, poses: kinematics.Poses, rates: Array) -> list[str]:
    """Remark on the count of P poses with unstable loops, and on the worst; ``rates`` (P,): growth there [1/s]."""
    if not (count := int((rates > 0).sum())):
        return []
    worst = first_largest(rates)
    at = pose_coordinates(robot, poses.part(slice(worst, worst + 1)))[0]
    moved = {name: x for name, x in zip(model.AXES, at.tolist(), strict=True) if abs(x) > 1e-9}
    where = f"at {coordinate_words(moved)} from home" if moved else "at home"
    return [remark("unstable at poses", count=count, poses=rates.size, worst=where, time=1 / float(rates[worst]))]


FEWEST = 20.0  # steps a period, whose length is then 0.8 % too long, Eq. (T6.16)
DRIFT = 0.1  # periods by which a mode may come too late to the motion's end
EXCITED = 1e-3  # of the largest deviation: smaller vibrations are not looked at
PER_PERIOD, MOST = 12, 4000  # instants of the motion, of a period of the highest mode that is asked; of all


def step_warnings(study: Study, elastic: ElasticRobot, step: float, deviation: Callable[[], Array]) -> list[str]:
    """A remark where a mode that the motion leaves vibrating has too few of the fixed steps a period.

    How a mode vibrates is estimated as for `flexapod check`: it answers by itself to the inertia of the rigid path.
    What starts, loads and floors excite is not asked for. ``deviation``: of the tool, (T, 3) [m].
    """
    end = study.motion.end_time - study.motion.hold
    ends = 0 < end <= study.duration * (1 + 1e-9)  # else nothing is left of the motion, or it is not over
    if study.simulation.tolerance is not None or study.robot.platform_fixed or not ends:
        return []
    try:
        rest = RigidPath(study, np.array([end])).resting()
        modes = single_pose_modes(elastic.lock(rest, end))
    except FlexapodError:
        return []
    if modes.growth:
        return []
    frequency, amplitude, needed = _vibrations(study, modes, end)
    followed = frequency * step * needed < 1 + 1e-9
    excited = amplitude > EXCITED * np.abs(deviation()).max()
    if not (excited & ~followed).any():
        return []
    worst = int(np.where(followed, 0, amplitude).argmax())
    finest = float((1 / (frequency * needed))[excited].min())
    digit = 10.0 ** np.floor(np.log10(finest))
    return [
        remark(
            "few steps",
            amplitude=1e6 * amplitude[worst],
            frequency=frequency[worst],
            steps=1 / (frequency[worst] * step),
            needed=needed[worst],
            step=np.floor(finest / digit * (1 + 1e-9)) * digit,
        )
    ]


def _vibrations(study: Study, modes: RobotModes, end: float) -> tuple[Array, Array, Array]:
    """Frequencies [Hz], amplitudes of the tool [m] after the motion, and steps a period that they need, Eq. (T8.24)."""
    highest = modes.frequency[modes.damping_ratio < 1].max(initial=0.0)
    t = np.linspace(0.0, end, int(min(np.ceil(PER_PERIOD * highest * end), MOST)) + 2)
    path = kinematics.poses(study.robot, study.motion, t)
    found = residual_vibration(study.robot, modes, t, path, from_rest=study.initial.start != "moving")
    with np.errstate(divide="ignore"):  # of an undamped robot the ratio is 0, or rounding on either side of it
        periods = np.minimum(found.frequency * end, 1 / (2 * np.pi * np.maximum(found.damping_ratio, 0.0)))
    return found.frequency, found.amplitude, steps_needed(periods)


def steps_needed(periods: Array) -> Array:
    """Steps a period that follow a vibration over so many of its periods, Eq. (T8.24)."""
    return np.maximum(FEWEST, 2 * np.pi * np.sqrt(periods / (12 * DRIFT)))
