"""From the model back to a study file in SI units: what was computed, whoever changed what on the way."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from flexapod.model.actuator import Actuator
from flexapod.model.cylinder import Cylinder
from flexapod.model.disturbance import Floor, Spectrum
from flexapod.model.geometry import Geometry
from flexapod.model.heat import Gradient, Heat
from flexapod.model.joint import Carriage, Joint
from flexapod.model.leg import Leg
from flexapod.model.material import MATERIALS, POISSON, Material, Tube
from flexapod.model.payload import Payload
from flexapod.model.piston import Piston, Strut
from flexapod.model.robot import Robot
from flexapod.model.screw import ScrewDrive
from flexapod.model.simulation import OWN_BASIS, Simulation
from flexapod.schema.axes import word_of
from flexapod.schema.base import Frozen
from flexapod.schema.toml import toml_text
from flexapod.schema.written import together
from flexapod.typing import Array


def to_toml(study: Frozen) -> str:
    """The study as TOML text; read again, it is the same study.

    What was read from a text and not changed since stands there as it was written, key by key; all else in SI units,
    numbers to the last digit. Tables stay in the CSV files they came from; one given from Python is named ``table.csv``
    and must be saved there by whoever wants to read the text again.

    Parameters
    ----------
    study : Study or ActuatorStudy
        The study.

    Returns
    -------
    str
        The text, its tables one after the other.
    """
    return "# Written by flexapod\n" + toml_text(_tables(study))


def _tables(study: Frozen) -> dict[str, Any]:
    if study.written is not None and study.unchanged:
        return dict(study.written.data)
    found: dict[str, object] = {}
    for name in type(study).model_fields:
        part = getattr(study, name)
        found |= _robot(part) if isinstance(part, Robot) else {name: part} if isinstance(part, Frozen) else {}
    tables = {name: _plain(part) for name, part in _merged(study, found).items()}
    return {name: table for name, table in tables.items() if table}


def _robot(robot: Robot) -> dict[str, Any]:
    home, fixed = robot.home, {"fixed": True} if robot.platform_fixed else {}
    above = not (home.rotation.any() or home.position[:2].any())
    places = zip(robot.legs, robot.base_joints, robot.platform_joints, strict=True)
    legs = [_plain(_leg(leg, base, platform, robot.normal)) for leg, base, platform in places]
    alike = all(leg == legs[0] for leg in legs) and len({leg.chain for leg in robot.legs}) == 1
    geometry = {
        "type": robot.type,
        **({"plane": robot.plane} if robot.plane else {}),
        "base": {"joints": robot.base_joints},
        "platform": {"joints": robot.platform_joints, **fixed},
        **({"home_height": robot.home_height} if above else {"home": home}),
        "gravity": robot.gravity,
        **{name: mount for name, mount in _mounts(robot)},
    }
    beside = {
        "payload": robot.payload and _payload(robot.payload),
        "leg": legs[0] if alike else legs,
        **{name: part for name in ("geometry", "heat", "tolerances") if (part := getattr(robot, name)) is not None},
    }
    found = _merged(robot, geometry | {name: part for name, part in beside.items() if part is not None})
    tables = {name: _plain(found[name]) for name in found if name in beside}
    return {"robot": _plain({name: found[name] for name in found if name not in beside}), **tables}


def _payload(payload: Payload) -> dict[str, object]:
    return _merged(payload, _fields(payload) | {"inertia": _diagonal(payload.inertia)})


def _mounts(robot: Robot) -> Iterator[tuple[str, object]]:
    for name in ("base_mount", "platform_mount"):
        if (mount := getattr(robot, name)) is not None:
            short = {key: _diagonal(value) for key, value in _fields(mount).items()}
            given = {key: value for key, value in short.items() if key == "loss" or np.asarray(value).any()}
            yield name, _merged(mount, given)
    if robot.base_motion is not None:
        yield "base_motion", robot.base_motion


def _diagonal(value: object) -> object:
    """A diagonal matrix as its diagonal."""
    if not isinstance(value, np.ndarray) or value.ndim != 2:
        return value
    return np.diag(value) if not (value - np.diag(np.diag(value))).any() else value


def _leg(leg: Leg, base: Array, platform: Array, normal: Array) -> dict[str, object]:
    fields = _fields(leg)
    del fields["chain"]  # the robot's type has it
    if leg.letters.platform and not leg.passive:
        del fields["passive"]
    if leg.passive:
        del fields["drive"]
    for name, place in (("base_joint", base), ("platform_joint", platform)):
        fields[name] = _joint(getattr(leg, name), place, normal)
        if not fields[name]:
            del fields[name]
    del fields["springs"]
    if leg.springs:
        fields["springs"] = {spring.name: spring for spring in leg.springs}
    if leg.carriage is not None:
        fields["carriage"] = _carriage(leg.carriage, base, normal)
    if leg.strut is None:
        return _merged(leg, fields)
    del fields["cylinder"], fields["piston"]
    return _merged(leg, fields)


def _screw(drive: ScrewDrive) -> dict[str, object]:
    return {name: x for name, x in _fields(drive).items() if name != "material"} | _material(drive.material)


def _of_all_legs(part: Geometry | Heat) -> dict[str, object]:
    """What is the same for all legs as one number."""
    inner = {n: _of_all_legs(x) if isinstance(x, Gradient) else x for n, x in _fields(part).items()}
    return {n: x.item() if isinstance(x, np.ndarray) and x.shape == (1,) else x for n, x in inner.items()}


def _joint(joint: Joint, place: Array, normal: Array) -> dict[str, object]:
    return _merged(joint, _of_joint(joint, place, normal))


def _of_joint(joint: Joint, place: Array, normal: Array) -> dict[str, object]:
    fields = _fields(joint)
    if joint.axis is not None:
        fields["axis"] = word_of(joint.axis, place, normal) or joint.axis
    given = {"damping": joint.stiffness_damping, "loss": joint.stiffness_loss}
    own = {name: value for name, value in given.items() if value}
    if joint.rolling is not None:
        fields["stiffness"] = joint.rolling
    elif joint.leg_axes and joint.stiffness is not None:
        along, across = float(joint.stiffness[2, 2]), float(joint.stiffness[0, 0])
        fields["stiffness"] = {"axial": along, "radial": across, **own}
    elif joint.stiffness is not None and own:
        turns = joint.stiffness[3:].any()
        fields["stiffness"] = {"rows": joint.stiffness if turns else joint.stiffness[:3, :3], **own}
    elif joint.across_and_along is not None:
        fields["stiffness"] = joint.across_and_along[0]
    return fields


def _carriage(carriage: Carriage, place: Array, normal: Array) -> dict[str, object]:
    unused = "mass" if carriage.kind == "crank" else "inertia"
    fields = {name: value for name, value in _fields(carriage).items() if name != unused or value}
    return _merged(carriage, {carriage.kind: word_of(carriage.axis, place, normal) or carriage.axis, **fields})


def _cylinder(cylinder: Cylinder) -> dict[str, object]:
    fields, section, material = _fields(cylinder), cylinder.section, cylinder.material
    if section is None or material is None:
        return fields
    computed = ("mass", "com", "inertia", "axial_inertia", "material")
    return {name: x for name, x in fields.items() if name not in computed} | _material(material)


def _beam(piston: Piston) -> dict[str, object]:
    fields = _fields(piston)
    if piston.keyed:
        fields.pop("keyed", None)
    if piston.sections:
        kept = ("sections", "bow", "axial_inertia", "shear")
        return {name: value for name, value in fields.items() if (name in kept and value) or name == "keyed"}
    fields.pop("sections")
    if not piston.shear:
        fields.pop("shear")
    made_of = {name: fields.pop(name, None) for name in ("E", "density")}
    if piston.E is None or piston.density is None:
        return fields
    own = {"yield_stress": piston.yield_stress, "poisson": piston.poisson, "expansion": piston.expansion}
    material = Material(name="given", E=piston.E, density=piston.density, **own)
    same = None
    if piston.diameter is not None:
        section = Tube(diameter=piston.diameter, inner_diameter=piston.inner_diameter)
        axial = piston.axial_inertia
        same = type(piston).round(length=piston.length, section=section, material=material, axial_inertia=axial)
    elif isinstance(piston, Strut) and piston.section is not None:
        same = Strut.strip(length=piston.length, section=piston.section, material=material)
    if same != piston.replace(bow=None, keyed=True, shear=False):
        return fields
    computed = ("EA", "EI", "rhoA", *(() if piston.diameter else ("axial_inertia",)))
    return {name: value for name, value in fields.items() if name not in computed} | made_of


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
    """Its name and what differs from that material, where it is one; else its values."""
    own = {name: getattr(material, name) for name in ("yield_stress", "poisson", "expansion")}
    known = MATERIALS.get(material.name)
    if known is None or None in own.values() or known.replace(**own) != material:
        return {name: value for name, value in _fields(material).items() if name != "name"}
    named: dict[str, object] = {"material": known.name}
    return named | {name: value for name, value in own.items() if value != getattr(known, name)}


def _fields(model: Frozen) -> dict[str, object]:
    skipped = model.derived
    if isinstance(model, Simulation) and model.fidelity in OWN_BASIS:
        skipped += ("basis",)
    if isinstance(model, Simulation) and model.friction == "sliding":
        skipped += ("friction",)
    if getattr(model, "poisson", None) == POISSON:
        skipped += ("poisson",)
    fields = {name: getattr(model, name) for name in type(model).model_fields if name not in skipped}
    if "file" in fields and fields["file"] is None and getattr(model, "time", None) is not None:
        fields["file"] = "table.csv"
    if isinstance(model, Floor) and model.curve is not None:
        return {"curve": model.curve}
    if isinstance(model, Floor | Spectrum) and model.spectrum is None:
        fields["spectrum"] = "table.csv"
    return {name: value for name, value in fields.items() if value is not None}


def _merged(model: Frozen, fields: dict[str, object]) -> dict[str, object]:
    """The keys of an object's table: as they were written where that still holds, else in SI."""
    if model.written is None:
        return fields
    data, changed = model.written.data, model.written.changed
    said = {*data, *changed, *model.placed}
    usual = {name: info.default for name, info in type(model).model_fields.items() if name not in said}
    given = {name: value for name, value in fields.items() if not _is(value, usual.get(name))}
    numbers = [name for name in model.placed if isinstance(fields.get(name), np.ndarray)]  # say the same anywhere
    kept = (key for key in data if model.still_says(key) and (key not in model.placed or key in numbers))
    return together(given, data, {key: data[key] for key in kept})


def _is(value: object, usual: object) -> bool:
    return type(value) is type(usual) and isinstance(value, Frozen | float | int | str) and value == usual


def _plain(value: object) -> Any:
    """A value as data of a study file."""
    if isinstance(value, Frozen):
        if value.written is not None and value.unchanged and not value.placed:
            return value.written.data
        value = _merged(value, _SPECIAL.get(type(value), _fields)(value))
    if isinstance(value, Mapping):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


_SPECIAL: dict[type, Callable[[Any], dict[str, object]]] = {
    Actuator: _actuator,
    Cylinder: _cylinder,
    Heat: _of_all_legs,
    Geometry: _of_all_legs,
    Piston: _beam,
    ScrewDrive: _screw,
    Strut: _beam,
}
