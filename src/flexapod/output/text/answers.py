"""Answers as text: results of runs, a first robot, maps, modes, errors.

Those of runs are for `flexapod run`, `actuator` and the report. A map states how much is reached and where each
quantity is least and largest; modes state frequencies, damping, kinds and the vibration by disturbances; an
error states what is wrong and with what, what is allowed, and the next step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.description.robot_description import RobotDescription, describe
from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.analysis.results.idealizations import idealization, soft_drives
from flexapod.analysis.results.poses import coordinate_words
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.summary import POINT_WORDS, RobotSummary, summaries, summary
from flexapod.common.quantities import column, columns, number, sentence, signed_components, text
from flexapod.common.ranking import EQUALS, first_least
from flexapod.design.maps.findings import Finding, MapFindings, axis_words
from flexapod.model import ActuatorStudy, Robot, Study
from flexapod.output.text.description import bushing_words, ideal_words, locked_drive_words, rest_words
from flexapod.output.text.parts import Chapter, Item, Remarks, TextTable, warning_lines

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.common.arrays import Array


def idealization_remarks(study: Study | ActuatorStudy | None) -> list[str | None]:
    """Remarks on ideal parts of a robot, and on what a run leaves to the budget; None where there is none."""
    if not isinstance(study, Study):
        return [None, None]
    return [ideal_words(idealization(study.robot)), run_counts(study.robot)]


def run_counts(robot: Robot) -> str | None:
    """Sentence on the parts that a run counts, and those that it leaves to the budget; None where it leaves nothing."""
    rubs = any(x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive))
    others = {
        "tolerances": robot.tolerances is not None,
        "play": bool(half_play(robot).any()),
        "what friction leaves behind": rubs,
    }
    named = [name for name, there in others.items() if there]
    if not named or robot.platform_fixed:
        return None
    listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
    warm = "" if robot.heat is None else "warm, "
    return f"Counted: one machine as drawn, {warm}under load and in motion; {listed}: flexapod budget."


def run_items(study: Study | ActuatorStudy, data: Dataset) -> Iterator[Item]:
    """The answer in sentences, deviations by axis, remarks."""
    told = summaries(data)
    yield from (*(found.sentence for found in told), *bodies_words(data))
    for found in told:
        if isinstance(found, RobotSummary):
            yield ""
            yield axes_table(found)
    yield from filter(None, idealization_remarks(study))
    yield Remarks(warning_lines(data), "Warning: ")


def bodies_words(data: Dataset) -> list[str]:
    """Sentences on a result: the joint with the least angle left, the least distance of legs, what bushings bear."""
    said = []
    if "joint_margin" in data:
        left = data.joint_margin.values
        k, leg, end = np.unravel_index(first_least(left), left.shape)
        said.append(left_words(float(left[k, leg, end]), int(leg) + 1, data.end.values[end], float(data.time[k])))
    if "leg_clearance" in data:
        k = first_least(data.leg_clearance.values, EQUALS)
        said.append(gap_words(float(data.leg_clearance[k]), data.nearest_legs.values[k], float(data.time[k])))
    if "guide_force" in data:
        said.append(bushing_words(np.linalg.norm(data.guide_force.values, axis=-1), data.time.values))
    return said


def left_words(left: float, leg: int, end: str, time: float) -> str:
    """The joint with the least angle left."""
    what = "are left of" if left >= 0 else "are missing to"
    return (
        f"{np.rad2deg(abs(left)):.3g} deg {what} the angle of the {end} joint of leg {leg} at t = {time:.4g} s, "
        "the least of all joints."
    )


def gap_words(gap: float, legs: Array, time: float) -> str:
    """The two legs nearest to each other."""
    one, other = legs
    if gap < 0:
        return sentence(remark("legs overlap", one=one, other=other, overlap=-gap, time=time))
    at = f"at t = {time:.4g} s"
    return f"Legs {one} and {other} come nearest to each other {at}: {text(gap, 'm', 3)} are between them."


def axes_table(found: RobotSummary) -> TextTable:
    """Deviation by axis, in columns of one unit."""
    axes = found.shown_axes
    length, peaks, rms = columns("m", [a.peak for a in axes], [a.rms for a in axes])
    travel_unit, travels = column([a.excursion for a in axes], "m")
    times = ["n/a" if a.time is None else f"{a.time:.3f}" for a in axes]
    shares = ["n/a" if a.per_cent is None else number(a.per_cent, 2) for a in axes]
    head = [POINT_WORDS[found.point], f"peak [{length}]", "at [s]", f"rms [{length}]"]
    head += [f"rigid travel [{travel_unit}]", "peak / travel [%]"]
    return TextTable(head, list(zip((a.axis for a in axes), peaks, times, rms, travels, shares, strict=True)))


def distances_table(found: RobotSummary) -> TextTable:
    """Deviation by axis and its distance, each number in the unit in which it reads well."""
    rows = [
        (
            a.axis.upper(),
            text(a.peak, "m") if a.peak else "0",
            "n/a" if a.time is None else f"{a.time:.3f} s",
            text(a.rms, "m") if a.rms else "0",
            text(a.excursion, "m", 4) if a.excursion else "0",
            "n/a" if a.per_cent is None else f"{number(a.per_cent, 2)} %",
        )
        for a in found.shown_axes
    ]
    rows.append(("Distance", text(found.peak, "m"), f"{found.time:.3f} s", text(found.rms, "m"), "", ""))
    return TextTable(("Axis", "Largest", "at", "rms", "Rigid travel", "Per cent of the travel"), rows)


def run_as_dict(study: Study | ActuatorStudy, data: Dataset) -> dict[str, object]:
    """A run as plain data."""
    ideal, counts = idealization_remarks(study)
    state = {name: data.attrs[name] for name in ("failure", "time_reached") if name in data.attrs}
    return {
        "summary": summary(data).as_dict(),
        "partial": bool(data.attrs["partial"]),
        **state,
        "ideal": ideal,
        "counts": counts,
        "warnings": warning_lines(data),
        "wall_time": data.attrs["wall_time"],
        "steps": int(data.attrs["steps"]),
    }


HEAVY = 1.0  # mass of the legs over that of the payload above which it is remarked on
MACHINE = 3.0  # the same of legs with screws or oil, which are sized for stiffness


def first_robot_sentences(written: str) -> list[str]:
    """Sentences on the study of a first robot, given as the text of its file."""
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
    if start.rest is not None and start.modes:
        first = start.modes[0]
        rest = rest_words(start.rest).rstrip(".")
        bears += f". {rest}; the lowest frequency is {first.frequency:.3g} Hz ({first.kind})"
    return [*lines, f"{bears}."]


def _heavy(robot: model.Robot) -> list[str]:
    legs = sum(leg.piston.mass + leg.cylinder.mass for leg in robot.legs)
    exact = robot.legs[0].drive.type == "prescribed"
    if legs <= (HEAVY if exact else MACHINE) * robot.payload.mass:
        return []
    advice = "thinner, hollow or lighter pistons would do (diameter, material)" if exact else "a smaller robot would do"
    words = f"the legs weigh {number(legs)} kg, more than the payload of {number(robot.payload.mass)} kg"
    return [f"{words}: {advice}"]


FIRST = ("frequency", "stiffness_least")  # what is said in a sentence, too


def map_items(data: Dataset, found: MapFindings) -> Iterator[Item]:
    """A map in sentences and as a table."""
    share = f"{found.reached} of {found.poses} poses are reached ({100 * found.reached / found.poses:.3g} %)"
    reasons = sorted(found.reasons.items(), key=lambda item: -item[1])
    yield Chapter(f"{share}: {axis_words(data)}.", [f"{count}: {words}" for words, count in reasons], close=True)
    if not found.quantities:
        yield "Nothing to map: choose other ranges or fixed coordinates."
    yield from (_sentence(quantity) for name in FIRST for quantity in found.quantities if quantity.name == name)
    yield ""
    if found.quantities:
        head = ["", "unit", "least", "at", "largest", "at", "home"]
        yield TextTable(head, list(map(_row, found.quantities)), left=(0, 1, 3, 5))
    yield from map("Warning: {}".format, warning_lines(data))


def _sentence(found: Finding) -> str:
    words = found.words[0].upper() + found.words[1:]
    return (
        f"{words}: {text(found.least, found.unit)} to {text(found.largest, found.unit)}; "
        f"least at {coordinate_words(found.least_at)}."
    )


def _row(found: Finding) -> list[str]:
    home = math.nan if found.home is None else found.home
    unit, (least, largest, at_home) = column([found.least, found.largest, home], found.unit)
    ends = (least, coordinate_words(found.least_at), largest, coordinate_words(found.largest_at))
    return [found.words, unit, *ends, "" if found.home is None else at_home]


def modes_items(
    study: model.Study | model.ActuatorStudy, data: Dataset, pose: str | None, count: int, shaken: Sequence[str]
) -> Iterator[Item]:
    """Pose of the modes, a table of the lowest `count`, sentences `shaken` on vibration by disturbances, warnings."""
    yield f"{_held(study, data, pose)}."
    yield ""
    shown = data.isel(mode=slice(0, count))
    _, frequencies = column(shown.frequency.values, "Hz", 6)
    _, ratios = column(100 * shown.damping_ratio.values, "")
    head, columns = ["mode", "frequency [Hz]", "damping [%]"], [frequencies, ratios]
    if "payload_share" in shown:  # of a robot
        head += ["of the payload [%]", "of the legs [%]"]
        columns += [_per_cent(shown.payload_share.values), _per_cent(shown.leg_share.values.sum(axis=-1))]
    rows = zip(map(str, shown.mode.values), *columns, map(str, shown.kind.values), strict=True)
    yield TextTable([*head, "what moves most, by its kinetic energy"], list(rows), left=(len(head),))
    if data.sizes["mode"] > count:
        yield f"The lowest {count} of {data.sizes['mode']} modes; more with --count."
    yield from map(sentence, shaken)
    yield from map("Warning: {}".format, warning_lines(data))


def _held(study: model.Study | model.ActuatorStudy, data: Dataset, pose: str | None) -> str:
    if isinstance(study, model.ActuatorStudy):
        free = study.actuator.free_length
        return f"Hub and extension held, about the straight beam, {free:.4g} m of it outside the hub"
    where = f"at {pose} from home" if pose else "at home"
    rest = f"about the static equilibrium (the centre of mass is off by {signed_components(data.com_sag.values)})"
    return f"{locked_drive_words(soft_drives(study.robot))}, {where}, {rest}"


def _per_cent(shares: Array) -> list[str]:
    return [f"{100 * abs(share):.0f}" for share in shares]


def modes_as_dict(data: Dataset, shaken: Dataset | None, files: Sequence[Path]) -> dict[str, object]:
    """Modes as plain data, with what vibrates by disturbances."""
    names = [name for name in ("mode", "frequency", "damping_ratio", "kind", "payload_share") if name in data.variables]
    columns = [data[name].values.tolist() for name in names]
    return {
        "modes": [dict(zip(names, mode, strict=True)) for mode in zip(*columns, strict=True)],
        **({"com_sag": data.com_sag.values.tolist()} if "com_sag" in data else {}),
        **({} if shaken is None else {"vibration_rms": shaken.vibration_rms.values.tolist()}),
        "warnings": warning_lines(data),
        "files": files,
    }
