"""Loss factors of springs made viscous, once, at home, Eq. (T13.19)."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import cast

import numpy as np

from flexapod.common.errors import ComputationError
from flexapod.common.quantities import number, text
from flexapod.kinematics import home_pose
from flexapod.mechanics.elements.springs import springs_along, viscous
from flexapod.model import (
    Drive,
    Encoder,
    ForceDrive,
    HydraulicDrive,
    Motor,
    PrescribedDrive,
    Robot,
    ScrewDrive,
    Simulation,
)
from flexapod.solve.modal.modes import the_modes
from flexapod.solve.statics.locked_robot import lock


def per_loss(robot: Robot, simulation: Simulation) -> float:
    """Viscous damping over stiffness of a spring of loss factor 1 [s]; 0 of a robot none of whose springs has one."""
    frequency = loss_frequency(robot, simulation)
    return 1 / (2 * np.pi * frequency) if frequency else 0.0  # (T13.19)


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
    # rigid legs have springs, too, and are locked by prescribed strokes
    sliding = simulation if simulation.friction == "sliding" else simulation.replace(friction="sliding")
    return _first(robot, sliding.replace(fidelity="lumped") if simulation.fidelity == "rigid" else sliding)


def loss_words(robot: Robot, simulation: Simulation) -> list[str]:
    """Frequency at which loss factors were made viscous, and what became of each kind of spring, without full stops."""
    frequency = loss_frequency(robot, simulation)
    if not frequency:
        return []
    stretched = ", pistons that stretch" if simulation.fidelity == "rigid" else ""
    found = [f"at the first frequency there, {number(frequency, 4)} Hz (undamped, drives locked{stretched})"]
    per = per_loss(robot, simulation)
    for end in ("base_joint", "platform_joint"):
        for joint in dict.fromkeys(getattr(leg, end) for leg in robot.legs):
            values = [(name, getattr(joint, name), "N m s/rad") for name in ("bending", "torsion")]
            loss = {"bending": joint.loss or 0.0, "torsion": joint.loss or 0.0}
            if joint.stiffness is not None:
                loss["stiffness"] = joint.loss_of_stiffness or 0.0
                values.append(("stiffness", float(np.abs(joint.stiffness[:3, :3]).max()), "N s/m"))
            parts = [f"{name} {text(loss[name] * per * k, unit)}" for name, k, unit in values if k and loss[name]]
            if parts:
                legs = [str(i) for i, leg in enumerate(robot.legs, start=1) if getattr(leg, end) == joint]
                which = "" if len(legs) == robot.count else f" of leg{'s' * (len(legs) > 1)} {', '.join(legs)}"
                found.append(f"{end}{which}: {', '.join(parts)}")
    for name in ("base_mount", "platform_mount"):
        mount = getattr(robot, name)
        if mount is not None and mount.loss:
            c = mount.loss * per * np.diag(mount.stiffness)
            along, about = text(float(c[:3].max()), "N s/m"), text(float(c[3:].max()), "N m s/rad")
            found.append(f"{name}: up to {along} along and {about} about its axes")
    return found + _of_springs(robot, per)


def _of_springs(robot: Robot, per: float) -> list[str]:
    """Dampers of the springs along the legs beside their joints, from the least to the largest of the legs at home."""
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
    ends = {name: (text(min(c), "N s/m"), text(max(c), "N s/m")) for name, c in dampers.items()}
    return [f"{name}: {low}" + (f" to {high}" if high != low else "") for name, (low, high) in ends.items()]


def _computed(robot: Robot, simulation: Simulation) -> float:
    lossless = _lossless(robot)
    found = the_modes(lock(lossless, simulation, home_pose(lossless), per_loss=0.0))
    if not found.frequency.size:
        raise ComputationError("no mode at home, at whose frequency loss factors could be made viscous")
    return float(found.frequency[0])


_first = cast("Callable[[Robot, Simulation], float]", lru_cache(maxsize=64)(_computed))


def _lossless(robot: Robot) -> Robot:
    none = {"loss": None, "stiffness_loss": None}
    legs = tuple(
        leg.replace(
            base_joint=leg.base_joint.replace(**none),
            platform_joint=leg.platform_joint.replace(**none),
            springs=tuple(spring.replace(loss=None) for spring in leg.springs),
            drive=_locked(leg.drive),
            guide=leg.guide and leg.guide.replace(loss=None),
        )
        for leg in robot.legs
    )
    mounts = {name: getattr(robot, name) for name in ("base_mount", "platform_mount")}
    still = {name: mount and mount.replace(loss=None) for name, mount in mounts.items()}
    return robot.replace(legs=legs, base_motion=None, **still)


def _locked(drive: Drive) -> Drive:
    """A drive that holds its place, without loss factors."""
    if isinstance(drive, ForceDrive):
        return PrescribedDrive()
    if isinstance(drive, HydraulicDrive):
        return drive.replace(leakage=0.0)
    if not isinstance(drive, ScrewDrive):
        return drive
    drive = drive.replace(motor=Motor(), encoder=drive.encoder if drive.holds else Encoder())
    nut, bearing = drive.nut.replace(loss=None), drive.bearing.replace(loss=None)
    held = {
        "command": "position",
        "law": "rigid",
        "value": None,
        "file": None,
        "time": None,
        "torque": None,
        "loop": None,
    }
    held = held if drive.command == "torque" else {}
    return drive.replace(nut=nut, bearing=bearing, **held)
