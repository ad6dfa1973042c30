"""Loss factors of springs made viscous, once, at home, Eq. (T13.19)."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import cast

import numpy as np

from flexapod.errors import ComputationError
from flexapod.model import ForceDrive, PrescribedDrive, Robot, Simulation
from flexapod.words import number, text

__all__ = ["loss_frequency", "loss_words", "per_loss"]


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
    if not any(joint.lossy for leg in robot.legs for joint in (leg.base_joint, leg.platform_joint)):
        return 0.0
    # rigid legs have springs, too, and are locked by prescribed strokes
    return _first(robot, simulation.replace(fidelity="lumped") if simulation.fidelity == "rigid" else simulation)


def loss_words(robot: Robot, simulation: Simulation) -> list[str]:
    """Frequency at which loss factors were made viscous, and what became of each kind of spring, without full stops."""
    frequency = loss_frequency(robot, simulation)
    if not frequency:
        return []
    found = [f"at the first frequency there, {number(frequency, 4)} Hz (undamped, drives locked)"]
    per = per_loss(robot, simulation)
    for end in ("base_joint", "platform_joint"):
        for joint in dict.fromkeys(getattr(leg, end) for leg in robot.legs):
            values = [(name, getattr(joint, name), "N m s/rad") for name in ("bending", "torsion")]
            loss = {"bending": joint.loss or 0.0, "torsion": joint.loss or 0.0}
            if joint.stiffness is not None:
                loss["stiffness"] = (joint.loss if joint.stiffness_loss is None else joint.stiffness_loss) or 0.0
                values.append(("stiffness", float(np.abs(joint.stiffness[:3, :3]).max()), "N s/m"))
            parts = [f"{name} {text(loss[name] * per * k, unit)}" for name, k, unit in values if k and loss[name]]
            if parts:
                legs = [str(i) for i, leg in enumerate(robot.legs, start=1) if getattr(leg, end) == joint]
                which = "" if len(legs) == robot.count else f" of leg{'s' * (len(legs) > 1)} {', '.join(legs)}"
                found.append(f"{end}{which}: {', '.join(parts)}")
    return found


def _computed(robot: Robot, simulation: Simulation) -> float:
    from flexapod.solve.modes import robot_modes  # which need the parameters that ask for this

    found = robot_modes(_lossless(robot), simulation)
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
            drive=PrescribedDrive() if isinstance(leg.drive, ForceDrive) else leg.drive,
        )
        for leg in robot.legs
    )
    return robot.replace(legs=legs)
