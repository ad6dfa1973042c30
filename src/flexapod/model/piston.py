"""Bodies of a leg: cylinder, piston, strut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from flexapod.errors import InputError
from flexapod.model.material import POISSON, SPELLS, Material, Rectangle, Tube
from flexapod.model.sections import SHARES, PistonSection, Step
from flexapod.model.spring import check_lossy
from flexapod.schema.base import Frozen, Loss, Measure, NonNegative, Number, Positive

SAME = 1e-9  # relative; rounding leaves less


class Mounted(Frozen):
    """A body on a cylinder: `mass` [kg], `com` [m] from the base joint, transverse `inertia` [kg m^2] about it."""

    mass: Annotated[NonNegative, Measure("mass")]
    com: Annotated[Number, Measure("length")] = 0.0
    inertia: Annotated[NonNegative, Measure("inertia")] = 0.0


class Cylinder(Frozen):
    """The lower part of a leg, rigid unless its section is known.

    `mass` [kg]; `com` [m], centre of mass from the universal joint along the axis; `inertia` [kg m^2], transverse,
    about that centre; `mouth` [m], where the piston comes out, from the universal joint; `axial_inertia` [kg m^2].
    A tube of `diameter`, `inner_diameter` [m] and `material` from the joint to the mouth bends and stretches; with
    what is mounted on it, `body`, it has the masses above.
    """

    spells: ClassVar[Mapping[str, tuple[str, ...]]] = SPELLS

    mass: Annotated[NonNegative, Measure("mass")]
    com: Annotated[Number, Measure("length")] = 0.0
    inertia: Annotated[NonNegative, Measure("inertia")] = 0.0
    mouth: Annotated[NonNegative, Measure("length")]
    axial_inertia: Annotated[NonNegative, Measure("inertia")] = 0.0
    diameter: Annotated[Positive, Measure("length")] | None = None
    inner_diameter: Annotated[Positive, Measure("length")] | None = None
    material: Material | None = None
    body: Mounted | None = None

    @model_validator(mode="after")
    def _real_body(self) -> Cylinder:
        _check_axial(self.axial_inertia, self.inertia, "inertia")
        if (self.diameter is None) != (self.material is None) or (self.body is not None and self.diameter is None):
            missing = "diameter" if self.diameter is None else "material"
            raise InputError("is missing", key=missing, next_step=f"Add {missing}, or mass, com and inertia alone")
        if self.diameter is not None and self.diameter >= self.mouth:
            raise InputError(
                "makes the cylinder wider than long: it is not a beam",
                key="diameter",
                value=self.diameter,
                allowed=f"below its length of {self.mouth:g} m, from the base joint to the mouth",
                next_step="Leave the section out for a rigid cylinder",
            )
        if self.section is not None and self.material is not None:
            found = _tube_masses(self.mouth, self.section, self.material, self.body)
            for key, value in found.items():
                if abs(getattr(self, key) - value) > SAME * abs(value):
                    raise InputError(
                        "is not that of the section, with what is mounted on it",
                        key=key,
                        value=getattr(self, key),
                        allowed=f"{value:g}",
                        next_step="Make it by Cylinder.tube(mouth=, section=, material=, body=)",
                    )
        return self

    @classmethod
    def tube(cls, *, mouth: float, section: Tube, material: Material, body: Mounted | None = None) -> Cylinder:
        """A cylinder that bends and stretches: its masses follow from section, material and what is mounted on it."""
        mouth = cls(mass=0.0, mouth=mouth).mouth  # within its bounds: it is squared here
        return cls(
            **_tube_masses(mouth, section, material, body),
            mouth=mouth,
            diameter=section.diameter,
            inner_diameter=section.inner_diameter,
            material=material,
            body=body,
        )

    @property
    def section(self) -> Tube | None:
        """Of one that bends."""
        return None if self.diameter is None else Tube(diameter=self.diameter, inner_diameter=self.inner_diameter)

    @property
    def beam(self) -> tuple[float, float, float]:
        """EI [N m^2], EA [N], rhoA [kg/m] of one that bends; zeros of a rigid one."""
        section, material = self.section, self.material
        if section is None or material is None:
            return 0.0, 0.0, 0.0
        return material.E * section.second_moment, material.E * section.area, material.density * section.area


def _tube_masses(mouth: float, section: Tube, material: Material, body: Mounted | None) -> dict[str, float]:
    """Mass, its centre and inertias of a tube and what is mounted on it, Eq. (T25.13)."""
    on = body or Mounted(mass=0.0)
    own = material.density * section.area * mouth
    mass = own + on.mass
    com = (own * mouth / 2 + on.mass * on.com) / mass
    about = section.second_moment / section.area
    inertia = own * (mouth**2 / 12 + about + (mouth / 2 - com) ** 2) + on.inertia + on.mass * (on.com - com) ** 2
    return {"mass": mass, "com": com, "inertia": inertia, "axial_inertia": 2 * own * about}


class Guide(Frozen):
    """Two bushings in which a piston slides: in the cylinder's mouth (`gland`), on the piston's inner end (`head`).

    Stiffness [N/m] of each across the leg, with a damper [N s/m] or a loss factor for both; `clearance` [m]: the free
    travel across, of each.
    """

    gland: Annotated[Positive, Measure("stiffness")]
    head: Annotated[Positive, Measure("stiffness")]
    clearance: Annotated[NonNegative, Measure("length")] | None = None
    damping: Annotated[NonNegative, Measure("damping")] | None = None
    loss: Loss | None = None

    @model_validator(mode="after")
    def _sensible(self) -> Guide:
        check_lossy(self)
        return self


class Piston(Frozen):
    """The upper, flexible part of a leg: a uniform Euler-Bernoulli beam.

    `length` [m], whole piston; `EA` [N]; `EI` [N m^2]; `rhoA` [kg/m], 0 for a spring without mass; `diameter`,
    `inner_diameter` [m], `E` [Pa], `density` [kg/m^3] and `yield_stress` [Pa] where known; `axial_inertia` [kg m^2];
    `poisson`, ratio of a round section; `GJ` [N m^2], torsional stiffness, of another one; `expansion` [1/K] by heat;
    `bow` [m]: of its axis, at rest and without load, from the line of its ends. `sections`, from the driven end to the
    tip, of one that is not uniform: the other values are then those of the whole (`stepped`). `keyed`: false of one
    that turns in its cylinder (C) and takes the nut of its screw along. `shear`: whether it shears and its sections
    have rotary inertia (Timoshenko's beam).
    """

    length: Annotated[Positive, Measure("length")]
    EA: Annotated[Positive, Measure("axial stiffness")]
    EI: Annotated[Positive, Measure("bending stiffness")]
    rhoA: Annotated[NonNegative, Measure("line density")]
    diameter: Annotated[Positive, Measure("length")] | None = None
    inner_diameter: Annotated[Positive, Measure("length")] | None = None
    E: Annotated[Positive, Measure("stress")] | None = None
    density: Annotated[Positive, Measure("density")] | None = None
    yield_stress: Annotated[Positive, Measure("stress")] | None = None
    axial_inertia: Annotated[NonNegative, Measure("inertia")] = 0.0
    poisson: float = Field(default=POISSON, strict=True, ge=-0.5, le=0.5)
    GJ: Annotated[Positive, Measure("bending stiffness")] | None = None
    expansion: Annotated[Number, Measure("expansion")] | None = None
    bow: Annotated[NonNegative, Measure("length")] | None = None
    sections: tuple[PistonSection, ...] = ()
    keyed: bool = True
    shear: bool = False

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
                    "makes the piston wider than long: it is not a beam",
                    key="diameter",
                    value=self.diameter,
                    allowed=f"below a tenth of the length of {self.length:g} m for an accurate beam",
                )
        _check_axial(self.axial_inertia, self.rhoA * self.length**3 / 12, "transverse inertia, rhoA length^3 / 12,")
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
        return cls(
            length=length,
            EA=material.E * section.area,
            EI=material.E * section.second_moment,
            rhoA=material.density * section.area,
            diameter=section.diameter,
            inner_diameter=section.inner_diameter,
            E=material.E,
            density=material.density,
            yield_stress=material.yield_stress,
            axial_inertia=axial_inertia,
            poisson=material.poisson,
            expansion=material.expansion,
            bow=bow,
            shear=shear,
        )

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
        steps = [step for section in sections for step in section.steps]
        length = sum(step.length for step in steps)
        grown = [section.length * section.expansion for section in sections if section.expansion is not None]
        moduli = {section.E for section in sections}
        limits = [section.yield_stress for section in sections if section.yield_stress is not None]
        return cls(
            length=length,
            EA=length / sum(step.length / step.EA for step in steps),
            EI=length / sum(step.length / step.EI[1] for step in steps),
            GJ=length / sum(step.length / step.GJ for step in steps),
            rhoA=sum(step.length * step.rhoA for step in steps) / length,
            axial_inertia=axial_inertia,
            expansion=sum(grown) / length if len(grown) == len(sections) else None,
            E=moduli.pop() if len(moduli) == 1 else None,
            yield_stress=min(limits) if len(limits) == len(sections) else None,
            bow=bow,
            sections=tuple(sections),
            shear=shear,
        )

    @property
    def steps(self) -> tuple[Step, ...]:
        """Its uniform pieces, from the driven end to the tip; none of a uniform piston."""
        return tuple(step for section in self.sections for step in section.steps)

    @property
    def parts(self) -> tuple[tuple[float, tuple[Step, ...]], ...]:
        """Length of its sections, or of all, from the driven end to the tip, and what they are at `sections.SHARES`."""
        found = tuple((section.length, section.samples) for section in self.sections)
        return found or ((self.length, self.steps_or_one * len(SHARES)),)

    @property
    def steps_or_one(self) -> tuple[Step, ...]:
        """`steps`, of a uniform piston one; its depth is 0 where it is not known."""
        depth = self.depth or 0.0
        if self.diameter is not None and self.E is not None:
            tube = Tube(diameter=self.diameter, inner_diameter=self.inner_diameter)
            shear = tube.cowper(self.poisson) * self.EA / (2 * (1 + self.poisson))
        else:
            shear = self.EA  # never read
        one = Step(
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
        return min(min(step.EI) for step in self.steps_or_one)

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


class Strip(Frozen):
    """Section of a strip that bends across its thickness: `width`, `thickness` [m]."""

    width: Annotated[Positive, Measure("length")]
    thickness: Annotated[Positive, Measure("length")]


class Strut(Piston):
    """A rod of fixed length in place of cylinder and piston: the beam of a piston that nothing guides.

    `section`: of a strip, in a planar robot.
    """

    derived: ClassVar[tuple[str, ...]] = ("keyed",)  # of pistons alone

    section: Strip | None = None

    @property
    def depth(self) -> float | None:
        """Size in the direction of bending [m], of a strip its thickness."""
        return self.diameter if self.section is None else self.section.thickness

    @classmethod
    def strip(cls, *, length: float, section: Strip, material: Material, bow: float | None = None) -> Strut:
        """A strip: EA, EI across its thickness and rhoA follow from section and material."""
        size = Rectangle(width=section.width, height=section.thickness)
        return cls(
            length=length,
            EA=material.E * size.area,
            EI=material.E * size.second_moment,
            rhoA=material.density * size.area,
            E=material.E,
            density=material.density,
            yield_stress=material.yield_stress,
            expansion=material.expansion,
            section=section,
            bow=bow,
        )


def _check_axial(axial: float, transverse: float, name: str) -> None:
    # Principal moments of a body of revolution (I, I, Ia): Ia <= 2 I, equal for a flat disc.
    if axial > 2 * transverse * (1 + 1e-9):
        raise InputError(
            "belongs to no body",
            key="axial_inertia",
            value=axial,
            allowed=f"at most twice the {name} of {transverse:g} kg m^2",
        )
