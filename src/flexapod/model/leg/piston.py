"""Beams that bend in a leg: its piston, or a strut in its place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity, nearly_same
from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.table import Table
from flexapod.model.leg.cylinder import check_axial
from flexapod.model.leg.material import (
    MATERIALS,
    OF_MATERIAL,
    POISSON,
    Material,
    Rectangle,
    Tube,
    read_material,
    read_tube,
)
from flexapod.model.leg.sections import SHARES, PistonSection, PistonStep, as_uniform, has_sections, rotary_inertia

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

STIFFNESS = ("EI", "EA", "rhoA")
#: What stands by hand in place of a part of the material.
_BY_HAND = {"E": ("EI", "EA", "GJ"), "density": ("rhoA",)}
#: What any may have, whatever it is made of.
_BESIDE = ("axial_inertia", "bow", "shear")


class Piston(Table):
    """The upper, flexible part of a leg: a uniform Euler-Bernoulli beam.

    `length` [m], whole piston; `EA` [N]; `EI` [N m^2]; `rhoA` [kg/m], 0 for a spring without mass: given, or they
    follow from a section, `diameter` and `inner_diameter` [m], and a material, `E` [Pa] and `density` [kg/m^3];
    `yield_stress` [Pa] where known; `axial_inertia` [kg m^2];
    `poisson`, ratio of a round section; `GJ` [N m^2], torsional stiffness, of another one; `expansion` [1/K] by heat;
    `bow` [m]: of its axis, at rest and without load, from the line of its ends. `sections`, from the driven end to the
    tip, of one that is not uniform: the other values are then those of the whole (`stepped`). `keyed`: false of one
    that turns in its cylinder (C) and takes the nut of its screw along. `shear`: whether it shears and its sections
    have rotary inertia (Timoshenko's beam).
    """

    also: ClassVar[tuple[str, ...]] = ("material",)
    silent: ClassVar[tuple[str, ...]] = ("poisson", "keyed", "sections", "shear", "axial_inertia")
    _source: ClassVar[str] = "section and material"

    length: Annotated[float, Quantity("length", above=0)]
    EA: Annotated[float, Quantity("axial stiffness", above=0, why="axial stiffness")]
    EI: Annotated[float, Quantity("bending stiffness", above=0, why="bending stiffness")]
    rhoA: Annotated[float, Quantity("line density", least=0, why="mass per length")]
    diameter: Annotated[float | None, Quantity("length", above=0, why="outer diameter, below the length")] = None
    inner_diameter: Annotated[
        float | None,
        Quantity("length", above=0, why="inner diameter of a tube, below the outer one", usual="a full bar"),
    ] = None
    E: Annotated[float | None, Quantity("stress", above=0, why="elastic modulus")] = None
    density: Annotated[float | None, Quantity("density", above=0, why="density")] = None
    yield_stress: Annotated[
        float | None, Quantity("stress", above=0, why="for the remarks on stresses", usual="that of the material")
    ] = None
    axial_inertia: Annotated[
        float,
        Quantity(
            "inertia",
            least=0,
            why="moment of inertia about the axis; 0 counts as left out",
            usual="0; of a round section where the leg twists, or nothing holds its turn",
        ),
    ] = 0.0
    poisson: Annotated[
        float,
        Key(
            "Poisson's ratio of a round section: its torsion, where a joint holds it",
            usual="that of the material, or 0.3",
        ),
    ] = Field(default=POISSON, strict=True, ge=-0.5, le=0.5)
    GJ: Annotated[
        float | None,
        Quantity(
            "bending stiffness",
            above=0,
            why="torsional stiffness; left out: that of a round section",
            usual="EI / (1 + poisson)",
        ),
    ] = None
    expansion: Annotated[
        float | None, Quantity("expansion", why="thermal expansion, for [heat]", usual="that of the material")
    ] = None
    bow: Annotated[
        float | None,
        Quantity(
            "length",
            least=0,
            why="largest distance of the axis from the line of its ends, without load: for `flexapod.accuracy`",
            usual="straight",
        ),
    ] = None
    sections: Annotated[
        tuple[PistonSection, ...],
        Key("list of tables: sections of one that is not uniform, from the driven end to the tip", usual="uniform"),
    ] = ()
    keyed: Annotated[
        bool,
        Key(
            "false: it turns in its cylinder (chains with C) and takes the nut of its screw along, which changes "
            "the length"
        ),
    ] = True
    shear: Annotated[
        bool,
        Key(
            "whether it shears and its sections have rotary inertia: for pistons shorter than ten diameters",
            usual="false",
        ),
    ] = False

    def __init__(self, **fields: Any) -> None:
        for name in ("diameter", "density") if has_sections(fields) else ():
            if fields.get(name) is not None:
                raise InputError(
                    "is given together with sections", key=name, value=fields[name],
                    allowed="in a section, or without sections",
                )  # fmt: skip
        super().__init__(**fields)
        given = {name: value for name, value in self._given.items() if value is not None}
        for name, others in _BY_HAND.items():
            if name in given and not given.keys().isdisjoint(others):
                raise InputError(
                    "is given together with EI, EA, rhoA", key=name, value=given[name],
                    allowed="either of the two: EI and EA, or a section and E; rhoA, or a section and density",
                )  # fmt: skip

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Sections, or a round section and a material; nothing of those where its stiffness is given."""
        keyed = {} if "keyed" in cls.derived else {"keyed": section.flag("keyed")}
        if "sections" in section:
            found = cls._of_sections(section)
        elif any(name in section for name in (*STIFFNESS, "GJ")):
            cls._check_stiffness(section)
            return keyed
        else:
            found = cls._of_section(section)
        return dict.fromkeys(name for name in columns_of(cls) if name not in _BESIDE) | found | keyed

    @classmethod
    def _of_sections(cls, section: Section) -> dict[str, object]:
        for name in section.data:
            if name not in ("sections", "keyed", *_BESIDE):
                raise section.error(
                    "is given together with sections", name, allowed="in a section, or without sections"
                )
        given = section.data["sections"]
        if not isinstance(given, list):
            raise section.malformed_error("is not a list", "sections", allowed="[{ length, diameter, material }, ...]")
        if not given:
            raise section.error("is empty", "sections", allowed="a section or more, from the driven end to the tip")
        tables = (section.child(data, f"sections[{k}]") for k, data in enumerate(given, start=1))
        return {"sections": tuple(table.read(PistonSection) for table in tables)}

    @classmethod
    def _check_stiffness(cls, section: Section) -> None:
        shaped, material = "diameter" in section or "section" in section, ("material", *_BY_HAND)
        follows = {other for name in material[1:] if shaped and name in section for other in _BY_HAND[name]}
        section.require_keys("length", *(name for name in STIFFNESS if name not in follows))
        for name in material:
            if name in section and any(other in section for other in _BY_HAND.get(name, (*STIFFNESS, "GJ"))):
                raise section.error("is given together with EI, EA, rhoA", name, allowed="either of the two")

    @classmethod
    def _of_section(cls, section: Section) -> dict[str, object]:
        section.require_keys("length", "diameter")
        length, tube, material = section.number("length", "length"), read_tube(section), read_material(section)
        found = {"length": length, "diameter": tube.diameter, "inner_diameter": tube.inner_diameter}
        return found | {name: getattr(material, name) for name in OF_MATERIAL}

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """Numbers that follow from its sections, or from its section and its material."""
        given = fields.get("sections")
        made = [PistonSection._of(section) for section in given] if isinstance(given, list | tuple) else []
        if sections := [section for section in made if section is not None]:
            return as_uniform(sections)
        section = cls._section(fields)
        made_of = {name: fields[name] for name in _BY_HAND if fields.get(name) is not None}
        if section is None or not made_of:
            return {}
        material = MATERIALS["steel"].replace(**made_of)
        found = {"EA": material.E * section.area, "EI": material.E * section.second_moment} if "E" in made_of else {}
        return found | ({"rhoA": material.density * section.area} if "density" in made_of else {})

    @classmethod
    def _section(cls, fields: Mapping[str, Any]) -> Tube | Rectangle | None:
        """The section of one of these fields; None where they have none."""
        outer, inner = (fields.get(name) for name in ("diameter", "inner_diameter"))
        return None if outer is None else Tube(diameter=outer, inner_diameter=inner)

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed; what follows from section and material follows from the new ones.

        By hand EA, EI and GJ stand in place of E, and rhoA in place of the density; so does what they were where the
        section or that part of the material is taken away (None).

        Raises
        ------
        InputError
            If a field does not exist, the new value is not allowed, or it contradicts others.
        """
        fields = {**self._given, **changes}
        follow, bare = self._following(fields), self._section(fields) is None
        for name, others in () if has_sections(fields) else _BY_HAND.items():
            given = {other: changes[other] for other in others if changes.get(other) is not None}
            by_hand = any(not nearly_same(value, follow.get(other)) for other, value in given.items())
            if changes.get(name) is None and (bare or by_hand):
                changes[name] = None
        return super().replace(**changes)

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        if self.inner_diameter is not None and self.diameter is None:
            raise InputError("needs the outer diameter too", key="diameter", next_step="Add diameter")
        if self.shear and not self.sections and (self.diameter is None or self.E is None):
            raise InputError(
                "needs a section and a material", key="shear", value=True, allowed="diameter and material, or sections"
            )
        if self.diameter is not None:
            Tube(diameter=self.diameter, inner_diameter=self.inner_diameter)
            if self.diameter >= self.length:
                raise InputError(
                    "makes the piston wider than long: it is not a beam", key="diameter", value=self.diameter,
                    allowed=f"below a tenth of the length of {self.length:g} m for an accurate beam",
                )  # fmt: skip
        check_axial(self.axial_inertia, self.rhoA * self.length**3 / 12, "transverse inertia, rhoA length^3 / 12,")
        return self

    @classmethod
    def round(
        cls,
        *,
        length: float,
        section: Tube,
        material: Material,
        axial_inertia: float = 0.0,
        bow: float | None = None,
        shear: bool = False,
    ) -> Self:
        """A piston of round section: EA, EI and rhoA follow from section and material."""
        sizes = {"diameter": section.diameter, "inner_diameter": section.inner_diameter}
        made_of = {name: getattr(material, name) for name in OF_MATERIAL}
        return cls(length=length, **sizes, **made_of, axial_inertia=axial_inertia, bow=bow, shear=shear)

    @classmethod
    def stepped(
        cls,
        sections: Sequence[PistonSection],
        *,
        axial_inertia: float = 0.0,
        bow: float | None = None,
        shear: bool = False,
    ) -> Self:
        """A piston of sections, from its driven end to its tip.

        EA, EI and GJ are those of a uniform one that stretches, bends under a constant moment (along leg y) and twists
        as far; rhoA is the mean, expansion the mean and yield_stress the least where all have one.
        """
        if not sections:
            raise InputError("is empty", key="sections", allowed="a section or more, from the driven end to the tip")
        return cls(sections=tuple(sections), axial_inertia=axial_inertia, bow=bow, shear=shear)

    @property
    def steps(self) -> tuple[PistonStep, ...]:
        """Uniform pieces, from the driven end to the tip; none of a uniform piston."""
        return tuple(step for section in self.sections for step in section.steps)

    @property
    def parts(self) -> tuple[tuple[float, tuple[PistonStep, ...]], ...]:
        """Length of its sections, or of all, from the driven end to the tip, and what they are at `sections.SHARES`."""
        found = tuple((section.length, section.samples) for section in self.sections)
        return found or ((self.length, self.steps_or_one * len(SHARES)),)

    @property
    def rotary_inertia(self) -> Array:
        """Rotary inertia of its sections along the whole, about leg y and x, (2,) [kg m^2]; 0 of one without shear."""
        return rotary_inertia(self.parts) if self.shear else np.zeros(2)

    @property
    def width(self) -> float:
        """The largest diameter [m], or that of a full round bar with its EI and EA, 4 sqrt(EI / EA)."""
        if self.sections:
            return max(max(at.depth) for _, samples in self.parts for at in samples)
        return self.diameter if self.diameter is not None else 4.0 * (self.EI / self.EA) ** 0.5

    @property
    def steps_or_one(self) -> tuple[PistonStep, ...]:
        """`steps`, of a uniform piston one; its depth is 0 where it is not known."""
        depth = self.depth or 0.0
        if self.diameter is not None and self.E is not None:
            tube = Tube(diameter=self.diameter, inner_diameter=self.inner_diameter)
            shear = tube.cowper(self.poisson) * self.EA / (2 * (1 + self.poisson))
        else:
            shear = self.EA  # never read
        one = PistonStep(
            length=self.length,
            EA=self.EA,
            EI=(self.EI, self.EI),
            rhoA=self.rhoA,
            GJ=self.torsional_stiffness,
            E=self.E or 0.0,
            depth=(depth, depth),
            shear=shear,
            round=True,
        )
        return self.steps or (one,)

    @property
    def least_EI(self) -> float:
        """Least bending stiffness of its sections, in any direction [N m^2]."""
        return min((min(step.EI) for step in self.steps), default=self.EI)

    @property
    def mass(self) -> float:
        """Mass of the whole piston [kg]."""
        return self.rhoA * self.length

    @property
    def torsional_stiffness(self) -> float:
        """`GJ`, or that of a round section, E I / (1 + poisson) [N m^2]."""
        return self.EI / (1 + self.poisson) if self.GJ is None else self.GJ

    @property
    def depth(self) -> float | None:
        """Size in the direction of bending [m]; None where no section is given."""
        return self.diameter


class Strip(Table):
    """Section of a strip that bends across its thickness: `width`, `thickness` [m]."""

    width: Annotated[float, Quantity("length", above=0, why="across the plane")]
    thickness: Annotated[float, Quantity("length", above=0, why="in the plane")]


class Strut(Piston):
    """A rod of fixed length in place of cylinder and piston: the beam of a piston that nothing guides.

    `section`: of a strip, in a planar robot.
    """

    derived: ClassVar[tuple[str, ...]] = ("keyed",)  # of pistons alone

    section: Annotated[Strip | None, Key("table: of a strip, in a planar robot")] = None

    def __init__(self, **fields: Any) -> None:
        super().__init__(**fields)
        for name in ("diameter", "axial_inertia") if self.section is not None and self.E is not None else ():
            if getattr(self, name):
                raise InputError("is given together with section", key=name, allowed="either of the two")

    @classmethod
    def _of_section(cls, section: Section) -> dict[str, object]:
        section.require_keys("length")
        length, strip = section.number("length", "length"), section.section("section")
        if strip is None:
            return super()._of_section(section)
        for name in ("diameter", "inner_diameter", "axial_inertia"):
            if name in section:
                raise section.error("is given together with section", name, allowed="either of the two")
        shape, material = strip.read(Strip), read_material(section)
        made_of = {name: getattr(material, name) for name in OF_MATERIAL if name != "poisson"}
        return {"length": length, "section": shape, **made_of, **dict.fromkeys(("axial_inertia", "shear"))}

    @property
    def depth(self) -> float | None:
        """Size in the direction of bending [m], of a strip its thickness."""
        return self.diameter if self.section is None else self.section.thickness

    @classmethod
    def _section(cls, fields: Mapping[str, Any]) -> Tube | Rectangle | None:
        """Section of a strip that bends across its thickness, or a round one."""
        strip = Strip._of(fields.get("section"))
        return super()._section(fields) if strip is None else Rectangle(width=strip.width, height=strip.thickness)

    @classmethod
    def strip(cls, *, length: float, section: Strip, material: Material, bow: float | None = None) -> Self:
        """A strip: EA, EI across its thickness and rhoA follow from section and material."""
        made_of = {name: getattr(material, name) for name in OF_MATERIAL if name != "poisson"}
        return cls(length=length, section=section, **made_of, bow=bow)
