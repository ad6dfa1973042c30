"""A study about rest as a linear system with named channels; many poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from flexapod import model
from flexapod.analysis.checks.reachability import CUT_OFF, FALLS_THROUGH, REACHED, equilibrium_codes, flags, rigid_codes
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RigidPose, RobotLike, read_subject, study_at_pose
from flexapod.analysis.results.poses import BATCH, as_poses, has_many_poses, pose_coordinates
from flexapod.common.arguments import number
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.common.units import DIMENSIONS, quantity
from flexapod.control.state_space import StateSpace
from flexapod.kinematics import RigidPoses
from flexapod.kinematics.rotations import blocks
from flexapod.solve.linear.actuator import ActuatorPlant, actuator_states
from flexapod.solve.linear.channels import plant_channels
from flexapod.solve.linear.plant import Drives, Plant, plant_at
from flexapod.solve.linear.states import Descriptor, States, descriptor_of, grid_of, states_of, units_of
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.statics.assembly_mode import assembly_changes
from flexapod.solve.statics.locked_robot import single_equilibrium

if TYPE_CHECKING:
    from xarray import Dataset


Friction = Literal["sliding", "stuck"]


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
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
    about : ndarray, shape (3,)
        Point about which the floor turns [m].
    plant : Plant
        The robot that it is of, in arrays.
    """

    study: str
    pose: Mapping[str, float]
    drives: Drives
    friction: Friction
    position: Array
    quaternion: Array
    about: Array
    plant: Plant

    def __repr__(self) -> str:
        """Study, size, drives and friction of the model."""
        return f"LinearModel({self.study}: {self._summary()}; drives {self.drives}, friction {self.friction})"

    def descriptor(self) -> Descriptor:
        """M, D, K, G, B, C in the flat coordinates of the equations, with names, Eq. (T20.1)."""
        robot = self.plant.robot
        inputs, outputs = plant_channels(self.inputs, robot, "inputs"), plant_channels(self.outputs, robot, "outputs")
        return descriptor_of(self.plant, inputs, outputs, self.about)


@one_thread()
def linearize(
    study: RobotLike | model.ActuatorStudy,
    pose: PoseLike = None,
    *,
    inputs: str | Sequence[str],
    outputs: str | Sequence[str],
    drives: Drives = "given",
    friction: Friction | None = None,
    load: LoadLike = None,
) -> LinearModel:
    """A robot about its equilibrium under gravity and load as a linear system with named channels, Eq. (T20.1).

    Closures are eliminated: states are motions by name ("payload x", "leg 3 a2", turns of the payload about platform
    axes) and their rates, chosen at home, the same at every pose. What has no mass is condensed with its damper; loops
    that sum or lag are states; unstable ones are no error. `docs/linear-model.md` says what each channel is.

    Parameters
    ----------
    study : Study, Robot, ActuatorStudy or path
        A single actuator stands as at t = 0; with pose {"rate": 20.0} [rad/s] its hub turns steadily.
    pose : pose, optional
        As for `modes`; default home. Many poses at once: names with arrays, or (P, 6).
    inputs : str or sequence of str
        ``wrench`` [N, N m] at the tool, ``drive`` [N, N m], ``command`` [m/s^2, rad/s^2], second derivative of what a
        drive is told, ``floor`` [m/s^2, rad/s^2] about the point of `base_motion` or the origin, ``force:POINT`` [N].
    outputs : str or sequence of str
        ``tool`` [m, rad], ``com`` [m], from a base plate ``tool-base``, ``com-base``; ``stroke``, ``encoder``;
        ``drive-force``, ``joint-force``, ``force-sensor:base``, ``:drive``, ``:platform`` [N]; ``accelerometer:POINT``
        [m/s^2], ``geophone:POINT`` [m/s]. POINT: ``tool``, ``com``, ``platform``, ``joint-3``, or in platform axes
        ``(0.1, 0, 0.05)`` [m]. Single channels: ``wrench:fx``, ``drive:3``, ``tool:rz``, ``force:tool:x``.
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
        A `control.StateSpace` that knows its pose; of an actuator a `StateSpace`. Of many poses a Dataset for
        interpolation: `mass`, `damping`, `stiffness` (pose, motion, motion_by), `input_matrix` (pose, motion, input),
        `output_matrix` (pose, output, motion) of M z'' + D z' + K z = B u, y = C z; NaN, with a `reason`, of some.

    Raises
    ------
    InputError
        Unknown channels, a pose out of reach, nothing that can move, pure force drives that are not released.
    ComputationError
        No equilibrium at this pose, or one so far from home that the motions chosen there say nothing of it.

    Examples
    --------
    >>> plant = fx.linearize(fx.preset("nano-hexapod"), inputs="wrench", outputs=["tool", "force-sensor:base"])
    >>> plant
    LinearModel(nano-hexapod: 180 states, inputs 6 (wrench), outputs 12 (tool, force-sensor:base); ...)
    >>> print(plant.damp().frequency.values[:3].round(1))  # Hz
    [232.1 232.1 268.7]
    """
    if isinstance(study := read_subject(study), model.ActuatorStudy):
        return cast("LinearModel", _of_actuator(study, pose, inputs, outputs, drives, friction=friction, load=load))
    if has_many_poses(pose):
        return cast("LinearModel", _grid(study, pose, inputs, outputs, drives, friction, load))
    found = study_about_rest(study, load, drives, friction)
    given, seen = plant_channels(inputs, found.robot, "inputs"), plant_channels(outputs, found.robot, "outputs")
    plant = plant_of(found, pose, drives)
    return model_of(found, plant, states_of(plant, given, seen, about=_about(found)))


def study_about_rest(study: RobotLike, load: LoadLike, drives: Drives, friction: Friction | None) -> model.Study:
    """The study with the arguments of a call in place of its own values."""
    _check_drives(drives)
    return model.override(study_at_pose(study, load), friction=friction)


def plant_of(study: model.Study, pose: PoseLike, drives: Drives) -> Plant:
    """The plant at one pose; raises as `linearize`."""
    elastic, at = ElasticRobot(study.robot, study.simulation, study.load), RigidPose(study.robot, pose)
    plant = plant_at(elastic, at, drives)
    single_equilibrium(plant.locked)
    return plant


def _check_drives(drives: object) -> None:
    if not isinstance(drives, str) or drives not in ("given", "force"):
        raise InputError("is not a way to take drives", key="drives", value=drives, allowed='"given", "force"')


def _of_actuator(
    study: model.ActuatorStudy,
    pose: PoseLike,
    inputs: str | Sequence[str],
    outputs: str | Sequence[str],
    drives: Drives,
    **none: object,
) -> StateSpace:
    """A single actuator at rest, or in steady rotation."""
    _check_drives(drives)
    for key, value in none.items():
        if value is not None:
            raise InputError("is for robots", key=key, value=value, allowed="none of a single actuator")
    given = dict(pose) if isinstance(pose, Mapping) else {}
    if (pose is not None and not isinstance(pose, Mapping)) or set(given) - {"rate", "free_length"}:
        raise InputError(
            "is no place of a single actuator", key="pose", value=pose,
            allowed='{"rate": 20.0}, rate of its hub [rad/s], and "free_length" [m]',
        )  # fmt: skip
    actuator = study.actuator
    if "free_length" in given:
        actuator = actuator.replace(free_length=quantity(given["free_length"], "length", key="pose.free_length"))
    names = ("rotation", "extension", "elevation")
    free = [name for name in names if drives == "force" or getattr(study.motion, name) is None]
    most = DIMENSIONS["angular rate"].most
    rate = number(given.get("rate", 0.0), "pose.rate", "angular rate", least=-most, most=most)
    plant = ActuatorPlant(actuator, study.simulation, rate)
    return StateSpace(**vars(actuator_states(plant, inputs, outputs, free=free)))


def _grid(
    study: RobotLike,
    pose: PoseLike,
    inputs: str | Sequence[str],
    outputs: str | Sequence[str],
    drives: Drives,
    friction: Friction | None,
    load: LoadLike,
) -> Dataset:
    """Matrices on motions at many poses."""
    from flexapod.common.datasets import build_dataset

    found = study_about_rest(study, load, drives, friction)
    path = as_poses(found.robot, pose)
    given, seen = plant_channels(inputs, found.robot, "inputs"), plant_channels(outputs, found.robot, "outputs")
    parts: dict[str, Array] = {}
    rigid = RigidPoses(found.robot, path)
    motions, free, reason = (), 0, rigid_codes(rigid, from_home=True)
    reason[reason == CUT_OFF] = REACHED
    within = np.flatnonzero(reason == REACHED)
    elastic = ElasticRobot(found.robot, found.simulation, found.load)
    for part in blocks(len(within), BATCH):
        chosen = within[part]
        some = rigid.resting(chosen)
        plant = plant_at(elastic, some, drives)
        locked = plant.locked
        grid = grid_of(plant, given, seen, about=_about(found))
        motions, free, at = grid.motions, grid.free, chosen[locked.at]
        fell = assembly_changes(
            locked.system, locked.robot, locked.start[locked.at], locked.equilibria.states[locked.at]
        )
        reason[chosen] = equilibrium_codes(locked.equilibria.code)
        reason[at[fell]] = FALLS_THROUGH
        for name, (of, _, _) in MATRICES.items():
            value = getattr(grid, of)
            parts.setdefault(name, np.full((len(path), *value.shape[1:]), np.nan))
            parts[name][at[~fell]] = value[~fell]
    units = units_of(found.robot, [*given, *seen])
    labels: dict[str, Any] = {"pose": np.arange(len(path)), "coordinate": list(model.AXES), "motion": list(motions)}
    labels |= {"motion_by": list(motions), "input": [c.name for c in given], "output": [c.name for c in seen]}
    for name, channels in (("input", given), ("output", seen)):
        labels[f"{name}_units"] = (name, [units[c.name] for c in channels])
    return build_dataset(
        {name: (MATRICES[name][1], value, {"long_name": MATRICES[name][2]}) for name, value in parts.items()}
        | {"pose_from_home": (("pose", "coordinate"), pose_coordinates(found.robot, path), {"long_name": FROM_HOME})}
        | {"reason": ("pose", reason, {"long_name": "why a pose has none", **flags()})},
        labels,
        {"study": _name(found), "drives": drives, "friction": found.simulation.friction, "free_motions": free},
    )


#: Matrices of a grid: their field of `PoseMatrices`, dimensions, words.
MATRICES = {
    "mass": ("M", ("pose", "motion", "motion_by"), "mass matrix"),
    "damping": ("D", ("pose", "motion", "motion_by"), "damping matrix"),
    "stiffness": ("K", ("pose", "motion", "motion_by"), "stiffness matrix"),
    "input_matrix": ("B", ("pose", "motion", "input"), "force on each motion by an input"),
    "output_matrix": ("C", ("pose", "output", "motion"), "output by each motion"),
}
FROM_HOME = "pose from home: lengths [m], angles [rad]"


def _about(study: model.Study) -> Array:
    """Point about which a floor turns."""
    return np.zeros(3) if study.robot.base_motion is None else np.asarray(study.robot.base_motion.at)


def _name(study: model.Study) -> str:
    return study.robot.type if study.path is None else Path(study.path).stem


def model_of(study: model.Study, plant: Plant, states: States) -> LinearModel:
    """The linear model of a plant with its states."""
    pose = pose_coordinates(study.robot, plant.locked.path)[0]
    return LinearModel(
        **vars(states), study=_name(study), pose=dict(zip(model.AXES, pose.tolist(), strict=True)), drives=plant.drives,
        friction=plant.locked.simulation.friction, position=plant.x.pose[0, :3], quaternion=plant.x.pose[0, 3:],
        about=_about(study), plant=plant,
    )  # fmt: skip
