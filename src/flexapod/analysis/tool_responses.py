"""Compliance and transmissibility of a study about rest, over frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.analysis.linear import Friction, linearize, model_of, plant_of, study_about_rest
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RobotLike
from flexapod.common.arguments import flag, frequencies
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_kind
from flexapod.common.resources import one_thread
from flexapod.control.state_space import StateSpace
from flexapod.kinematics.rotations import carried_twists, matrix
from flexapod.solve.linear.channels import plant_channels
from flexapod.solve.linear.plant import Drives
from flexapod.solve.linear.states import states_of

if TYPE_CHECKING:
    from xarray import Dataset


@one_thread()
def compliance(
    study: RobotLike,
    hz: ArrayLike,
    pose: PoseLike = None,
    *,
    drives: Drives = "given",
    friction: Friction | None = None,
    load: LoadLike = None,
) -> Dataset:
    """Motion of the tool by a wrench at the tool over frequency, along and about world axes.

    Parameters
    ----------
    study, pose, drives, friction, load
        As for `linearize`.
    hz : array_like, shape (f,)
        Frequencies; 0 is allowed.

    Returns
    -------
    xarray.Dataset
        `compliance` (output, input, frequency, part) [m/N, rad/N, m/(N m), rad/(N m)] and `compliance_norm`
        (frequency), its Frobenius norm with the SI units of all entries taken as one.

    Raises
    ------
    InputError, ComputationError
        As `linearize`.

    Examples
    --------
    >>> data = fx.compliance(fx.preset("machine-hexapod"), [0, 20, 60])  # Hz
    >>> up = data.compliance.sel(output="tool:z", input="wrench:fz", part="real")
    >>> print((1e9 * up).round(2).values)  # um/kN
    [3.96 4.03 4.7 ]
    """
    hz = frequencies(hz)
    found = linearize(study, pose, inputs="wrench", outputs="tool", drives=drives, friction=friction, load=load)
    return _matrix("compliance", found, found.at(hz), hz, "motion of the tool by a wrench at the tool")


@one_thread()
def transmissibility(
    study: RobotLike,
    hz: ArrayLike,
    pose: PoseLike = None,
    *,
    at: str = "tool",
    tilt: bool = False,
    drives: Drives = "given",
    friction: Friction | None = None,
    load: LoadLike = None,
) -> Dataset:
    """Motion of the platform by the motion of the floor over frequency, both at one point, Eq. (T20.24).

    A floor that is displaced along, and turned about, world axes through the point of the platform; at 0 Hz it is 1.

    Parameters
    ----------
    study, pose, drives, friction, load
        As for `linearize`.
    hz : array_like, shape (f,)
        Frequencies; 0 is allowed without `tilt`.
    at : str
        A point, as of `linearize`.
    tilt : bool
        Whether gravity pulls aside as the floor tilts; then slow turns show the sag of a robot on a slope.

    Returns
    -------
    xarray.Dataset
        `transmissibility` (output, input, frequency, part) and `transmissibility_norm` (frequency), its Frobenius norm
        with the SI units of all entries taken as one.

    Raises
    ------
    InputError, ComputationError
        As `linearize`.

    Examples
    --------
    >>> data = fx.transmissibility(fx.preset("machine-hexapod"), [0, 20, 1000])  # Hz
    >>> print(data.transmissibility.sel(output="tool:z", input="floor:z", part="real").round(2).values)
    [1.   1.02 0.02]
    """
    flag(tilt, "tilt")
    check_kind(at, str, "at", "the name of a point")
    hz, found = frequencies(hz), study_about_rest(study, load, drives, friction)
    if found.robot.plane is not None:
        raise InputError(
            "is of a robot whose floor cannot turn", key="robot.plane", value=found.robot.plane,
            allowed="robots in space",
            next_step='fx.linearize(..., inputs="floor", outputs="tool") has the floor\'s translations',
        )  # fmt: skip
    inputs, outputs = plant_channels("floor", found.robot, "inputs"), plant_channels("tool", found.robot, "outputs")
    (point, *_) = plant_channels(f"accelerometer:{at}", found.robot, "at")
    plant = plant_of(found, pose, drives)
    R = matrix(plant.x.pose[:, 3:])[0]
    arm = R @ (point.at if point.at is not None else np.zeros(3))
    states = states_of(plant, inputs, outputs, tilt=tilt, about=plant.x.pose[0, :3] + arm)
    whole = model_of(found, plant, states)
    carry = carried_twists(arm - R @ (plant.robot.tool - plant.robot.com))  # a turn about the tool displaces the point
    values = np.eye(6)[:, :, None] + (2j * np.pi * hz) ** 2 * np.einsum("ij,jkf->ikf", carry, whole.at(hz))
    return _matrix("transmissibility", whole, values, hz, f"motion of the platform by that of the floor, at {at}")


def _matrix(name: str, found: StateSpace, values: NDArray[np.complex128], hz: Array, words: str) -> Dataset:
    from flexapod.control.datasets import response_dataset

    unit = "output_units / input_units" if name == "compliance" else "1"
    said = {"units": "1", "long_name": "Frobenius norm, SI units of all entries taken as one"}
    norm = np.sqrt((np.abs(values) ** 2).sum(axis=(0, 1)))
    data = response_dataset(found, hz, values, (name, words, unit))
    return data.assign({f"{name}_norm": ("frequency", norm, said)})
