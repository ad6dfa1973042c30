"""The whole study as TOML text: as it was read where nothing changed, generated where a Python call changed it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from flexapod import model
from flexapod.errors import InputError
from flexapod.model.base import Frozen

__all__ = ["generated_text", "study_text"]

_HEADER = re.compile(r"^\s*\[\[?\s*([A-Za-z_][\w-]*)")
_GROUPS = {
    "robot": ("robot", "payload", "leg"),
    "actuator": ("actuator",),
    "motion": ("motion",),
    "load": ("load",),
    "initial": ("initial",),
    "simulation": ("simulation",),
}


def study_text(study: model.Study | model.ActuatorStudy) -> str:
    """TOML text that repeats the study: its file, with the tables replaced that a call changed; else all generated."""
    original = _as_read(study)
    if original is None:
        return generated_text(study)
    changed = [name for name in _fields(study) if getattr(study, name) != getattr(original, name)]
    if not changed:
        return study.source_text
    new = {name: _block(study, name) for name in changed}
    kept = _without(study.source_text, {table for name in changed for table in _GROUPS[name]})
    return "\n\n".join(part for part in (kept.strip(), *new.values()) if part) + "\n"


def generated_text(study: model.Study | model.ActuatorStudy) -> str:
    """TOML text made from the model alone, in SI units."""
    head = "# Written by flexapod from a study made in Python; SI units."
    return "\n\n".join(part for part in (head, *(_block(study, name) for name in _fields(study))) if part) + "\n"


def _fields(study: model.Study | model.ActuatorStudy) -> tuple[str, ...]:
    subject = "actuator" if isinstance(study, model.ActuatorStudy) else "robot"
    return (subject, "motion", "load", "initial", "simulation")


def _as_read(study: model.Study | model.ActuatorStudy) -> model.Study | model.ActuatorStudy | None:
    if not study.source_text:
        return None
    try:
        original = model.loads(study.source_text, path=study.path)
    except InputError:  # a table it names is no longer there
        return None
    return original if type(original) is type(study) else None


def _without(text: str, tables: set[str]) -> str:
    """The text without these tables and their sub-tables; comments before the first table stay."""
    kept, keep = [], True
    for line in text.splitlines():
        if match := _HEADER.match(line):
            keep = match[1] not in tables
        if keep:
            kept.append(line)
    return "\n".join(kept)


def _block(study: model.Study | model.ActuatorStudy, name: str) -> str:
    part = getattr(study, name)
    if isinstance(part, model.Robot):
        return _robot(part)
    if isinstance(part, model.Actuator):
        fields = _plain(part)
        dropped = {key: fields.pop(key) for key in ("EA", "depth", "E", "yield_stress") if key in fields}
        notes = [f"# {key} = {_value(value)}  # of the section" for key, value in dropped.items()]
        return "\n".join([_table("actuator", fields), *notes])
    if isinstance(part, model.Simulation):
        unused = () if part.lateral_shapes else ("modes", "basis")
        return _table(name, {key: value for key, value in _plain(part).items() if key not in unused})
    if isinstance(part, model.ActuatorLoad):
        values = {key: law for key, law in (("torque", part.torque), ("force", part.force)) if law is not None}
        return _table(name, {key: _law(law) for key, law in values.items()}) if values else ""
    if isinstance(part, model.ActuatorMotion):
        values = {"rotation": part.rotation, "extension": part.extension}
        return _table(name, {key: _law(law) for key, law in values.items() if law is not None})
    if isinstance(part, model.Load):
        return "" if part.wrench is None else _table(name, {"wrench": _law(part.wrench)})
    return _table(name, _law(part))


def _robot(robot: model.Robot) -> str:
    head = {
        "type": robot.type,
        "base": {"joints": robot.base_joints},
        "platform": {"joints": robot.platform_joints},
        "home_height": robot.home_height,
        "gravity": robot.gravity,
    }
    same = len(set(robot.legs)) == 1
    legs = robot.legs[:1] if same else robot.legs
    title = "leg" if same else "[leg]"
    parts = [_table("robot", head), _table("payload", _plain(robot.payload))]
    return "\n\n".join([*parts, *(_table(title, _leg(leg)) for leg in legs)])


def _leg(leg: model.Leg) -> dict[str, object]:
    fields = _plain(leg)
    fields["piston"] = _piston(leg.piston)
    fields["drive"] = _law(leg.drive)
    return fields


def _piston(piston: model.Piston) -> dict[str, object]:
    """Diameter and material where they say it all, else EI, EA and rhoA."""
    fields = _plain(piston)
    if piston.diameter is not None and piston.E is not None and piston.density is not None:
        again = model.Piston.round(
            length=piston.length,
            section=model.Tube(diameter=piston.diameter, inner_diameter=piston.inner_diameter),
            material=model.Material(
                name="given", E=piston.E, density=piston.density, yield_stress=piston.yield_stress
            ),
            axial_inertia=piston.axial_inertia,
        )
        if again == piston:
            return {key: value for key, value in fields.items() if key not in ("EA", "EI", "rhoA")}
    return {key: value for key, value in fields.items() if key not in ("E", "density")}


def _plain(part: Frozen) -> dict[str, object]:
    """Fields that are set, nested models as dictionaries."""
    found = {}
    for name in type(part).model_fields:
        value = getattr(part, name)
        if value is None:
            continue
        found[name] = _plain(value) if isinstance(value, Frozen) else value
    return found


_TABLES = ("time", "pose", "value", "wrench", "force")


def _law(law: Frozen) -> dict[str, object]:
    """Fields of a motion, law or drive; a table read from a file is named by its file."""
    fields = _plain(law)
    if isinstance(law, model.WaypointMotion):
        fields["points"] = [_plain(point) for point in law.points]
    if fields.get("file") is not None or isinstance(law, model.CsvMotion | model.CsvWrench | model.CsvLaw):
        fields = {key: value for key, value in fields.items() if key not in _TABLES}
        fields.setdefault("file", "(a table given in Python)")
    return fields


def _table(title: str, fields: Mapping[str, object]) -> str:
    return "\n".join([f"[{title}]", *(f"{key} = {_value(value)}" for key, value in fields.items())])


def _value(value: object) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Sequence):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value)
