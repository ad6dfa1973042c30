"""Check of simulation results read from a file: every variable read later is present and valid."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.leg_results import STROKES
from flexapod.analysis.results.variables import ACTUATOR_FORMS, ANGLES, VARIABLES, Variable, fixed_labels
from flexapod.common.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

_ENERGIES = (
    "energy_kinetic", "energy_potential", "energy_strain", "energy_dissipated", "work_drive", "work_external",
    "closure_residual",
)  # fmt: skip
ROBOT = (
    "com_position_rigid", "com_position", "com_deviation", "tool_position_rigid", "tool_position", "tool_deviation",
    "rotation_deviation", "platform_quaternion", "platform_quaternion_rigid", "platform_angular_velocity",
    "leg_angle", "tip_deflection", "joint_force", "deviation_by_cause", "deviation_residual", "translation_command",
    "rotation_command", *_ENERGIES,
)  # fmt: skip
"""Variables that every simulation of a robot has."""
DRIVES = ("drive_position", "drive_command", "drive_force")
"""One of these groups at least; robots whose legs have strokes have both, their older results the former."""
ACTUATOR = ("tip_deflection", "length", "angle", "tip_position", "force", "torque", *_ENERGIES)
"""Variables that every simulation of a single actuator has."""

TEXTS = ("flexapod_version", "study", "study_file", "study_hash", "warnings", "fidelity", "basis")
NUMBERS = ("modes", "step", "output_step", "steps", "newton_iterations", "wall_time", "partial")
NUMBERS_IF_THERE = (
    "tolerance", "estimated_error", "axial_modes", "time_reached", "impact_energy", "rho_inf", "compiled",
    "factorisations", "rejected_steps", "estimated_force_error",
)  # fmt: skip
TEXTS_IF_THERE = ("failure", "start", "title", "integrator")
LARGEST = 1e100
LONGEST_STUDY = 1_000_000
"""Longest text of a study that is read [characters]."""


def check_run(data: Dataset, file: str) -> None:
    """Refuse results that are not those of a simulation of a robot or of a single actuator.

    Raises
    ------
    InputError
        A variable or an attribute is missing, or has another form than results have; or a number is not finite.
    """
    is_robot = "com_deviation" in data
    if not is_robot and not ("tip_deflection" in data and "angle" in data):
        raise InputError(
            "is not a result of a simulation", file=file, allowed="results.nc of `flexapod run`, or a study file"
        )
    try:
        _check_attributes(data.attrs)
        _check_time(data)
        forms = VARIABLES if is_robot else {**VARIABLES, **ACTUATOR_FORMS}
        drives = DRIVES if "drive_position" in data and "leg_stroke" not in data else STROKES
        missing = [name for name in ((*ROBOT, *drives) if is_robot else ACTUATOR) if name not in data]
        if missing:
            raise _Wrong("is missing", missing[0])
        for name in data.data_vars:
            _check_variable(data, str(name), forms.get(str(name)))
        _check_labels(data)
        stored = data.sizes.get("shape" if is_robot else "mode", 0)
        if data.attrs["modes"] != stored:
            raise _Wrong(f"does not fit the {stored} shapes that are stored", "modes", data.attrs["modes"])
    except _Wrong as wrong:
        raise InputError(
            wrong.what,
            file=file,
            key=wrong.name,
            value=None if wrong.value is None else f"{wrong.value!s:.60}",
            allowed="results as `flexapod run` writes them",
            next_step="Compute them anew with `flexapod run FILE`",
        ) from None


class _Wrong(Exception):
    def __init__(self, what: str, name: str, value: object = None) -> None:
        super().__init__(what)
        self.what, self.name, self.value = what, name, value


def _check_attributes(attrs: Mapping[str, object]) -> None:
    for name in (*TEXTS, *NUMBERS):
        if name not in attrs:
            raise _Wrong("is missing", name)
    for name in (*TEXTS, *TEXTS_IF_THERE):
        if not isinstance(attrs.get(name, ""), str):
            raise _Wrong("is not a text", name, attrs[name])
    for name in (*NUMBERS, *NUMBERS_IF_THERE):
        value = attrs.get(name, 0)
        if not isinstance(value, Real) or not np.isfinite(float(value)):
            raise _Wrong("is not a number", name, value)
    if len(str(attrs["study"])) > LONGEST_STUDY:
        raise _Wrong(f"has more than {LONGEST_STUDY} characters", "study")


def _check_time(data: Dataset) -> None:
    if "time" not in data.coords or data.time.dims != ("time",) or data.time.dtype.kind != "f":
        raise _Wrong("is not a list of instants", "time")
    instants = data.time.values
    if not len(instants) or not np.isfinite(instants).all() or not (np.diff(instants) > 0).all():
        raise _Wrong("has instants that do not grow", "time")


def _check_variable(data: Dataset, name: str, known: Variable | None) -> None:
    values = data[name]
    if values.dtype.kind not in "biuf":
        raise _Wrong("does not hold numbers", name)
    if known is not None and values.dims != known.dims:
        dims = ", ".join(map(str, values.dims)) or "nothing"
        raise _Wrong(f"varies over {dims}, where results vary over {', '.join(known.dims)}", name)
    if known is not None and not (np.abs(values.values) < LARGEST).all():  # not true of what is not a number, too
        raise _Wrong("holds numbers that are not finite, or larger than any of a robot", name)


def _check_labels(data: Dataset) -> None:
    for dim, (labels, _) in fixed_labels({str(dim): size for dim, size in data.sizes.items()}).items():
        wanted = [str(label) for label in np.asarray(labels)]
        found = [f"{label!s:.40}" for label in data[dim].values[: max(len(wanted), len(ANGLES)) + 1]]
        if dim == "cause":
            found = found[: len(wanted)]  # further ones are the robot's
        if found != wanted and not (dim == "joint_angle" and set(found) <= set(ANGLES)):
            raise _Wrong("has other labels than results have", dim, ", ".join(found))
