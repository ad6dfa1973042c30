"""One leg: cylinder, piston, stroke, drive."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, InstanceOf, SerializeAsAny, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text
from flexapod.common.tables.base import Key, Quantity, Vec3
from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.table import Table
from flexapod.mechanics.elements.element import Element, registered
from flexapod.mechanics.elements.registry import element_values, read_elements
from flexapod.model.leg.chain import Chain, chain_of
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.damping import BodyDamping, damping_parts
from flexapod.model.leg.drive import ForceDrive, PrescribedDrive
from flexapod.model.leg.guide import Guide
from flexapod.model.leg.hydraulic import HydraulicDrive
from flexapod.model.leg.joint import Carriage, Joint, read_carriage, read_joint
from flexapod.model.leg.piston import Piston, Strut
from flexapod.model.leg.screw import TURNING, Drive, ScrewDrive
from flexapod.model.leg.spring import AxialSpring, read_springs

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

SLIDING = ("stiffness", "damping", "force", "length")
IDLE = {"type": "prescribed"}
NOTHING = Cylinder(mass=0.0, mouth=0.0)  # in place of the cylinder that a strut does not have


class Stroke(Table):
    """Allowed joint-to-joint length [m]."""

    min: Annotated[float, Quantity("length", least=0, why="shortest length")]
    max: Annotated[float, Quantity("length", above=0, why="longest length, above the shortest")]

    @model_validator(mode="after")
    def _ordered(self) -> Stroke:
        if self.min >= self.max:
            raise InputError(
                "is not above the shortest length",
                key="max",
                value=self.max,
                allowed=f"above min = {self.min:g} m",
                next_step="min and max are joint-to-joint lengths of the leg",
            )
        return self


class Leg(Table):
    """A leg between base and platform: a chain of joints, of letters "UPS" unless others are given (`model.chain`).

    `cylinder` and `piston` of a leg with a stroke, or `strut` of fixed length (then `piston` is the strut, `cylinder`
    nothing); `guide`: bushings of the piston, which is clamped at the mouth without it; `carriage`: what moves the
    foot, where the letters have one; `base_joint`, `platform_joint`;
    `springs` along it, in series with its other parts; `passive`: nothing drives it; `damping`: modal damping ratio of
    the piston, or `Damping` with a part in proportion to its stiffness; `axial_modes`: number of axial shapes, the
    static one first; `elements`: parts with tables of their own (`flexapod.Element`).
    `u_axis` stands for the axis of `base_joint`.
    """

    derived: ClassVar[tuple[str, ...]] = ("elements",)
    placed: ClassVar[tuple[str, ...]] = ("base_joint", "platform_joint", "carriage", "u_axis", "count", "chain")

    chain: Annotated[str, Key("letters of the leg, as `robot.type` has them", usual="that of robot.type")] = "UPS"
    passive: Annotated[
        bool, Key("nothing drives it", usual="false; required where the leg is fixed to the platform")
    ] = False
    cylinder: Annotated[Cylinder, Key("table: the lower part")] = NOTHING
    piston: Annotated[Piston, Key("table: the upper part")]
    strut: Annotated[Strut | None, Key("table: a rod of fixed length in place of cylinder and piston")] = None
    guide: Annotated[Guide | None, Key("table: two bushings that hold the piston across")] = None
    carriage: Annotated[Carriage | None, Key("table: what moves the foot")] = None
    base_joint: Annotated[Joint, Key("table: the joint at the base", usual="free as its letter says")] = Joint()
    platform_joint: Annotated[Joint, Key("table: the joint at the platform", usual="free as its letter says")] = Joint()
    springs: Annotated[tuple[AxialSpring, ...], Key("table: springs along the leg, by name")] = ()
    stroke: Annotated[Stroke | None, Key("table: limits of the length", usual="no limits")] = None
    damping: Annotated[BodyDamping, Key("damping ratio of the piston's modes, or a table")] = 0.0
    drive: Annotated[Drive, Key("table: what moves the piston", usual="prescribed")] = PrescribedDrive()
    axial_modes: Annotated[int, Key("shapes of the piston's stretch, the static one first")] = Field(
        default=2, strict=True, ge=0, le=4
    )
    elements: tuple[SerializeAsAny[InstanceOf[Element]], ...] = ()

    def __init__(self, **fields: Any) -> None:
        if fields.get("strut") is not None and fields.get("piston") not in (None, fields["strut"]):
            raise InputError("is given together with strut", key="piston", allowed="one of the two")
        if (axis := fields.pop("u_axis", None)) is not None:
            fields["base_joint"] = (fields.get("base_joint") or Joint()).replace(axis=axis)
        super().__init__(**fields)

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The beam of a strut is the strut."""
        return {} if fields.get("strut") is None else {"piston": fields["strut"]}

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed, as `Table.replace`; the piston of a leg with a strut is the strut."""
        if self.strut is not None and "strut" not in changes and isinstance(changes.get("piston"), Strut):
            changes["strut"] = changes.pop("piston")
        return super().replace(**changes)

    @property
    def u_axis(self) -> Vec3 | None:
        """Direction of the base joint's axis that is fixed to the base (3,), world axes; None: Z x leg."""
        return self.base_joint.axis

    @property
    def letters(self) -> Chain:
        """Meaning of the letters of its chain."""
        return chain_of(self.chain)

    @property
    def swings(self) -> bool:
        """Tell whether both its joints turn freely: nothing holds it across."""
        letters = self.letters
        return letters.base in ("U", "S") and letters.platform == "S"

    @property
    def driven(self) -> str:
        """Part that its drive moves: "stroke", "carriage", "" of a passive leg."""
        return "" if self.passive else self.letters.driven

    @property
    def screw(self) -> ScrewDrive | None:
        """Drive that is a screw, or None."""
        return self.drive if isinstance(self.drive, ScrewDrive) else None

    @property
    def gives(self) -> bool:
        """Tell whether springs stand between its drive and its piston."""
        driven = self.screw is not None or self.cylinder_of_oil is not None
        return driven or any(spring.at == "nut" for spring in self.springs) or self.pressed > 0

    @property
    def pressed(self) -> float:
        """Length of a cylinder with a section that the thrust of its drive stretches, from the base joint [m].

        Up to the bearing of a screw, or to the bottom: where the piston's inner end is at the least stroke.
        """
        held = self.driven == "stroke" and not isinstance(self.drive, ForceDrive)
        return max(self.begins - self.piston.length, 0.0) if held and self.cylinder.section is not None else 0.0

    @property
    def cylinder_of_oil(self) -> HydraulicDrive | None:
        """Drive that is hydraulic, or None."""
        return self.drive if isinstance(self.drive, HydraulicDrive) else None

    @property
    def begins(self) -> float:
        """Length of the leg with the piston's inner end where its screw or its stroke begins [m]."""
        if self.screw is not None:
            return self.piston.length + self.screw.bearing.position
        oil = self.cylinder_of_oil
        if oil is not None and oil.bottom is not None:
            return self.piston.length + oil.bottom
        return 0.0 if self.stroke is None else self.stroke.min

    @property
    def closed_about(self) -> str:
        """Place of the loop of its motor if that is not the rotor: "stroke", "joint-to-joint"; "" otherwise."""
        return self.measured if self.screw is not None and self.screw.closes_elsewhere else ""

    @property
    def backlash(self) -> float:
        """Free travel of its drive, from one end to the other [m], of a crank [rad]."""
        holder = self.drive if self.screw is None else self.screw.nut
        return getattr(holder, "backlash", None) or 0.0

    @property
    def half_play(self) -> float:
        """Half of all free travel along a leg that is driven by its stroke [m]."""
        return 0.5 * ((self.base_joint.play or 0.0) + (self.platform_joint.play or 0.0) + self.backlash)

    @property
    def holds_stroke(self) -> bool:
        """Tell whether a drive that holds its command holds the stroke, not a rotor before it."""
        return self.screw.holds_stroke if self.screw is not None else not self.gives

    @property
    def turning(self) -> float:
        """Length that a turn of the piston in its cylinder adds [m/rad], Eq. (T23.41); 0 inside a loop."""
        unkeyed = self.screw is not None and not self.piston.keyed and self.measured == "rotor"
        return self.screw.per_turn if unkeyed else 0.0  # type: ignore[union-attr]

    @property
    def measured(self) -> str:
        """Place of its measurement: "rotor", "stroke" or "joint-to-joint"; what lies before is made up for."""
        return "rotor" if self.screw is None else self.screw.encoder.at

    def _shown(self) -> dict[str, str]:
        letters = {} if self.chain == "UPS" else {"chain": self.chain + (", passive" if self.passive else "")}
        width = "" if self.piston.diameter is None else f"{text(self.piston.diameter, 'm', 4)} thick, "
        beam = (
            f"{width}{text(self.piston.length, 'm', 4)} long, EA {text(self.piston.EA, 'N', 4)}, "
            f"EI {number(self.piston.EI, 4)} N m^2"
        )
        mouth = f"mouth at {text(self.cylinder.mouth, 'm', 4)}, {number(self.cylinder.mass, 4)} kg"
        bodies = {"piston": beam, "cylinder": mouth} if self.strut is None else {"strut": beam}
        carriage = {} if self.carriage is None else {"carriage": self.carriage.kind}
        ends = () if self.stroke is None else (text(self.stroke.min, "m", 4), text(self.stroke.max, "m", 4))
        limits = {"stroke": " to ".join(ends) + " joint to joint"} if ends else {}
        drive = {"drive": self.drive.type} if self.driven else {}
        return {**letters, **carriage, **bodies, **limits, **drive, "damping": _damped(self.damping)}

    @model_validator(mode="after")
    def _parts_of_its_chain(self) -> Leg:
        try:
            letters = self.letters
        except InputError as error:
            raise error.with_location(prefix="chain") from None
        if not letters.stroke and self.strut is None:
            raise _misfit(self.chain, "strut", "is missing: without P or C the leg is a rod of fixed length")
        if letters.stroke and self.strut is not None:
            raise _misfit(self.chain, "strut", "does not fit a leg with a stroke", "cylinder and piston")
        if not letters.stroke and self.cylinder != NOTHING:
            raise _misfit(self.chain, "cylinder", "does not fit a strut", "strut and carriage")
        if not letters.stroke and self.stroke is not None:
            raise _misfit(self.chain, "stroke", "limits a stroke that the leg does not have", "carriage.stroke")
        if letters.carriage != ("" if self.carriage is None else self.carriage.kind):
            if self.carriage is None:
                raise _misfit(self.chain, "carriage", f"is missing: {self.chain[0]} moves the foot of the leg")
            allowed = f"a {letters.carriage}" if letters.carriage else "P or R before the base joint: PUS, RUS"
            raise _misfit(self.chain, "carriage", f"is a {self.carriage.kind}", allowed)
        if not self.passive and not letters.driven:
            raise _misfit(self.chain, "chain", "has no drive: no P, no C, no R before the base joint", "passive = true")
        if self.passive and self.drive != PrescribedDrive():
            raise _misfit(self.chain, "drive", "drives a passive leg", "a drive, or passive = true")
        crooked = self.piston.bow or self.base_joint.eccentricity or self.platform_joint.eccentricity
        if crooked and not self.swings:
            key = "piston.bow" if self.piston.bow else "platform_joint.eccentricity"
            raise _misfit(self.chain, key, "is of legs that no joint holds across", "legs UPS, SPS and their like")
        return self

    @model_validator(mode="after")
    def _friction_where_something_slides(self) -> Leg:
        letters = self.letters
        ends = (
            ("base_joint", self.base_joint, letters.base),
            ("platform_joint", self.platform_joint, letters.platform),
        )
        for name, joint, letter in ends:
            if joint.friction is not None and letter in ("F", ""):
                raise _misfit(self.chain, f"{name}.friction", "is of a joint that does not turn", "U, S or R there")
        if self.drive.friction is not None and self.driven != "stroke":
            raise _misfit(self.chain, "drive.friction", "belongs to a driven stroke")
        return self

    @model_validator(mode="after")
    def _guided(self) -> Leg:
        if self.guide is None:
            return self
        if self.strut is not None:
            raise _misfit(self.chain, "guide", "does not fit a strut: nothing slides", "cylinder and piston")
        if self.guide.clearance and not self.swings:
            what = "is of legs that no joint holds across"
            raise _misfit(self.chain, "guide.clearance", what, "legs UPS, SPS and their like", "Leave clearance out")
        if self.stroke is not None and (overlap := self.overlap(self.stroke.max)) <= 0:
            raise InputError(
                f"leaves no overlap of the bushings at the longest leg of {self.stroke.max:g} m ({overlap:g} m)",
                key="guide",
                allowed=f"a leg below cylinder.mouth + piston.length = {self.cylinder.mouth + self.piston.length:g} m",
                next_step="A longer piston, or a shorter stroke.max",
            )
        return self

    def overlap(self, length: float) -> float:
        """Distance of gland and head of a leg of some length [m]."""
        return self.cylinder.mouth + self.piston.length - length

    @model_validator(mode="after")
    def _keyed(self) -> Leg:
        if self.piston.keyed or (self.screw is not None and self.letters.stroke == "C"):
            return self
        raise _misfit(
            self.chain,
            "piston.keyed",
            "lets a piston turn that a key or its joints hold, or that no screw drives",
            "of legs with C for their stroke (UCU) and a screw as their drive; true elsewhere",
        )

    @model_validator(mode="after")
    def _springs_where_they_act(self) -> Leg:
        names = [spring.name for spring in self.springs]
        for spring in self.springs:
            if names.count(spring.name) > 1:
                raise InputError("stands there twice", key=f"springs.{spring.name}", allowed="each name once")
            joint = {"base": self.base_joint, "platform": self.platform_joint}.get(spring.at)
            if joint is not None and joint.flexes:
                raise InputError(
                    "is in series with a joint whose stiffness has axes of its own",
                    key=f"springs.{spring.name}",
                    allowed='at = "nut", or a joint of stiffness { axial, radial }',
                )
        if not self.gives:
            return self
        oil = self.cylinder_of_oil
        if oil is not None and oil.bottom is None and self.stroke is None:
            raise InputError(
                "is missing: where the stroke of the hydraulic cylinder begins is not known",
                key="drive.bottom",
                next_step="Add drive.bottom, or stroke = { min, max } of the leg: then it begins at min",
            )
        key = "drive" if self.screw is not None or oil is not None else "springs"
        if self.driven != "stroke":
            raise _misfit(self.chain, key, "belongs to a driven stroke", 'at = "base" or "platform" of springs')
        if isinstance(self.drive, ForceDrive):
            raise InputError(
                "does nothing behind a force drive: a force is the same at both ends of a spring",
                key=key,
                allowed='at = "base" or "platform", or a drive that has a position',
            )
        return self

    def told_at(self, base: Array, platform: Array, normal: Array) -> dict[str, object]:
        """Keys with its joints at their places (3,) [m]."""
        fields = self.si_values()
        del fields["chain"]  # the robot's type has it
        if self.letters.platform and not self.passive:
            del fields["passive"]
        if self.passive:
            del fields["drive"]
        for name, place in (("base_joint", base), ("platform_joint", platform)):
            fields[name] = getattr(self, name).told_at(place, normal)
            if not fields[name]:
                del fields[name]
        del fields["springs"]
        if self.springs:
            fields["springs"] = {spring.name: spring for spring in self.springs}
        fields |= element_values(self.elements)
        if self.carriage is not None:
            fields["carriage"] = self.carriage.told_at(base, normal)
        if self.strut is not None:
            del fields["cylinder"]
        return self.data(fields)


def _misfit(chain: str, key: str, what: str, allowed: str | None = None, next_step: str | None = None) -> InputError:
    return InputError(f"{what} (chain {chain})", key=key, allowed=allowed, next_step=next_step)


def _damped(damping: BodyDamping) -> str:
    ratio, time = damping_parts(damping)
    return f"{number(100 * ratio)} %" + (f" and {text(time, 's')} times stiffness" if time else "")


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
        section.require_keys(*(("cylinder", "piston") if letters.stroke else ("strut",)))
        strut, carriage = section.section("strut"), section.section("carriage")
        cylinder, piston = section.section("cylinder"), section.section("piston")
        return {
            "chain": chain,
            "cylinder": None if cylinder is None else Cylinder.from_table(cylinder),
            "piston": None if piston is None else Piston.from_table(piston),
            "strut": None if strut is None else Strut.from_table(strut),
            "carriage": None if carriage is None else read_carriage(carriage, base, normal),
            "base_joint": read_joint(section, "base_joint", base, normal),
            "platform_joint": read_joint(section, "platform_joint", platform, normal),
            "springs": read_springs(section.section("springs")),
            "drive": _drive(section.section("drive"), TURNING if letters.turning else SLIDING),
            "elements": elements,
        }

    elements = read_elements(section, {*columns_of(Leg), "count", "u_axis"} - {*Leg.derived})
    return section.read(Leg, also=("count", "u_axis", *registered), then=parts)


def _drive(section: Section | None, among: tuple[str, ...]) -> Drive | None:
    return None if section is None else section.one_of(columns_of(Leg)["drive"].models, among=among)  # type: ignore
