"""`flexapod map`: frequencies, stiffness, deviations, forces and margins over a line, slice or volume of poses.

Poses of `flexapod modes` and `export`, axes, fixed coordinates and vectors of `flexapod map` as they are typed.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.analysis.results.arguments import coordinate, pose_in_words
from flexapod.app.cli.failures import guarded
from flexapod.app.cli.options import Json, NoFigures, Out, Quiet, StudyFile, as_options, results_folder, robot_study
from flexapod.common.errors import InputError, check_known
from flexapod.common.units import number_and_unit, quantity
from flexapod.design.maps.grid import Range
from flexapod.model import AXES
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


@guarded
def workspace_map(
    file: StudyFile, x: X = None, y: Y = None, z: Z = None, at: At = None, direction: Direction = "z",
    acceleration: Acceleration = None, budget: Budget = False, mode: Mode = 1, count: Count = None, out: Out = None,
    no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Map frequencies, stiffness, deviations, forces and margins over poses: map.nc and figures."""
    from flexapod.analysis.checks.resource_limits import check_map

    pass  # FOLD
    from flexapod.design.maps import workspace_map as compute
    from flexapod.design.maps.findings import map_findings
    from flexapod.design.maps.grid import grid, usual_axes
    from flexapod.design.maps.maps import FREQUENCIES
    from flexapod.output.text.answers import map_items

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
    drawn = " and a figure of each quantity" if len(files) > 1 else ""
    where = f"In {folder}: map.nc{drawn}. ({data.attrs['wall_time']:.2g} s of computation)"
    more = {"wall_time": data.attrs["wall_time"], "folder": folder, "files": files}
    terminal.tell(chain(map_items(data, found), [where]), lambda: found.as_dict() | more, json=json)


def _write(data: Dataset, folder: Path, mode: int, report: Report, *, figures: bool) -> list[Path]:
    """The map, and where they are wanted a figure of each quantity, of frequencies that of this `mode`."""
    from flexapod.analysis.store import save
    from flexapod.design.maps.findings import drawn
    from flexapod.output import figures as plot

    report("writing the map", COMPUTING)
    files, names = [save(data, folder / "map.nc")], drawn(data) if figures else ()
    for k, name in enumerate(names):
        report(f"drawing {name.replace('_', ' ')}", COMPUTING + (1 - COMPUTING) * k / len(names))
        files += plot.save(plot.workspace_map(data, name, mode=mode), folder / f"map-{name.replace('_', '-')}")
    return files


_AXIS = re.compile(
    r"^\s*(?P<name>[^=\s]+)\s*(?:[=\s]\s*(?P<low>.+?)\s*\.\.\s*(?P<high>[^:]+?)\s*)?(?::\s*(?P<count>\S+))?\s*$"
)
_UNIT = re.compile(r"[a-zA-Z°µ\"'].*$")
FORM = '"surge=-100mm..100mm", "roll=-20..20deg:41", or "heave" for as far as the robot reaches'


def parse_axes(options: dict[str, str | None], count: int | None, usual: Sequence[str]) -> dict[str, Range]:
    """Axes by name from texts (``"surge=-100mm..100mm:41"``) by option (``"--x"``); the `usual` ones without any.

    `count`: points of each axis that names none. InputError: an unknown coordinate, one that is given twice, ends that
    are not lengths or angles or in the wrong order, no points.
    """
    axes: dict[str, Range] = {}
    for option, text in options.items():
        if text is None:
            continue
        name, found = _axis(option, text)
        if name in axes:
            raise InputError("is given twice", key=option, value=text, next_step="Give each coordinate one axis")
        axes[name] = Range(low=found.low, high=found.high, count=count if found.count is None else found.count)
    return axes or {name: Range(count=count) for name in usual}


def _axis(option: str, text: str) -> tuple[str, Range]:
    match = _AXIS.match(text)
    name = match["name"].split(":")[0] if match else text.split("=")[0].strip()
    _check_name(option, name)
    if match is None or name != match["name"]:
        match = _AXIS.match(text.replace(":", " :", 1)) if match else None
    if match is None:
        raise InputError("is not an axis", key=option, value=text, allowed=FORM)
    count = _count(option, match["count"])
    if match["low"] is None:
        if "=" in text:
            raise InputError("is not an axis", key=option, value=text, allowed=FORM)
        return name, Range(count=count)
    low, high = match["low"], match["high"]
    if (unit := _UNIT.search(high)) and _is_number(low):
        low += unit[0]
    ends = [coordinate(name, end, f"{option} {name}") for end in (low, high)]
    if ends[0] > ends[1] or (ends[0] == ends[1] and count != 1):
        raise InputError("begins where it should end", key=option, value=text, allowed="the lower end first")
    return name, Range(low=ends[0], high=ends[1], count=count)


def _count(option: str, text: str | None) -> int | None:
    if text is None:
        return None
    if not text.isdecimal() or int(text) < 1:
        raise InputError("is not a number of points", key=option, value=text, allowed="1 or more")
    return int(text)


def parse_at(text: str | None, axes: Collection[str] = ()) -> dict[str, float]:
    """Fixed coordinates from ``"roll=20deg,heave=10mm"``.

    InputError: unknown coordinates, one given twice or one of the `axes`, something that is not a length or angle.
    """
    fixed: dict[str, float] = {}
    for part in (text or "").split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not part.strip():
            continue
        _check_name("--at", name)
        if not equals or name in fixed:
            what = "is given twice" if name in fixed else "has no value"
            raise InputError(what, key="--at", value=part.strip(), next_step='Write --at "roll=20deg,heave=10mm"')
        if name in axes:
            raise InputError("varies in this map: it cannot be fixed, too", key="--at", value=part.strip())
        fixed[name] = coordinate(name, value, f"--at {name}")
    return fixed


def parse_pose(text: str | None) -> dict[str, float] | None:
    """A pose as of `pose_in_words`; None: home."""
    return None if text is None else pose_in_words(text, "--pose")


def parse_direction(text: str) -> str | list[float]:
    """``x``, ``y``, ``z``, or three numbers: ``1,0,1``."""
    if text in ("x", "y", "z"):
        return text
    return _numbers("--direction", text, 'x, y, z, or three numbers such as "1,0,1"')


def parse_acceleration(text: str | None) -> list[float] | None:
    """Three accelerations [m/s^2]: ``"0,0,5"``, or with units ``"0, 0, 0.5 m/s^2"``."""
    if text is None:
        return None
    parts = text.split(",")
    unit = _UNIT.search(parts[-1].strip())
    whole = [part.strip() + (unit[0] if unit and _is_number(part) else "") for part in parts]
    if len(whole) != 3:
        raise InputError("is not a vector", key="--acceleration", value=text, allowed='three numbers such as "0,0,5"')
    return [quantity(part, "acceleration", key="--acceleration") for part in whole]


def _numbers(option: str, text: str, allowed: str) -> list[float]:
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != 3:
        raise InputError("is not a direction", key=option, value=text, allowed=allowed)
    return found


def _check_name(option: str, name: str) -> None:
    check_known(name, AXES, option, "is not a coordinate")


def _is_number(text: str) -> bool:
    """Whether a text is a number without a unit."""
    read = number_and_unit(text)
    return read is not None and not read[1]
