"""The paper's planar actuator: a beam that slides out of a rotating hub."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.quantities import number, text
from flexapod.common.tables.base import Key, Quantity, nearly_same
from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.table import Table
from flexapod.model.laws import ConstantLaw, CsvLaw, LoadLaw, MotionLaw, RateLaw, Wrench, read_wrench
from flexapod.model.leg.damping import BodyDamping
from flexapod.model.leg.material import OF_MATERIAL, MadeOf, Material, Rectangle, Tube, read_material
from flexapod.model.motion import check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

#: Fields that only an actuator in space has.
IN_SPACE = (
    "elevation", "EA", "GJ", "axial_inertia", "tip_axial_inertia", "hub_axial_inertia", "axial_modes",
)  # fmt: skip

_STIFFNESS = ("rhoA", "EI")
_DRIVEN = {  # what a load drives: the load and its dimension, the dimensions of the motion
    "rotation": ("torque", "torque", ("angle", "angular rate")),
    "extension": ("force", "force", ("length", "velocity")),
    "elevation": ("elevation_torque", "torque", ("angle", "angular rate")),
}


class Actuator(MadeOf):
    """A uniform beam in a hub, moving in a plane, or in `space`: about two axes, then of round section.

    `length` [m], whole beam; `rhoA` [kg/m]; `EI` [N m^2]; `free_length` [m], outside the hub at t = 0; `tip_mass` [kg];
    `tip_inertia`, `hub_inertia` [kg m^2]; `hub_radius` [m], from the pivot to the clamp; `angle` [rad] from the
    horizontal at t = 0; `gravity` [m/s^2], along -Y in the plane; `damping`, modal damping ratio, or
    `Damping` with a part in proportion to stiffness; `section` and `material` where they are known. In space the hub
    turns by `angle` about Z and by `elevation` [rad] towards Z, gravity is along -Z, and the beam may stretch
    (`EA` [N], `axial_modes` shapes) and twist (`GJ` [N m^2], `axial_inertia` [kg m^2] of the whole beam)
    from its inner end; `tip_axial_inertia`, `hub_axial_inertia` [kg m^2] about its axis.
    """

    _source: ClassVar[str] = "section and material"

    length: Annotated[float, Quantity("length", above=0, why="whole beam")]
    rhoA: Annotated[float, Quantity("line density", above=0, why="mass per length", usual="of section and material")]
    EI: Annotated[
        float, Quantity("bending stiffness", above=0, why="bending stiffness", usual="of section and material")
    ]
    free_length: Annotated[float, Quantity("length", above=0, why="outside the hub at t = 0, at most the length")]
    tip_mass: Annotated[float, Quantity("mass", least=0, why="point mass at the tip")] = 0.0
    tip_inertia: Annotated[float, Quantity("inertia", least=0, why="moment of inertia of the tip's body")] = 0.0
    hub_inertia: Annotated[float, Quantity("inertia", least=0, why="moment of inertia of the hub")] = 0.0
    hub_radius: Annotated[float, Quantity("length", least=0, why="from the pivot to where the beam comes out")] = 0.0
    angle: Annotated[float, Quantity("angle", why="from the horizontal at t = 0")] = 0.0
    gravity: Annotated[float, Quantity("acceleration", why="acceleration along -Y, in the plane of motion")] = 0.0
    damping: Annotated[BodyDamping, Key("damping ratio of the bending modes, or a table")] = 0.0
    section: Annotated[Tube | Rectangle | None, Key("table: section of the beam")] = None
    material: Annotated[Material | None, Key("in place of E, density and yield_stress")] = None
    space: Annotated[bool, Key("true: the hub turns about two axes", usual="false")] = False
    elevation: Annotated[float, Quantity("angle", why="from the horizontal at t = 0, towards Z")] = 0.0
    EA: Annotated[
        float | None, Quantity("axial stiffness", above=0, why="axial stiffness", usual="does not stretch")
    ] = None
    GJ: Annotated[
        float | None, Quantity("bending stiffness", above=0, why="torsional stiffness", usual="does not twist")
    ] = None
    axial_inertia: Annotated[
        float, Quantity("inertia", least=0, why="moment of inertia of the whole beam about its axis")
    ] = 0.0
    tip_axial_inertia: Annotated[float, Quantity("inertia", least=0, why="of the tip's body about the beam")] = 0.0
    hub_axial_inertia: Annotated[float, Quantity("inertia", least=0, why="of the hub about the beam")] = 0.0
    axial_modes: Annotated[int, Key("axial shapes")] = Field(default=2, strict=True, ge=1, le=6)

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Section and material; nothing of a beam that is given by its stiffness alone."""
        made_of = [name for name in ("material", *OF_MATERIAL) if name in section]
        by_hand = [name for name in _STIFFNESS if name in section]
        allowed = "rhoA and EI, or section and material"
        if "section" not in section:
            section.require_keys(*_STIFFNESS)
            if made_of:
                raise section.error("needs a section", made_of[0], allowed=allowed)
            return {}
        if by_hand and (len(by_hand) == 1 or made_of):
            raise section.error("is given together with section", by_hand[0], allowed=allowed)
        inner = section.child(section.data["section"], "section")
        model = Rectangle if "width" in inner or "height" in inner else Tube
        shape = inner.read(model, also=("width", "height") if model is Tube else ())
        return {"section": shape, "material": None if by_hand else read_material(section)}

    def _shown(self) -> dict[str, str]:
        tip = {"tip": f"{number(self.tip_mass, 4)} kg"} if self.tip_mass else {}
        return {
            "beam": f"{text(self.length, 'm', 4)}, {text(self.free_length, 'm', 4)} of it outside the hub at t = 0",
            "EI": f"{number(self.EI, 5)} N m^2",
            "rhoA": f"{number(self.rhoA, 4)} kg/m",
            **tip,
        }

    @model_validator(mode="after")
    def _fits(self) -> Actuator:
        if self.section is None and self.material is not None:
            raise InputError("is missing", key="section", allowed="section and material, or rhoA and EI")
        if self.free_length > self.length:
            raise InputError(
                "is longer than the whole beam",
                key="free_length",
                value=self.free_length,
                allowed=f"above 0, at most length = {self.length:g} m",
            )
        if self.section is not None and self.section.depth >= self.length:
            raise InputError("makes the beam thicker than long", key="section", allowed=f"below {self.length:g} m")
        return self

    @model_validator(mode="after")
    def _in_space(self) -> Actuator:
        fields = type(self).model_fields
        for name in () if self.space else IN_SPACE:
            if getattr(self, name) != fields[name].default:
                raise InputError(
                    "belongs to an actuator in space: in its plane the beam neither stretches nor twists",
                    key=name,
                    value=getattr(self, name),
                    next_step="Add space = true to [actuator], or leave it out",
                )
        if self.space and isinstance(self.section, Rectangle):
            raise InputError(
                "bends differently in two planes", key="section", allowed="in space a round section: diameter"
            )
        if self.GJ is not None and not self.axial_inertia:
            raise InputError(
                "needs the inertia of what twists", key="GJ", value=self.GJ, next_step="Give axial_inertia, above 0"
            )
        if self.EA is None and self.axial_modes != fields["axial_modes"].default:
            raise InputError(
                "counts shapes of a beam that stretches",
                key="axial_modes",
                value=self.axial_modes,
                next_step="Give EA, or leave it out",
            )
        return self

    def refuse_space(self) -> None:
        """Refuse an actuator in space: for models that know the plane alone."""
        if self.space:
            raise InputError(
                "is not modelled here: this reference moves in its plane",
                key="actuator.space",
                value=True,
                allowed="false",
                next_step="Leave space out, or use flexapod run",
            )

    if TYPE_CHECKING:  # what follows need not be given

        def __init__(self, **fields: Any) -> None: ...

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """Mass and stiffness, of section and material."""
        given, material = fields.get("section"), Material._of(fields.get("material"))
        if not isinstance(given, Tube | Rectangle) or material is None:
            return {}
        return {"rhoA": material.density * given.area, "EI": material.E * given.second_moment}

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed; what follows from section and material follows from the new ones.

        By hand rhoA and EI stand in place of the material; so does what they were where section or material is taken
        away (None).

        Raises
        ------
        InputError
            If a field does not exist, the new value is not allowed, or it contradicts others.
        """
        follow = self._following({**self._given, **changes})
        given = {name: changes[name] for name in _STIFFNESS if changes.get(name) is not None}
        by_hand = not follow or any(not nearly_same(value, follow[name]) for name, value in given.items())
        if changes.get("material") is None and by_hand:
            changes["material"] = None
        return super().replace(**changes)

    @classmethod
    def from_section(cls, *, section: Tube | Rectangle, material: Material, **fields: Any) -> Actuator:
        """An actuator whose rhoA and EI follow from section and material; `fields` are the others."""
        return cls(section=section, material=material, **fields)


class ActuatorMotion(Table):
    """Prescribed `rotation`, in space `elevation` [rad], `extension` [m] since t = 0; None: that coordinate is free."""

    rotation: MotionLaw | None = RateLaw(rate=0.0)
    extension: MotionLaw | None = RateLaw(rate=0.0)
    elevation: MotionLaw | None = RateLaw(rate=0.0)

    def _shown(self) -> Mapping[str, str]:
        words = super()._shown()
        return words if self.elevation != RateLaw(rate=0.0) else {k: v for k, v in words.items() if k != "elevation"}

    @model_validator(mode="after")
    def _smooth(self) -> ActuatorMotion:
        for name in type(self).model_fields:
            law = getattr(self, name)
            if isinstance(law, CsvLaw):
                check_times(law.time, len(law.value), key=f"{name}.time")
        return self

    @property
    def laws(self) -> tuple[MotionLaw | None, ...]:
        """Laws of rotation, extension and elevation."""
        return self.rotation, self.extension, self.elevation

    @property
    def rate_jumps(self) -> tuple[float, ...]:
        """Instants after t = 0 at which a prescribed rate jumps [s]."""
        return tuple(sorted({law.duration for law in self.laws if law is not None and law.law == "linear"}))

    @property
    def end_time(self) -> float | None:
        """Instant at which the last law with an end has reached it [s]; None where a constant rate never ends."""
        ends = []
        for law in self.laws:
            if law is None or law.law in ("rate", "spin-up"):
                if law is None or law.rate != 0:  # type: ignore[union-attr]
                    return None
            else:
                ends.append(float(law.time[-1]) if law.law == "csv" else law.duration)  # type: ignore[union-attr]
        return max(ends, default=None)


class ActuatorLoad(Table):
    """Driving `torque` [N m] on the hub and axial `force` [N] on the beam; each frees its coordinate.

    In space also `elevation_torque` [N m], and a `wrench` at the tip: in world axes, or with `follow` in axes that turn
    with the tip and are the world's where angle and elevation are 0.
    """

    torque: Annotated[LoadLaw | None, Key("on the hub, or a table: a law over time")] = None
    force: Annotated[LoadLaw | None, Key("along the beam, or a table: a law over time")] = None
    elevation_torque: Annotated[LoadLaw | None, Key("on the hub towards Z, or a table: a law over time")] = None
    wrench: Annotated[Wrench | None, Key("Fx, Fy, Fz, Mx, My, Mz, or a table: a law over time")] = None
    follow: Annotated[bool | None, Key("true: the wrench turns with the tip", usual="false")] = None

    @model_validator(mode="after")
    def _followed(self) -> ActuatorLoad:
        if self.follow is not None and self.wrench is None:
            raise InputError("says how load.wrench acts, and there is none", key="follow", next_step="Leave it out")
        return self


class ActuatorInitial(Table):
    """State at t = 0: `tip_displacement` [m] of the static shape under a tip force, modal velocities zero.

    `angle_rate` [rad/s] and `length_rate` [m/s] where angle or length are free, that is driven by a load. In space
    `tip_displacement` is towards larger angles, `elevation_displacement` [m] towards larger elevations, and
    `elevation_rate` [rad/s] that of a free elevation.
    """

    tip_displacement: Annotated[
        float, Quantity("length", why="of the static shape under a force at the tip, released at rest")
    ] = 0.0
    angle_rate: Annotated[float, Quantity("angular rate", why="of a hub that a torque drives")] = 0.0
    length_rate: Annotated[float, Quantity("velocity", why="of a beam that a force drives")] = 0.0
    elevation_displacement: Annotated[
        float, Quantity("length", why="as tip_displacement, towards larger elevations")
    ] = 0.0
    elevation_rate: Annotated[float, Quantity("angular rate", why="of a hub that a torque drives towards Z")] = 0.0

    def _shown(self) -> Mapping[str, str]:
        return {name: words for name, words in super()._shown().items() if getattr(self, name)}


def read_drives(top: Section) -> tuple[ActuatorMotion, ActuatorLoad]:
    """Motion and load of the actuator: a prescribed coordinate or a load on it; a coordinate with neither is held."""
    motion, load = top.section("motion"), top.section("load")
    laws: dict[str, Any] = {}
    loads: dict[str, Any] = {}
    if load is not None:
        load.check_keys(*columns_of(ActuatorLoad))
        if "wrench" in load:
            loads["wrench"] = read_wrench(load)
        if "follow" in load:
            loads["follow"] = load.flag("follow")
    if motion is not None:
        motion.check_keys(*_DRIVEN)
    for name, (drive, dimension, moved) in _DRIVEN.items():
        if load is not None and drive in load:
            loads[drive], laws[name] = _load_law(load, drive, dimension), None
            if motion is not None and name in motion:
                raise motion.error(f"is prescribed and driven by load.{drive}", name, allowed="one of the two")
        elif motion is not None and name in motion:
            laws[name] = _law(motion.child(motion.data[name], name), ActuatorMotion, name, moved)
    moved = ActuatorMotion(**laws) if motion is None else ActuatorMotion(**laws).attach_source(motion.source_table)
    return moved, ActuatorLoad() if load is None else load.build(ActuatorLoad, **loads).attach_source(load.source_table)


def _load_law(load: Section, name: str, dimension: str) -> object:
    if not isinstance(load.data[name], Mapping):
        return load.build(ConstantLaw, value=load.number(name, dimension))
    return _law(load.child(load.data[name], name), ActuatorLoad, name, (dimension,))


def _law(section: Section, model: type[ActuatorMotion | ActuatorLoad], name: str, among: tuple[str, ...]) -> object:
    def table(section: Section) -> dict[str, object]:
        found = section.table({"value": among[0]}, needed=True, jumps=model is ActuatorLoad)
        return {"time": found["time"], "value": found["value"]}

    return section.one_of(
        columns_of(model)[name].models,
        among=among,
        default=RateLaw if model is ActuatorMotion else None,
        readers={CsvLaw: lambda s: s.read(CsvLaw, then=table)},
    )
