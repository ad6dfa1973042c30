"""The answer of a run on the terminal: sentence, table by axis, warnings, files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.app.outputs import FORMATS
from flexapod.app.terminal import print_table, print_text

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.study.after.summary import RobotSummary

__all__ = ["show_run"]


def show_run(data: Dataset, folder: Path, files: Sequence[Path], warnings: Sequence[str]) -> None:
    """Print what a run found and where it is."""
    from flexapod.study.after.summary import POINT_WORDS, RobotSummary, summaries

    told = summaries(data)
    for found in told:
        print_text(found.sentence)
    for found in told:
        if isinstance(found, RobotSummary):
            print_text()
            _axes(found, POINT_WORDS[found.point])
    for line in warnings:
        print_text(f"Warning: {line}")
    print_text()
    formats = list(dict.fromkeys(path.suffix for path in files if path.suffix[1:] in FORMATS))
    names = ", ".join(path.name for path in files if path.suffix not in formats)
    names = names.replace("report.html", "report.html (open it in a browser)")
    figures = sum(path.suffix in formats for path in files) // max(len(formats), 1)
    kinds = " and ".join(suffix[1:].upper() for suffix in formats)
    drawn = f", {figures} figure{'s' * (figures > 1)} ({kinds})" if figures else ""
    seconds = f"{data.attrs['steps']} steps, {data.attrs['wall_time']:.2g} s"
    print_text(f"In {folder}: {names}{drawn}. ({seconds} of time integration)")


def _axes(found: RobotSummary, name: str) -> None:
    from flexapod.study.words import column

    axes = found.shown_axes
    length, peaks_and_rms = column([*(a.peak for a in axes), *(a.rms for a in axes)], "m")
    count = len(axes)
    travel_unit, travels = column([a.excursion for a in axes], "m")
    _, shares = column([float("nan") if a.per_cent is None else a.per_cent for a in axes], "", 2)
    rows = zip(
        (a.axis for a in axes),
        peaks_and_rms[:count],
        ("n/a" if a.time is None else f"{a.time:.3f}" for a in axes),
        peaks_and_rms[count:],
        travels,
        shares,
        strict=True,
    )
    head = [name, f"peak [{length}]", "at [s]", f"rms [{length}]", f"rigid travel [{travel_unit}]", "peak / travel [%]"]
    print_table(head, [list(row) for row in rows])
