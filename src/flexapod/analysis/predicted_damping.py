"""Damping and static stiffness with a study's controller, by the linear model, before a simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from flexapod import model
from flexapod.analysis.controller_settings import control_remarks, sampled_controller
from flexapod.analysis.linear import linearize
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.control.frequency_response import SWINGS
from flexapod.control.state_space import StateSpace

if TYPE_CHECKING:
    from xarray import Dataset

NONE = 1e-6  # of the stiffness without a controller
MOST = 12  # modes


@dataclass(frozen=True, kw_only=True)
class PredictedDamping:
    """Frequencies [Hz] and damping ratios of k modes without the controller and with it; how many poles grow."""

    frequency: Array
    ratio: Array
    frequency_with: Array
    ratio_with: Array
    growing: int


def predicted_damping(study: model.Study) -> PredictedDamping | None:
    """Damping of the slowest modes at home, without and with the controller of the study; None without one.

    Modes faster than half the samples are left out: between samples they look slower.
    """
    sampled = sampled_controller(study)
    if sampled is None or sampled.function is not None:
        return None
    plant = linearize(study, inputs=sampled.outputs, outputs=sampled.readings)
    law = StateSpace(
        A=sampled.A, B=sampled.B, C=sampled.C, D=sampled.D, inputs=plant.outputs, outputs=sampled.outputs,
        states=tuple(f"law x{i + 1}" for i in range(len(sampled.A))), units={}, sample=sampled.period,
    )  # fmt: skip
    loop = plant.close(law, sample=sampled.period, delay=sampled.delay_samples * sampled.period)
    before, after = plant.damp(), loop.damp()
    s, z = _pole(before), _pole(after)
    first = np.flatnonzero((np.imag(s) > SWINGS * np.abs(s)) & (np.imag(s) < np.pi / sampled.period))[:MOST]
    later = np.flatnonzero(np.isfinite(z))
    away = np.abs(s[first][:, None] - z[later])
    rows, columns = linear_sum_assignment(away)
    first, later = first[rows], later[columns]
    grows = np.abs(loop.poles()) > 1 + SWINGS * sampled.period
    return PredictedDamping(
        frequency=before.frequency.values[first],
        ratio=before.damping_ratio.values[first],
        frequency_with=after.frequency.values[later],
        ratio_with=after.damping_ratio.values[later],
        growing=int(grows.sum()),
    )


def static_stiffness(study: model.Study) -> tuple[float, float] | None:
    """Stiffness of the tool at home [N/m] in the direction in which it is least, without and with the controller.

    0 where the controller leaves none, infinite where integrals hold the tool, Eq. (T26.11); None without a controller.
    """
    sampled = sampled_controller(study)
    if sampled is None or sampled.function is not None:
        return None
    names = dict.fromkeys([*sampled.readings, "tool:x", "tool:y", "tool:z"])
    plant = linearize(study, inputs=[*sampled.outputs, "wrench"], outputs=list(names))
    readings = plant.outputs[: len(sampled.readings)]
    force = [f"wrench:{axis}" for axis in ("fx", "fy", "fz")]
    at_rest = lambda inputs, outputs: plant.select(inputs, outputs).at(0.0)[:, :, 0].real  # noqa: E731
    moved, read = at_rest(force, ["tool:x", "tool:y", "tool:z"]), at_rest(force, readings)
    by_moved = at_rest(sampled.outputs, ["tool:x", "tool:y", "tool:z"])
    by_read = at_rest(sampled.outputs, readings)
    A, B, C, D = sampled.A, sampled.B, sampled.C, sampled.D
    whole = np.block([[np.eye(len(A)) - A, -B @ by_read], [-C, np.eye(len(C)) - D @ by_read]])
    given = np.vstack([B @ read, D @ read])
    size = np.maximum(np.abs(whole).max(axis=0), 1e-300)  # of states and outputs: their units are no matter
    rows = np.maximum(np.abs(whole / size).max(axis=1), 1e-300)[:, None]
    held, *_ = np.linalg.lstsq(whole / size / rows, given / rows, rcond=1e-12)
    off = 1 / np.linalg.norm(moved, 2)
    if np.linalg.norm((whole / size @ held - given) / rows) > NONE * np.linalg.norm(given / rows):
        return float(off), 0.0  # nothing can be at rest
    share = off * np.linalg.norm(moved + by_moved @ (held / size[:, None])[len(A) :], 2)
    if share < NONE:
        return float(off), np.inf
    return float(off), float(off / share) if share < 1 / NONE else 0.0


@dataclass(frozen=True, kw_only=True)
class ControlEffect:
    """Effect of a controller: number of `growing` poles, `stiffness` as `static_stiffness`; `remarks` of doubt.

    Without stiffness where poles grow or nothing is predicted.
    """

    growing: int = 0
    stiffness: tuple[float, float] | None = None
    remarks: tuple[str, ...] = ()


def control_effect(study: model.Study) -> ControlEffect | str | None:
    """Effect of a study's controller on its loop and on static stiffness, or why it is unknown.

    None without one.
    """
    sampled = sampled_controller(study)
    if sampled is None:
        return None
    remarks = control_remarks(sampled)
    try:
        predicted = predicted_damping(study)
        if predicted is not None and predicted.growing:
            return ControlEffect(growing=predicted.growing, remarks=remarks)
        return ControlEffect(stiffness=static_stiffness(study), remarks=remarks)
    except FlexapodError as error:
        return str(error)


def _pole(data: Dataset) -> NDArray[np.complex128]:
    from flexapod.control.datasets import join_complex

    return join_complex(data.pole).values
