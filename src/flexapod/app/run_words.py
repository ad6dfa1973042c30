"""The answer of a run on the terminal: sentence, table by axis, warnings, files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.app.outputs import FORMATS
from flexapod.app.terminal import print_table, print_text

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.study.summary import RobotSummary

__all__ = ["show_run"]


def show_run(data: Dataset, folder: Path, files: Sequence[Path], warnings: Sequence[str]) -> None:
    """Print what a run found and where it is."""
    from flexapod.study.summary import POINT_WORDS, RobotSummary, summaries

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
    figures = sum(path.suffix in formats for path in files) // max(len(formats), 1)
    kinds = " and ".join(suffix[1:].upper() for suffix in formats)
    drawn = f", {figures} figure{'s' * (figures > 1)} ({kinds})" if figures else ""
    seconds = f"{data.attrs['steps']} steps, {data.attrs['wall_time']:.2g} s"
    print_text(f"In {folder}: {names}{drawn}. ({seconds} of time integration)")


def _axes(found: RobotSummary, name: str) -> None:
    from flexapod.study.words import text

    rows = [
        [
            a.axis,
            text(a.peak, "m"),
            f"{a.time:.4g} s",
            text(a.rms, "m"),
            text(a.excursion, "m", 4),
            "n/a" if a.per_cent is None else f"{a.per_cent:.2g} %",
        ]
        for a in found.axes
    ]
    print_table([name, "peak", "at", "rms", "rigid travel", "peak / travel"], rows)
