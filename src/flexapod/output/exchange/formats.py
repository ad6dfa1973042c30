"""Formats in which a study can be exported, and `export`, which writes them all.

The writer of a format returns `Content`. Two are here: `state_space`, a robot about rest as matrices with named
channels, and `uff`, frequency responses as a universal file of datasets 58, one for each input and output.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RobotLike, study_at_pose
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, suggest_word
from flexapod.common.files import path_of, replace_file, temporary_folder
from flexapod.common.lazy_imports import LazyModule

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from flexapod.analysis import linear
    from flexapod.output.exchange import c_source, fmu, gltf, mjcf, pose_deck, vtk
else:
    linear = LazyModule("flexapod.analysis.linear")
    c_source = LazyModule("flexapod.output.exchange.c_source")
    fmu = LazyModule("flexapod.output.exchange.fmu")
    gltf = LazyModule("flexapod.output.exchange.gltf")
    mjcf = LazyModule("flexapod.output.exchange.mjcf")
    pose_deck = LazyModule("flexapod.output.exchange.pose_deck")
    vtk = LazyModule("flexapod.output.exchange.vtk")


@dataclass(frozen=True, kw_only=True)
class Content:
    """A study in some format.

    `files`: contents by name, that of the file itself is "", others are beside it, or in the folder where the format is
    one; a text is ASCII or UTF-8. `left_out`: what the files do not have, in words. `remarks`: what their reader must
    know, for instance how to run them.
    """

    files: Mapping[str, str | bytes]
    left_out: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


Writer = Callable[..., Content]  # of a study and the options that are given, by their names


@dataclass(frozen=True)
class Format:
    """A format: `writer` gives the function that returns what is `Content`; its module is loaded with the first call.

    The writer takes the study, and of the `options` of `export` those that are given, by their names. `endings` of the
    file, none: it is a folder; `noun`, `words`: what it is; `named`: how it has to be named; `by_name`: what is written
    depends on that, which the writer takes as `name`.
    """

    writer: Callable[[], Writer]
    endings: tuple[str, ...]
    noun: str
    words: str
    named: str
    options: tuple[str, ...]
    by_name: bool = False


FORMATS: Mapping[str, Format] = {
    "abaqus": Format(
        lambda: pose_deck.abaqus, (".inp",), "a deck", "a deck that CalculiX reads as well",
        "FILE.inp: both programs ask for it", ("pose", "load", "title", "elements", "modes"),
    ),
    "fmu": Format(
        lambda: fmu.fmu, (".fmu",), "a functional mock-up unit", "a unit for co-simulation, FMI 3.0, with its sources",
        "FILE.fmu", ("commands", "step"),
    ),
    "c": Format(
        lambda: c_source.c, (), "a folder of C", "a folder with the robot's steps in C",
        "a folder", ("commands", "step"),
    ),
    "mjcf": Format(
        lambda: mjcf.mjcf, (".xml", ".mjcf"), "a model for MuJoCo", "a model for MuJoCo with closed loops",
        "FILE.xml or FILE.mjcf", ("fidelity",),
    ),
    "gltf": Format(
        lambda: gltf.gltf, (".glb",), "a GLB file", "the motion for viewers of glTF, with pistons that bend",
        "FILE.glb", ("data", "magnify"),
    ),
    "vtk": Format(
        lambda: vtk.vtk, (".pvd",), "a time series for ParaView", "the motion as a time series for ParaView",
        "FILE.pvd", ("data",), by_name=True,
    ),
    "mat": Format(
        lambda: state_space, (".mat", ".npz", ".nc"), "a file of matrices",
        "matrices A, B, C, D about rest, of MATLAB, NumPy or NetCDF", "FILE.mat, FILE.npz or FILE.nc",
        ("pose", "load", "inputs", "outputs"), by_name=True,
    ),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A finished export: `path`, a file or a folder; `files`, all of them; `left_out`, `remarks` as of `Content`.

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
    return write_format(
        study_at_pose(study), format, path_of(out, "out"), {k: value for k, value in given.items() if value is not None}
    )


def write_format(study: model.Study, format: str, path: Path, given: Mapping[str, object]) -> Exported:
    """Write a study in a format to a path with the options that are `given`; others have their defaults."""
    kind = format_of(format)
    check_options(format, given)
    check_place(format, path)
    named = {"name": path.name} if kind.by_name else {}
    found = kind.writer()(study, **named, **given)
    beside = path.parent if kind.endings else path
    places = {beside / name if name else path: content for name, content in found.files.items()}
    for place, content in sorted(places.items(), key=lambda each: each[0] == path):  # last what names the others
        with replace_file(place) as temporary:
            temporary.write_bytes(content if isinstance(content, bytes) else content.encode())
    return Exported(path=path, files=tuple(places), left_out=found.left_out, remarks=found.remarks)


def format_of(name: str) -> Format:
    """The format of a name; InputError of none."""
    if not isinstance(name, str) or name not in FORMATS:
        allowed = "; ".join(f"{known}, {kind.words}" for known, kind in FORMATS.items())
        raise InputError(
            "is not a format", key="format", value=name, allowed=allowed, next_step=suggest_word(str(name), FORMATS)
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


def state_space(
    study: model.Study,
    *,
    name: str,
    pose: PoseLike = None,
    load: LoadLike = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> Content:
    """A, B, C, D with names and units of `flexapod.linearize`, in the format that `name` ends in.

    Without names all of a robot's own: wrench, commands and floor in, tool, strokes and drive forces out. Drives that
    are forces are released, and their forces are inputs in place of commands.
    """
    robot = study.robot
    pushed = any(leg.driven and leg.drive.pushes for leg in robot.legs)
    of_platform, in_space = not robot.platform_fixed, robot.plane is None
    into = ["wrench"] * of_platform + ["drive" if pushed else "command"] + ["floor"] * in_space
    screws = any(leg.screw is not None for leg in robot.legs)  # drive_force of results is a torque there
    out = ["tool"] * of_platform + ["stroke", "force-sensor:drive" if screws else "drive-force"]
    found = linear.linearize(
        study,
        pose,
        inputs=into if inputs is None else inputs,
        outputs=out if outputs is None else outputs,
        drives="force" if pushed else "given",
        load=load,
    )
    with temporary_folder() as folder:
        content = found.save(folder / Path(name).name).read_bytes()
    left = ["all that is not linear about the equilibrium", "frequencies above those of the shapes"]
    left += ["[control]: the loop of a controller"] * (study.control is not None)
    return Content(files={"": content}, left_out=tuple(left))


RESPONSE, COMPLEX_DOUBLE, FREQUENCY = 4, 6, 18  # function type, ordinate data type, abscissa data type
QUANTITIES = {"m": 8, "m/s": 11, "m/s^2": 12, "N": 9, "m s-1": 11, "m s-2": 12}  # specific data types of outputs
EXCITATION, GENERAL = 13, 1
DIRECTIONS = {axis: k for k, axis in enumerate(("x", "y", "z", "rx", "ry", "rz"), start=1)}
DIRECTIONS |= {axis: k for k, axis in enumerate(("fx", "fy", "fz", "mx", "my", "mz"), start=1)}
DIMS = ("output", "input", "frequency", "part")
EVEN = 1e-9  # of the spacing: how uneven a grid may be


def uff(data: Dataset) -> str:
    """A response (output, input, frequency, part) as text, dataset after dataset.

    The first line of each says output and input by name, the axes their units. Entity names are cut to ten characters;
    a channel with a number, as ``drive:3``, is that node, one with an axis, as ``tool:z``, that direction of node 1.
    Spacing is even where the frequencies are; of uneven ones the format keeps six digits.

    InputError: no such response among the variables.
    """
    found = next((x for x in getattr(data, "data_vars", {}).values() if set(x.dims) == set(DIMS)), None)
    if found is None:
        allowed = "a result of frequency_response, compliance or transmissibility"
        raise InputError("has no response over frequency", key="data", allowed=allowed)
    return "".join(
        f"{line}\n"
        for i in range(found.sizes["output"])
        for j in range(found.sizes["input"])
        for line in _set(found, i, j)
    )


def _set(found: DataArray, i: int, j: int) -> Iterator[str]:
    one = found.transpose(*DIMS).isel(output=i, input=j)
    frequency, values = one.frequency.values, one.values
    names = str(one.output.values), str(one.input.values)
    units = str(one.output_units.values), str(one.input_units.values)
    start, step = _spacing(frequency)
    yield from ("    -1", "    58")
    yield from (f"{' / '.join(names)}", "flexapod: frequency response", "NONE", "NONE", "NONE")
    yield f"{RESPONSE:5d}{0:10d}{0:5d}{0:10d}{_place(names[0])}{_place(names[1])}"
    even = step is not None
    yield f"{COMPLEX_DOUBLE:10d}{len(frequency):10d}{int(even):10d}{start:13.5E}{step or 0.0:13.5E}{0.0:13.5E}"
    yield _axis(FREQUENCY, "Frequency", "Hz")
    yield _axis(QUANTITIES.get(units[0], GENERAL), names[0], units[0])
    yield _axis(EXCITATION if units[1] == "N" else QUANTITIES.get(units[1], GENERAL), names[1], units[1])
    yield _axis(0, "NONE", "NONE")
    yield from _values(frequency, values, even=even)
    yield "    -1"


def _spacing(frequency: Array) -> tuple[float, float | None]:
    """First frequency and spacing; that is None where it is not the same throughout."""
    start = float(frequency[0]) if len(frequency) else 0.0
    if len(frequency) < 2:
        return start, None
    step = float(frequency[-1] - start) / (len(frequency) - 1)
    even = start + step * np.arange(len(frequency))
    return start, step if np.abs(frequency - even).max() <= EVEN * abs(step) else None


def _place(name: str) -> str:
    """Entity, node and direction of a channel."""
    entity, _, last = name.rpartition(":")
    node = int(last) if last.isdigit() else 1
    return f" {(entity or last)[:10]:<10}{node:10d}{DIRECTIONS.get(last, 0):4d}"


def _axis(kind: int, label: str, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {label[:20]:<20} {unit[:20]:<20}"


def _values(frequency: Array, values: Array, *, even: bool) -> Iterator[str]:
    texts = [f"{x:20.12E}{y:20.12E}" for x, y in values]
    if even:
        yield from ("".join(texts[k : k + 2]) for k in range(0, len(texts), 2))
    else:
        yield from (f"{f:13.5E}{text}" for f, text in zip(frequency, texts, strict=True))
