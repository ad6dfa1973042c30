"""Materials and beam sections."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Quantity
from flexapod.common.tables.table import Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

POISSON = 0.3  # where no other is given
#: Keys of a table of which a material is made.
OF_MATERIAL = ("E", "density", "yield_stress", "poisson", "expansion")


class Material(Table):
    """Material of a beam.

    `E` [Pa], `density` [kg/m^3], `yield_stress` [Pa], `poisson`'s ratio and thermal `expansion` [1/K]; None: not known.
    Materials of the same numbers are the same, whatever they are called.
    """

    silent: ClassVar[tuple[str, ...]] = ("poisson",)

    name: str
    E: Annotated[float, Quantity("stress", above=0)]
    density: Annotated[float, Quantity("density", above=0)]
    yield_stress: Annotated[float | None, Quantity("stress", above=0)] = None
    poisson: float = Field(default=POISSON, strict=True, ge=-0.5, le=0.5)
    expansion: Annotated[float | None, Quantity("expansion")] = None

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed; with another modulus or density it is no longer the one of its name."""
        if not {"E", "density"}.isdisjoint(changes):
            changes = {"name": "given", **changes}
        return super().replace(**changes)

    def _content(self) -> tuple[object, ...]:
        return tuple(getattr(self, name) for name in OF_MATERIAL)


# E and density of steel: Table 3 of the paper. The others are handbook values at room temperature
# (aluminium: 6061-T6; titanium: Ti-6Al-4V annealed; cfrp: standard-modulus tube, fibres mostly along the axis, its
# "yield" being the compressive strength); the yield stress of steel is that of a quenched and tempered shaft (42CrMo4).
# Expansion: of steel the middle of the two screw makers' values (HIWIN BS-08-2-EN: 11.6e-6, THK A-715: 12e-6);
# aluminium and titanium: the producers' data sheets of these alloys, 20 to 100 degC; cfrp: along the fibres of
# standard-modulus laminates it lies between -1e-6 and 1e-6.
_TABLE = (
    Material(name="steel", E=200e9, density=7800.0, yield_stress=650e6, expansion=11.8e-6),
    Material(name="aluminium", E=68.9e9, density=2700.0, yield_stress=276e6, poisson=0.33, expansion=23.6e-6),
    Material(name="titanium", E=113.8e9, density=4430.0, yield_stress=880e6, poisson=0.34, expansion=8.6e-6),
    Material(name="cfrp", E=120e9, density=1600.0, yield_stress=600e6, expansion=0.0),
)
MATERIALS = MappingProxyType({material.name: material for material in _TABLE})


class Tube(Table):
    """Round section, full or hollow: outer and inner diameter [m]."""

    diameter: Annotated[float, Quantity("length", above=0)]
    inner_diameter: Annotated[float | None, Quantity("length", above=0)] = None

    @model_validator(mode="after")
    def _hollow_inside(self) -> Tube:
        if self.inner_diameter is not None and self.inner_diameter >= self.diameter:
            raise InputError(
                "leaves no wall",
                key="inner_diameter",
                value=self.inner_diameter,
                allowed=f"below the outer diameter of {self.diameter:g} m",
                next_step="Leave inner_diameter out for a full section",
            )
        return self

    @property
    def area(self) -> float:
        """Cross-section area [m^2]."""
        return math.pi / 4 * (self.diameter**2 - (self.inner_diameter or 0.0) ** 2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter [m^4]."""
        return math.pi / 64 * (self.diameter**4 - (self.inner_diameter or 0.0) ** 4)

    @property
    def depth(self) -> float:
        """Size in the direction of bending [m]."""
        return self.diameter

    def cowper(self, poisson: float) -> float:
        """Shear coefficient (Cowper 1966)."""
        hollow = (self.inner_diameter or 0.0) / self.diameter
        m = (1 + hollow**2) ** 2
        return 6 * (1 + poisson) * m / ((7 + 6 * poisson) * m + (20 + 12 * poisson) * hollow**2)  # (T8.19)


def read_tube(section: Section) -> Tube:
    """Round section of a table with its diameters."""
    return section.build(Tube, **{name: section.number(name, "length") for name in ("diameter", "inner_diameter")})


class Rectangle(Table):
    """Rectangular section: width across and height along the direction of bending [m]."""

    width: Annotated[float, Quantity("length", above=0, why="across the plane of bending")]
    height: Annotated[float, Quantity("length", above=0, why="in the plane of bending")]

    @property
    def area(self) -> float:
        """Cross-section area [m^2]."""
        return self.width * self.height

    @property
    def second_moment(self) -> float:
        """Second moment of area for bending along the height [m^4]."""
        return self.width * self.height**3 / 12

    @property
    def depth(self) -> float:
        """Size in the direction of bending [m]."""
        return self.height

    def cowper(self, poisson: float) -> float:
        """Shear coefficient (Cowper 1966)."""
        return 10 * (1 + poisson) / (12 + 11 * poisson)  # (T8.19)


class MadeOf(Table):
    """Base of tables that have the keys of their `material`."""

    also: ClassVar[tuple[str, ...]] = OF_MATERIAL
    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {key: ("material",) for key in OF_MATERIAL}

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file, with the keys of its material."""
        fields = super().si_values()
        material = fields.pop("material", None)
        return fields | material_values(material) if isinstance(material, Material) else fields


def material_values(material: Material) -> dict[str, object]:
    """Name of a material and what differs from it, where it is one; else its values."""
    own = {name: getattr(material, name) for name in ("yield_stress", "poisson", "expansion")}
    known = MATERIALS.get(material.name)
    if known is None or None in own.values() or known.replace(**own) != material:
        return {name: value for name, value in material.si_values().items() if name != "name"}
    named: dict[str, object] = {"material": known.name}
    return named | {name: value for name, value in own.items() if value != getattr(known, name)}


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
    section.require_keys("E", "density")
    modulus, density = section.number("E", "stress"), section.number("density", "density")
    return section.build(Material, name="given", E=modulus, density=density, **own)
