"""Commands that say what to change: `sensitivity` of outputs to the numbers of a study."""

from __future__ import annotations

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
    Pose,
    Quiet,
    Settings,
    StudyFile,
    as_options,
    check_writable,
    parse_formats,
    robot_study,
)
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from flexapod.analysis import store
    from flexapod.app.cli import pose_options
    from flexapod.design import sensitivity as design_sensitivity
    from flexapod.output import figures
    from flexapod.output.text import sensitivity as text_sensitivity
else:
    store = LazyModule("flexapod.analysis.store")
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    design_sensitivity = LazyModule("flexapod.design.sensitivity")
    figures = LazyModule("flexapod.output.figures")
    text_sensitivity = LazyModule("flexapod.output.text.sensitivity")

Keys = Annotated[
    list[str] | None,
    typer.Option("--key", metavar="KEY", help="A number of the study, leg.piston.diameter; again for more."),
]
Outputs = Annotated[
    list[str] | None, typer.Option("--output", metavar="NAME", help="An output, first_frequency; again for more.")
]
Folder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write sensitivity.nc and the chart; default: not.")
]


@report_failures
def sensitivity(
    file: StudyFile, settings: Settings = None, key: Keys = None, output: Outputs = None, pose: Pose = None,
    out: Folder = None, formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Say which number of a study changes frequency, stiffness, sag and accuracy by how much, the strongest first."""
    study, drawn = robot_study(file, settings), parse_formats(formats, no_figures)
    check_writable(out)
    with as_options(keys="--key", outputs="--output", pose="--pose"), terminal.progress_bar(quiet=quiet or json) as say:
        data = design_sensitivity.sensitivity(study, key, output, pose_options.parse_pose(pose), progress=say)
    files: list[Path] = []
    if out is not None:
        files.append(store.save(data, out / "sensitivity.nc"))
        files += figures.save(figures.tornado(data), out / "sensitivity", formats=drawn) if drawn else ()
    terminal.print_answer(
        chain(text_sensitivity.sensitivity_items(data), map("Written: {}".format, files)),
        lambda: text_sensitivity.sensitivity_as_dict(data) | {"files": files},
        json=json,
    )
