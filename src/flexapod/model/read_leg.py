"""From a table [leg] of a study file to a Leg: bodies, joints, carriage, drive."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from flexapod.elements.element import Element, registered
from flexapod.elements.known import element_at
from flexapod.errors import InputError
from flexapod.model.chain import chain_of
from flexapod.model.cylinder import Cylinder, Mounted
from flexapod.model.drive import ForceDrive, PrescribedDrive, ServoDrive
from flexapod.model.hydraulic import HydraulicDrive
from flexapod.model.joint import NO_DIRECTION, Carriage, Joint
from flexapod.model.joint_stiffness import AlongLeg, InRows
from flexapod.model.leg import Leg
from flexapod.model.material import MATERIALS, Material, Tube
from flexapod.model.piston import Piston, Strip, Strut
from flexapod.model.rolling import RollingLaw
from flexapod.model.screw import Drive, Encoder, Motor, Ripple, ScrewDrive
from flexapod.model.sections import PistonSection
from flexapod.model.spring import AxialSpring
from flexapod.schema.axes import axis_of
from flexapod.schema.columns import columns_of
from flexapod.schema.csv_tables import forces
from flexapod.schema.section import Section
from flexapod.typing import Array

P = TypeVar("P", bound=Piston)
_STIFFNESS = ("EI", "EA", "rhoA")
_SLIDING = ("stiffness", "damping", "force", "length")
_TURNING = ("rotational stiffness", "rotational damping", "torque", "angle")
_OF_MATERIAL = ("E", "density", "yield_stress", "poisson", "expansion")
IDLE = {"type": "prescribed"}
LEAST_STIFFNESS = 1e-9  # N/m, as of other springs
_TRANSLATIONS, _FORCES = ("stiffness",) * 3, ("force",) * 3


def read_leg(section: Section, number: int, count: int, chain: str, places: tuple[Array, Array, Array]) -> Leg:
    """Leg `number` of `count`, whose letters are `chain`; `places`: its base and platform joint, the normal."""
    base, platform, normal = places

    def parts(section: Section) -> dict[str, object]:
        if section.text("chain") not in (None, chain):
            raise section.error("is not the chain of this leg", "chain", allowed=f"{chain}, as robot.type says")
        letters = chain_of(chain)
        if letters.stroke and not letters.platform and "passive" not in section:
            raise InputError(
                f"must be said for {chain}, a leg that is fixed to the platform",
                file=section.file,
                key=section.key("passive"),
                allowed="true if nothing drives it, false if its stroke is driven",
                next_step=f"Add {section.key('passive')} = true",
            )
        written = section.data.get("drive", IDLE)  # files of earlier versions have the drive of all legs there
        if section.data.get("passive") is True and written != IDLE:
            raise section.error(
                f"drives a passive leg (chain {chain})",
                "drive",
                allowed="a drive, or passive = true",
                next_step="Leave it out",
            )
        section.need(*(("cylinder", "piston") if letters.stroke else ("strut",)))
        strut, carriage = section.section("strut"), section.section("carriage")
        cylinder = section.section("cylinder")
        return {
            "chain": chain,
            "cylinder": None if cylinder is None else _cylinder(cylinder),
            "piston": None if "piston" not in section else _piston(section.child(section.data["piston"], "piston")),
            "strut": None if strut is None else _strut(strut),
            "carriage": None if carriage is None else _carriage(carriage, base, normal),
            "base_joint": _joint(section, "base_joint", base, normal),
            "platform_joint": _joint(section, "platform_joint", platform, normal),
            "springs": _springs(section.section("springs")),
            "drive": _drive(section.section("drive"), number, count, _TURNING if letters.turning else _SLIDING),
            "elements": tuple(element for kind in kinds.values() for element in _elements(section, kind)),
        }

    own = {*columns_of(Leg), "count", "u_axis"} - {*Leg.derived}
    kinds = {name: kind for name in section.data if name not in own and (kind := element_at(name)) is not None}
    return section.read(Leg, also=("count", "u_axis", *registered), then=parts)


def _elements(section: Section, kind: type[Element]) -> list[Element]:
    """Elements of a kind: one table, or a list of tables."""
    given = section.data[kind.at]
    if not isinstance(given, list):
        return [section.child(given, kind.at).read(kind)]
    return [section.child(table, f"{kind.at}[{k}]").read(kind) for k, table in enumerate(given, start=1)]


def _joint(leg: Section, name: str, place: Array, normal: Array) -> Joint | None:
    axis = leg.vector("u_axis", "number", "number", "number") if name == "base_joint" else None
    if axis is not None and np.abs(axis).max() < NO_DIRECTION:
        raise leg.error("has no direction", "u_axis", allowed="a non-zero vector")
    section = leg.section(name)
    if section is None:
        return None if axis is None else Joint(axis=np.array(axis))
    if axis is not None and "axis" in section:
        raise leg.error("is given together with base_joint.axis", "u_axis", allowed="one of the two: they are the same")

    def parts(section: Section) -> dict[str, object]:
        return {"axis": axis or section.direction("axis", place, normal), **_stiffness(section)}

    return section.read(Joint, also=("at",), then=parts)


def _stiffness(section: Section) -> dict[str, object]:
    """A number, along and across the leg, a law, three or six rows; the latter with dampers as a table."""
    value = section.data.get("stiffness")
    if isinstance(value, list):
        return {"stiffness": _rows(section, "stiffness")}
    if isinstance(value, Mapping):
        inner = section.child(value, "stiffness")
        if "law" in inner:
            return {"rolling": inner.read(RollingLaw)}
        form, springs = (InRows, _in_rows) if "rows" in inner else (AlongLeg, _along_leg)
        return inner.read(form, then=lambda s: _damped(s) | springs(s)).of_joint
    number = _above_zero(section, "stiffness") if "stiffness" in section else section.number("stiffness", "stiffness")
    return {} if number is None else {"stiffness": np.diag([number] * 3 + [0.0] * 3)}


def _damped(section: Section) -> dict[str, object]:
    if "damping" in section and "loss" in section:
        raise section.error("is given together with loss", "damping", allowed="either of the two")
    return {"damping": section.number("damping", "damping"), "loss": section.number("loss", "number")}


def _along_leg(section: Section) -> dict[str, object]:
    section.need("axial", "radial")
    return {name: _above_zero(section, name) for name in ("axial", "radial")}


def _in_rows(section: Section) -> dict[str, object]:
    return {"rows": _rows(section, "rows")}


def _rows(section: Section, name: str) -> Array:
    """Three or six rows of a stiffness, (6, 6)."""
    value, found = section.data.get(name), np.zeros((6, 6))
    if isinstance(value, list) and len(value) == 6:
        mixed = (*_FORCES, *("rotational stiffness",) * 3)
        return np.array(section.rows(name, *((*_TRANSLATIONS, *_FORCES),) * 3, *(mixed,) * 3))
    found[:3, :3] = section.rows(name, *(_TRANSLATIONS,) * 3)
    return found


def _above_zero(section: Section, name: str) -> float:
    value = section.number(name, "stiffness")
    if value is None or not value > 0:
        raise section.error(
            "is not above zero: such a spring holds nothing", name, allowed="above 0 N/m; a joint without it is rigid"
        )
    if value < LEAST_STIFFNESS:
        raise section.error("is out of range", name, allowed=f"{LEAST_STIFFNESS:g} to 1e+18 N/m")
    return value


def _carriage(section: Section, base: Array, normal: Array) -> Carriage:
    def parts(section: Section) -> dict[str, object]:
        if kind not in section:
            section.need("slider")
        if "crank" in section and "slider" in section:
            raise section.error("is given together with slider", "crank", allowed="one of the two")
        axis = section.direction(kind, base, normal)
        arm = section.vector("arm", "length", "length", "length")
        radius = section.number("radius", "length")
        if radius is not None:
            if arm is not None or axis is None or kind == "slider":
                raise section.error("does not fit here", "radius", allowed="of a crank, in place of arm")
            arm = _arm(section, radius, axis, base, normal)
        return {"kind": kind, "axis": axis, "arm": arm}

    kind = "crank" if "crank" in section else "slider"
    among = ("length",) if kind == "slider" else ("angle",)
    try:
        return section.read(Carriage, among=among, also=("slider", "crank", "radius"), then=parts)
    except InputError as error:
        if error.key != section.key("axis"):
            raise
        raise section.error(error.what, kind, allowed=error.allowed) from None


def _arm(section: Section, radius: float, axis: Array, base: Array, normal: Array) -> Array:
    """Arm of a crank at angle 0: radial as far as the axis lets it, else tangential."""
    unit = axis / np.linalg.norm(axis)
    for word in ("radial", "tangential"):
        if (direction := axis_of(word, base, normal)) is not None:
            across = direction - (direction @ unit) * unit
            if (size := float(np.linalg.norm(across))) > 1e-6:
                return radius * across / size
    raise section.error("has no direction to begin in", "radius", allowed="arm = [x, y, z] for this crank")


def _sections(section: Section, model: type[P]) -> P:
    """A piston or strut of several sections."""
    for name in section.data:
        if name not in ("sections", "axial_inertia", "bow", "keyed", "shear"):
            raise section.error("is given together with sections", name, allowed="in a section, or without sections")
    given = section.data["sections"]
    if not isinstance(given, list):
        raise section.malformed("is not a list", "sections", allowed="[{ length, diameter, material }, ...]")
    tables = [section.child(data, f"sections[{k}]") for k, data in enumerate(given, start=1)]
    return section.build(
        model.stepped,
        sections=[table.read(PistonSection, also=("material",), then=_of_material) for table in tables],
        axial_inertia=section.number("axial_inertia", "inertia"),
        bow=section.number("bow", "length"),
        shear=section.flag("shear"),
    )


def _of_material(section: Section) -> dict[str, object]:
    material = read_material(section)
    return {name: getattr(material, name) for name in _OF_MATERIAL}


def _piston(section: Section) -> Piston:
    keyed = section.flag("keyed")
    return _beam(section).replace(**({} if keyed is None else {"keyed": keyed})).keep(section.written)


def _beam(section: Section) -> Piston:
    section.only(*columns_of(Piston), "material")
    if "sections" in section:
        return _sections(section, Piston)
    if any(name in section for name in (*_STIFFNESS, "GJ")):
        return _given(section, Piston)
    section.need("length", "diameter")
    return section.build(
        Piston.round,
        length=section.number("length", "length"),
        section=section.build(Tube, **_diameters(section)),
        material=read_material(section),
        axial_inertia=section.number("axial_inertia", "inertia"),
        bow=section.number("bow", "length"),
        shear=section.flag("shear"),
    )


def _cylinder(section: Section) -> Cylinder:
    """A rigid cylinder, or one whose section is given."""
    section.only(*columns_of(Cylinder), *_OF_MATERIAL)
    tube: dict[str, object] = {name: None for name in ("diameter", "inner_diameter", "material", "body")}
    if not any(name in section for name in (*tube, *_OF_MATERIAL)):
        return section.read(Cylinder, also=_OF_MATERIAL, then=lambda _: tube)
    for name in ("mass", "com", "inertia", "axial_inertia"):
        if name in section:
            raise section.error(
                "follows from section and material of the cylinder", name, allowed="body, for what is mounted on it"
            )
    section.need("mouth", "diameter")
    body = section.section("body")
    cylinder = section.build(
        Cylinder.tube,
        mouth=section.number("mouth", "length"),
        section=section.build(Tube, **_diameters(section)),
        material=read_material(section),
        body=None if body is None else body.read(Mounted),
    )
    return cylinder.keep(section.written)


def _strut(section: Section) -> Strut:
    return _rod(section).keep(section.written)


def _rod(section: Section) -> Strut:
    section.only(*(name for name in columns_of(Strut) if name not in Strut.derived), "material")
    if "sections" in section:
        return _sections(section, Strut)
    if any(name in section for name in (*_STIFFNESS, "GJ")):
        return _given(section, Strut)
    section.need("length")
    length, strip = section.number("length", "length"), section.section("section")
    if strip is None:
        section.need("diameter")
        round_section = section.build(Tube, **_diameters(section))
        axial_inertia = section.number("axial_inertia", "inertia")
        return section.build(
            Strut.round,
            length=length,
            section=round_section,
            material=read_material(section),
            axial_inertia=axial_inertia,
            bow=section.number("bow", "length"),
            shear=section.flag("shear"),
        )
    for name in ("diameter", "inner_diameter", "axial_inertia"):
        if name in section:
            raise section.error("is given together with section", name, allowed="either of the two")
    parts = {"section": strip.read(Strip), "material": read_material(section)}
    return section.build(Strut.strip, length=length, bow=section.number("bow", "length"), **parts)


def _given(section: Section, model: type[P]) -> P:
    """A piston or strut by its stiffness."""
    section.need("length", *_STIFFNESS)
    for name in ("material", "E", "density"):
        if name in section:
            raise section.error("is given together with EI, EA, rhoA", name, allowed="either of the two")
    return section.read(model, also=("material",))


def _diameters(section: Section) -> dict[str, float | None]:
    return {name: section.number(name, "length") for name in ("diameter", "inner_diameter")}


def _drive(section: Section | None, number: int, count: int, among: tuple[str, ...]) -> Drive | None:
    if section is None:
        return None

    def table(section: Section) -> dict[str, object]:
        if section.data.get("law") != "csv" or "file" not in section:
            return {}
        found = section.table(forces(count, among[2]), needed=True, jumps=True)
        return {"time": found["time"], "force": found[f"leg {number}"]}

    def turned(section: Section) -> dict[str, object]:
        parts = _screw_parts(section)
        if section.data.get("law") != "csv" or "file" not in section:
            return parts
        found = section.table(forces(count, "torque"), needed=True, jumps=True)
        return parts | {"time": found["time"], "torque": found[f"leg {number}"]}

    def volumes(section: Section) -> dict[str, object]:
        both = isinstance(section.data.get("dead_volume"), list)
        value = section.vector("dead_volume", "volume", "volume") if both else section.number("dead_volume", "volume")
        return {"dead_volume": value}

    kinds = (PrescribedDrive, ServoDrive, ForceDrive, ScrewDrive, HydraulicDrive)
    readers = {
        ForceDrive: lambda s: s.read(ForceDrive, among=among, then=table),
        HydraulicDrive: lambda s: s.read(HydraulicDrive, then=volumes),
        ScrewDrive: lambda s: s.read(ScrewDrive, among=_TURNING, also=_OF_MATERIAL, then=turned),
    }
    return section.one_of(kinds, among=among, readers=readers)


def _screw_parts(section: Section) -> dict[str, object]:
    encoder = section.section("encoder")
    turns = encoder is None or encoder.data.get("at", "rotor") == "rotor"
    measure = ("angle",) if turns else ("length",)
    motor = section.section("motor")
    return {
        "material": read_material(section),
        "encoder": encoder and encoder.read(Encoder, among=measure),
        "motor": motor and motor.read(Motor, then=_ripple),
    }


def _ripple(motor: Section) -> dict[str, object]:
    section = motor.section("ripple")
    return {"ripple": section and section.read(Ripple, then=_harmonics)}


def _harmonics(section: Section) -> dict[str, object]:
    given = section.data.get("harmonics")
    return {"harmonics": section.vector("harmonics", *("number",) * (len(given) if isinstance(given, list) else 1))}


def _springs(section: Section | None) -> tuple[AxialSpring, ...] | None:
    """Springs along a leg by name: a number, or a table."""
    if section is None:
        return None
    section.any_names()
    found = []
    for name, value in section.data.items():
        spring = section.child(value if isinstance(value, Mapping) else {}, name)
        if isinstance(value, Mapping):
            found.append(spring.read(AxialSpring, then=lambda _, name=name: {"name": name}))
        else:
            found.append(spring.build(AxialSpring, name=name, stiffness=_above_zero(section, name)))
    return tuple(found)


def read_material(section: Section) -> Material:
    """Material of a section that has `material`, or `E` and `density`; the others may be set in both cases."""
    own = {
        "yield_stress": section.number("yield_stress", "stress"),
        "poisson": section.number("poisson", "number"),
        "expansion": section.number("expansion", "expansion"),
    }
    if "material" in section:
        for name in ("E", "density"):
            if name in section:
                raise section.error("is given together with material", name, allowed="material, or E and density")
        material = MATERIALS[str(section.text("material", tuple(MATERIALS)))]
        given = {key: value for key, value in own.items() if value is not None}
        return section.build(material.replace, **given) if given else material
    if "E" not in section and "density" not in section:
        raise InputError(
            "is missing",
            file=section.file,
            key=section.key("material"),
            allowed=f"material ({', '.join(MATERIALS)}), or E and density",
            next_step=f"Add {section.key('material')}",
        )
    section.need("E", "density")
    modulus, density = section.number("E", "stress"), section.number("density", "density")
    return section.build(Material, name="given", E=modulus, density=density, **own)
