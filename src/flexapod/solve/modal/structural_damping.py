"""Loss factors of springs made viscous, once, at home, Eq. (T13.19)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import NamedTuple, cast

import numpy as np

from flexapod.common.errors import ComputationError
from flexapod.kinematics import RigidPoses, home_pose
from flexapod.mechanics.elements.springs import springs_along, viscous
from flexapod.model import (
    Drive,
    Encoder,
    ForceDrive,
    Motor,
    PrescribedDrive,
    Robot,
    ScrewDrive,
    Simulation,
)
from flexapod.solve.modal.modes import single_pose_modes
from flexapod.solve.statics.locked_robot import lock

_kept: ContextVar[float | None] = ContextVar("frequency of loss factors", default=None)


@contextmanager
def hold_loss_frequency(robot: Robot, simulation: Simulation) -> Iterator[None]:
    """Keep the frequency of loss factors as it is for this robot, also for the variants of it that are computed inside.

    Half of what the modes of a variant cost is this frequency, which only their dampers need.
    """
    mark = _kept.set(loss_frequency(robot, simulation) or None)
    try:
        yield
    finally:
        _kept.reset(mark)


def per_loss(robot: Robot, simulation: Simulation) -> float:
    """Viscous damping over stiffness of a spring of loss factor 1 [s]; 0 of a robot none of whose springs has one."""
    frequency = loss_frequency(robot, simulation)
    return _per_loss(frequency) if frequency else 0.0


def _per_loss(frequency: float) -> float:
    return 1 / (2 * np.pi * frequency)  # (T13.19)


def loss_frequency(robot: Robot, simulation: Simulation) -> float:
    """Frequency [Hz] at which springs lose what their loss factors say: the first at home, drives locked, undamped.

    0 of a robot none of whose springs has a loss factor.

    Raises
    ------
    ComputationError
        There is no such frequency.
    """
    joints = (joint.lossy for leg in robot.legs for joint in (leg.base_joint, leg.platform_joint))
    mounts = (mount.loss for mount in (robot.base_mount, robot.platform_mount) if mount is not None)
    guides = (leg.guide.loss for leg in robot.legs if leg.guide is not None)
    lossy = any(x.loss or x.leakage for leg in robot.legs for x in springs_along(leg))
    if not (lossy or any(joints) or any(guides) or any(mounts)):
        return 0.0
    if (held := _kept.get()) is not None:
        return held
    # rigid legs have springs, too, and are locked by prescribed strokes
    sliding = simulation if simulation.friction == "sliding" else simulation.replace(friction="sliding")
    return _first(robot, sliding.replace(fidelity="lumped") if simulation.fidelity == "rigid" else sliding)


class JointDampers(NamedTuple):
    """Joints alike at an `end` of `legs`, empty of all: what each of their springs got for a damper, with its unit."""

    end: str
    legs: tuple[int, ...]
    dampers: tuple[tuple[str, float, str], ...]


class ViscousLosses(NamedTuple):
    """Dampers that loss factors were made into at a `frequency` [Hz], whose legs stretch at the least if `rigid`.

    `mounts`: largest damper along [N s/m] and about [N m s/rad] the axes of each; `springs` along the legs beside their
    joints: least and largest of the legs at home [N s/m].
    """

    frequency: float
    rigid: bool
    joints: tuple[JointDampers, ...]
    mounts: tuple[tuple[str, float, float], ...]
    springs: tuple[tuple[str, float, float], ...]


def viscous_losses(robot: Robot, simulation: Simulation) -> ViscousLosses | None:
    """Frequency at which loss factors were made viscous, and what became of each kind of spring; None without any."""
    frequency = loss_frequency(robot, simulation)
    if not frequency:
        return None
    per = _per_loss(frequency)
    mounts = ((name, getattr(robot, name)) for name in ("base_mount", "platform_mount"))
    by_axis = {name: mount.loss * per * np.diag(mount.stiffness) for name, mount in mounts if mount and mount.loss}
    return ViscousLosses(
        frequency=frequency,
        rigid=simulation.fidelity == "rigid",
        joints=tuple(_of_joints(robot, per)),
        mounts=tuple((name, float(c[:3].max()), float(c[3:].max())) for name, c in by_axis.items()),
        springs=tuple((name, min(c), max(c)) for name, c in _of_springs(robot, per).items()),
    )


def _of_joints(robot: Robot, per: float) -> Iterator[JointDampers]:
    for end in ("base_joint", "platform_joint"):
        for joint in dict.fromkeys(getattr(leg, end) for leg in robot.legs):
            values = [(name, getattr(joint, name), "N m s/rad") for name in ("bending", "torsion")]
            loss = {"bending": joint.loss or 0.0, "torsion": joint.loss or 0.0}
            if joint.stiffness is not None:
                loss["stiffness"] = joint.loss_of_stiffness or 0.0
                values.append(("stiffness", float(np.abs(joint.stiffness[:3, :3]).max()), "N s/m"))
            dampers = tuple((name, loss[name] * per * k, unit) for name, k, unit in values if k and loss[name])
            if dampers:
                legs = tuple(i for i, leg in enumerate(robot.legs, start=1) if getattr(leg, end) == joint)
                yield JointDampers(end, () if len(legs) == robot.count else legs, dampers)


def _of_springs(robot: Robot, per: float) -> dict[str, list[float]]:
    """Dampers of the springs along the legs beside their joints, of each leg at home."""
    dampers: dict[str, list[float]] = {}
    for leg, length in zip(robot.legs, robot.home_lengths, strict=True):
        for spring in springs_along(leg):
            if (spring.loss or spring.leakage) and not spring.name.endswith("_joint"):
                stiffness = 1.0 / float(spring.at_length(length))
                leaking = float(spring.creep(length)) * (per * stiffness) ** 2  # (T23.5)
                dampers.setdefault(spring.name, []).append(viscous(stiffness, 0.0, spring.loss, per) + leaking)
    for guide in (leg.guide for leg in robot.legs if leg.guide is not None and leg.guide.loss):
        found = (("gland", guide.gland), ("head", guide.head))
        for name, stiffness in found:
            dampers.setdefault(name, []).append(viscous(stiffness, 0.0, guide.loss, per))
    return dampers


def _computed(robot: Robot, simulation: Simulation) -> float:
    held = _with_drives_held(robot)
    found = single_pose_modes(lock(held, simulation, RigidPoses(held, home_pose(held)), per_loss=0.0))
    if not found.frequency.size:
        raise ComputationError("no mode at home, at whose frequency loss factors could be made viscous")
    return float(found.frequency[0])


_first = cast("Callable[[Robot, Simulation], float]", lru_cache(maxsize=64)(_computed))


def _with_drives_held(robot: Robot) -> Robot:
    """The robot whose drives hold their places; itself, where they do."""
    drives = [_held(leg.drive) for leg in robot.legs]
    if drives == [leg.drive for leg in robot.legs]:
        return robot
    return robot.replace(legs=tuple(x.replace(drive=drive) for x, drive in zip(robot.legs, drives, strict=True)))


def _held(drive: Drive) -> Drive:
    """A drive that holds its place."""
    if isinstance(drive, ForceDrive):
        return PrescribedDrive()
    if not isinstance(drive, ScrewDrive):
        return drive
    drive = drive.replace(motor=Motor(), encoder=drive.encoder if drive.holds else Encoder())
    if drive.command != "torque":
        return drive
    none = dict.fromkeys(("value", "file", "time", "torque", "loop"))
    return drive.replace(command="position", law="rigid", **none)
