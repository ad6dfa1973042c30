"""`flexapod budget`: what every part adds to the error of the tool, at a pose or along the motion."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, NoFigures, Pose, Quiet, StudyFile, Verbose, as_options, check_writable

if TYPE_CHECKING:
    from xarray import Dataset

Motion = Annotated[bool, typer.Option("--motion", help="Along the motion in place of a pose: with what is dynamic.")]
Folder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write budget.nc and the chart; default: not.")
]


@guarded
def budget(
    file: StudyFile, pose: Pose = None, motion: Motion = False, out: Folder = None, no_figures: NoFigures = False,
    quiet: Quiet = False, verbose: Verbose = False, json: Json = False,
) -> None:  # fmt: skip
    """Error budget of the tool: which part adds what, and what halving the largest error would bring."""
    from flexapod import model
    from flexapod.app.map_options import parse_pose
    from flexapod.app.terminal import print_json, progress_bar
    from flexapod.errors import InputError
    from flexapod.study import budget as compute
    from flexapod.study.counted import budget_counts
    from flexapod.study.ideal import ideal_words

    study = model.load(file)
    if isinstance(study, model.ActuatorStudy):
        raise InputError("is the study of a single actuator", file=file, allowed="the study of a robot")
    check_writable(out)
    with as_options(pose="--pose"), progress_bar(quiet=quiet or json) as report:
        data = compute(
            study, parse_pose(pose), motion=motion, progress=lambda now, end: report("simulating", now / end)
        )
    files = [] if out is None else _write(data, out, figure=not no_figures)
    ideal, counts = ideal_words(study.robot), None if motion else budget_counts(study.robot)
    if json:
        print_json({**_as_dict(data, files), "ideal": ideal, "counts": counts})
    else:
        _show(data, files, (ideal, counts), verbose=verbose)


def _write(data: Dataset, folder: Path, *, figure: bool) -> list[Path]:
    from flexapod import plot
    from flexapod.study.store import save

    files = [save(data, folder / "budget.nc")]
    return [*files, *(plot.save(plot.budget(data), folder / "budget") if figure else ())]


def _as_dict(data: Dataset, files: list[Path]) -> dict[str, object]:
    kinds = list(map(str, data.kind.values))
    parts = [
        {
            "part": str(part),
            "nature": str(data.nature.values[i]),
            "share": float(data.share[i]),
            **{kind: data.budget.values[i, k].tolist() for k, kind in enumerate(kinds) if data.how.values[i, k]},
            "how": {kind: str(data.how.values[i, k]) for k, kind in enumerate(kinds) if data.how.values[i, k]},
        }
        for i, part in enumerate(data.part.values)
    ]
    whole = ("worst", "rss", "repeatability_unidirectional", "repeatability_bidirectional")
    return {
        "summary": data.attrs["summary"].splitlines(),
        "components": list(map(str, data.component.values)),
        "parts": parts,
        "total": dict(zip(kinds, data.budget_total.values.tolist(), strict=True)),
        "residual": dict(zip(kinds, data.budget_residual.values.tolist(), strict=True)),
        **{name: data[name].values.tolist() for name in whole},
        "pose_accuracy": dict(zip(map(str, data.state.values), data.pose_accuracy.values.tolist(), strict=True)),
        **({"worst_time": float(data.worst_time)} if "worst_time" in data else {}),
        "warnings": [line for line in data.attrs["warnings"].splitlines() if line],
        "files": files,
    }


def _show(data: Dataset, files: list[Path], also: Sequence[str | None], *, verbose: bool) -> None:
    from flexapod.app.terminal import print_remarks, print_table, print_text
    from flexapod.study.budgets.words import table

    first, *further = data.attrs["summary"].splitlines()
    print_text(first)
    print_text()
    if data.sizes["part"]:
        head, rows = table(data)
        print_table(head, rows, left=(0, 1))
        print_text()
    for line in further:
        print_text(line)
    for line in filter(None, also):
        print_text(line)
    print_remarks(data.attrs["warnings"].splitlines(), verbose=verbose, title="Warning: ")
    for path in files:
        print_text(f"Written: {path}")
