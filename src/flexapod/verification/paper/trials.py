"""Numbers that a variant of the paper's robot shows: how far it deviates, and whether that can be trusted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.results.attributes import robot_study
from flexapod.analysis.simulation import simulate
from flexapod.analysis.static import modes
from flexapod.common.errors import ComputationError, InputError
from flexapod.verification.paper.claim import largest_deviation, residual_vibration

TRIAL_STEP = 5e-4  # s; peaks change by less than 1 % from 1 ms to 0.25 ms


def load_share(data: Dataset) -> float:
    """Largest thrust of a drive over the Euler load of its leg at that length."""
    robot = robot_study(data).robot
    free = data.leg_length.values - np.array([leg.cylinder.mouth for leg in robot.legs])
    shares = (data.actuator_force.values[:, i] / buckling_load(leg, free[:, i]) for i, leg in enumerate(robot.legs))
    return max(float(share.max()) for share in shares)


def _verdict(data: Dataset) -> str:
    if data.attrs["partial"]:
        return str(data.attrs["failure"])
    share = load_share(data)
    return f"collapse: a leg bears {100 * share:.0f} % of its Euler load" if share >= 1 else ""


def _spread(data: Dataset, dim: str) -> float:
    """Largest less smallest commanded length along a dimension [m], where it is largest."""
    command = data.leg_length_command
    return float((command.max(dim) - command.min(dim)).max())


def _piston(data: Dataset) -> model.Piston:
    return robot_study(data).robot.legs[0].piston


class TrialColumn(NamedTuple):
    """Column of a table of variants: unit, its value in a simulation, dimensions of a value.

    `value`: None of what is not found in a simulation.
    """

    unit: str
    value: Callable[[Dataset], Any] | None = None
    dims: tuple[str, ...] = ()


COLUMNS = {
    "verdict": TrialColumn("", _verdict),
    "piston_mass": TrialColumn("kg", lambda data: _piston(data).rhoA * _piston(data).length),
    "payload_vibration": TrialColumn("m", partial(residual_vibration, name="com_deviation")),
    "tip_vibration": TrialColumn("m", partial(residual_vibration, name="tip_deflection")),
    "lowest_frequency": TrialColumn("Hz", lambda data: float(modes(robot_study(data)).frequency[0])),
    "deviation_peak": TrialColumn("m", largest_deviation, ("axis",)),
    "home_sag": TrialColumn("m", lambda data: np.abs(data.com_deviation.values[0]), ("axis",)),
    "tip_peak": TrialColumn("m", lambda data: float(np.abs(data.tip_deflection).max())),
    "force_peak": TrialColumn("N", lambda data: float(np.abs(data.actuator_force).max())),
    "load_share": TrialColumn("1", load_share),
    "travel": TrialColumn("m", partial(_spread, dim="time")),
    "apart": TrialColumn("m", partial(_spread, dim="leg")),
    "stretch_stiffness": TrialColumn("N m-1", lambda data: _piston(data).EA / _piston(data).length),
    "sag": TrialColumn("m", dims=("axis",)),
    "miss": TrialColumn("m", dims=("time", "axis")),
    "miss_peak": TrialColumn("m", dims=("axis",)),
    "lost": TrialColumn("J"),
    "vibration": TrialColumn("m", dims=("time", "axis")),
    "longer": TrialColumn("s"),
    "deviation": TrialColumn("m", dims=("roll", "axis")),
    "off_axis": TrialColumn("m", dims=("roll",)),
    "slope": TrialColumn("rad", dims=("roll",)),
    "shortening": TrialColumn("m", dims=("roll",)),
    "leg_force": TrialColumn("N", dims=("roll",)),
    "stress": TrialColumn("Pa", dims=("roll",)),
}
"""Columns of tables of variants by name."""


def nothing(columns: Sequence[str], **sizes: int) -> dict[str, Any]:
    """NaN in each of the columns; `sizes` of dimensions beside the three axes."""
    known = {"axis": 3, **sizes}
    return {name: np.full([known[dim] for dim in COLUMNS[name].dims], np.nan) for name in columns}


def trial(study: model.Study, columns: Sequence[str], step: float | None = TRIAL_STEP) -> dict[str, Any]:
    """Columns by name of a simulation; `verdict` states why they are not to be trusted, and is empty where they are.

    Where nothing could be computed all values are NaN; without a `verdict` that says so, the error is raised.
    """
    try:
        data = simulate(study, step=step)
    except (InputError, ComputationError) as error:
        if "verdict" not in columns:
            raise
        return {**nothing(columns), "verdict": error.what.split(":")[0]}
    return trial_columns(data, columns)


def trial_columns(data: Dataset, columns: Sequence[str]) -> dict[str, Any]:
    """Columns by name of the result of a simulation; without those that are found in none."""
    return {name: value(data) for name in columns if (value := COLUMNS[name].value) is not None}
