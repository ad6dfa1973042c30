"""What a study can be written as, and the one way to write it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RobotLike, at_pose
from flexapod.common.errors import InputError, closest
from flexapod.common.files import path_of, replacing
from flexapod.common.lazy_imports import loaded
from flexapod.output.exchange.content import Content

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class Format:
    """A format: its `writer`, as "module.function" below `flexapod.output.exchange`, which returns what is `Content`.

    The writer takes the study, and of the `options` of `export` those that are given, by their names. `endings` of the
    file, none: it is a folder; `noun`, `words`: what it is; `named`: how it has to be named; `by_name`: what is written
    depends on that, which the writer takes as `name`.
    """

    writer: str
    endings: tuple[str, ...]
    noun: str
    words: str
    named: str
    options: tuple[str, ...]
    by_name: bool = False


FORMATS: Mapping[str, Format] = {
    "abaqus": Format(
        "export.abaqus", (".inp",), "a deck", "a deck that CalculiX reads as well",
        "FILE.inp: both programs ask for it", ("pose", "load", "title", "elements", "modes"),
    ),
    "fmu": Format(
        "fmu.fmu", (".fmu",), "a functional mock-up unit", "a unit for co-simulation, FMI 3.0, with its sources",
        "FILE.fmu", ("commands", "step"),
    ),
    "c": Format(
        "c_source.c", (), "a folder of C", "a folder with the robot's steps in C", "a folder", ("commands", "step")
    ),
    "mjcf": Format(
        "mjcf.mjcf", (".xml", ".mjcf"), "a model for MuJoCo", "a model for MuJoCo with closed loops",
        "FILE.xml or FILE.mjcf", ("fidelity",),
    ),
    "gltf": Format(
        "gltf.gltf", (".glb",), "a GLB file", "the motion for viewers of glTF, with pistons that bend",
        "FILE.glb", ("data", "magnify"),
    ),
    "vtk": Format(
        "vtk.vtk", (".pvd",), "a time series for ParaView", "the motion as a time series for ParaView",
        "FILE.pvd", ("data",), by_name=True,
    ),
    "mat": Format(
        "state_space.state_space", (".mat", ".npz", ".nc"), "a file of matrices",
        "matrices A, B, C, D about rest, of MATLAB, NumPy or NetCDF", "FILE.mat, FILE.npz or FILE.nc",
        ("pose", "load", "inputs", "outputs"), by_name=True,
    ),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Exported:
    """What was written: `path`, a file or a folder; `files`, all of them; `left_out`, `remarks` as of `Content`.

    Stands for its path wherever a path is asked for.
    """

    path: Path
    files: tuple[Path, ...]
    left_out: tuple[str, ...]
    remarks: tuple[str, ...]

    def __fspath__(self) -> str:
        return os.fspath(self.path)

    def __str__(self) -> str:
        return str(self.path)


def export(
    study: RobotLike,
    format: str,
    out: str | Path,
    *,
    pose: PoseLike = None,
    load: LoadLike = None,
    title: str | None = None,
    elements: int | None = None,
    modes: int | None = None,
    fidelity: str | None = None,
    data: Dataset | None = None,
    magnify: float | None = None,
    commands: str | None = None,
    step: float | str | None = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> Exported:
    """The robot as a file for other programs; a file that exists is replaced.

    Options belong to formats: one that the format does not take is refused.

    Parameters
    ----------
    study : Study, Robot or path
        A robot stays at home.
    format : str
        A name of `FORMATS`.
    out : path
        The file, with an ending of the format, or the folder.
    pose, load, title, elements, modes : optional
        Of a deck: pose and load as for `flexapod.modes`, first line, solid elements along a piston, frequencies.
    fidelity : str, optional
        In place of that of [simulation]; "rigid": nothing gives way.
    data, magnify : optional
        Of a motion: its result, of `flexapod.simulate`, which is made if left out; a factor on deflections.
    commands, step : optional
        Of a program: "inputs", commands come from outside, or "motion", that of the study; fixed steps inside [s].
    inputs, outputs : sequence of str, optional
        Channels of a linear model, as of `flexapod.linearize`.

    Returns
    -------
    Exported
        Path, files, and what they do not have in words.

    Raises
    ------
    InputError
        An unknown format or ending, an option of another format, a part of the robot that must not be left out.

    Examples
    --------
    >>> made = fx.export(fx.preset("paper-robot"), "mat", "rest.mat", inputs=["wrench"], outputs=["tool"])
    >>> print(made)
    rest.mat
    """
    given = {
        "pose": pose, "load": load, "title": title, "elements": elements, "modes": modes, "fidelity": fidelity,
        "data": data, "magnify": magnify, "commands": commands, "step": step, "inputs": inputs, "outputs": outputs,
    }  # fmt: skip
    return written(
        at_pose(study), format, path_of(out, "out"), {k: value for k, value in given.items() if value is not None}
    )


def written(study: model.Study, format: str, path: Path, given: Mapping[str, object]) -> Exported:
    """As `export`, with those options that are `given`."""
    kind = format_of(format)
    check_options(format, given)
    check_place(format, path)
    named = {"name": path.name} if kind.by_name else {}
    module, _, function = kind.writer.partition(".")
    found: Content = getattr(loaded(f"flexapod.output.exchange.{module}"), function)(study, **named, **given)
    beside = path.parent if kind.endings else path
    places = {beside / name if name else path: content for name, content in found.files.items()}
    for place, content in sorted(places.items(), key=lambda each: each[0] == path):  # last what names the others
        with replacing(place) as temporary:
            temporary.write_bytes(content if isinstance(content, bytes) else content.encode())
    return Exported(path=path, files=tuple(places), left_out=found.left_out, remarks=found.remarks)


def format_of(name: str) -> Format:
    """The format of a name; InputError of none."""
    if not isinstance(name, str) or name not in FORMATS:
        allowed = "; ".join(f"{known}, {kind.words}" for known, kind in FORMATS.items())
        raise InputError(
            "is not a format", key="format", value=name, allowed=allowed, next_step=closest(str(name), FORMATS)
        )
    return FORMATS[name]


def check_options(format: str, given: Mapping[str, object]) -> None:
    """Refuse options of other formats."""
    known = FORMATS[format].options
    for name, value in given.items():
        if name not in known:
            allowed = ", ".join(known) or "no options"
            others = ", ".join(other for other, kind in FORMATS.items() if name in kind.options)
            words = f"It belongs to {others}" if others else None
            raise InputError(f"is not an option of {format}", key=name, value=value, allowed=allowed, next_step=words)


def check_place(format: str, path: Path) -> None:
    """Refuse a file whose name does not say its format, or a folder in place of a file."""
    endings = FORMATS[format].endings
    if path.is_dir() and endings:
        raise InputError("is a folder", key="out", value=str(path), next_step="Give the name of a file")
    if endings and path.suffix.lower() not in endings:
        kind = FORMATS[format]
        raise InputError(f"is not named as {kind.noun}", key="out", value=str(path), allowed=kind.named)
    if not endings and path.exists() and not path.is_dir():
        raise InputError("is a file", key="out", value=str(path), next_step="Give the name of a folder")
