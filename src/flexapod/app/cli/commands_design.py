"""Commands that say what to change: `sensitivity` of outputs to the numbers of a study, `optimise` of the numbers."""

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
from flexapod.common.errors import InputError
from flexapod.common.files import write_text
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from flexapod.analysis import store
    from flexapod.analysis.results import attributes
    from flexapod.app.cli import pose_options
    from flexapod.design import sensitivity as design_sensitivity
    from flexapod.design.optimisation import optimise as design_optimise
    from flexapod.output import figures
    from flexapod.output.text import optimum as text_optimum
    from flexapod.output.text import sensitivity as text_sensitivity
else:
    store = LazyModule("flexapod.analysis.store")
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    attributes = LazyModule("flexapod.analysis.results.attributes")
    text_optimum = LazyModule("flexapod.output.text.optimum")
    design_optimise = LazyModule("flexapod.design.optimisation.optimise")
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


DesignFile = Annotated[
    Path, typer.Argument(metavar="DESIGN", help="Design file (TOML): variables, objective, constraints.")
]
Optimum = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write optimum.toml and optimum.nc; default: not.")
]


@report_failures
def optimise(
    file: StudyFile, design: DesignFile, settings: Settings = None, pose: Pose = None, out: Optimum = None,
    json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Find the best values of some numbers of a study within limits, and say which limits cost what."""
    study = robot_study(file, settings)
    check_writable(out)
    if out is not None and (out / "optimum.toml").absolute() == file.absolute():
        raise InputError("would replace the study itself", key="--out", value=out, next_step="Choose another folder")
    with as_options(pose="--pose"), terminal.progress_bar(quiet=quiet or json) as say:
        data = design_optimise.optimise(study, design, pose=pose_options.parse_pose(pose), progress=say)
    files: list[Path] = []
    if out is not None:
        files.append(store.save(data, out / "optimum.nc"))
        write_text(out / "optimum.toml", attributes.result_study(data).source_text)
        files.append(out / "optimum.toml")
    terminal.print_answer(
        chain(text_optimum.optimum_items(data), map("Written: {}".format, files)),
        lambda: text_optimum.optimum_as_dict(data) | {"files": files},
        json=json,
    )
