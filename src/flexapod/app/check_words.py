"""What `flexapod check` says of a robot and of a single actuator, and `flexapod new` of a first robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexapod.app.terminal import print_remarks, print_table, print_text
from flexapod.study.after.inside import bushing_words
from flexapod.study.before.describe.hydraulic import hydraulic_table
from flexapod.study.before.describe.screw import screw_table
from flexapod.study.words import column, number, scale, text
from flexapod.ties import most, ranked

if TYPE_CHECKING:
    from flexapod.study.before.describe.actuator import ActuatorDescription, BeamDescription
    from flexapod.study.before.describe.leg import Extreme
    from flexapod.study.before.describe.robot import PoseDescription, RobotDescription, VibrationToExpect

SHOWN_ANGLE = math.radians(60)


def show_robot(found: RobotDescription, *, verbose: bool = False) -> None:
    """Print a description in sections; `verbose`: with what explains remarks."""
    print_text(
        f"The path keeps all limits. The motion takes {found.motion_end:.4g} s, the simulation {found.duration:.4g} s "
        f"({found.fidelity}). Estimates from the rigid path:"
    )
    _motions(found)
    _lengths(found)
    _carriages(found)
    _angles(found)
    _bodies(found)
    _singularity(found)
    _loads(found)
    _screws(found)
    _hydraulics(found)
    if found.losses:
        _heading("Loss factors, made viscous at home")
        for sentence in found.losses:
            print_text(f"{sentence}.", indent=2)
    for pose in found.poses:
        _pose(pose, found.held)
    _vibration(found.vibration)
    for title, sentences in (("The machine as built", found.accuracy), ("Disturbances", found.disturbances)):
        if sentences:
            _heading(title)
        for sentence in sentences:
            print_text(f"{sentence[0].upper()}{sentence[1:]}.", indent=2)
    _heading("Remarks")
    if found.ideal:
        print_text(found.ideal, indent=2)
    if found.remarks or not found.ideal:
        print_remarks(found.remarks or ("None.",), verbose=verbose, indent=2)


def _heading(title: str) -> None:
    print_text()
    print_text(title)


def _motions(found: RobotDescription) -> None:
    _heading("Motions of the rigid robot")
    for sentence in found.motions:
        print_text(f"{sentence[0].upper()}{sentence[1:]}.", indent=2)


def _lengths(found: RobotDescription) -> None:
    _heading("Lengths, joint to joint")
    rows = [
        [
            f"  leg {leg.leg}",
            _at(leg.shortest),
            _at(leg.longest),
            "no limits" if leg.stroke_margin is None else _at(leg.stroke_margin),
            "strut" if leg.guided is None else f"{1e3 * leg.guided.value:.2f}",
            f"{leg.slenderness:.1f}",
        ]
        for leg in found.legs
    ]
    header = ["", "shortest [mm]", "longest [mm]", "stroke left [mm]", "in cylinder [mm]", "free length / width"]
    print_table(header, rows)
    limited = [(leg.stroke_margin.value, leg) for leg in found.legs if leg.stroke_margin is not None]
    if limited:
        margin, leg = most(limited, key=lambda entry: -entry[0])
        low, high = leg.stroke or (0.0, 0.0)
        print_text(
            f"Leg {leg.leg} comes nearest to its limits of {1e3 * low:.4g} and {1e3 * high:.4g} mm: {1e3 * margin:.2f} "
            "mm are left.",
            indent=2,
        )


def _carriages(found: RobotDescription) -> None:
    ways = [(leg.leg, leg.carriage) for leg in found.legs if leg.carriage is not None]
    if not ways:
        return
    turns = ways[0][1].kind == "crank"
    unit, factor = ("deg", 180 / math.pi) if turns else ("mm", 1e3)
    _heading("Cranks" if turns else "Carriages")
    rows = []
    for leg, way in ways:
        extremes = (way.low, way.high, way.margin)
        rows.append([f"  leg {leg}", *("no limits" if e is None else _at(e, factor) for e in extremes)])
    print_table(["", f"least [{unit}]", f"largest [{unit}]", f"travel left [{unit}]"], rows)


def _angles(found: RobotDescription) -> None:
    """Angles of joints that come near their limit of 85 deg; those of universal joints of six legs UPS go unsaid."""
    least = {"universal joint": SHOWN_ANGLE}
    shown = [a for a in found.angles if a.largest.value > least.get(a.joint, 1e-3)]
    if not shown:
        return
    _heading("Largest angles (limit 85 deg)")
    for angle in shown:
        words = "between carriage and leg" if angle.joint == "carriage" else f"of the {angle.joint}"
        degrees = math.degrees(angle.largest.value)
        print_text(f"{degrees:.1f} deg {words} of leg {angle.leg} at t = {angle.largest.time:.3f} s.", indent=2)


def _bodies(found: RobotDescription) -> None:
    _heading("Joints and room between legs")
    for turn in found.turns:
        value, limit = math.degrees(turn.largest.value), turn.limit
        left = (
            "" if limit is None else f", of {math.degrees(limit):.4g} deg: {math.degrees(limit) - value:.2f} are left"
        )
        at = f"leg {turn.leg} at t = {turn.largest.time:.3f} s"
        print_text(f"Joints at the {turn.end} turn from home by up to {value:.2f} deg ({at}){left}.", indent=2)
    if found.clearance is not None:
        (one, other), least = found.clearance.legs, found.clearance.least
        print_text(
            f"Legs {one} and {other} come nearest to each other: {text(least.value, 'm', 3)} are between them at "
            f"t = {least.time:.3f} s, at home {text(found.clearance.home, 'm', 3)} between the nearest.",
            indent=2,
        )
    for end in found.stroke_ends:
        words = (f"base {math.degrees(end.base):.2f} deg", f"platform {math.degrees(end.platform):.2f} deg")
        left = () if end.margin is None else (f"{math.degrees(end.margin):.2f} deg are left at least",)
        room = () if end.gap is None else (f"{text(end.gap, 'm', 3)} between the nearest legs",)
        name = "shortest" if end.shortest else "longest"
        print_text(f"With all legs at their {name}: {', '.join((*words, *left, *room))}.", indent=2)


def _at(extreme: Extreme, factor: float = 1e3) -> str:
    return f"{factor * extreme.value + 0.0:.2f} at {extreme.time:.3f} s"


def _singularity(found: RobotDescription) -> None:
    s = found.singularity
    if s is None:
        return
    _heading("Distance to a singularity (scaled Jacobian)")
    print_text(
        f"Smallest singular value {s.smallest_singular_value:.3g}, condition {s.condition:.3g} at t = {s.time:.3f} s; "
        f"at home {s.home_smallest_singular_value:.3g} and {s.home_condition:.3g}. "
        "An error of the legs' lengths reaches the platform up to "
        f"{1 / s.smallest_singular_value:.3g} times as large.",
        indent=2,
    )


def _loads(found: RobotDescription) -> None:
    _heading("Loads (+ pushes)")
    count = len(found.legs)
    of_drives = [*(leg.force_min.value for leg in found.legs), *(leg.force_max.value for leg in found.legs)]
    unit, forces = column(of_drives, "N m" if any(leg.drive == "crank" for leg in found.legs) else "N")
    _, shares = column([100 * leg.euler_share.value for leg in found.legs], "", 3)
    times = [f" at {leg.euler_share.time:.3f} s" for leg in found.legs]
    pushed_words = [
        "never pushed" if leg.euler_share.value == 0 else share + time
        for leg, share, time in zip(found.legs, shares, times, strict=True)
    ]
    pressure, *stresses = _stresses(found)
    names = [f"  leg {leg.leg}" for leg in found.legs]
    rows = zip(names, forces[:count], forces[count:], pushed_words, *stresses, strict=True)
    header = ["", f"least [{unit}]", f"largest [{unit}]", "of Euler load [%]", *pressure]
    print_table(header, [list(row) for row in rows])
    pushed = most(found.legs, key=lambda leg: leg.euler_share.value)
    if pushed.euler_share.value > 0:
        print_text(
            f"Leg {pushed.leg} comes nearest to buckling: {1 / pushed.euler_share.value:.3g} times its load would "
            f"do it (Euler load {text(pushed.euler_load, 'N')}).",
            indent=2,
        )
    known = [(leg.stress, leg.leg) for leg in found.legs if leg.stress is not None]
    if not known:
        print_text("No stresses: the section or the material of the legs is not given.", indent=2)
        return
    stress, number = most(known, key=lambda entry: entry[0].total.value)
    limit = "" if stress.yield_stress is None else f", {100 * stress.total.value / stress.yield_stress:.2g} % of yield"
    print_text(f"Leg {number} is stressed most: {text(stress.total.value, 'Pa')}{limit}.", indent=2)


def _stresses(found: RobotDescription) -> tuple[list[str], list[str], list[str], list[str]]:
    """Heads and columns of axial stress, bending stress and their sum."""
    known = [(s.axial, s.bending, s.total.value) if (s := leg.stress) else (math.nan,) * 3 for leg in found.legs]
    unit, flat = column([value for stresses in known for value in stresses], "Pa")
    return [f"axial [{unit}]", f"bending [{unit}]", f"together [{unit}]"], flat[0::3], flat[1::3], flat[2::3]


def _screws(found: RobotDescription) -> None:
    if not found.screws:
        return
    _heading("Screws, largest values on the path")
    head, rows = screw_table(found.screws)
    print_table(["", *head], [[f"  leg {s.leg}", *row] for s, row in zip(found.screws, rows, strict=True)])
    print_text(f"{found.back[0].upper()}{found.back[1:]}.", indent=2)


def _hydraulics(found: RobotDescription) -> None:
    if not found.hydraulics:
        return
    _heading("Hydraulic cylinders, on the path")
    head, rows = hydraulic_table(found.hydraulics)
    print_table(["", *head], [[f"  leg {x.leg}", *row] for x, row in zip(found.hydraulics, rows, strict=True)])
    for sentence in found.oil:
        print_text(f"{sentence[0].upper()}{sentence[1:]}.", indent=2)


def _pose(pose: PoseDescription, held: str) -> None:
    _heading(f"{held}, {pose.name} (t = {pose.time:.3f} s)")
    if pose.problem:
        print_text(pose.problem, indent=2)
    if pose.stiffness is not None:
        s = pose.stiffness
        direction = ", ".join(f"{round(part, 2) + 0.0:.2f}" for part in s.softest)
        turning = scale([s.turning_least, s.turning_most], "N m/rad")
        print_text(
            f"Stiffness at the tool: {text(s.least, 'N/m')} along [{direction}], where it is least, to "
            f"{text(s.most, 'N/m')}; against turning {number(turning.factor * s.turning_least)} to "
            f"{turning.text(s.turning_most)}.",
            indent=2,
        )
    if pose.rest:
        print_text(pose.rest, indent=2)
    if pose.parts is not None:
        _parts(pose.parts)
    if any(pose.lost_motion):
        lags = " to ".join(dict.fromkeys(text(lag(pose.lost_motion), "m") for lag in (min, max)))
        print_text(f"Friction of the drives lets the legs lag by {lags}, to and fro by twice as much.", indent=2)
    if pose.bushings:
        print_text(bushing_words(np.array([pose.bushings])), indent=2)
    if pose.modes:
        _, frequencies = column([m.frequency for m in pose.modes], "Hz")
        rows = [
            [f"  {f}", f"{100 * m.damping_ratio:.2g}", m.kind] for f, m in zip(frequencies, pose.modes, strict=True)
        ]
        print_table(["  frequency [Hz]", "damping [%]", "what moves"], rows, left=(2,))


def _parts(parts: Mapping[str, tuple[float, ...]]) -> None:
    """Stiffness of every part along every leg, softest first, and all of a leg in series."""
    legs = range(len(next(iter(parts.values()))))
    softness = [sum(1 / values[i] for values in parts.values()) for i in legs]
    whole = [1 / x if x else math.inf for x in softness]
    softest, names = ranked(-np.array([min(values) for values in parts.values()])), list(parts)
    print_text("Stiffness along the legs [N/µm], softest part first, and its share in the leg's compliance:", indent=2)
    rows = [[f"  {name}", *(_stiffness_and_share(k, all_) for k, all_ in zip(parts[name], whole, strict=True))]
            for name in (names[i] for i in softest)]  # fmt: skip
    rows.append(["  all in series", *("-" if math.isinf(k) else number(k / 1e6, 4) for k in whole)])
    print_table(["", *(f"leg {i}" for i in range(1, len(whole) + 1))], rows)
    if any(math.isinf(k) for values in parts.values() for k in values):
        print_text("-: a part that the leg does not have, or that its encoder makes up for.", indent=2)


def _stiffness_and_share(stiffness: float, whole: float) -> str:
    return "-" if math.isinf(stiffness) else f"{number(stiffness / 1e6, 4)} ({100 * whole / stiffness:.0f} %)"


def _vibration(found: VibrationToExpect | None) -> None:
    _heading("Vibration to expect after the motion, at the tool")
    if found is None:
        print_text("None that could be estimated.", indent=2)
        return
    band = text(found.band, "m")
    if math.isinf(found.settling):
        when = f"without damping it does not fall below {band}"
    elif found.settling == 0:
        when = f"below {band} at once"
    else:
        when = f"below {band} after {text(found.settling, 's')}"
    if found.left_out is not None:
        when += f"; modes from {found.left_out:.4g} Hz on are left out of it, the motion is too long to sample them"
    print_text(
        f"About {text(found.amplitude, 'm')} with all modes in phase, {number(100 * found.share, 2)} % of it at "
        f"{found.frequency:.4g} Hz; {when}.",
        indent=2,
    )


def show_actuator(found: ActuatorDescription, *, verbose: bool = False) -> None:
    """Print a description in sections; `verbose`: with what explains remarks."""
    print_text(f"The beam stays in its hub. A single actuator over {found.duration:.4g} s ({found.fidelity}).")
    print_text()
    print_text("Motion")
    for line in _actuator_motion(found):
        print_text(line, indent=2)
    print_text()
    print_text("Beam, hub and extension held")
    unit, sags = column([beam.sag or math.nan for beam in found.beam], "m")
    length, lengths = column([beam.free_length for beam in found.beam], "m")
    header = [
        "",
        f"free length [{length}]",
        "frequencies [Hz]",
        "damping [%]",
        "free length / depth",
        f"sag if level [{unit}]",
    ]
    rows = [
        row
        for beam, free, sag in zip(found.beam, lengths, sags, strict=True)
        for row in _rows(beam, free, "no gravity" if sag == "n/a" else sag)
    ]
    print_table(header, rows)
    for beam in found.beam:
        if beam.problem:
            print_text(f"{beam.name}: {beam.problem}", indent=2)
    print_text()
    print_text("Remarks")
    print_remarks(found.remarks or ("None.",), verbose=verbose, indent=2)


def _actuator_motion(found: ActuatorDescription) -> list[str]:
    lines = []
    if found.angles is not None:
        first, last = (math.degrees(angle) for angle in found.angles)
        lines.append(f"The hub turns from {first:.4g} to {last:.4g} deg.")
    if found.elevations is not None:
        first, last = (math.degrees(angle) for angle in found.elevations)
        lines.append(f"Its elevation goes from {first:.4g} to {last:.4g} deg.")
    if found.free_lengths is not None:
        low, high = found.free_lengths
        span = f"lies between {low:.4g} and {high:.4g} m" if high > low else f"stays at {low:.4g} m"
        lines.append(f"The free length {span}.")
    names = {
        "rotation": "The hub is driven by a torque: its angle",
        "extension": "The beam is driven by a force: its length",
        "elevation": "The hub is driven by a torque towards Z: its elevation",
    }
    rates = {"rotation": (found.angle_rate, "rad/s"), "extension": (found.length_rate, "m/s")}
    rates["elevation"] = (found.elevation_rate, "rad/s")
    for name in found.driven:
        rate, unit = rates[name]
        lines.append(f"{names[name]} is a result{f', starting at {rate:.4g} {unit}' if rate else ''}.")
    if found.tip_displacement:
        lines.append(f"The tip starts {text(found.tip_displacement, 'm')} off the line, released at rest.")
    if found.elevation_displacement:
        lines.append(f"The tip starts {text(found.elevation_displacement, 'm')} above the line, released at rest.")
    return lines


def _rows(beam: BeamDescription, free: str, sag: str) -> list[list[str]]:
    """A row of the table; of a beam with modes of several kinds one more for each kind."""
    slenderness = "n/a" if beam.slenderness is None else f"{beam.slenderness:.3g}"
    kinds = [(f"    {kind}", "", *numbers, "", "") for kind, *numbers in beam.by_kind]
    if len(kinds) > 1:
        return [[f"  {beam.name}", free, "", "", slenderness, sag], *map(list, kinds)]
    numbers = kinds[0][2:4] if kinds else ("n/a", "n/a")
    return [[f"  {beam.name}", free, *numbers, slenderness, sag]]
