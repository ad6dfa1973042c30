"""`flexapod modes`: frequencies, damping and shapes of the locked robot at a pose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, NoFigures, StudyFile, as_options

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.model import ActuatorStudy, Study

__all__ = ["add", "parse_pose"]

Pose = Annotated[
    str | None,
    typer.Option("--pose", metavar='"roll=20deg,heave=10mm"', help="From home; numbers without unit in m and rad."),
]
Folder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write modes.nc and the shapes as a figure; default: not.")
]
Count = Annotated[int, typer.Option("--count", min=1, help="How many of the lowest modes to show.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("modes")(modes)


@guarded
def modes(
    file: StudyFile, pose: Pose = None, out: Folder = None, count: Count = 12, no_figures: NoFigures = False,
    json: Json = False,
) -> None:  # fmt: skip
    """Frequencies, damping and shapes at a pose, commands of the drives held, about the static equilibrium.

    Of a single actuator those of its straight beam at t = 0.
    """
    from flexapod import model
    from flexapod.app.outputs import check_writable
    from flexapod.app.terminal import print_json
    from flexapod.study import modes as compute

    study = model.load(file)
    check_writable(out)
    with as_options(pose="--pose"):
        data = compute(study, parse_pose(pose))
    of_robot = isinstance(study, model.Study)
    files = [] if out is None else _write(data, out, figure=of_robot and not no_figures)
    if json:
        print_json(_as_dict(data, files))
    else:
        _show(data, _robot_words(study, data, pose) if of_robot else _beam_words(study), count, files)


def parse_pose(text: str | None) -> dict[str, float] | None:
    """Surge, sway, heave [m], roll, pitch, yaw [rad] from ``"roll=20deg,heave=10mm"``; None: home.

    Raises
    ------
    InputError
        Unknown axes, something that is not a number with a unit of the right kind.
    """
    from flexapod.errors import InputError, closest
    from flexapod.model import AXES
    from flexapod.units import to_si

    if not text or not text.strip():
        return None
    pose: dict[str, float] = {}
    for part in text.split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or name not in AXES or name in pose:
            what = "is given twice" if name in pose else "is not an axis with its value"
            hint = closest(name, AXES) or 'Write --pose "roll=20deg,heave=10mm"'
            raise InputError(what, key="--pose", value=part.strip(), allowed=", ".join(AXES), next_step=hint)
        dimension = "length" if name in AXES[:3] else "angle"
        pose[name] = to_si(_number(value), dimension, key=f"--pose {name}")
    return pose


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _write(data: Dataset, folder: Path, *, figure: bool) -> list[Path]:
    from flexapod import plot
    from flexapod.study.store import save

    files = [save(data, folder / "modes.nc")]
    return [*files, *(plot.save(plot.modes_3d(data), folder / "modes") if figure else ())]


def _as_dict(data: Dataset, files: list[Path]) -> dict[str, object]:
    found = [
        {"mode": int(m), "frequency": float(f), "damping_ratio": float(d), "kind": str(kind)}
        for m, f, d, kind in zip(data.mode, data.frequency, data.damping_ratio, data.kind.values, strict=True)
    ]
    return {
        "modes": found,
        **({"com_sag": data.com_sag.values.tolist()} if "com_sag" in data else {}),
        "warnings": [line for line in data.attrs["warnings"].splitlines() if line],
        "files": files,
    }


def _robot_words(study: Study, data: Dataset, pose: str | None) -> str:
    from flexapod.study.words import held, length

    where, sag = f"at {pose} from home" if pose else "at home", float((data.com_sag**2).sum() ** 0.5)
    return f"{held(study.robot)}, {where}, about the static equilibrium (the centre of mass sags by {length(sag)})."


def _beam_words(study: ActuatorStudy) -> str:
    return f"Hub and extension held, about the straight beam, {study.actuator.free_length:.4g} m of it outside the hub."


def _show(data: Dataset, words: str, count: int, files: list[Path]) -> None:
    from flexapod.app.terminal import print_table, print_text
    from flexapod.study.words import column

    print_text(words)
    print_text()
    shown = data.isel(mode=slice(0, count))
    _, frequencies = column(shown.frequency.values, "Hz", 6)
    _, ratios = column(100 * shown.damping_ratio.values, "")
    kinds = map(str, shown.kind.values)
    rows = [[str(int(m)), *row] for m, *row in zip(shown.mode, frequencies, ratios, kinds, strict=True)]
    print_table(["mode", "frequency [Hz]", "damping [%]", "what moves most"], rows, left=(3,))
    if data.sizes["mode"] > count:
        print_text(f"The lowest {count} of {data.sizes['mode']} modes; more with --count.")
    for line in data.attrs["warnings"].splitlines():
        print_text(f"Warning: {line}")
    for path in files:
        print_text(f"Written: {path}")
