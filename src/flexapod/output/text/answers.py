"""What a run found: for `flexapod run`, for `actuator`, and for the report.

A first robot in words: what was found, and what to think about.

What `flexapod map` says: how much is reached, and where each quantity is least and largest.

What `flexapod modes` says: frequencies, damping and kinds at a pose, and how much disturbances shake it there.

An error in words: what is wrong and with what, what is allowed, the next step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.analysis.description.robot_description import RobotDescription, describe
from flexapod.analysis.error_budget.text import run_counts
from flexapod.analysis.results.bodies import bodies_words
from flexapod.analysis.results.idealizations import held, ideal_words
from flexapod.analysis.results.poses import coordinate_words
from flexapod.analysis.results.summary import POINT_WORDS, RobotSummary, summaries, summary
from flexapod.common.errors import ComputationError, FlexapodError, InputError
from flexapod.common.quantities import column, columns, number, sentence, signed, text
from flexapod.design.maps.findings import Finding, MapFindings, axis_words
from flexapod.model import ActuatorStudy, Study
from flexapod.output.text.parts import Chapter, Item, Remarks, TextTable, warnings_of

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.common.arrays import Array


def told_of(study: Study | ActuatorStudy | None) -> list[str | None]:
    """What of a robot is ideal, and what a run leaves to the budget; None where there is nothing to say."""
    return [ideal_words(study.robot), run_counts(study.robot)] if isinstance(study, Study) else [None, None]


def run_items(study: Study | ActuatorStudy, data: Dataset) -> Iterator[Item]:
    """The answer in sentences, deviations by axis, remarks."""
    told = summaries(data)
    yield from (*(found.sentence for found in told), *bodies_words(data))
    for found in told:
        if isinstance(found, RobotSummary):
            yield ""
            yield axes_table(found)
    yield from filter(None, told_of(study))
    yield Remarks(warnings_of(data), "Warning: ")


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
    ideal, counts = told_of(study)
    state = {name: data.attrs[name] for name in ("failure", "time_reached") if name in data.attrs}
    return {
        "summary": summary(data).as_dict(),
        "partial": bool(data.attrs["partial"]),
        **state,
        "ideal": ideal,
        "counts": counts,
        "warnings": warnings_of(data),
        "wall_time": data.attrs["wall_time"],
        "steps": int(data.attrs["steps"]),
    }


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
    yield from map("Warning: {}".format, warnings_of(data))


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
    """Where the modes are, a table of the lowest `count`, how disturbances have `shaken` the robot, warnings."""
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
    yield from map("Warning: {}".format, warnings_of(data))


def _held(study: model.Study | model.ActuatorStudy, data: Dataset, pose: str | None) -> str:
    if isinstance(study, model.ActuatorStudy):
        free = study.actuator.free_length
        return f"Hub and extension held, about the straight beam, {free:.4g} m of it outside the hub"
    where = f"at {pose} from home" if pose else "at home"
    rest = f"about the static equilibrium (the centre of mass is off by {signed(data.com_sag.values)})"
    return f"{held(study.robot)}, {where}, {rest}"


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
        "warnings": warnings_of(data),
        "files": files,
    }


def parts_of(error: FlexapodError) -> dict[str, str | None]:
    """The parts of an error by name: `kind`, `what`, and where given `file`, `key`, `value`, `allowed`, `next_step`."""
    if isinstance(error, InputError):
        return {"kind": "input", **error.as_dict()}
    if isinstance(error, ComputationError):
        return {"kind": "computation", "what": error.what, "next_step": error.next_step}
    return {"kind": "computation", "what": str(error)}


def lines_of(parts: Mapping[str, str | None]) -> list[str]:
    """An error in words: what is wrong and with what, then a line each for file, what is allowed and the next step."""
    named = ("allowed", "next_step") if not parts.get("key") else ("file", "allowed", "next_step")
    return [_headline(parts), *(f"  {name.replace('_', ' '):11s}{parts[name]}" for name in named if parts.get(name))]


def _headline(parts: Mapping[str, str | None]) -> str:
    """Key and value, else the file, and what is wrong with it."""
    place = parts.get("key") or parts.get("file")
    if parts.get("key") and parts.get("value") is not None:
        place = f"{place} = {parts['value']}"
    return f"Error: {place}: {parts['what']}" if place else f"Error: {parts['what']}"
