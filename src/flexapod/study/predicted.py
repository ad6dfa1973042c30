"""What a study's controller does to its damping, by the linear model: before anything is simulated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from flexapod import model
from flexapod.arrays import Array
from flexapod.control.poles import SWINGS
from flexapod.control.state_space import StateSpace
from flexapod.study.controlled import sampled_controller
from flexapod.study.linear import linearize

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Predicted", "predicted_damping"]

MOST = 12  # modes


@dataclass(frozen=True, kw_only=True)
class Predicted:
    """Frequencies [Hz] and damping ratios of k modes without the controller and with it; how many poles grow."""

    frequency: Array
    ratio: Array
    frequency_with: Array
    ratio_with: Array
    growing: int


def predicted_damping(study: model.Study) -> Predicted | None:
    """Damping of the slowest modes at home, without and with the controller of the study; None without one.

    Modes faster than half the samples are left out: between samples they look slower.
    """
    sampled = sampled_controller(study)
    if sampled is None or sampled.function is not None:
        return None
    law = StateSpace(
        A=sampled.A, B=sampled.B, C=sampled.C, D=sampled.D, inputs=sampled.readings, outputs=sampled.outputs,
        states=tuple(f"law x{i + 1}" for i in range(len(sampled.A))), units={}, sample=sampled.period,
    )  # fmt: skip
    plant = linearize(study, inputs=sampled.outputs, outputs=sampled.readings)
    loop = plant.close(law, sample=sampled.period, delay=sampled.delay_samples * sampled.period)
    before, after = plant.damp(), loop.damp()
    s, z = _pole(before), _pole(after)
    first = np.flatnonzero((np.imag(s) > SWINGS * np.abs(s)) & (np.imag(s) < np.pi / sampled.period))[:MOST]
    later = np.flatnonzero(np.isfinite(z))
    away = np.abs(s[first][:, None] - z[later])
    rows, columns = linear_sum_assignment(away)
    first, later = first[rows], later[columns]
    grows = np.abs(loop.poles()) > 1 + SWINGS * sampled.period
    return Predicted(
        frequency=before.frequency.values[first],
        ratio=before.damping_ratio.values[first],
        frequency_with=after.frequency.values[later],
        ratio_with=after.damping_ratio.values[later],
        growing=int(grows.sum()),
    )


def _pole(data: Dataset) -> NDArray[np.complex128]:
    from flexapod.control.datasets import complex_of

    return complex_of(data.pole).values
