"""The lower part of a leg, rigid unless its section is known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table
from flexapod.model.leg.material import OF_MATERIAL, MadeOf, Material, Tube, read_material, read_tube

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

_BENT = ("diameter", "inner_diameter", "material", "body")  # what one that bends is made of
_FOLLOW = ("mass", "com", "inertia", "axial_inertia")  # what follows from that


class Mounted(Table):
    """A body on a cylinder: `mass` [kg], `com` [m] from the base joint, transverse `inertia` [kg m^2] about it."""

    mass: Annotated[float, Quantity("mass", least=0, why="mass")]
    com: Annotated[float, Quantity("length", why="centre of mass, from the base joint along the axis")] = 0.0
    inertia: Annotated[
        float, Quantity("inertia", least=0, why="transverse moment of inertia about the centre of mass")
    ] = 0.0


class Cylinder(MadeOf):
    """The lower part of a leg, rigid unless its section is known.

    `mass` [kg]; `com` [m], centre of mass from the universal joint along the axis; `inertia` [kg m^2], transverse,
    about that centre; `mouth` [m], where the piston comes out, from the universal joint; `axial_inertia` [kg m^2].
    A tube of `diameter`, `inner_diameter` [m] and `material` from the joint to the mouth bends and stretches; with
    what is mounted on it, `body`, it has the masses above.
    """

    _source: ClassVar[str] = "the section, with what is mounted on it"

    mass: Annotated[float, Quantity("mass", least=0, why="mass")]
    com: Annotated[float, Quantity("length", why="centre of mass, from the universal joint along the axis")] = 0.0
    inertia: Annotated[
        float, Quantity("inertia", least=0, why="transverse moment of inertia about the centre of mass")
    ] = 0.0
    mouth: Annotated[
        float,
        Quantity(
            "length",
            least=0,
            why="where the piston comes out, from the universal joint; below the home length of the leg",
        ),
    ]
    axial_inertia: Annotated[
        float, Quantity("inertia", least=0, why="moment of inertia about the axis, at most twice the transverse one")
    ] = 0.0
    diameter: Annotated[float | None, Quantity("length", above=0, why="outer diameter of the tube")] = None
    inner_diameter: Annotated[
        float | None, Quantity("length", above=0, why="inner diameter of the tube; full without it")
    ] = None
    material: Annotated[Material | None, Key("what the tube is made of")] = None
    body: Annotated[Mounted | None, Key("table: what is mounted on it")] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Section, material and what is mounted on one that bends; none of a rigid one."""
        if not any(name in section for name in (*_BENT, *OF_MATERIAL)):
            return dict.fromkeys(_BENT)
        for name in _FOLLOW:
            if name in section:
                raise section.error(
                    "follows from section and material of the cylinder", name, allowed="body, for what is mounted on it"
                )
        section.require_keys("mouth", "diameter")
        body, mouth, tube = section.section("body"), section.number("mouth", "length"), read_tube(section)
        found = {"mouth": mouth, "diameter": tube.diameter, "inner_diameter": tube.inner_diameter}
        found |= {"material": read_material(section), "body": body and body.read(Mounted)}
        return dict.fromkeys(_FOLLOW) | found

    @model_validator(mode="after")
    def _real_body(self) -> Cylinder:
        check_axial(self.axial_inertia, self.inertia, "inertia")
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
        return self

    if TYPE_CHECKING:  # what follows need not be given

        def __init__(self, **fields: Any) -> None: ...

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """Masses of one that bends, of its section, its material and what is mounted on it."""
        outer, inner = (fields.get(name) for name in ("diameter", "inner_diameter"))
        material, mouth = Material._of(fields.get("material")), fields.get("mouth")
        if outer is None or material is None or mouth is None:
            return {}
        mouth = cls(mass=0.0, mouth=mouth).mouth  # within its bounds: it is squared here
        return _tube_masses(
            mouth, Tube(diameter=outer, inner_diameter=inner), material, Mounted._of(fields.get("body"))
        )

    @classmethod
    def tube(cls, *, mouth: float, section: Tube, material: Material, body: Mounted | None = None) -> Self:
        """A cylinder that bends and stretches: its masses follow from section, material and what is mounted on it."""
        return cls(
            mouth=mouth,
            diameter=section.diameter,
            inner_diameter=section.inner_diameter,
            material=material,
            body=body,
        )

    @property
    def section(self) -> Tube | None:
        """Section of one that bends."""
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


def check_axial(axial: float, transverse: float, name: str) -> None:
    """Refuse a moment of inertia about the axis that no body of revolution has."""
    # Principal moments of a body of revolution (I, I, Ia): Ia <= 2 I, equal for a flat disc.
    if axial > 2 * transverse * (1 + 1e-9):
        raise InputError(
            "belongs to no body",
            key="axial_inertia",
            value=axial,
            allowed=f"at most twice the {name} of {transverse:g} kg m^2",
        )
