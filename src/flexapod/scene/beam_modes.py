"""Modes of a single actuator's beam with hub and extension held, as lines to draw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import model
from flexapod.solve.actuator_modes import actuator_modes, amplitude_groups
from flexapod.solve.shapes import actuator_shapes
from flexapod.typing import Array

__all__ = ["BeamModes", "beam_modes"]


@dataclass(frozen=True, kw_only=True)
class BeamModes:
    """Modes of the beam at one free length, ascending.

    `frequency` (m,) [Hz], `damping_ratio` (m,), `kind` (m,): what moves; `shape` (m, n, 3): displacement in the axes of
    `geometry.beam_frame` at n points spread evenly from mouth to tip, its largest value 1; `twist` (m, n): turn about
    the beam, of 1 at the tip where nothing else moves; `free_length` [m].
    """

    frequency: Array
    damping_ratio: Array
    kind: tuple[str, ...]
    shape: Array
    twist: Array
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
    actuator, simulation = study.actuator, study.simulation
    found, zeta = actuator_modes(actuator, simulation), np.linspace(0.0, 1.0, points)
    eta = 1 - (1 - zeta) * actuator.free_length / actuator.length
    shapes = actuator_shapes(actuator, simulation)
    lateral = shapes.a.values(zeta)
    values = {"c": (0, shapes.axial.values(eta)), "b": (1, -lateral), "a": (2, lateral), "t": (3, eta[None])}
    moved = np.zeros((len(found.kind), points, 4))
    for name, at in amplitude_groups(shapes).items():
        k, shape = values[name]
        moved[:, :, k] = found.shapes[:, at] @ shape
    flat = moved.reshape(len(moved), -1)
    moved /= np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, None], axis=1)[:, :, None]
    return BeamModes(
        frequency=found.frequency,
        damping_ratio=found.damping_ratio,
        kind=found.kind,
        shape=moved[:, :, :3],
        twist=moved[:, :, 3],
        free_length=actuator.free_length,
    )
