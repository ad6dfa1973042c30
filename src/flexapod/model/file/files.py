"""Study files and presets: text to model."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from os import PathLike
from pathlib import Path
from typing import Literal, TypeVar, overload

from flexapod.common.errors import InputError, check_kind, suggest_word
from flexapod.common.files import LARGEST_TEXT, check_name, path_of, read_text
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.tables.section import Section
from flexapod.common.tables.table import Table
from flexapod.common.tables.toml import parse_toml
from flexapod.model.file.plausible import size_remarks
from flexapod.model.laws import Load
from flexapod.model.leg.actuator import Actuator, ActuatorInitial, read_drives
from flexapod.model.motion import AxisMotion, CombinedMotion, CsvMotion, Motion, WaypointMotion
from flexapod.model.study.control import DampedControl, FileControl, ForceControl, StrokeControl, ToolControl
from flexapod.model.study.disturbance import read_disturbance
from flexapod.model.study.requirement import Requirement
from flexapod.model.study.robot import Robot, platform_fixed, read_robot
from flexapod.model.study.simulation import STRAIGHT, Initial, Simulation, read_simulation, unused_settings
from flexapod.model.study.study import ActuatorStudy, Study

T = TypeVar("T", bound=Table)
PAPER_PRESETS = ("paper-robot", "paper-robot-radii", "paper-actuator")
PRESETS = (*PAPER_PRESETS, "tripod", "flight-simulator", "machine-hexapod", "small-hexapod", "nano-hexapod",
           "motion-base")  # fmt: skip
RobotPreset = Literal[
    "paper-robot",
    "paper-robot-radii",
    "tripod",
    "flight-simulator",
    "machine-hexapod",
    "small-hexapod",
    "nano-hexapod",
    "motion-base",
]
AT_REST = AxisMotion(type="heave", amplitude=0.0, duration=1.0)
_AS_BUILT = ("geometry", "heat", "tolerances")
_LOOPS = (ForceControl, DampedControl, StrokeControl, ToolControl, FileControl)
_COMMON = ("motion", "load", "initial", "simulation")


@dataclass(frozen=True, kw_only=True)
class OpenValue:
    """A value of a preset that its source leaves open: key path, value as written, why this one."""

    key: str
    value: str
    reason: str


def load(path: str | Path) -> Study | ActuatorStudy:
    """Read a study file (TOML).

    Parameters
    ----------
    path : str or Path
        The file. Tables it names are found relative to its folder.

    Returns
    -------
    Study or ActuatorStudy
        SI values, frozen. Nothing is computed yet.

    Raises
    ------
    InputError
        With file, key path, value, what is allowed, and the next step.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("robot.toml").write_text(fx.preset("paper-robot").source_text)  # as `flexapod new robot.toml`
    >>> study = fx.load("robot.toml")
    >>> study.robot.payload.mass
    100.0
    """
    check_kind(path, (str, PathLike), "path", "the path of a study file, a text or a Path")
    path = Path(path)
    check_name(path)
    try:
        text = read_text(path, LARGEST_TEXT)
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}",
            file=path,
            next_step="`flexapod new NAME.toml` writes one to start from",
        ) from None
    top = _tables(text, path)
    remarks = size_remarks(top.data, top.file)
    study = read_study(top, text)
    return study.replace(notes=(*study.notes, *remarks), source_text=text) if remarks else study


def loads(text: str, *, path: str | Path | None = None) -> Study | ActuatorStudy:
    """Read a study from its text.

    Parameters
    ----------
    text : str
        TOML.
    path : str or Path, optional
        Named in messages; tables (CSV) are found relative to its folder. Nothing is read from it.

    Returns
    -------
    Study or ActuatorStudy
        As of `load`.

    Raises
    ------
    InputError
        As of `load`.

    Examples
    --------
    >>> study = fx.loads(fx.preset("paper-robot").source_text)
    >>> study.robot == fx.preset("paper-robot").robot
    True
    """
    return loads_among(text, path)


def loads_among(text: str, path: str | Path | None, files: NamedFiles | None = None) -> Study | ActuatorStudy:
    """Read a study as `loads`; `files`: those that it may name, in place of all that its path leads to."""
    return read_study(_tables(text, path, files), text)


def read_study(top: Section, text: str) -> Study | ActuatorStudy:
    """Study of a whole-file section; `text` is what it was read from."""
    return _actuator_study(top, text) if "actuator" in top else _study(top, text)


def loads_robot(text: str, *, path: str | Path | None = None, files: NamedFiles | None = None) -> Robot:
    """Read the robot alone from the text of its study: tables of its motion and load need not be there."""
    return read_robot(_tables(text, path, files))


def _tables(text: str, path: str | Path | None, files: NamedFiles | None = None) -> Section:
    check_kind(text, str, "text", "the TOML text of a study")
    file = None if path is None else str(path_of(path, "path"))
    check_name(file or "")
    beside = Path(path).parent if path else Path()
    top = Section(parse_toml(text, file or "study text"), "", file, beside if files is None else files)
    if ("robot" in top) == ("actuator" in top):
        found = "both [robot] and [actuator]" if "robot" in top else "neither [robot] nor [actuator]"
        raise InputError(f"has {found}", file=file or "study text", allowed="one of the two")
    return top


@overload
def preset(name: RobotPreset) -> Study: ...
@overload
def preset(name: Literal["paper-actuator"]) -> ActuatorStudy: ...
@overload
def preset(name: str) -> Study | ActuatorStudy: ...
def preset(name: str) -> Study | ActuatorStudy:
    """A study that comes with flexapod.

    Parameters
    ----------
    name : str
        One of `PRESETS`.

    Returns
    -------
    Study or ActuatorStudy
        Of the preset's file, which `flexapod new NAME.toml --preset` writes; its comments say where values are from.

    Raises
    ------
    InputError
        A name that is not known.

    Examples
    --------
    >>> study = fx.preset("machine-hexapod")
    >>> study.robot.legs[0].drive.lead
    0.01
    """
    return loads(preset_text(name), path=f"{name}.toml")


def preset_text(name: str) -> str:
    """The commented TOML text of a preset."""
    if not isinstance(name, str) or name not in PRESETS:
        raise InputError(
            "is not known",
            key="preset",
            value=name if isinstance(name, str) else type(name).__name__,
            allowed=", ".join(PRESETS),
            next_step=suggest_word(name, PRESETS) if isinstance(name, str) else None,
        )
    return files("flexapod.model").joinpath("presets", f"{name}.toml").read_text(encoding="utf-8")


_SECTION = re.compile(r"^\s*\[([\w.-]+)\]")
_KEY = re.compile(r"^\s*([\w-]+)\s*=")
_OURS = re.compile(r"#\s*ours(?:\s+([\w.-]+))?:\s*(.+?)\s*$")


def open_values(name: str) -> tuple[OpenValue, ...]:
    """The values of a preset that its source leaves open, each with the reason for ours.

    A preset marks them with a comment: ``# ours: reason`` at the end of the key's line, or, for a key inside a table
    in braces, ``# ours leg.cylinder.mass: reason`` on a line of its own.

    Parameters
    ----------
    name : str
        Of the preset.

    Returns
    -------
    tuple of OpenValue
        In the order of the file.

    Raises
    ------
    InputError
        A name that is not known.

    Examples
    --------
    >>> [value.key for value in fx.open_values("paper-robot")][:2]
    ['robot.base.half_angle', 'robot.platform.half_angle']
    """
    text = preset_text(name)
    data, found, section = tomllib.loads(text), [], ""
    for line in text.splitlines():
        if match := _SECTION.match(line):
            section = match[1]
        key, ours = _KEY.match(line), _OURS.search(line)
        if ours is not None and (ours[1] or key):
            path = ours[1] or f"{section}.{key[1] if key else ''}"
            found.append(OpenValue(key=path, value=_lookup(data, path), reason=ours[2]))
    return tuple(found)


def _lookup(data: object, path: str) -> str:
    for name in path.split("."):
        data = data[name] if isinstance(data, dict) else data
    return str(data)


def _study(top: Section, text: str) -> Study:
    top.check_keys("robot", "payload", "leg", *_AS_BUILT, *_COMMON, "disturbance", "control", "requirement")
    fixed = platform_fixed(top)
    top.require_keys("robot", *(() if fixed else ("payload",)), "leg", *(() if fixed else ("motion",)))
    settings = top.section("simulation")
    simulation = read_simulation(settings, basis="tip-load", bases=("tip-load", "clamped-free"))
    robot = read_robot(top)
    study = top.build(
        Study,
        robot=robot,
        motion=_motion(top.child(top.data["motion"], "motion")) if "motion" in top else AT_REST,
        load=_given(top.section("load"), Load),
        initial=_given(top.section("initial"), Initial),
        simulation=simulation,
        disturbance=read_disturbance(top, robot),
        control=None if (loop := top.section("control")) is None else loop.one_of(_LOOPS),
        requirement=None if (asked := top.section("requirement")) is None else asked.read(Requirement),
        source_text=text,
        path=top.file,
        notes=(*unused_settings(settings, simulation), *_unused_axial_modes(top, simulation)),
    )
    return study.attach_source(top.source_table)


def _motion(section: Section) -> Motion:
    return section.one_of((AxisMotion, CombinedMotion, WaypointMotion, CsvMotion))  # type: ignore[return-value]


def _given(section: Section | None, kind: type[T]) -> T:
    return kind() if section is None else kind.from_table(section)


def _unused_axial_modes(top: Section, simulation: Simulation) -> tuple[str, ...]:
    legs = top.data["leg"]
    given = any("axial_modes" in leg for leg in (legs if isinstance(legs, list) else [legs]))
    if simulation.fidelity not in STRAIGHT or not given:
        return ()
    return (f"leg.axial_modes has no effect with fidelity {simulation.fidelity!r}",)


def _actuator_study(top: Section, text: str) -> ActuatorStudy:
    top.check_keys("actuator", *_COMMON)
    settings = top.section("simulation")
    bases = ("clamped-free", "tip-load", "tip-mass")
    simulation = read_simulation(settings, basis="clamped-free", bases=bases)
    motion, load = read_drives(top)
    study = top.build(
        ActuatorStudy,
        actuator=Actuator.from_table(top.child(top.data["actuator"], "actuator")),
        motion=motion,
        load=load,
        initial=_given(top.section("initial"), ActuatorInitial),
        simulation=simulation,
        source_text=text,
        path=top.file,
        notes=unused_settings(settings, simulation),
    )
    return study.attach_source(top.source_table)
