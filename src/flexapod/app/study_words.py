"""A study in words, for the report: what moves, what the legs are, how it was computed, what the path asks for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.app import html
from flexapod.study.words import number, text

if TYPE_CHECKING:
    from flexapod.model import ActuatorStudy, Study
    from flexapod.study.describe.actuator import ActuatorDescription
    from flexapod.study.describe.pose import PoseDescription
    from flexapod.study.describe.robot import RobotDescription

__all__ = ["modes_section", "study_words"]

_LEGS = {
    "rigid": "rigid",
    "lumped": "stretching, without bending",
    "finite-segment": "chains of rigid segments",
    "assumed-modes": "flexible by assumed modes",
    "beam-fem": "flexible by beam elements",
    "solid-fem": "flexible by shapes of solid elements",
}


def study_words(study: Study | ActuatorStudy, found: RobotDescription | ActuatorDescription | None) -> list[str]:
    """Sentences and, where the path could be described, a table of the legs on it."""
    if isinstance(study, model.ActuatorStudy):
        return [html.bullets(_actuator(study))]
    parts = [html.bullets(_robot(study))]
    if found is not None and found.kind == "robot":
        parts += _path(found)  # type: ignore[arg-type]
    return parts


def _robot(study: Study) -> list[str]:
    robot, piston, simulation = study.robot, study.robot.legs[0].piston, study.simulation
    size = f"{number(1e3 * piston.diameter)} mm thick, " if piston.diameter else ""
    alike = "" if all(leg == robot.legs[0] for leg in robot.legs) else " (leg 1; the legs differ)"
    shapes = simulation.lateral_shapes
    count = f", {shapes} lateral shapes per plane and leg" if shapes else ""
    return [
        f"A robot of type {robot.type} carries {number(robot.payload.mass)} kg on six legs.",
        f"Pistons: {size}{number(1e3 * piston.length)} mm long, EA = {number(1e-6 * piston.EA)} MN, "
        f"EI = {number(piston.EI)} N m²{alike}.",
        f"Motion: {_motion(study.motion)}.",
        f"Legs: {_LEGS.get(simulation.fidelity, simulation.fidelity)} ({simulation.fidelity}{count}); "
        f"{number(study.duration, 4)} s simulated, from {_START.get(study.initial.start, study.initial.start)}.",
    ]


_START = {
    "equilibrium": "the static equilibrium",
    "straight": "straight legs at rest",
    "moving": "the velocity of the command",
}


def _motion(motion: model.Motion) -> str:
    if isinstance(motion, model.CsvMotion):
        return "from a table"
    if isinstance(motion, model.WaypointMotion):
        return f"through {len(motion.points)} points, {motion.profile} between them"
    target = np.asarray(motion.target)
    moved = [_amount(name, value) for name, value in zip(model.AXES, target, strict=True) if value]
    ends = f" in {number(motion.duration, 4)} s, {motion.profile}, then {number(motion.hold, 4)} s of rest"
    return (" and ".join(moved) or "none") + ends


def _amount(name: str, value: float) -> str:
    return f"{name} {text(value, 'm', 4) if name in model.AXES[:3] else f'{number(math.degrees(value), 4)} deg'}"


def _path(found: RobotDescription) -> list[str]:
    rows = [
        (
            f"{leg.leg}",
            f"{1e3 * leg.shortest.value:.1f} to {1e3 * leg.longest.value:.1f} mm",
            "no limits" if leg.stroke_margin is None else f"{1e3 * leg.stroke_margin.value:.1f} mm",
            f"{leg.force_min.value:.4g} to {leg.force_max.value:.4g} N",
            "never pushed" if leg.euler_share.value == 0 else f"{100 * leg.euler_share.value:.2g} %",
            "n/a" if leg.stress is None else text(leg.stress.total.value, "Pa"),
        )
        for leg in found.legs
    ]
    head = ("Leg", "Length", "Stroke left", "Drive force", "Of Euler load", "Largest stress")
    s = found.singularity
    words = (
        f"Estimates from the rigid path, as `flexapod check` gives them. Distance to a singularity: smallest singular "
        f"value of the scaled Jacobian {s.smallest_singular_value:.3g} at t = {s.time:.3f} s, condition "
        f"{s.condition:.3g}; at home {s.home_smallest_singular_value:.3g} and {s.home_condition:.3g}."
    )
    return [html.heading("What the path asks of the legs"), html.table(head, rows), html.paragraph(words, "soft")]


def _actuator(study: ActuatorStudy) -> list[str]:
    beam, simulation = study.actuator, study.simulation
    shapes = simulation.lateral_shapes
    tip = f", with {number(beam.tip_mass)} kg at its tip" if beam.tip_mass else ""
    start = study.initial.tip_displacement
    released = f", released from {text(start, 'm')} at the tip" if start else ""
    return [
        f"A single actuator: a beam of {number(beam.length)} m, {number(beam.free_length)} m of it outside the hub at "
        f"the start{tip}; rhoA = {number(beam.rhoA)} kg/m, EI = {number(beam.EI, 5)} N m².",
        f"Driven: {_driven(study)}.",
        f"The beam is {_LEGS.get(simulation.fidelity, simulation.fidelity)} ({simulation.fidelity}, {shapes} shapes); "
        f"{number(study.duration, 4)} s simulated{released}.",
    ]


def _driven(study: ActuatorStudy) -> str:
    words = []
    for name, load, unit in (("rotation", "torque", "rad/s"), ("extension", "force", "m/s")):
        law = getattr(study.motion, name)
        if law is None:
            words.append(f"{name} by a {load}, so that it is a result")
        elif law.law == "rate":
            words.append(f"{name} at {number(law.rate)} {unit}")
        else:
            words.append(f"{name} by the law {law.law}")
    return " and ".join(words)


def modes_section(found: RobotDescription | ActuatorDescription | None) -> list[str]:
    """Frequencies, damping and stiffness with the drives locked; nothing where there is no description."""
    if found is None:
        return []
    if found.kind == "actuator":
        return [html.section("modes", "Modes", *_beam(found))]  # type: ignore[arg-type]
    parts = [part for pose in found.poses for part in _pose(pose)]  # type: ignore[union-attr]
    words = "Drives locked, about the static equilibrium. Damping is the part of critical damping."
    return [html.section("modes", "Modes", html.paragraph(words, "soft"), *parts)]


def _pose(pose: PoseDescription) -> list[str]:
    parts = [html.heading(f"{pose.name[0].upper()}{pose.name[1:]}, t = {pose.time:.3f} s")]
    if pose.problem:
        parts.append(html.paragraph(pose.problem, "bad"))
    if pose.modes:
        rows = [
            (f"{i}", f"{mode.frequency:.4g} Hz", f"{100 * mode.damping_ratio:.2g} %", mode.kind)
            for i, mode in enumerate(pose.modes, start=1)
        ]
        parts.append(html.table(("Mode", "Frequency", "Damping", "What moves most"), rows))
    if pose.stiffness is not None:
        s = pose.stiffness
        words = f"Stiffness at the tool: {text(s.least, 'N/m')} to {text(s.most, 'N/m')} along a direction."
        parts.append(html.paragraph(words, "soft"))
    return parts


def _beam(found: ActuatorDescription) -> list[str]:
    rows = [
        (
            beam.name,
            f"{beam.free_length:.4g} m",
            ", ".join(f"{f:.4g}" for f in beam.frequency) or beam.problem or "n/a",
            ", ".join(f"{100 * d:.2g}" for d in beam.damping_ratio) or "n/a",
        )
        for beam in found.beam
    ]
    words = "Rotation and extension held, about the straight beam at rest."
    head = ("Beam", "Free length", "Frequencies [Hz]", "Damping [%]")
    return [html.paragraph(words, "soft"), html.table(head, rows)]
