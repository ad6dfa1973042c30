"""Commands of the linear model about rest: `frf` writes responses over frequency, `damp` lists poles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexapod.app.cli.commands_export import COMMA
from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    USUAL,
    Force,
    Format,
    Json,
    NoFigures,
    Pose,
    StudyFile,
    as_options,
    check_writable,
    parse_formats,
    refuse_existing,
    robot_study,
)
from flexapod.common.errors import InputError
from flexapod.common.files import write_text
from flexapod.common.lazy_imports import LazyModule, hide_package
from flexapod.output.text.terminal import print_answer

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis import linear as analysis_linear
    from flexapod.analysis import store
    from flexapod.analysis.linear import LinearModel
    from flexapod.app.cli import pose_options
    from flexapod.common import units
    from flexapod.common.arrays import Array
    from flexapod.output import figures
    from flexapod.output.exchange import formats
    from flexapod.output.figures import linear as figures_linear
    from flexapod.output.text import linear
else:
    analysis_linear = LazyModule("flexapod.analysis.linear")
    store = LazyModule("flexapod.analysis.store")
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    units = LazyModule("flexapod.common.units")
    formats = LazyModule("flexapod.output.exchange.formats")
    figures = LazyModule("flexapod.output.figures")
    figures_linear = LazyModule("flexapod.output.figures.linear")
    linear = LazyModule("flexapod.output.text.linear")

OPTIONS = {"pose": "--pose", "drives": "--drives", "friction": "--friction", "inputs": "--input", "outputs": "--output"}

Inputs = Annotated[
    str, typer.Option("--input", metavar="NAMES", help="Channels with commas: wrench, drive, command, floor, drive:3.")
]
Outputs = Annotated[
    str, typer.Option("--output", metavar="NAMES", help="Channels with commas: tool, stroke, tool:z, encoder.")
]
Drives = Annotated[
    str, typer.Option("--drives", metavar="KIND", help="given: as they are; force: released, their forces are inputs.")
]
Friction = Annotated[
    str | None, typer.Option("--friction", metavar="KIND", help="sliding or stuck, in place of the study's.")
]
From = Annotated[str, typer.Option("--from", metavar="FREQUENCY", help="Lowest frequency, 1Hz; without unit in Hz.")]
To = Annotated[str, typer.Option("--to", metavar="FREQUENCY", help="Highest frequency.")]
Points = Annotated[int, typer.Option("--points", min=2, max=100_000, help="How many, at equal ratios.")]
Folder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Write frf.nc and a figure; default: not.")]
Uff = Annotated[Path | None, typer.Option("--uff", metavar="FILE.uff", help="Write a universal file, datasets 58.")]
Mat = Annotated[Path | None, typer.Option("--mat", metavar="FILE.mat", help="Write matrices and names for MATLAB.")]
Count = Annotated[int, typer.Option("--count", min=1, help="How many of the slowest poles to show.")]


@report_failures
def frf(
    file: StudyFile, input: Inputs = "wrench", output: Outputs = "tool", pose: Pose = None, drives: Drives = "given",
    friction: Friction = None, lowest: From = "1 Hz", highest: To = "1000 Hz", points: Points = 400,
    out: Folder = None, uff: Uff = None, mat: Mat = None, force: Force = False, formats: Format = USUAL,
    no_figures: NoFigures = False, json: Json = False,
) -> None:  # fmt: skip
    """Responses of outputs to inputs over frequency, about the static equilibrium at a pose."""
    check_writable(out)
    drawn = parse_formats(formats, no_figures)
    for path, key in ((uff, "--uff"), (mat, "--mat")):
        if path is not None:
            _check_file(path, key, force)
    hz = _frequencies(lowest, highest, points)
    with hide_package("dask"):
        model = _model(file, pose, drives, friction, (input, output))
        data = model.frequency_response(hz)
        files = _write(model, data, out, uff, mat, drawn)
        items = chain(linear.frf_items(data, pose, drives), map("Written: {}".format, files))
        print_answer(items, lambda: linear.frf_as_dict(data, files), json=json)


@report_failures
def damp(
    file: StudyFile, pose: Pose = None, drives: Drives = "given", friction: Friction = None, count: Count = 24,
    json: Json = False,
) -> None:  # fmt: skip
    """Poles about the static equilibrium at a pose: frequencies, damping, and whether they grow."""
    with hide_package("dask"):
        data = _model(file, pose, drives, friction).damp()
        print_answer(linear.damp_items(data, pose, drives, count), lambda: linear.damp_as_dict(data), json=json)


def _model(
    file: Path, pose: str | None, drives: str, friction: str | None, channels: tuple[str, str] | None = None
) -> LinearModel:
    """The model with these channels; without any such that every robot has."""
    with as_options(**OPTIONS):
        if friction not in (None, "sliding", "stuck"):
            raise InputError("is not known", key="friction", value=friction, allowed="sliding, stuck")
        study = robot_study(file)
        own = ("floor", "stroke") if study.robot.platform_fixed else ("wrench", "tool")
        names = [[name.strip() for name in COMMA.split(text)] for text in channels or own]
        kinds: Any = {"drives": drives, "friction": friction}  # whatever was typed
        return analysis_linear.linearize(
            study, pose_options.parse_pose(pose), inputs=names[0], outputs=names[1], **kinds
        )


def _frequencies(lowest: str, highest: str, points: int) -> Array:
    import numpy as np

    low, high = (units.quantity(text, "frequency", key=key) for text, key in ((lowest, "--from"), (highest, "--to")))
    least, most = units.DIMENSIONS["frequency"].least, units.DIMENSIONS["frequency"].most
    if not 0 < low < high:
        raise InputError("are no range", key="--from, --to", value=f"{lowest}, {highest}", allowed="0 < --from < --to")
    if low < least or high > most:
        words, allowed = "are beyond every machine", f"{least:g} to {most:g} Hz"
        raise InputError(words, key="--from, --to", value=f"{lowest}, {highest}", allowed=allowed)
    return np.geomspace(low, high, points)


def _check_file(path: Path, key: str, force: bool) -> None:
    ending = f".{key[2:]}"
    endings = (ending, ".unv") if ending == ".uff" else (ending,)
    if path.is_dir() or path.suffix.lower() not in endings:
        raise InputError(
            "is not named as such a file", key=key, value=str(path), allowed=f"FILE{' or FILE'.join(endings)}"
        )
    refuse_existing(path, force)
    check_writable(path.parent, key)


def _write(
    model: LinearModel, data: Dataset, folder: Path | None, uff: Path | None, mat: Path | None, drawn: Sequence[str]
) -> Sequence[Path]:
    files: list[Path] = []
    if folder is not None:
        files.append(store.save(data, folder / "frf.nc"))
        files += _figure(data, folder, drawn) if drawn else ()
    if uff is not None:
        write_text(uff, formats.uff(data), encoding="ascii", errors="replace")
        files.append(uff)
    return [*files, *([] if mat is None else [model.save(mat)])]


def _figure(data: Dataset, folder: Path, drawn: Sequence[str]) -> Sequence[Path]:
    """The figure, of the first inputs where all of them are too many curves."""
    first = data.isel(output=slice(0, figures_linear.MOST))
    figure = figures.bode(first.isel(input=slice(0, max(1, figures_linear.MOST // first.sizes["output"]))))
    return figures.save(figure, folder / "frf", formats=drawn)
