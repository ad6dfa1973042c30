"""A first robot in words: what was found, and what to think about."""

from __future__ import annotations

from flexapod import model
from flexapod.analysis.description.robot_description import RobotDescription, describe
from flexapod.common.quantities import number, text

HEAVY = 1.0  # mass of the legs over that of the payload above which it is remarked on
MACHINE = 3.0  # the same of legs with screws or oil, which are sized for stiffness


def first_words(written: str) -> list[str]:
    """Sentences about the study in a text."""
    study = model.loads(written)
    found = describe(study)
    if not isinstance(study, model.Study) or not isinstance(found, RobotDescription):
        return []
    return [*_found(study, found), *(f"Remark: {remark}" for remark in (*_heavy(study.robot), *found.remarks))]


def _found(study: model.Study, found: RobotDescription) -> list[str]:
    robot, motion, start = study.robot, study.motion, found.poses[0]
    leg = robot.legs[0]
    low, high = (leg.stroke.min, leg.stroke.max) if leg.stroke is not None else (0.0, 0.0)
    path = ", ".join(f"{name} {words}" for name, words in motion._shown().items())
    home, shortest, longest = (number(1e3 * length, 4) for length in (float(robot.home_lengths[0]), low, high))
    lines = [
        f"Legs of {home} mm at home, {shortest} to {longest} mm; "
        f"pistons {text(leg.piston.diameter or 0.0, 'm')} thick and {text(leg.piston.length, 'm', 4)} long, mouths of "
        f"the cylinders at {text(leg.cylinder.mouth, 'm', 4)}. Motion: {path}."
    ]
    pushed = max(leg.euler_share.value for leg in found.legs)
    bears = f"Pistons bear at most {number(100 * pushed, 2)} % of their Euler load"
    if start.sag is not None and start.modes:
        first = start.modes[0]
        bears += f". {start.rest.rstrip('.')}; the lowest frequency is {first.frequency:.3g} Hz ({first.kind})"
    return [*lines, f"{bears}."]


def _heavy(robot: model.Robot) -> list[str]:
    legs = sum(leg.piston.mass + leg.cylinder.mass for leg in robot.legs)
    exact = robot.legs[0].drive.type == "prescribed"
    if legs <= (HEAVY if exact else MACHINE) * robot.payload.mass:
        return []
    advice = "thinner, hollow or lighter pistons would do (diameter, material)" if exact else "a smaller robot would do"
    words = f"the legs weigh {number(legs)} kg, more than the payload of {number(robot.payload.mass)} kg"
    return [f"{words}: {advice}"]
