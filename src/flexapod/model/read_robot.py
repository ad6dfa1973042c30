"""From the tables [robot], [payload], [leg] of a study file to a Robot."""

from __future__ import annotations

from collections.abc import Callable

from flexapod.errors import InputError
from flexapod.model.circle import Circle, base_circle, platform_circle
from flexapod.model.damping import read_damping
from flexapod.model.drive import Drive, Feedback, ForceDrive, PrescribedDrive, ServoDrive
from flexapod.model.leg import Leg, Stroke
from flexapod.model.material import MATERIALS, Material, Tube
from flexapod.model.payload import Payload
from flexapod.model.piston import Cylinder, Piston
from flexapod.model.robot import Robot
from flexapod.model.section import Section
from flexapod.model.tables import FORCES, read_table
from flexapod.typing import Array

__all__ = ["read_material", "read_robot"]

_LENGTHS = ("length", "length", "length")
_INERTIAS = ("inertia", "inertia", "inertia")


def read_robot(top: Section) -> Robot:
    """The robot of a study file, from its whole-file section."""
    top.need("robot", "payload", "leg")
    section = top.child(top.data["robot"], "robot")
    section.only("type", "base", "platform", "home_height", "gravity")
    section.need("base", "platform", "home_height")
    return top.build(
        Robot,
        type=section.text("type", ("6-UPS",)),
        base_joints=_joints(section, "base", base_circle),
        platform_joints=_joints(section, "platform", platform_circle),
        home_height=section.number("home_height", "length"),
        gravity=section.vector("gravity", "acceleration", "acceleration", "acceleration") or (0.0, 0.0, -9.81),
        payload=_payload(top.child(top.data["payload"], "payload")),
        legs=_legs(top),
    )


def read_material(section: Section) -> Material:
    """Material of a section that has `material`, or `E` and `density`; the others may be set in both cases."""
    own = {"yield_stress": section.number("yield_stress", "stress"), "poisson": section.number("poisson", "number")}
    if "material" in section:
        for name in ("E", "density"):
            if name in section:
                raise section.error("is given together with material", name, allowed="material, or E and density")
        name = section.text("material", tuple(MATERIALS))
        material = MATERIALS[str(name)]
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
    return section.build(
        Material,
        name="given",
        E=section.number("E", "stress"),
        density=section.number("density", "density"),
        **own,
    )


def _joints(robot: Section, name: str, circle: Callable[[float, float], Array]) -> Array | list[list[float]]:
    section = robot.child(robot.data[name], name)
    if "joints" in section:
        section.only("joints")
        return section.rows("joints", 6, *_LENGTHS)
    section.only("radius", "half_angle", "joints")
    section.need("radius", "half_angle")
    found = section.build(
        Circle, radius=section.number("radius", "length"), half_angle=section.number("half_angle", "angle")
    )
    return circle(found.radius, found.half_angle)


def _payload(section: Section) -> Payload:
    section.only("mass", "inertia", "com", "tool")
    section.need("mass", "inertia", "com")
    value = section.data["inertia"]
    nested = isinstance(value, list) and any(isinstance(row, list) for row in value)
    return section.build(
        Payload,
        mass=section.number("mass", "mass"),
        inertia=section.rows("inertia", 3, *_INERTIAS) if nested else section.vector("inertia", *_INERTIAS),
        com=section.vector("com", *_LENGTHS),
        tool=section.vector("tool", *_LENGTHS),
    )


def _legs(top: Section) -> tuple[Leg, ...]:
    value = top.data["leg"]
    if not isinstance(value, list):
        section = top.child(value, "leg")
        first = _leg(section, 1)
        apart = isinstance(first.drive, ForceDrive) and first.drive.force is not None  # a column for each leg
        return (first, *(_leg(section, i) if apart else first for i in range(2, 7)))
    if len(value) != 6:
        raise InputError(
            f"appears {len(value)} times", file=top.file, key="[[leg]]", allowed="[leg] once, or [[leg]] six times"
        )
    return tuple(_leg(top.child(leg, f"leg[{i}]"), i) for i, leg in enumerate(value, start=1))


def _leg(section: Section, number: int) -> Leg:
    section.only("cylinder", "piston", "stroke", "damping", "drive", "axial_modes", "u_axis")
    section.need("cylinder", "piston")
    return section.build(
        Leg,
        cylinder=_cylinder(section.child(section.data["cylinder"], "cylinder")),
        piston=_piston(section.child(section.data["piston"], "piston")),
        stroke=_stroke(section.section("stroke")),
        damping=read_damping(section),
        drive=_drive(section.section("drive"), number),
        axial_modes=section.whole("axial_modes"),
        u_axis=section.vector("u_axis", "number", "number", "number"),
    )


def _cylinder(section: Section) -> Cylinder:
    section.only("mass", "com", "inertia", "mouth", "axial_inertia")
    return section.build(
        Cylinder,
        mass=section.number("mass", "mass"),
        com=section.number("com", "length"),
        inertia=section.number("inertia", "inertia"),
        mouth=section.number("mouth", "length"),
        axial_inertia=section.number("axial_inertia", "inertia"),
    )


def _piston(section: Section) -> Piston:
    stiffness = ("EI", "EA", "rhoA")
    made_of = ("material", "E", "density", "yield_stress", "poisson")
    section.only("length", "diameter", "inner_diameter", *made_of, *stiffness, "GJ", "axial_inertia")
    section.need("length")
    length, axial_inertia = section.number("length", "length"), section.number("axial_inertia", "inertia")
    if not any(name in section for name in (*stiffness, "GJ")):
        section.need("diameter")
        return section.build(
            Piston.round,
            section=_tube(section),
            material=read_material(section),
            length=length,
            axial_inertia=axial_inertia,
        )
    section.need(*stiffness)
    for name in ("material", "E", "density"):
        if name in section:
            raise section.error("is given together with EI, EA, rhoA", name, allowed="either of the two")
    return section.build(
        Piston,
        length=length,
        EI=section.number("EI", "bending stiffness"),
        EA=section.number("EA", "axial stiffness"),
        rhoA=section.number("rhoA", "line density"),
        diameter=section.number("diameter", "length"),
        inner_diameter=section.number("inner_diameter", "length"),
        yield_stress=section.number("yield_stress", "stress"),
        poisson=section.number("poisson", "number"),
        GJ=section.number("GJ", "bending stiffness"),
        axial_inertia=axial_inertia,
    )


def _tube(section: Section) -> Tube:
    return section.build(
        Tube,
        diameter=section.number("diameter", "length"),
        inner_diameter=section.number("inner_diameter", "length"),
    )


def _stroke(section: Section | None) -> Stroke | None:
    if section is None:
        return None
    section.only("min", "max")
    return section.build(Stroke, min=section.number("min", "length"), max=section.number("max", "length"))


def _drive(section: Section | None, number: int) -> Drive:
    if section is None:
        return PrescribedDrive()
    section.need("type")
    kind = section.text("type", ("prescribed", "servo", "force"))
    if kind == "prescribed":
        section.only("type")
        return PrescribedDrive()
    if kind == "servo":
        section.only("type", "stiffness", "damping")
        return section.build(ServoDrive, **_gains(section))
    return _force_drive(section, number)


def _force_drive(section: Section, number: int) -> ForceDrive:
    section.only("type", "law", "file", "feedback")
    law, file = section.text("law", ("rigid", "csv")), section.text("file")
    feedback = section.section("feedback")
    if feedback is not None:
        feedback.only("stiffness", "damping")
    table: dict[str, Array] = {}
    if law == "csv" and file is not None:
        table = read_table(section.folder / file, FORCES, needed=True, jumps=True)
    return section.build(
        ForceDrive,
        law=law,
        file=file,
        time=table.get("time"),
        force=table.get(f"leg {number}"),
        feedback=None if feedback is None else feedback.build(Feedback, **_gains(feedback)),
    )


def _gains(section: Section) -> dict[str, float | None]:
    return {
        "stiffness": section.number("stiffness", "stiffness"),
        "damping": section.number("damping", "damping"),
    }
