"""`flexapod map`: frequencies, stiffness, deviations, forces and margins over a line, slice or volume of poses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    USUAL,
    Format,
    Json,
    NoFigures,
    Out,
    Quiet,
    StudyFile,
    as_options,
    parse_formats,
    results_folder,
    robot_study,
)
from flexapod.common.errors import InputError
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis.results.time_history import Report

COMPUTING = 0.7  # share of the bar for the poses; the rest is for figures
_FORM = '"surge=-100..100mm:41"'
X = Annotated[str | None, typer.Option("--x", metavar=_FORM, help="First axis; without range: as far as is reached.")]
Y = Annotated[
    str | None,
    typer.Option("--y", metavar="AXIS", help="Second axis; of neither: surge and heave, or what the robot can do."),
]
Z = Annotated[str | None, typer.Option("--z", metavar="AXIS", help="Third axis of a volume: one panel per value.")]
At = Annotated[
    str | None, typer.Option("--at", metavar='"roll=10deg"', help="Fixed coordinates; the others as at home.")
]
Direction = Annotated[
    str, typer.Option("--direction", metavar="x|y|z|1,0,1", help="Of the force for the stiffness at the tool.")
]
Acceleration = Annotated[
    str | None,
    typer.Option(
        "--acceleration", metavar='"0,0,5"', help="Of the platform, m/s^2; default: 1 m/s^2, worst direction."
    ),
]
Budget = Annotated[
    bool, typer.Option("--budget", help="Also an error budget of each pose: the worst case, and what each part does.")
]
Mode = Annotated[int, typer.Option("--mode", min=1, help="Which natural frequency to show.")]
Count = Annotated[int | None, typer.Option("--count", min=1, help="Points of an axis that names none.")]


@report_failures
def workspace_map(
    file: StudyFile, x: X = None, y: Y = None, z: Z = None, at: At = None, direction: Direction = "z",
    acceleration: Acceleration = None, budget: Budget = False, mode: Mode = 1, count: Count = None, out: Out = None,
    formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Map frequencies, stiffness, deviations, forces and margins over poses: map.nc and figures."""
    from flexapod.analysis.checks.resource_limits import check_map
    from flexapod.app.cli.pose_options import parse_acceleration, parse_at, parse_axes, parse_direction
    from flexapod.design.maps import workspace_map as compute
    from flexapod.design.maps.findings import map_findings
    from flexapod.design.maps.grid import build_grid, usual_axes
    from flexapod.design.maps.maps import FREQUENCIES
    from flexapod.output.text.answers import map_items

    study, drawn = robot_study(file), parse_formats(formats, no_figures)
    axes = parse_axes({"--x": x, "--y": y, "--z": z}, count, usual_axes(study.robot))
    fixed = parse_at(at, axes)
    settings = {"direction": parse_direction(direction), "acceleration": parse_acceleration(acceleration)}
    folder = results_folder(file, "map", out)
    with terminal.progress_bar(quiet=quiet or json) as report:
        with as_options(axes="--x", at="--at", direction="--direction", acceleration="--acceleration"):
            poses, frequencies = build_grid(study.robot, axes, fixed), max(mode, FREQUENCIES)
            check_map(poses.size, frequencies, folder)
            data = compute(
                study, poses.values, at=fixed, frequencies=frequencies, budget=budget, **settings,
                progress=lambda words, share: report(words, COMPUTING * share),
            )  # fmt: skip
        if mode > data.sizes["mode"]:
            raise InputError(
                "is not a mode of this robot", key="--mode", value=mode, allowed=f"1 to {data.sizes['mode']}"
            )
        files = _write(data, folder, mode, report, drawn)
    found = map_findings(data, mode)
    figures = " and a figure of each quantity" if len(files) > 1 else ""
    where = f"In {folder}: map.nc{figures}. ({data.attrs['wall_time']:.2g} s of computation)"
    more = {"wall_time": data.attrs["wall_time"], "folder": folder, "files": files}
    terminal.print_answer(chain(map_items(data, found), [where]), lambda: found.as_dict() | more, json=json)


def _write(data: Dataset, folder: Path, mode: int, report: Report, formats: Sequence[str]) -> list[Path]:
    """The map, and where a format is given a figure of each quantity, of frequencies that of this `mode`."""
    from flexapod.analysis.store import save
    from flexapod.design.maps.findings import scalars_with_values
    from flexapod.output import figures as plot

    report("writing the map", COMPUTING)
    files, names = [save(data, folder / "map.nc")], scalars_with_values(data) if formats else ()
    for k, name in enumerate(names):
        report(f"drawing {name.replace('_', ' ')}", COMPUTING + (1 - COMPUTING) * k / len(names))
        figure, stem = plot.workspace_map(data, name, mode=mode), folder / f"map-{name.replace('_', '-')}"
        files += plot.save(figure, stem, formats=formats)
    return files
