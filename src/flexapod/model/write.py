"""From the model back to a study file in SI units: what was computed, whoever changed what on the way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod.model.actuator import Actuator
from flexapod.model.base import Frozen
from flexapod.model.drive import ForceDrive
from flexapod.model.laws import CsvLaw
from flexapod.model.leg import Leg
from flexapod.model.load import CsvWrench
from flexapod.model.material import MATERIALS, POISSON, Material, Tube
from flexapod.model.motion import CsvMotion
from flexapod.model.piston import Piston
from flexapod.model.robot import Robot
from flexapod.model.simulation import OWN_BASIS, Simulation

__all__ = ["to_toml", "toml_value"]

_IN_FILE = {
    CsvMotion: ("time", "pose"),
    CsvWrench: ("time", "wrench"),
    CsvLaw: ("time", "value"),
    ForceDrive: ("time", "force"),
}


def to_toml(study: Frozen) -> str:
    """The study as TOML text in SI units; read again, it is the same study.

    Tables stay in the CSV files they came from; one given from Python is named ``table.csv`` and must be saved there
    by whoever wants to read the text again.

    Parameters
    ----------
    study : Study or ActuatorStudy
        The study.

    Returns
    -------
    str
        The text, numbers to the last digit.
    """
    lines = ["# Written by flexapod, SI units"]
    for name in type(study).model_fields:
        part = getattr(study, name)
        if isinstance(part, Robot):
            lines += _robot(part)
        elif isinstance(part, Actuator):
            lines += _section("actuator", _actuator(part))
        elif isinstance(part, Frozen) and (fields := _fields(part)):
            lines += _section(name, fields)
    return "\n".join(lines) + "\n"


def _robot(robot: Robot) -> Iterator[str]:
    yield from _section(
        "robot",
        {
            "type": robot.type,
            "base": {"joints": robot.base_joints},
            "platform": {"joints": robot.platform_joints},
            "home_height": robot.home_height,
            "gravity": robot.gravity,
        },
    )
    yield from _section("payload", _fields(robot.payload))
    legs = [_keys(_leg(leg)) for leg in robot.legs]
    if all(leg == legs[0] for leg in legs):
        yield from ["", "[leg]", *legs[0]]
    else:
        for leg in legs:
            yield from ["", "[[leg]]", *leg]


def _leg(leg: Leg) -> dict[str, object]:
    fields = _fields(leg)
    for name in ("chain", "passive", "base_joint", "platform_joint"):
        if fields[name] == Leg.model_fields[name].default:
            del fields[name]
    if leg.u_axis is not None:
        fields["u_axis"] = leg.u_axis
        del fields["base_joint"]
    return fields | {"piston": _piston(leg.piston)}


def _piston(piston: Piston) -> dict[str, object]:
    fields = _fields(piston)
    made_of = {name: fields.pop(name, None) for name in ("E", "density")}
    if piston.diameter is None or piston.E is None or piston.density is None:
        return fields
    material = Material(
        name="given", E=piston.E, density=piston.density, yield_stress=piston.yield_stress, poisson=piston.poisson
    )
    section = Tube(diameter=piston.diameter, inner_diameter=piston.inner_diameter)
    same = Piston.round(length=piston.length, section=section, material=material, axial_inertia=piston.axial_inertia)
    if same != piston:
        return fields
    return {name: value for name, value in fields.items() if name not in ("EA", "EI", "rhoA")} | made_of


def _actuator(actuator: Actuator) -> dict[str, object]:
    fields = _fields(actuator)
    fields.pop("section", None)
    fields.pop("material", None)
    section, material = actuator.section, actuator.material
    if section is None or material is None:
        return fields
    others = {name: value for name, value in fields.items() if name not in ("rhoA", "EI")}
    if Actuator.from_section(section=section, material=material, **others) != actuator:  # type: ignore[arg-type]
        return fields
    return others | {"section": section} | _material(material)


def _material(material: Material) -> dict[str, object]:
    """Its name where that says what it is made of, else its values."""
    known, fields = MATERIALS.get(material.name), _fields(material)
    if known is None or known != material.replace(name=known.name, yield_stress=known.yield_stress):
        return {name: value for name, value in fields.items() if name != "name"}
    named: dict[str, object] = {"material": material.name}
    return named if known == material else named | {"yield_stress": material.yield_stress}


def _fields(model: Frozen) -> dict[str, object]:
    skipped = _IN_FILE.get(type(model), ())
    if isinstance(model, Simulation) and model.fidelity in OWN_BASIS:
        skipped = ("basis",)
    if getattr(model, "poisson", None) == POISSON:
        skipped += ("poisson",)
    fields = {name: getattr(model, name) for name in type(model).model_fields if name not in skipped}
    if "file" in fields and fields["file"] is None and getattr(model, "time", None) is not None:
        fields["file"] = "table.csv"
    return {name: value for name, value in fields.items() if value is not None}


def _section(name: str, fields: dict[str, object]) -> list[str]:
    return ["", f"[{name}]", *_keys(fields)]


def _keys(fields: dict[str, object]) -> list[str]:
    return [f"{name} = {toml_value(value)}" for name, value in fields.items()]


def toml_value(value: object) -> str:
    """A value as it stands in a study file."""
    if isinstance(value, Frozen):
        value = _fields(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(_keys(value)) + " }"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(value)
