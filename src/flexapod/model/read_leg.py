"""From a table [leg] of a study file to a Leg: bodies, joints, carriage, drive."""

from __future__ import annotations

import numpy as np

from flexapod.errors import InputError
from flexapod.model.chain import chain_of
from flexapod.model.cylinder import Cylinder
from flexapod.model.joint import NO_DIRECTION, Carriage, Joint
from flexapod.model.joint_stiffness import read_stiffness
from flexapod.model.leg import Leg
from flexapod.model.piston import Piston, Strut
from flexapod.model.screw import TURNING, Drive
from flexapod.model.spring import read_springs
from flexapod.schema.axes import axis_of
from flexapod.schema.columns import columns_of
from flexapod.schema.section import Section
from flexapod.typing import Array

SLIDING = ("stiffness", "damping", "force", "length")
IDLE = {"type": "prescribed"}


def read_leg(section: Section, number: int, count: int, chain: str, places: tuple[Array, Array, Array]) -> Leg:
    """Leg `number` of `count`, whose letters are `chain`; `places`: its base and platform joint, the normal."""
    base, platform, normal = places
    section.leg = (number, count)

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
            "cylinder": None if cylinder is None else Cylinder.from_table(cylinder),
            "piston": _piston(section.section("piston")),
            "strut": None if strut is None else Strut.from_table(strut),
            "carriage": None if carriage is None else _carriage(carriage, base, normal),
            "base_joint": _joint(section, "base_joint", base, normal),
            "platform_joint": _joint(section, "platform_joint", platform, normal),
            "springs": read_springs(section.section("springs")),
            "drive": _drive(section.section("drive"), TURNING if letters.turning else SLIDING),
        }

    return section.read(Leg, also=("count", "u_axis"), then=parts)


def _piston(section: Section | None) -> Piston | None:
    return None if section is None else Piston.from_table(section)


def _drive(section: Section | None, among: tuple[str, ...]) -> Drive | None:
    return None if section is None else section.one_of(columns_of(Leg)["drive"].models, among=among)  # type: ignore


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
        return {"axis": axis or section.direction("axis", place, normal), **read_stiffness(section)}

    return section.read(Joint, also=("at",), then=parts)


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
