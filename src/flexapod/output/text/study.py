"""A study as text, for the report: motion, legs, computation, loads along the path."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.results.cause_labels import CAUSES, cause_label
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.idealizations import soft_drives
from flexapod.common.quantities import number, text
from flexapod.output.text import check, html
from flexapod.output.text.description import locked_drive_words
from flexapod.output.text.html import Html
from flexapod.output.text.parts import Bullets, Chapter, Item, Text, TextTable
from flexapod.solve.statics.lost_motion import places_with_friction

if TYPE_CHECKING:
    from flexapod.analysis.description.actuator_description import ActuatorDescription
    from flexapod.analysis.description.leg_description import LegDescription
    from flexapod.analysis.description.robot_description import PoseDescription, RobotDescription
    from flexapod.common.arrays import Array
    from flexapod.model import ActuatorStudy, Robot, Study

_LEGS = {
    "rigid": "rigid",
    "lumped": "stretching, without bending",
    "finite-segment": "chains of rigid segments",
    "assumed-modes": "flexible by assumed modes",
    "beam-fem": "flexible by beam elements",
    "solid-fem": "flexible by shapes of solid elements",
}
_START = {
    "equilibrium": "the static equilibrium",
    "straight": "straight legs at rest",
    "moving": "the velocity of the command",
}


def study_items(study: Study | ActuatorStudy, found: RobotDescription | ActuatorDescription | None) -> Iterator[Item]:
    """Sentences and, where the path could be described, a table of the legs on it."""
    if isinstance(study, model.ActuatorStudy):
        yield Bullets(_actuator(study))
        return
    yield Bullets(_robot(study))
    if found is not None and found.kind == "robot":
        yield Chapter("What the path asks of the legs", _path(found))  # type: ignore[arg-type]
        yield check.screws(found)  # type: ignore[arg-type]
        yield check.hydraulics(found)  # type: ignore[arg-type]


def _robot(study: Study) -> list[str]:
    robot, piston, simulation = study.robot, study.robot.legs[0].piston, study.simulation
    size = f"{number(1e3 * piston.diameter)} mm thick, " if piston.diameter else ""
    alike = "" if robot.alike else " (leg 1; the legs differ)"
    body = "piston" if robot.legs[0].strut is None else "strut"
    shapes = simulation.lateral_shapes
    count = f", {shapes} lateral shapes per plane and leg" if shapes else ""
    return [
        *_carried(robot),
        f"{body.capitalize()}s: {size}{number(1e3 * piston.length)} mm long, EA = {number(1e-6 * piston.EA)} MN, "
        f"EI = {number(piston.EI)} N m², {_damping(robot.legs[0].damping, body)}{alike}.",
        f"Drives: {_drives(robot)}.",
        *_parts(study),
        f"Motion: {_motion(study.motion)}.",
        f"Load: {_load(study.load.wrench)}.",
        f"Legs: {_LEGS[simulation.fidelity]} ({simulation.fidelity}{count}); "
        f"{number(study.duration, 4)} s simulated, from {_START[study.initial.start]}.",
    ]


def _parts(study: Study) -> list[str]:
    """Sentences on parts that are not ideal, deviations from the nominal machine, and sources of vibration."""
    tables = {"Tolerances": study.robot.tolerances, "Disturbances": study.disturbance}
    parts = [cause_label(name) for name in cause_names(study.robot)[len(CAUSES) :]]
    rubs = [f"friction of the joints at the {x[:-6]}" for x in places_with_friction(study.robot) if x != "drive"]
    listed = {"Other parts that count": [*parts, *rubs]}
    for title, table in tables.items():
        names = [] if table is None else type(table).model_fields
        listed[title] = [name.replace("_", " ") for name in names if getattr(table, name) is not None]
    return [f"{title}: {', '.join(words)}." for title, words in listed.items() if words] + _elements(study.robot)


def _elements(robot: Robot) -> list[str]:
    """Sentences on elements with tables of their own; of identical legs once."""
    told: dict[str, list[int]] = {}
    for leg, one in enumerate(robot.legs, start=1):
        for element in one.elements:
            said = element.source_table.data if element.source_table is not None else element._shown()
            words = ", ".join(f"{name} {value}" for name, value in said.items())
            told.setdefault(f"[leg.{element.at}]: {words}", []).append(leg)
    legs = {words: "" if len(which) == robot.count else f" (legs {which})" for words, which in told.items()}
    return [f"{words}{which}." for words, which in legs.items()]


def _carried(robot: Robot) -> list[str]:
    """Sentences on the load of the legs: payload, gravity, and the payload's points."""
    legs, gravity = f"on {_legs_of(robot)}", _gravity(robot.gravity)
    if robot.payload is None:
        return [f"A platform that is fixed, {legs} (type {robot.type}); {gravity}."]
    mass = number(robot.payload.mass)
    return [f"A robot of type {robot.type} carries {mass} kg {legs}; {gravity}.", _points(robot.payload)]


def _legs_of(robot: Robot) -> str:
    count = len(robot.legs)
    words = ("one leg", "two", "three", "four", "five", "six", "seven", "eight")
    return words[0] if count == 1 else f"{words[count - 1] if count <= len(words) else count} legs"


def _gravity(gravity: Array) -> str:
    along = np.flatnonzero(gravity)
    if not along.size:
        return "no gravity"
    if along.size > 1:
        return f"gravity [{', '.join(number(part) for part in gravity)}] m/s²"
    size = float(gravity[along[0]])
    return f"gravity of {number(abs(size))} m/s² along {'-' if size < 0 else ''}{'xyz'[along[0]]}"


def _points(payload: model.Payload) -> str:
    com, tool = (f"[{', '.join(number(1e3 * part + 0.0, 4) for part in at)}] mm" for at in (payload.com, payload.tool))
    also = "which is the tool, too" if np.array_equal(payload.com, payload.tool) else f"the tool at {tool}"
    return f"Centre of mass at {com} from the platform's centre, {also}."


def _damping(damping: float | model.Damping, body: str) -> str:
    ratio, time = model.damping_parts(damping)
    every = f"damping of {number(100 * ratio)} % of the critical one in every mode of the bare {body}"
    stiff = f"damping of {text(time, 's')} times the stiffness of the {body}"
    return " and ".join([*([every] if ratio else []), *([stiff] if time else [])]) or "no damping"


def _drives(robot: Robot) -> str:
    """Sentences on the drives, those of a kind together."""
    legs: dict[str, list[str]] = {}
    for i, leg in enumerate(robot.legs, start=1):
        words = _drive(leg.drive) if leg.driven else "none, passive"
        legs.setdefault(words.replace("stroke", leg.driven or "stroke"), []).append(str(i))
    if len(legs) == 1:
        return next(iter(legs))
    return "; ".join(f"leg{'s' * (len(some) > 1)} {', '.join(some)}: {words}" for words, some in legs.items())


def _drive(drive: model.Drive) -> str:
    if isinstance(drive, model.PrescribedDrive):
        return "prescribed, the stroke follows its command exactly"
    if isinstance(drive, model.ServoDrive):
        damper = f" and a damper of {number(drive.damping)} N s/m" if drive.damping else ""
        return f"servo, a spring of {text(drive.stiffness, 'N/m')}{damper} between commanded and real stroke"
    if isinstance(drive, model.ScrewDrive):
        return _screw(drive)
    if isinstance(drive, model.HydraulicDrive):
        ends = ", at both ends" if drive.double_ended else ""
        return (
            f"hydraulic, bore {text(drive.bore, 'm', 4)}, rod {text(drive.rod, 'm', 4)}{ends}, stroke "
            f"{text(drive.stroke, 'm', 4)}, the valve closed where the stroke is commanded"
        )
    force = "that which the rigid robot needs" if drive.law == "rigid" else "from a table"
    force = force if drive.value is None else f"constant, {text(drive.value, 'N')}"
    back = drive.feedback
    if back is None:
        return f"force, {force}"
    return f"force, {force}, corrected by {text(back.stiffness, 'N/m')} and {number(back.damping)} N s/m on the stroke"


def _screw(drive: model.ScrewDrive) -> str:
    held = {"joint-to-joint": "distance of its joints"}.get(drive.encoder.at, drive.encoder.at)
    motors = {
        "position": f"the {held} held at its command",
        "servo": f"the {held} pulled to its command by a loop",
        "torque": {
            "rigid": "driven by the torque that the rigid robot and the rotor need",
            "constant": f"driven by a constant torque of the motor, {text(drive.value or 0.0, 'N m')}",
            "csv": "driven by a torque of the motor from a table",
        }[drive.law],
    }
    late = f", its torque behind by {text(drive.lag, 's')}" if drive.lag else ""
    return (
        f"screw of {text(drive.root_diameter, 'm', 4)} with a lead of {text(drive.lead, 'm', 4)}, {drive.mounting}, "
        f"{motors[drive.command]}{late}"
    )


_WRENCH = (("Fx", "N"), ("Fy", "N"), ("Fz", "N"), ("Mx", "N m"), ("My", "N m"), ("Mz", "N m"))


def _load(wrench: model.Wrench | None) -> str:
    if wrench is None:
        return "none"
    if isinstance(wrench, model.CsvWrench):
        return "from a table, at the tool, world axes"
    values = wrench.value if isinstance(wrench, model.ConstantWrench) else wrench.amplitude
    parts = [f"{name} {text(float(v), unit)}" for (name, unit), v in zip(_WRENCH, values, strict=True) if v]
    if isinstance(wrench, model.SineWrench):
        phase = f", phase {number(math.degrees(wrench.phase))} deg" if wrench.phase else ""
        when = f", times a sine of {text(wrench.frequency, 'Hz')}{phase}"
    else:
        when = f" from t = {number(wrench.time, 4)} s on" if isinstance(wrench, model.StepWrench) else ", constant"
    return f"{' and '.join(parts)}{when}, at the tool, world axes" if parts else "none"


def _motion(motion: model.Motion) -> str:
    if isinstance(motion, model.CsvMotion):
        return "from a table"
    if isinstance(motion, model.WaypointMotion):
        return f"through {len(motion.points)} points, {motion.profile} between them"
    target = np.asarray(motion.target)
    moved = [_amount(name, value) for name, value in zip(model.AXES, target, strict=True) if value]
    if not moved:
        return "none"
    ends = f" in {number(motion.duration, 4)} s, {motion.profile}, then {number(motion.hold, 4)} s of rest"
    return " and ".join(moved) + ends


def _amount(name: str, value: float) -> str:
    return f"{name} {text(value, 'm', 4) if name in model.AXES[:3] else f'{number(math.degrees(value), 4)} deg'}"


def _path(found: RobotDescription) -> Iterator[Item]:
    rows = [
        (
            f"{leg.leg}",
            *_travel_and_margin(leg),
            "none: passive"
            if not leg.drive
            else f"{leg.force_min.value:.4g} to {leg.force_max.value:.4g} {'N m' if leg.drive == 'crank' else 'N'}",
            "never pushed" if leg.euler_share.value == 0 else f"{100 * leg.euler_share.value:.2g} %",
            "n/a" if leg.stress is None else text(leg.stress.total.value, "Pa"),
        )
        for leg in found.legs
    ]
    kind = next((leg.carriage.kind for leg in found.legs if leg.carriage is not None), "")
    crank = any(leg.carriage is not None and leg.carriage.kind == "crank" for leg in found.legs)
    place, left = {"crank": ("Angle", "Turn left"), "slider": ("Position", "Travel left")}.get(
        kind, ("Length", "Stroke left")
    )
    force = "Drive torque" if crank else "Drive force"
    yield TextTable((place, left, force, "Of Euler load", "Largest stress"), rows, of="leg")
    words = "Estimates from the rigid path, as `flexapod check` gives them."
    if (s := found.singularity) is not None:
        words += (
            f" Distance to a singularity: smallest singular value of the scaled Jacobian "
            f"{s.smallest_singular_value:.3g} at t = {s.time:.3f} s, condition {s.condition:.3g}; at home "
            f"{s.home_smallest_singular_value:.3g} and {s.home_condition:.3g}."
        )
    yield Text(words, "soft")


def _travel_and_margin(leg: LegDescription) -> tuple[str, str]:
    """Range of a leg's carriage, else of its length, and the margin to its limits, as text."""
    if (way := leg.carriage) is None:
        low, high, margin, unit, factor = leg.shortest, leg.longest, leg.stroke_margin, "mm", 1e3
    else:
        turns = way.kind == "crank"
        low, high, margin = way.low, way.high, way.margin
        unit, factor = ("deg", math.degrees(1.0)) if turns else ("mm", 1e3)
    left = "no limits" if margin is None else f"{factor * margin.value:.1f} {unit}"
    return f"{factor * low.value:.1f} to {factor * high.value:.1f} {unit}", left


def _actuator(study: ActuatorStudy) -> list[str]:
    beam, simulation = study.actuator, study.simulation
    shapes = simulation.lateral_shapes
    tip = f", with {number(beam.tip_mass)} kg at its tip" if beam.tip_mass else ""
    start = study.initial.tip_displacement
    released = f", released from {text(start, 'm')} at the tip" if start else ""
    there = [words for words, value in (("stretches", beam.EA), ("twists", beam.GJ)) if value is not None]
    downwards = np.array([0.0, float(not beam.space), float(beam.space)])
    also = f" and {' and '.join(there)}" if there else ""
    parts = f" It moves in space: it bends in two planes{also}." if beam.space else ""
    return [
        f"A single actuator: a beam of {number(beam.length)} m, {number(beam.free_length)} m of it outside the hub at "
        f"the start{tip}; rhoA = {number(beam.rhoA)} kg/m, EI = {number(beam.EI, 5)} N m²; "
        f"{_damping(beam.damping, 'beam')}, {_gravity(-beam.gravity * downwards)}.{parts}",
        f"Driven: {_driven(study)}.",
        f"The beam is {_LEGS[simulation.fidelity]} ({simulation.fidelity}, {shapes} shapes); "
        f"{number(study.duration, 4)} s simulated{released}.",
    ]


def _driven(study: ActuatorStudy) -> str:
    words = []
    units = {"rotation": ("rad/s", "N m"), "extension": ("m/s", "N"), "elevation": ("rad/s", "N m")}
    starts = {"rotation": "angle_rate", "extension": "length_rate", "elevation": "elevation_rate"}
    for name, (rate, unit) in list(units.items())[: 2 + study.actuator.space]:
        load, law = model.DRIVEN_BY[name], getattr(study.motion, name)
        if law is None:
            first = getattr(study.initial, starts[name])
            begun = f", from {number(first)} {rate} at the start" if first else ""
            words.append(
                f"{name} by a {load.rsplit('_')[-1]}{_law(getattr(study.load, load), unit)}{begun}, "
                "so that it is a result"
            )
        elif law.law == "rate":
            words.append(f"{name} at {number(law.rate)} {rate}")
        else:
            words.append(f"{name} by the law {law.law}")
    if study.load.wrench is not None:
        words.append(f"a load at the tip{' that follows it' if study.load.follow else ''}")
    return " and ".join(words)


def _law(law: model.LoadLaw, unit: str) -> str:
    """Size of a torque or force by its law, as text that continues a sentence."""
    if isinstance(law, model.ConstantLaw):
        return f" of {text(law.value, unit)}"
    if isinstance(law, model.CsvLaw):
        return " from a table"
    if isinstance(law, model.SineLaw):
        return f" of up to {text(law.amplitude, unit)} at {text(law.frequency, 'Hz')}"
    when = f" from t = {number(law.time, 4)} s on" if isinstance(law, model.StepLaw) else f", {law.law}"
    return f" of up to {text(law.amplitude, unit)}{when}"


def modes_section(
    study: Study | ActuatorStudy | None, found: RobotDescription | ActuatorDescription | None
) -> list[Html]:
    """Frequencies, damping and stiffness while the commands stand still; nothing where there is no description."""
    if study is None or found is None:
        return []
    if isinstance(study, model.ActuatorStudy):
        return [html.section("modes", "Modes", _beam(found))]  # type: ignore[arg-type]
    held = locked_drive_words(soft_drives(study.robot))
    words = f"{held}, about the static equilibrium. Damping is the part of critical damping."
    return [html.section("modes", "Modes", [Text(words, "soft"), *map(_pose, found.poses)])]  # type: ignore[union-attr]


def _pose(pose: PoseDescription) -> Chapter:
    told: list[Item] = [] if not pose.problem else [Text(pose.problem, "bad")]
    if pose.modes:
        told.append(modes_table((mode.frequency, mode.damping_ratio, mode.kind) for mode in pose.modes))
    if (s := pose.stiffness) is not None:
        words = f"Stiffness at the tool: {text(s.least, 'N/m')} to {text(s.most, 'N/m')} along a direction."
        told.append(Text(words, "soft"))
    if pose.parts is not None:
        legs = range(1, 1 + len(next(iter(pose.parts.values()))))
        rows = [
            (name, *("-" if math.isinf(k) else f"{k / 1e6:.4g}" for k in values)) for name, values in pose.parts.items()
        ]
        told.append(TextTable(("Stiffness along the leg [N/µm]", *map("leg {}".format, legs)), rows))
    return Chapter(f"{pose.name[0].upper()}{pose.name[1:]}, t = {pose.time:.3f} s", told)


def modes_table(modes: Iterable[tuple[float, float, str]]) -> TextTable:
    """Modes from the lowest on: frequency [Hz], damping ratio, kind."""
    rows = [(f"{i}", f"{f:.4g} Hz", f"{100 * d:.2g} %", kind) for i, (f, d, kind) in enumerate(modes, start=1)]
    return TextTable(("Frequency", "Damping", "What moves most"), rows, of="mode")


def _beam(found: ActuatorDescription) -> list[Item]:
    rows = [
        (beam.name, f"{beam.free_length:.4g} m", *numbers)
        for beam in found.beam
        for numbers in beam.by_kind or [("n/a", beam.problem or "n/a", "n/a")]
    ]
    head = ("Beam", "Free length", "What moves", "Frequencies [Hz]", "Damping [%]")
    return [Text("Hub and extension held, about the straight beam at rest.", "soft"), TextTable(head, rows)]
