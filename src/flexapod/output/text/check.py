"""Text of `flexapod check` on a robot or a single actuator."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.description.hydraulic_description import BAR, LITRES
from flexapod.analysis.description.screw_description import RPM
from flexapod.common.quantities import column, columns, number, scale, sentence, text
from flexapod.common.ranking import descending_order, largest_item
from flexapod.output.text.description import (
    accuracy_words,
    back_words,
    bushing_words,
    ideal_words,
    locked_drive_words,
    loss_words,
    oil_words,
    rest_words,
    vibration_words,
)
from flexapod.output.text.parts import Chapter, Item, Remarks, TextTable

if TYPE_CHECKING:
    from flexapod.analysis.description.actuator_description import ActuatorDescription, BeamDescription
    from flexapod.analysis.description.hydraulic_description import HydraulicDescription
    from flexapod.analysis.description.leg_description import Extreme
    from flexapod.analysis.description.residual_vibration import ExpectedVibration
    from flexapod.analysis.description.robot_description import PoseDescription, RobotDescription
    from flexapod.analysis.description.screw_description import ScrewDescription

SHOWN_ANGLE = math.radians(60)


def check_items(found: RobotDescription | ActuatorDescription, control: Sequence[str] = ()) -> Iterator[Item]:
    """A description in sections; `control`: what is said of the controller."""
    return _robot(found, control) if found.kind == "robot" else _actuator(found)  # type: ignore[arg-type]


def _robot(found: RobotDescription, control: Sequence[str]) -> Iterator[Item]:
    yield (
        f"The path keeps all limits. The motion takes {found.motion_end:.4g} s, the simulation {found.duration:.4g} s "
        f"({found.fidelity}). Estimates from the rigid path:"
    )
    yield Chapter("Motions of the rigid robot", map(sentence, found.motions))
    yield Chapter("Lengths, joint to joint", _lengths(found))
    turn = any(leg.carriage is not None and leg.carriage.kind == "crank" for leg in found.legs)
    yield Chapter("Cranks" if turn else "Carriages", _carriages(found))
    yield Chapter("Largest angles (limit 85 deg)", _angles(found))
    yield Chapter("Joints and room between legs", _bodies(found))
    yield Chapter("Distance to a singularity (scaled Jacobian)", _singularity(found))
    yield Chapter("Loads (+ pushes)", _loads(found))
    yield screws(found)
    yield hydraulics(found)
    yield Chapter("Loss factors, made viscous at home", map("{}.".format, loss_words(found.losses)))
    for pose in found.poses:
        yield Chapter(f"{locked_drive_words(found.held)}, {pose.name} (t = {pose.time:.3f} s)", _pose(pose))
    yield Chapter("Vibration to expect after the motion, at the tool", [_vibration(found.vibration)])
    yield Chapter("The machine as built", map(sentence, accuracy_words(found.accuracy)))
    yield Chapter("Disturbances", map(sentence, vibration_words(found.disturbances, "at home")))
    yield Chapter("Controller", map(sentence, control))
    ideal = [words] if (words := ideal_words(found.ideal)) else []
    yield Chapter("Remarks", [*ideal, Remarks(found.remarks or (() if ideal else ("None.",)))])


def _lengths(found: RobotDescription) -> Iterator[Item]:
    rows = [
        [
            str(leg.leg),
            _at(leg.shortest),
            _at(leg.longest),
            _at(leg.stroke_margin),
            "strut" if leg.guided is None else f"{1e3 * leg.guided.value:.2f}",
            f"{leg.slenderness:.1f}",
        ]
        for leg in found.legs
    ]
    head = ["shortest [mm]", "longest [mm]", "stroke left [mm]", "in cylinder [mm]", "free length / width"]
    yield TextTable(head, rows, of="leg")
    limited = [(leg.stroke_margin.value, leg) for leg in found.legs if leg.stroke_margin is not None]
    if limited:
        margin, leg = largest_item(limited, key=lambda entry: -entry[0])
        low, high = leg.stroke or (0.0, 0.0)
        yield (
            f"Leg {leg.leg} comes nearest to its limits of {1e3 * low:.4g} and {1e3 * high:.4g} mm: {1e3 * margin:.2f} "
            "mm are left."
        )


def _carriages(found: RobotDescription) -> Iterator[Item]:
    ways = [(leg.leg, leg.carriage) for leg in found.legs if leg.carriage is not None]
    if ways:
        unit, factor = ("deg", 180 / math.pi) if ways[0][1].kind == "crank" else ("mm", 1e3)
        rows = [[str(leg), *(_at(e, factor) for e in (way.low, way.high, way.margin))] for leg, way in ways]
        yield TextTable([f"least [{unit}]", f"largest [{unit}]", f"travel left [{unit}]"], rows, of="leg")


def _angles(found: RobotDescription) -> Iterator[Item]:
    """Angles of joints that come near their limit of 85 deg; those of universal joints of six legs UPS go unsaid."""
    least = {"universal joint": SHOWN_ANGLE}
    for angle in found.angles:
        if angle.largest.value > least.get(angle.joint, 1e-3):
            words = "between carriage and leg" if angle.joint == "carriage" else f"of the {angle.joint}"
            degrees = math.degrees(angle.largest.value)
            yield f"{degrees:.1f} deg {words} of leg {angle.leg} at t = {angle.largest.time:.3f} s."


def _bodies(found: RobotDescription) -> Iterator[Item]:
    for turn in found.turns:
        value, limit = math.degrees(turn.largest.value), turn.limit
        left = (
            "" if limit is None else f", of {math.degrees(limit):.4g} deg: {math.degrees(limit) - value:.2f} are left"
        )
        at = f"leg {turn.leg} at t = {turn.largest.time:.3f} s"
        yield f"Joints at the {turn.end} turn from home by up to {value:.2f} deg ({at}){left}."
    if found.clearance is not None:
        (one, other), least = found.clearance.legs, found.clearance.least
        yield (
            f"Legs {one} and {other} come nearest to each other: {text(least.value, 'm', 3)} are between them at "
            f"t = {least.time:.3f} s, at home {text(found.clearance.home, 'm', 3)} between the nearest."
        )
    for end in found.stroke_ends:
        words = (f"base {math.degrees(end.base):.2f} deg", f"platform {math.degrees(end.platform):.2f} deg")
        left = () if end.margin is None else (f"{math.degrees(end.margin):.2f} deg are left at least",)
        room = () if end.gap is None else (f"{text(end.gap, 'm', 3)} between the nearest legs",)
        name = "shortest" if end.shortest else "longest"
        yield f"With all legs at their {name}: {', '.join((*words, *left, *room))}."


def _at(extreme: Extreme | None, factor: float = 1e3) -> str:
    return "no limits" if extreme is None else f"{factor * extreme.value + 0.0:.2f} at {extreme.time:.3f} s"


def _singularity(found: RobotDescription) -> Iterator[Item]:
    if (s := found.singularity) is not None:
        yield (
            f"Smallest singular value {s.smallest_singular_value:.3g}, condition {s.condition:.3g} at t = "
            f"{s.time:.3f} s; at home {s.home_smallest_singular_value:.3g} and {s.home_condition:.3g}. An error of the "
            f"legs' lengths reaches the platform up to {1 / s.smallest_singular_value:.3g} times as large."
        )


def _loads(found: RobotDescription) -> Iterator[Item]:
    legs = found.legs
    drive = "N m" if any(leg.drive == "crank" for leg in legs) else "N"
    unit, *forces = columns(drive, [leg.force_min.value for leg in legs], [leg.force_max.value for leg in legs])
    _, shares = column([100 * leg.euler_share.value for leg in legs], "", 3)
    pushed = [
        "never pushed" if leg.euler_share.value == 0 else f"{share} at {leg.euler_share.time:.3f} s"
        for leg, share in zip(legs, shares, strict=True)
    ]
    parts = [(s.axial, s.bending, s.total.value) if (s := leg.stress) else (math.nan,) * 3 for leg in legs]
    pressure, *stresses = columns("Pa", *zip(*parts, strict=True))
    head = [f"least [{unit}]", f"largest [{unit}]", "of Euler load [%]"]
    head += [f"{name} [{pressure}]" for name in ("axial", "bending", "together")]
    numbers = [str(leg.leg) for leg in legs]
    yield TextTable(head, list(zip(numbers, *forces, pushed, *stresses, strict=True)), of="leg")
    near = largest_item(legs, key=lambda leg: leg.euler_share.value)
    if near.euler_share.value > 0:
        yield (
            f"Leg {near.leg} comes nearest to buckling: {1 / near.euler_share.value:.3g} times its load would "
            f"do it (Euler load {text(near.euler_load, 'N')})."
        )
    known = [(leg.stress, leg.leg) for leg in legs if leg.stress is not None]
    if known:
        stress, leg = largest_item(known, key=lambda entry: entry[0].total.value)
        limit = stress.yield_stress
        share = "" if limit is None else f", {100 * stress.total.value / limit:.2g} % of yield"
        yield f"Leg {leg} is stressed most: {text(stress.total.value, 'Pa')}{share}."
    else:
        yield "No stresses: the section or the material of the legs is not given."


def screws(found: RobotDescription) -> Chapter:
    """Section on the loads of screws along the path, and on back-driving with their motors off."""
    items = [_screw_table(found.screws), sentence(back_words(found.back))] if found.screws else []
    return Chapter("Screws, largest values on the path", items)


def _screw_table(screws: Sequence[ScrewDescription]) -> TextTable:
    head = ["thrust [N]", "of buckling [%]", "motor [rpm]", "of critical speed [%]", "motor [N m]", "rms [N m]",
            "static safety", "life [h]"]  # fmt: skip
    known = any(s.current is not None for s in screws)
    head += ["current [A]", "rms [A]"] if known else []
    rows = [
        [
            f"{s.leg}",
            f"{s.thrust.value:.4g}",
            f"{100 * s.buckling.value:.3g}",
            f"{RPM * s.speed.value:.4g}",
            f"{100 * s.critical:.3g}",
            f"{s.torque.value:.3g}",
            f"{s.rms_torque:.3g}",
            "-" if s.safety is None else f"{s.safety:.3g}",
            "-" if s.hours is None else f"{s.hours:.3g}",
            *("-" if x is None else f"{x:.3g}" for x in (s.current, s.rms_current) if known),
        ]
        for s in screws
    ]
    return TextTable(head, rows, of="leg")


def hydraulics(found: RobotDescription) -> Chapter:
    """Section on the loads of hydraulic cylinders along the path."""
    words = map(sentence, oil_words(found.oil, found.hydraulics))
    items = [_hydraulic_table(found.hydraulics), *words] if found.hydraulics else []
    return Chapter("Hydraulic cylinders, on the path", items)


def _hydraulic_table(found: Sequence[HydraulicDescription]) -> TextTable:
    head = ["thrust [N]", "pressure [bar]", "flow [l/min]", "least stiffness of the oil [N/um]", "creep [um/s]"]
    rows = [
        [
            f"{x.leg}",
            f"{x.thrust.value:.4g}",
            f"{BAR * x.pressure.value:.3g}",
            f"{LITRES * x.flow.value:.3g}",
            f"{1e-6 * x.stiffness.value:.3g}",
            f"{1e6 * x.creep:.3g}",
        ]
        for x in found
    ]
    return TextTable(head, rows, of="leg")


def _pose(pose: PoseDescription) -> Iterator[Item]:
    if pose.problem:
        yield pose.problem
    if (s := pose.stiffness) is not None:
        direction = ", ".join(f"{round(part, 2) + 0.0:.2f}" for part in s.softest)
        turning = scale([s.turning_least, s.turning_most], "N m/rad")
        yield (
            f"Stiffness at the tool: {text(s.least, 'N/m')} along [{direction}], where it is least, to "
            f"{text(s.most, 'N/m')}; against turning {number(turning.factor * s.turning_least)} to "
            f"{turning.text(s.turning_most)}."
        )
    if pose.rest is not None:
        yield rest_words(pose.rest)
    if pose.parts is not None:
        yield from _parts(pose.parts)
    if any(pose.lost_motion):
        lags = " to ".join(dict.fromkeys(text(lag(pose.lost_motion), "m") for lag in (min, max)))
        yield f"Friction of the drives lets the legs lag by {lags}, to and fro by twice as much."
    if pose.bushings:
        yield bushing_words(np.array([pose.bushings]))
    if pose.modes:
        _, frequencies = column([m.frequency for m in pose.modes], "Hz")
        rows = [[f, f"{100 * m.damping_ratio:.2g}", m.kind] for f, m in zip(frequencies, pose.modes, strict=True)]
        yield TextTable(["frequency [Hz]", "damping [%]", "what moves"], rows, left=(2,))


def _parts(parts: Mapping[str, tuple[float, ...]]) -> Iterator[Item]:
    """Stiffness of every part along every leg, softest first, and all of a leg in series."""
    legs = range(len(next(iter(parts.values()))))
    softness = [sum(1 / values[i] for values in parts.values()) for i in legs]
    whole = [1 / x if x else math.inf for x in softness]
    softest, names = descending_order(-np.array([min(values) for values in parts.values()])), list(parts)
    yield "Stiffness along the legs [N/µm], softest part first, and its share in the leg's compliance:"
    rows = [[name, *(_stiffness_and_share(k, all_) for k, all_ in zip(parts[name], whole, strict=True))]
            for name in (names[i] for i in softest)]  # fmt: skip
    rows.append(["all in series", *("-" if math.isinf(k) else number(k / 1e6, 4) for k in whole)])
    yield TextTable(["", *(f"leg {i}" for i in range(1, len(whole) + 1))], rows)
    if any(math.isinf(k) for values in parts.values() for k in values):
        yield "-: a part that the leg does not have, or that its encoder makes up for."


def _stiffness_and_share(stiffness: float, whole: float) -> str:
    return "-" if math.isinf(stiffness) else f"{number(stiffness / 1e6, 4)} ({100 * whole / stiffness:.0f} %)"


def _vibration(found: ExpectedVibration | None) -> str:
    if found is None:
        return "None that could be estimated."
    band = text(found.band, "m")
    if math.isinf(found.settling):
        when = f"without damping it does not fall below {band}"
    elif found.settling == 0:
        when = f"below {band} at once"
    else:
        when = f"below {band} after {text(found.settling, 's')}"
    if found.left_out is not None:
        when += f"; modes from {found.left_out:.4g} Hz on are left out of it, the motion is too long to sample them"
    return (
        f"About {text(found.amplitude, 'm')} with all modes in phase, {number(100 * found.share, 2)} % of it at "
        f"{found.frequency:.4g} Hz; {when}."
    )


def _actuator(found: ActuatorDescription) -> Iterator[Item]:
    yield f"The beam stays in its hub. A single actuator over {found.duration:.4g} s ({found.fidelity})."
    yield Chapter("Motion", _actuator_motion(found))
    unit, sags = column([beam.sag or math.nan for beam in found.beam], "m")
    length, lengths = column([beam.free_length for beam in found.beam], "m")
    rows = [
        row
        for beam, free, sag in zip(found.beam, lengths, sags, strict=True)
        for row in _rows(beam, free, "no gravity" if sag == "n/a" else sag)
    ]
    head = ["", f"free length [{length}]", "frequencies [Hz]", "damping [%]", "free length / depth"]
    problems = [f"{beam.name}: {beam.problem}" for beam in found.beam if beam.problem]
    yield Chapter("Beam, hub and extension held", [TextTable([*head, f"sag if level [{unit}]"], rows), *problems])
    yield Chapter("Remarks", [Remarks(found.remarks or ("None.",))])


def _actuator_motion(found: ActuatorDescription) -> Iterator[str]:
    if found.angles is not None:
        first, last = (math.degrees(angle) for angle in found.angles)
        yield f"The hub turns from {first:.4g} to {last:.4g} deg."
    if found.elevations is not None:
        first, last = (math.degrees(angle) for angle in found.elevations)
        yield f"Its elevation goes from {first:.4g} to {last:.4g} deg."
    if found.free_lengths is not None:
        low, high = found.free_lengths
        span = f"lies between {low:.4g} and {high:.4g} m" if high > low else f"stays at {low:.4g} m"
        yield f"The free length {span}."
    results = {
        "rotation": ("The hub is driven by a torque: its angle", found.angle_rate, "rad/s"),
        "extension": ("The beam is driven by a force: its length", found.length_rate, "m/s"),
        "elevation": ("The hub is driven by a torque towards Z: its elevation", found.elevation_rate, "rad/s"),
    }
    for words, rate, unit in map(results.__getitem__, found.driven):
        yield f"{words} is a result{f', starting at {rate:.4g} {unit}' if rate else ''}."
    if found.tip_displacement:
        yield f"The tip starts {text(found.tip_displacement, 'm')} off the line, released at rest."
    if found.elevation_displacement:
        yield f"The tip starts {text(found.elevation_displacement, 'm')} above the line, released at rest."


def _rows(beam: BeamDescription, free: str, sag: str) -> list[list[str]]:
    """A row of the table; of a beam with modes of several kinds one more for each kind."""
    slenderness = "n/a" if beam.slenderness is None else f"{beam.slenderness:.3g}"
    kinds = [(f"  {kind}", "", *numbers, "", "") for kind, *numbers in beam.by_kind]
    if len(kinds) > 1:
        return [[beam.name, free, "", "", slenderness, sag], *map(list, kinds)]
    numbers = kinds[0][2:4] if kinds else ("n/a", "n/a")
    return [[beam.name, free, *numbers, slenderness, sag]]
