"""`flexapod map`: frequencies, stiffness, deviations, forces and margins over a line, slice or volume of poses."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app import terminal
from flexapod.app.failures import guarded
from flexapod.app.options import Json, NoFigures, Out, Quiet, StudyFile, as_options, results_folder, robot_study
from flexapod.app.terminal import print_json, print_table, print_text
from flexapod.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.study.record import Report
    from flexapod.surveys.workspace.findings import Finding, MapFindings

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


@guarded
def workspace_map(
    file: StudyFile, x: X = None, y: Y = None, z: Z = None, at: At = None, direction: Direction = "z",
    acceleration: Acceleration = None, budget: Budget = False, mode: Mode = 1, count: Count = None, out: Out = None,
    no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Map frequencies, stiffness, deviations, forces and margins over poses: map.nc and figures."""
    from flexapod.app.map_options import parse_acceleration, parse_at, parse_axes, parse_direction
    from flexapod.study.before.room import check_map
    from flexapod.surveys.workspace import workspace_map as compute
    from flexapod.surveys.workspace.findings import map_findings
    from flexapod.surveys.workspace.grid import grid, usual_axes
    from flexapod.surveys.workspace.maps import FREQUENCIES

    study = robot_study(file)
    axes = parse_axes({"--x": x, "--y": y, "--z": z}, count, usual_axes(study.robot))
    fixed = parse_at(at, axes)
    settings = {"direction": parse_direction(direction), "acceleration": parse_acceleration(acceleration)}
    folder = results_folder(file, "map", out)
    with terminal.progress_bar(quiet=quiet or json) as report:
        with as_options(axes="--x", at="--at", direction="--direction", acceleration="--acceleration"):
            poses, frequencies = grid(study.robot, axes, fixed), max(mode, FREQUENCIES)
            check_map(poses.size, frequencies, folder)
            data = compute(
                study, poses.values, at=fixed, frequencies=frequencies, budget=budget, **settings,
                progress=lambda words, share: report(words, COMPUTING * share),
            )  # fmt: skip
        if mode > data.sizes["mode"]:
            raise InputError(
                "is not a mode of this robot", key="--mode", value=mode, allowed=f"1 to {data.sizes['mode']}"
            )
        files = _write(data, folder, mode, report, figures=not no_figures)
    found = map_findings(data, mode)
    if json:
        print_json(found.as_dict() | {"wall_time": data.attrs["wall_time"], "folder": folder, "files": files})
    else:
        _show(data, found, folder, files)


def _write(data: Dataset, folder: Path, mode: int, report: Report, *, figures: bool) -> list[Path]:
    """The map, and where they are wanted a figure of each quantity, of frequencies that of this `mode`."""
    from flexapod import plot
    from flexapod.study.store import save
    from flexapod.surveys.workspace.findings import drawn

    report("writing the map", COMPUTING)
    files, names = [save(data, folder / "map.nc")], drawn(data) if figures else ()
    for k, name in enumerate(names):
        report(f"drawing {name.replace('_', ' ')}", COMPUTING + (1 - COMPUTING) * k / len(names))
        files += plot.save(plot.workspace_map(data, name, mode=mode), folder / f"map-{name.replace('_', '-')}")
    return files


def _show(data: Dataset, found: MapFindings, folder: Path, files: list[Path]) -> None:
    from flexapod.surveys.workspace.findings import axis_words

    share = found.reached / found.poses
    print_text(f"{found.reached} of {found.poses} poses are reached ({100 * share:.3g} %): {axis_words(data)}.")
    for words, count in sorted(found.reasons.items(), key=lambda item: -item[1]):
        print_text(f"{count}: {words}", indent=2)
    if not found.quantities:
        print_text("Nothing to map: choose other ranges or fixed coordinates.")
    for name in ("frequency", "stiffness_least"):
        for quantity in found.quantities:
            if quantity.name == name:
                print_text(_sentence(quantity))
    print_text()
    rows = [_row(quantity) for quantity in found.quantities]
    if rows:
        print_table(["", "unit", "least", "at", "largest", "at", "home"], rows, left=(0, 1, 3, 5))
    for line in data.attrs["warnings"].splitlines():
        print_text(f"Warning: {line}")
    drawn = " and a figure of each quantity" if len(files) > 1 else ""
    print_text(f"In {folder}: map.nc{drawn}. ({data.attrs['wall_time']:.2g} s of computation)")


def _sentence(found: Finding) -> str:
    from flexapod.study.poses import coordinate_words
    from flexapod.study.words import text

    words = found.words[0].upper() + found.words[1:]
    return (
        f"{words}: {text(found.least, found.unit)} to {text(found.largest, found.unit)}; "
        f"least at {coordinate_words(found.least_at)}."
    )


def _row(found: Finding) -> list[str]:
    from flexapod.study.poses import coordinate_words
    from flexapod.study.words import column

    home = float("nan") if found.home is None else found.home
    unit, (least, largest, at_home) = column([found.least, found.largest, home], found.unit)
    return [
        found.words,
        unit,
        least,
        coordinate_words(found.least_at),
        largest,
        coordinate_words(found.largest_at),
        "" if found.home is None else at_home,
    ]
