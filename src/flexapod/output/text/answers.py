"""What a run found: for `flexapod run`, for `actuator`, and for the report."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from flexapod.analysis.error_budget.counted import run_counts
from flexapod.analysis.results.bodies import bodies_words
from flexapod.analysis.results.idealizations import ideal_words
from flexapod.analysis.results.summary import POINT_WORDS, RobotSummary, summaries, summary
from flexapod.common.quantities import column, columns, number, text
from flexapod.model import ActuatorStudy, Study
from flexapod.output.text.parts import Item, Remarks, TextTable, warnings_of

if TYPE_CHECKING:
    from xarray import Dataset


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
