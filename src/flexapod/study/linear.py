"""A study about rest as a linear system with named channels; compliance and transmissibility; many poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod import model
from flexapod.arrays import Array
from flexapod.control.state_space import StateSpace
from flexapod.errors import InputError
from flexapod.kinematics.rotations import matrix
from flexapod.results.arguments import LoadLike, PoseLike, RobotLike, as_pose, at_pose
from flexapod.results.poses import coordinates_of
from flexapod.runtime.threads import one_thread
from flexapod.solve.linear.channels import asked
from flexapod.solve.linear.plant import Drives, Plant, plant_at
from flexapod.solve.linear.states import Descriptor, descriptor_of, states_of
from flexapod.solve.statics.locked import the_equilibrium

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["LinearModel", "compliance", "linearize", "transmissibility"]

Friction = Literal["sliding", "stuck"]


@dataclass(frozen=True, kw_only=True)
class LinearModel(StateSpace):
    """A robot about its equilibrium at a pose, as `linearize` gives it.

    Attributes
    ----------
    study : str
        Its name.
    pose : mapping
        Surge, sway, heave [m], roll, pitch, yaw [rad] of the platform from home, before it sags.
    drives : {"given", "force"}
    friction : {"sliding", "stuck"}
    position, quaternion : ndarray, shapes (3,), (4,)
        Of the payload's centre of mass [m] and its attitude, at the equilibrium.
    """

    study: str
    pose: Mapping[str, float]
    drives: Drives
    friction: Friction
    position: Array
    quaternion: Array
    plant: Plant

    def descriptor(self) -> Descriptor:
        """M, D, K, G, B, C in the flat coordinates of the equations, with names, Eq. (T20.1)."""
        robot = self.plant.robot
        return descriptor_of(self.plant, asked(self.inputs, robot, "inputs"), asked(self.outputs, robot, "outputs"))


@one_thread()
def linearize(
    study: RobotLike,
    pose: PoseLike = None,
    *,
    inputs: str | Sequence[str],
    outputs: str | Sequence[str],
    drives: Drives = "given",
    friction: Friction | None = None,
    load: LoadLike = None,
) -> LinearModel:
    """A robot about its equilibrium under gravity and load as a linear system with named channels, Eq. (T20.1).

    Closures are eliminated, so that states are motions by name ("payload x", "leg 3 a2", turns of the payload about
    platform axes) and their rates; they are chosen at home, and mean the same at every pose. What has no mass is
    condensed with the damper that it may have; loops that sum or lag are states. Unstable loops are no error.

    Parameters
    ----------
    study : Study, Robot or path
    pose : pose, optional
        As for `modes`; default home.
    inputs : str or sequence of str
        ``wrench`` [N, N m] at the tool along world axes; ``drive`` [N, of cranks N m], force of each drive;
        ``command`` [m/s^2, rad/s^2], second derivative of what each drive is told: place and rate are states;
        ``floor`` [m/s^2, rad/s^2], acceleration and angular acceleration of the base about the point at which
        `base_motion` of the study turns it, else the origin; ``force:POINT`` [N] along world axes. Single channels:
        ``wrench:fx``, ``drive:3``, ``floor:rz``, ``force:tool:x``.
    outputs : str or sequence of str
        ``tool`` [m, rad] and ``com`` [m] against the floor, along and about world axes; ``stroke`` [m, rad] of what a
        drive moves; ``drive-force`` [N, N m] on that, behind a rotor's inertia and before the mass that it moves;
        ``joint-force`` [N] of each leg on the platform, world axes; ``force-sensor:base``, ``:drive``, ``:platform``
        [N] along the leg, pressing is positive: between the base and all masses of the leg, at the drive, between all
        masses of the leg and the platform; ``encoder`` [m, rad], what a drive measures; ``accelerometer:POINT``
        [m/s^2], absolute acceleration less gravity along axes that turn with the platform; ``geophone:POINT`` [m/s]
        or ``geophone:POINT[4.5 Hz, 0.7, 28.8]`` [V] by its corner, damping ratio and sensitivity.
        POINT: ``tool``, ``com``, ``platform``, ``joint-3``, or a place in platform axes as ``(0.1, 0, 0.05)`` [m].
    drives : {"given", "force"}
        "force" releases the drives at the equilibrium that they hold, with the force that holds them: neither springs
        nor loops of theirs are left. Pure force drives are linearised so.
    friction : {"sliding", "stuck"}, optional
        In place of the study's.
    load : Load, wrench or array_like (6,), optional
        As for `modes`.

    Returns
    -------
    LinearModel
        A `control.StateSpace` that knows its pose.

    Raises
    ------
    InputError
        Unknown channels, a pose out of reach, nothing that can move, pure force drives that are not released.
    ComputationError
        No equilibrium at this pose, or one so far from home that the motions chosen there say nothing of it.
    """
    found, plant = _plant(study, pose, load, drives, friction)
    robot = plant.robot
    states = states_of(plant, asked(inputs, robot, "inputs"), asked(outputs, robot, "outputs"), about=_about(found))
    return _model(found, plant, **{f.name: getattr(states, f.name) for f in fields(states)})


def _plant(
    study: RobotLike, pose: PoseLike, load: LoadLike, drives: Drives, friction: Friction | None
) -> tuple[model.Study, Plant]:
    """The plant at one pose."""
    if drives not in ("given", "force"):
        raise InputError("is not a way to take drives", key="drives", value=drives, allowed='"given", "force"')
    found = model.override(at_pose(study, load), friction=friction)
    path = as_pose(found.robot, pose)
    try:
        plant = plant_at(found.robot, found.simulation, path, found.load, drives)
    except InputError as error:
        if error.key != "leg.drive" or "pure force" not in error.what:
            raise
        raise InputError(
            error.what, key=error.key, value=error.value, allowed=error.allowed,
            next_step='linearize(..., drives="force") releases the drives where they are',
        ) from None  # fmt: skip
    the_equilibrium(plant.locked)
    return found, plant


def _about(study: model.Study) -> Array:
    """Point about which a floor turns."""
    return np.zeros(3) if study.robot.base_motion is None else np.asarray(study.robot.base_motion.at)


def _name(study: model.Study) -> str:
    return study.robot.type if study.path is None else Path(study.path).stem


def _model(study: model.Study, plant: Plant, **matrices: object) -> LinearModel:
    pose = coordinates_of(study.robot, plant.locked.path)[0]
    return LinearModel(
        **matrices,  # type: ignore[arg-type]
        study=_name(study), pose=dict(zip(model.AXES, pose.tolist(), strict=True)), drives=plant.drives,
        friction=plant.locked.simulation.friction, position=plant.x.pose[0, :3], quaternion=plant.x.pose[0, 3:],
        plant=plant,
    )  # fmt: skip


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
    """
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
    """
    found, plant = _plant(study, pose, load, drives, friction)
    inputs, outputs = asked("floor", plant.robot, "inputs"), asked("tool", plant.robot, "outputs")
    (point, *_) = asked(f"accelerometer:{at}", plant.robot, "outputs")
    R = matrix(plant.x.pose[:, 3:])[0]
    arm = R @ (point.at if point.at is not None else np.zeros(3))
    states = states_of(plant, inputs, outputs, tilt=tilt, about=plant.x.pose[0, :3] + arm)
    whole = _model(found, plant, **{f.name: getattr(states, f.name) for f in fields(states)})
    away = arm - R @ (plant.robot.tool - plant.robot.com)
    carry = np.eye(6)
    carry[:3, 3:] = np.cross(np.eye(3), away).T  # a turn about the tool displaces the point
    s = 2j * np.pi * np.atleast_1d(np.asarray(hz, dtype=float))
    values = np.eye(6)[:, :, None] + s**2 * np.einsum("ij,jkf->ikf", carry, whole.at(hz))
    return _matrix("transmissibility", whole, values, hz, f"motion of the platform by that of the floor, at {at}")


def _matrix(name: str, found: StateSpace, values: NDArray[np.complex128], hz: ArrayLike, words: str) -> Dataset:
    import xarray as xr

    from flexapod.control.datasets import PARTS, channel_labels, in_parts

    frequency = np.atleast_1d(np.asarray(hz, dtype=float))
    norm = np.sqrt((np.abs(values) ** 2).sum(axis=(0, 1)))
    said = "Frobenius norm, SI units of all entries taken as one"
    units = "output_units / input_units" if name == "compliance" else "1"
    return xr.Dataset(
        {
            name: (("output", "input", "frequency", "part"), in_parts(values), {"units": units, "long_name": words}),
            f"{name}_norm": ("frequency", norm, {"units": "1", "long_name": said}),
        },
        channel_labels(found, "output", "input")
        | {"frequency": ("frequency", frequency, {"units": "Hz"}), "part": ("part", PARTS)},
    )
