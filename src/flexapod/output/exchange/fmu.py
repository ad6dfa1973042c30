"""A robot as a functional mock-up unit for co-simulation, FMI 3.0: its C, compiled, with a description."""

from __future__ import annotations

import hashlib
import io
import platform
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as xml

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.common.version import __version__
from flexapod.mechanics.symbolic.compiler import shared_object
from flexapod.output.exchange.c_source import FLAGS, source_texts
from flexapod.output.exchange.c_source_data import Channel, CMarch, prepare_c_march
from flexapod.output.exchange.formats import Content

WRAPPER = Path(__file__).parent / "c" / "fmi3.c"
NAME = "robot"
DATE = (1980, 1, 1, 0, 0, 0)  # of all files: equal robots make equal units
HIDDEN = "-fvisibility=hidden"
SOURCES = ("robot.c", "fmi3.c")
SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib")}
MACHINES = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
#: Units of channels by the exponents of base units.
UNITS: Mapping[str, Mapping[str, int]] = {
    "1": {},
    "m": {"m": 1},
    "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    **{f"{of} s-{order}": {of: 1, "s": -order} for of in ("m", "rad") for order in (1, 2)},
}


def fmu(study: model.Study, commands: str = "inputs", step: float | str | None = None) -> Content:
    """A robot in fixed steps as an FMU, with a binary for this kind of machine and its sources.

    Parameters
    ----------
    study : Study
    commands : str
        "inputs": the drives' commands come from outside; "motion": the study's own motion is built in.
    step : float, optional
        Length of the steps inside [s]; that of the study, if it has a fixed one. Communication steps are multiples.

    Returns
    -------
    Content
        One file.

    Raises
    ------
    InputError
        As of `prepare_c_march`; a kind of machine that FMI has no name for.
    ComputationError
        The compiler failed.
    """
    (folder, ending), found = _machine(), prepare_c_march(study, commands, step)
    sources = source_texts(found)
    token = hashlib.sha256("\0".join([__version__, *sources.values()]).encode()).hexdigest()[:32]
    sources["fmi3.c"] = _numbers(found, token) + WRAPPER.read_text()
    files: dict[str, str | bytes] = {
        "modelDescription.xml": _description(found, token),
        f"binaries/{folder}/{NAME}{ending}": shared_object(sources, SOURCES, (*FLAGS, HIDDEN)),
        **{f"sources/{name}": text for name, text in sources.items()},
        "sources/buildDescription.xml": _build_description(),
    }
    remarks = (
        f"Steps inside are {found.march.step:g} s long: communication steps are multiples. Inputs at a communication "
        "point hold until the next; commands of drives go on by their rates and accelerations.",
    )
    return Content(files={"": _zipped(files)}, left_out=found.left_out, remarks=remarks)


def _machine() -> tuple[str, str]:
    """Folder of binaries, and what they end with."""
    system, ending = SYSTEMS.get(sys.platform, ("", ""))
    machine = MACHINES.get(platform.machine(), "")
    if not system or not machine:
        raise InputError(
            "is built on a machine that FMI 3.0 has no name for here",
            key="format",
            value=f"{sys.platform}, {platform.machine()}",
            allowed="Linux and macOS on x86-64 and ARM",
            next_step='Take format "c"',
        )
    return f"{machine}-{system}", ending


def _numbers(found: CMarch, token: str) -> str:
    channels = [(1, x) for x in found.inputs] + [(0, x) for x in found.outputs]
    rows = ", ".join(f"{{{kind}, {x.first}, {x.size}}}" for kind, x in channels)
    built_in = int(not found.commanded)
    return f'#define TOKEN "{token}"\n#define VARIABLES {{{rows}}}\nenum {{ BUILT_IN = {built_in} }};\n'


def _description(found: CMarch, token: str) -> str:
    root = xml.Element(
        "fmiModelDescription", fmiVersion="3.0", modelName=NAME, instantiationToken=token,
        description="Parallel robot with elastic legs in fixed steps", generationTool=f"flexapod {__version__}",
        variableNamingConvention="flat",
    )  # fmt: skip
    step = repr(float(found.march.step))
    xml.SubElement(
        root, "CoSimulation", modelIdentifier=NAME, canHandleVariableCommunicationStepSize="true",
        fixedInternalStepSize=step, canGetAndSetFMUState="true", canSerializeFMUState="true",
    )  # fmt: skip
    _units(root, {x.units for x in (*found.inputs, *found.outputs)})
    categories = xml.SubElement(root, "LogCategories")
    xml.SubElement(categories, "Category", name="logStatusError", description="Why a call has failed")
    stop = repr(float(found.study.duration))
    xml.SubElement(root, "DefaultExperiment", startTime="0", stopTime=stop, stepSize=step)
    variables = xml.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous"}
    xml.SubElement(variables, "Float64", time)
    every = [*((x, "input") for x in found.inputs), *((x, "output") for x in found.outputs)]
    for number, (channel, causality) in enumerate(every, start=1):
        _variable(variables, channel, causality, number)
    structure, count = xml.SubElement(root, "ModelStructure"), len(found.inputs)
    for kind in ("Output", "InitialUnknown"):
        for number in range(count + 1, len(every) + 1):
            xml.SubElement(structure, kind, valueReference=str(number))
    return _text(root)


def _variable(parent: xml.Element, channel: Channel, causality: str, number: int) -> None:
    said = {
        "name": channel.name, "valueReference": str(number), "causality": causality, "variability": "continuous",
        "description": channel.words,
    }  # fmt: skip
    if channel.units in UNITS:
        said["unit"] = channel.units
    if causality == "input":
        said["start"] = " ".join(repr(float(x)) for x in channel.start)
    found = xml.SubElement(parent, "Float64", said)
    for size in channel.shape:
        xml.SubElement(found, "Dimension", start=str(size))


def _units(root: xml.Element, used: set[str]) -> None:
    units = xml.SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        if name in used:
            base = {of: str(power) for of, power in exponents.items()}
            xml.SubElement(xml.SubElement(units, "Unit", name=name), "BaseUnit", base)


def _build_description() -> str:
    root = xml.Element("fmiBuildDescription", fmiVersion="3.0")
    build = xml.SubElement(root, "BuildConfiguration", modelIdentifier=NAME)
    files = xml.SubElement(build, "SourceFileSet", language="C11", compilerOptions=" ".join(FLAGS))
    for name in SOURCES:
        xml.SubElement(files, "SourceFile", name=name)
    xml.SubElement(build, "Library", name="m")
    return _text(root)


def _text(root: xml.Element) -> str:
    xml.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + xml.tostring(root, encoding="unicode") + "\n"


def _zipped(files: Mapping[str, str | bytes]) -> bytes:
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, DATE), content, zipfile.ZIP_DEFLATED)
    return whole.getvalue()
