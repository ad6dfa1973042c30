"""Whether fixed steps follow what a motion leaves vibrating, Eq. (T8.24)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.estimates import residual_vibration
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.quantities import number
from flexapod.model import Study
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.solve.modal.modes import RobotModes

__all__ = ["step_warnings", "steps_needed"]

FEWEST = 20.0  # steps a period, whose length is then 0.8 % too long, Eq. (T6.16)
DRIFT = 0.1  # periods by which a mode may come too late to the motion's end
EXCITED = 1e-3  # of the largest deviation: smaller vibrations are not looked at
PER_PERIOD, MOST = 12, 4000  # instants of the motion, of a period of the highest mode that is asked; of all


def step_warnings(study: Study, step: float, deviation: Callable[[], Array]) -> list[str]:
    """A remark where a mode that the motion leaves vibrating has too few of the fixed steps a period.

    How a mode vibrates is estimated as for `flexapod check`: it answers by itself to the inertia of the rigid path.
    What starts, loads and floors excite is not asked for. ``deviation``: of the tool, (T, 3) [m].
    """
    end = study.motion.end_time - study.motion.hold
    ends = 0 < end <= study.duration * (1 + 1e-9)  # else nothing is left of the motion, or it is not over
    if study.simulation.tolerance is not None or study.robot.platform_fixed or not ends:
        return []
    try:
        at = kinematics.poses(study.robot, study.motion, np.array([end]))
        rest = kinematics.Poses.at_rest(at.position, at.rotation)
        modes = robot_modes(study.robot, study.simulation, rest, study.load, end)
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
        f"the motion leaves the tool vibrating by some {number(1e6 * amplitude[worst], 2)} um at "
        f"{number(frequency[worst], 3)} Hz: {number(1 / (frequency[worst] * step), 3)} steps a period are fewer than "
        f"the {number(needed[worst], 2)} that follow it. Set simulation.tolerance = 1e-4 in place of step, or step = "
        f"{np.floor(finest / digit * (1 + 1e-9)) * digit:.1g} s"
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
