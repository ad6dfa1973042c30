"""Modes of a single actuator's beam with hub and extension held, as lines to draw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import model
from flexapod.scene.robot import lateral_values
from flexapod.solve.actuator_modes import actuator_modes
from flexapod.typing import Array

__all__ = ["BeamModes", "beam_modes"]


@dataclass(frozen=True, kw_only=True)
class BeamModes:
    """Modes of the beam at one free length, ascending.

    `frequency` (k,) [Hz], `damping_ratio` (k,); `shape` (k, n): displacement across the straight beam at n points
    spread evenly from mouth to tip, its largest value 1; `free_length` [m].
    """

    frequency: Array
    damping_ratio: Array
    shape: Array
    free_length: float


def beam_modes(study: model.ActuatorStudy, points: int) -> BeamModes:
    """Modes of a study's beam at its free length, about the straight beam at rest, drawn with a number of points.

    Raises
    ------
    InputError
        A rigid beam.
    ComputationError
        The straight beam has buckled under its own load.
    """
    found = actuator_modes(study.actuator, study.simulation)
    shape = found.shapes @ lateral_values(study, np.linspace(0.0, 1.0, points))
    largest = np.take_along_axis(shape, np.abs(shape).argmax(axis=1)[:, None], axis=1)
    return BeamModes(
        frequency=found.frequency,
        damping_ratio=found.damping_ratio,
        shape=shape / largest,
        free_length=study.actuator.free_length,
    )
