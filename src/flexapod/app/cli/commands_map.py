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
    Settings,
    StudyFile,
    as_options,
    parse_formats,
    results_folder,
    robot_study,
)
from flexapod.common.errors import InputError
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis import store
    from flexapod.analysis.checks import resource_limits
    from flexapod.analysis.results.time_history import Report
    from flexapod.app.cli import pose_options
    from flexapod.design import maps
    from flexapod.design.maps import findings, grid
    from flexapod.design.maps import maps as maps_maps
    from flexapod.output import figures as output_figures
    from flexapod.output.text import answers
    from flexapod.output.text import verdict as text_verdict
else:
    resource_limits = LazyModule("flexapod.analysis.checks.resource_limits")
    store = LazyModule("flexapod.analysis.store")
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    maps = LazyModule("flexapod.design.maps")
    findings = LazyModule("flexapod.design.maps.findings")
    grid = LazyModule("flexapod.design.maps.grid")
    maps_maps = LazyModule("flexapod.design.maps.maps")
    output_figures = LazyModule("flexapod.output.figures")
    answers = LazyModule("flexapod.output.text.answers")
    text_verdict = LazyModule("flexapod.output.text.verdict")

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
    file: StudyFile, settings: Settings = None, x: X = None, y: Y = None, z: Z = None, at: At = None,
    direction: Direction = "z", acceleration: Acceleration = None, budget: Budget = False, mode: Mode = 1,
    count: Count = None, out: Out = None, formats: Format = USUAL, no_figures: NoFigures = False,
    json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Map frequencies, stiffness, deviations, forces and margins over poses: map.nc and figures."""
    study, drawn = robot_study(file, settings), parse_formats(formats, no_figures)
    axes = pose_options.parse_axes({"--x": x, "--y": y, "--z": z}, count, grid.usual_axes(study.robot))
    fixed = pose_options.parse_at(at, axes)
    load = {
        "direction": pose_options.parse_direction(direction),
        "acceleration": pose_options.parse_acceleration(acceleration),
    }
    folder = results_folder(file, "map", out)
    verdict = text_verdict.study_verdict(study)
    with terminal.progress_bar(quiet=quiet or json) as report:
        with as_options(axes="--x", at="--at", direction="--direction", acceleration="--acceleration"):
            poses, frequencies = grid.build_grid(study.robot, axes, fixed), max(mode, maps_maps.FREQUENCIES)
            resource_limits.check_map(poses.size, frequencies, folder)
            data = maps.workspace_map(
                study, poses.values, at=fixed, frequencies=frequencies, budget=budget, **load,
                progress=lambda words, share: report(words, COMPUTING * share),
            )  # fmt: skip
        if mode > data.sizes["mode"]:
            raise InputError(
                "is not a mode of this robot", key="--mode", value=mode, allowed=f"1 to {data.sizes['mode']}"
            )
        files = _write(data, folder, mode, report, drawn)
    found = findings.map_findings(data, mode)
    figures = " and a figure of each quantity" if len(files) > 1 else ""
    where = f"In {folder}: map.nc{figures}. ({data.attrs['wall_time']:.2g} s of computation)"
    more = {"wall_time": data.attrs["wall_time"], "folder": folder, "files": files}
    items = chain(text_verdict.verdict_items(verdict), answers.map_items(data, found), [where])
    more |= text_verdict.verdict_as_dict(verdict)
    terminal.print_answer(items, lambda: found.as_dict() | more, json=json)


def _write(data: Dataset, folder: Path, mode: int, report: Report, formats: Sequence[str]) -> list[Path]:
    """The map, and where a format is given a figure of each quantity, of frequencies that of this `mode`."""
    report("writing the map", COMPUTING)
    files, names = [store.save(data, folder / "map.nc")], findings.scalars_with_values(data) if formats else ()
    for k, name in enumerate(names):
        report(f"drawing {name.replace('_', ' ')}", COMPUTING + (1 - COMPUTING) * k / len(names))
        figure, stem = output_figures.workspace_map(data, name, mode=mode), folder / f"map-{name.replace('_', '-')}"
        files += output_figures.save(figure, stem, formats=formats)
    return files
