"""Sentences of a description: mechanism, losses, drives that are off, accuracy at home, vibration, what is ideal."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.cause_labels import cause_label
from flexapod.common.quantities import NOTHING, UNSAID, along_axes, number, signed_components, text, zero_rounding
from flexapod.common.ranking import first_largest, largest_item

if TYPE_CHECKING:
    from flexapod.analysis.description.actuator_description import ActuatorDescription
    from flexapod.analysis.description.hydraulic_description import HydraulicDescription
    from flexapod.analysis.description.robot_description import RobotDescription
    from flexapod.analysis.description.screw_description import BackDriving
    from flexapod.analysis.pose_errors.disturbances import Shaking
    from flexapod.analysis.pose_errors.home_accuracy import HomeAccuracy, RestOffset
    from flexapod.analysis.predicted_damping import ControlEffect
    from flexapod.analysis.results.idealizations import Idealization
    from flexapod.common.arrays import Array
    from flexapod.solve.modal.structural_damping import ViscousLosses

_HELD = {
    "servo": "springs and dampers of the servo drives",
    "force": "feedback of the force drives",
    "screw": "loops of the screw drives",
}


def description_as_dict(found: RobotDescription | ActuatorDescription) -> dict[str, object]:
    """A description as plain data, in words where it is said in words."""
    if found.kind != "robot":
        return found.as_dict()
    robot: RobotDescription = found  # type: ignore[assignment]
    return {
        **robot.as_dict(),
        "held": locked_drive_words(robot.held),
        "losses": loss_words(robot.losses),
        "back": back_words(robot.back),
        "oil": oil_words(robot.oil, robot.hydraulics),
        "poses": [{**asdict(pose), "rest": rest_words(pose.rest)} for pose in robot.poses],
        "accuracy": accuracy_words(robot.accuracy),
        "disturbances": vibration_words(robot.disturbances, "at home"),
        "ideal": ideal_words(robot.ideal),
    }


def locked_drive_words(soft: Collection[str]) -> str:
    """Words for the coordinates that modes and stiffness lock: drives, or commands of drives with compliance."""
    if not soft:
        return "Drives locked"
    return f"Commands of the drives held, with the {' and the '.join(_HELD[kind] for kind in soft)}"


def ideal_words(found: Idealization | None) -> str | None:
    """Text on the parts without compliance, and on its usual size in a machine of this size."""
    if found is None:
        return None
    miss = " and most of its miss" if found.share > 50 else ""
    return (
        f"Ideal, without give: {', '.join(found.parts)}; in {found.machine}, a machine of this size, they make "
        f"{found.share} % of a leg's compliance{miss} (docs/real-machines.md)."
    )


def loss_words(found: ViscousLosses | None) -> list[str]:
    """Frequency at which loss factors were made viscous, and what became of each kind of spring, without full stops."""
    if found is None:
        return []
    stretched = ", pistons that stretch" if found.rigid else ""
    return [
        f"at the first frequency there, {number(found.frequency, 4)} Hz (undamped, drives locked{stretched})",
        *(
            f"{joint.end}{_which(joint.legs)}: "
            + ", ".join(f"{name} {text(damper, unit)}" for name, damper, unit in joint.dampers)
            for joint in found.joints
        ),
        *(
            f"{name}: up to {text(along, 'N s/m')} along and {text(about, 'N m s/rad')} about its axes"
            for name, along, about in found.mounts
        ),
        *(f"{name}: {_from_to(text(low, 'N s/m'), text(high, 'N s/m'))}" for name, low, high in found.springs),
    ]


def _which(legs: Sequence[int]) -> str:
    return f" of leg{'s' * (len(legs) > 1)} {', '.join(map(str, legs))}" if legs else ""


def _from_to(low: str, high: str) -> str:
    return f"{low} to {high}" if high != low else low


def oil_words(frequency: tuple[float, float] | None, cylinders: Sequence[HydraulicDescription]) -> tuple[str, ...]:
    """Text on the frequencies of the platform on its oil [Hz] and on how fast it sinks, without full stops."""
    words = []
    if frequency is not None:
        low, high = (number(x, 3) for x in frequency)
        words.append(f"the platform on its oil alone vibrates at {_from_to(low, high)} Hz at least")
    worst = largest_item(cylinders, key=lambda x: x.creep) if cylinders else None
    if worst is not None and worst.creep:
        words.append(
            f"leakage lets leg {worst.leg} give way by up to {number(1e6 * worst.creep, 3)} um/s where nothing "
            "corrects it; positions and frequencies are those of valves that do"
        )
    return tuple(words)


def back_words(found: BackDriving | None) -> str:
    """Text on back-driving with the motors of screws off."""
    if found is None:
        return ""
    if found.efficiency <= 0:
        return "with the motors off the screws stay where they are: at efficiencies up to 0.5 no thrust turns them back"
    if found.torque == 0:
        return "with the motors off nothing turns the screws: no leg bears a thrust"
    brake = "no brake is given" if found.brake is None else f"its brake holds {text(found.brake, 'N m')}"
    return (
        f"with the motors off the legs give way: the thrust turns the motor of leg {found.leg} back with up to "
        f"{text(found.torque, 'N m')} (efficiency {number(found.efficiency, 2)} backwards); {brake}"
    )


def accuracy_words(found: HomeAccuracy | str | None) -> tuple[str, ...]:
    """Text on the accuracy of the tool at home: geometry, heat, tolerances, play; or why it is unknown."""
    if found is None:
        return ()
    if isinstance(found, str):
        return (f"the accuracy at home cannot be said: {found}",)
    words = []
    if found.moved is not None:
        words.append(
            f"as built and warm the tool stands {_size(found.moved)} beside its drawn place at home, most of it by "
            f"{cause_label(found.largest)} ({text(found.largest_size, 'm', 3)})"
        )
    if found.drift is not None:
        far, time = found.drift
        words.append(
            f"the temperatures of heat.file move the tool at home by up to {text(far, 'm', 3)} from where it "
            f"stands at the start, at t = {time:.4g} s"
        )
    if found.sigma is not None:
        words.append(f"tolerances spread the tool at home by {along_axes(found.sigma)} (standard deviations)")
    if found.play is not None:
        words.append(f"play lets the tool move at home by up to {along_axes(found.play)}")
    return tuple(words)


def _size(moved: Sequence[float]) -> str:
    turned = float(np.linalg.norm(moved[3:]))
    words = text(float(np.linalg.norm(moved[:3])), "m", 3)
    return words if turned < NOTHING else f"{words} and {text(turned, 'rad', 3)}"


def rest_words(found: RestOffset | None) -> str:
    """Text on the offset of the centre of mass at rest: by heat and by weight, with signs."""
    if found is None:
        return ""
    off, built = np.array(found.off), np.array(found.built)
    size = float(np.linalg.norm(off))
    if size < NOTHING:
        return "At rest the centre of mass is where it is drawn."
    words = f"At rest the centre of mass is off by {signed_components(off)}"
    if np.linalg.norm(built) < UNSAID * size:
        return f"{words}."
    by = "heat" if found.by_heat else "heat and geometry as built"
    return (
        f"{words}: by {by} {signed_components(built, off)}, by weight and load {signed_components(off - built, off)}."
    )


def bushing_words(force: Array, time: Array | None = None) -> str:
    """Text on the largest forces (T, legs, 2) [N] of glands and heads; without ``time`` [s] of a single pose."""
    parts = []
    for k, name in enumerate(("glands", "heads")):
        at, leg = np.unravel_index(first_largest(force[..., k]), force.shape[:-1])
        when = "" if time is None else f" at t = {time[at]:.4g} s"
        parts.append(f"{name} bear up to {text(float(force[at, leg, k]), 'N')} across (leg {leg + 1}{when})")
    return f"The {', '.join(parts)}."


def vibration_words(found: Shaking | str | None, where: str) -> tuple[str, ...]:
    """Text on how much the tool vibrates, along which axis, by what, in which mode, or why that is unknown; doubts."""
    if found is None:
        return ()
    if isinstance(found, str):
        return (f"the vibration {where} by disturbances cannot be said: {found}",)
    if not found.most > 0:
        return (f"disturbances do not move the tool {where}",)
    sizes = along_axes([zero_rounding(size, max(found.rms)) for size in found.rms])
    return (
        f"disturbances shake the tool {where} by {sizes} (rms, relative to the base), along {found.axis} most by the "
        f"{found.source}, {found.per_cent:.0f} % of it in the mode at {found.frequency:.4g} Hz ({found.kind})",
        *found.doubts,
    )


def control_words(found: ControlEffect | str | None) -> tuple[str, ...]:
    """Text on the stability of a study's loop and its effect on static stiffness, or why these are unknown."""
    if found is None:
        return ()
    if isinstance(found, str):
        return (f"what the controller does cannot be said: {found}",)
    if found.growing:
        poles = "one of its poles grows" if found.growing == 1 else f"{found.growing} of its poles grow"
        words = (
            f"the loop is not stable: {poles}, by the linear model from sample to sample; "
            "reduce gains or delay, or sample more often"
        )
        return (words, *found.remarks)
    if found.stiffness is None:
        return found.remarks
    off, on = found.stiffness
    kept = "none with it" if on == 0 else "held by integrals with it"
    if 0 < on < math.inf:
        kept = f"{text(on, 'N/m', 3)} with it"
    words = (
        f"static stiffness of the tool at home, where it is least: {text(off, 'N/m', 3)} without the controller, {kept}"
    )
    return (words, *found.remarks)
