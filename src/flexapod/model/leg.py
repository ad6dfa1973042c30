"""One leg: cylinder, piston, stroke, drive."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from flexapod.errors import InputError
from flexapod.model.base import Frozen, Measure, NonNegative, Number, Positive, Vec3
from flexapod.model.damping import BodyDamping, damping_parts
from flexapod.model.drive import Drive, PrescribedDrive
from flexapod.model.material import Material, Tube
from flexapod.words import number, text

__all__ = ["Cylinder", "Leg", "Piston", "Stroke"]


class Cylinder(Frozen):
    """The lower, rigid part of a leg.

    `mass` [kg]; `com` [m], centre of mass from the universal joint along the axis; `inertia` [kg m^2], transverse,
    about that centre; `mouth` [m], where the piston comes out, from the universal joint; `axial_inertia` [kg m^2].
    """

    mass: Annotated[NonNegative, Measure("mass")]
    com: Annotated[Number, Measure("length")] = 0.0
    inertia: Annotated[NonNegative, Measure("inertia")] = 0.0
    mouth: Annotated[NonNegative, Measure("length")]
    axial_inertia: Annotated[NonNegative, Measure("inertia")] = 0.0

    @model_validator(mode="after")
    def _real_body(self) -> Cylinder:
        _check_axial(self.axial_inertia, self.inertia, "inertia")
        return self


class Piston(Frozen):
    """The upper, flexible part of a leg: a uniform Euler-Bernoulli beam.

    `length` [m], whole piston; `EA` [N]; `EI` [N m^2]; `rhoA` [kg/m], 0 for a spring without mass; `diameter`,
    `inner_diameter` [m], `E` [Pa], `density` [kg/m^3] and `yield_stress` [Pa] where known; `axial_inertia` [kg m^2].
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

    @model_validator(mode="after")
    def _sensible(self) -> Piston:
        if self.inner_diameter is not None and self.diameter is None:
            raise InputError("needs the outer diameter too", key="diameter", next_step="Add diameter")
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
    def round(cls, *, length: float, section: Tube, material: Material, axial_inertia: float = 0.0) -> Piston:
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
        )

    @property
    def mass(self) -> float:
        """Mass of the whole piston [kg]."""
        return self.rhoA * self.length


class Stroke(Frozen):
    """Allowed joint-to-joint length [m]."""

    min: Annotated[NonNegative, Measure("length")]
    max: Annotated[Positive, Measure("length")]

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


class Leg(Frozen):
    """A leg between a universal joint on the base and a spherical joint on the platform.

    `damping`: modal damping ratio of the piston, or `Damping` with a part in proportion to its stiffness;
    `axial_modes`: number of axial shapes, the static one first;
    `u_axis`: direction of the universal joint's base-fixed axis (world axes), default Z x leg.
    """

    cylinder: Cylinder
    piston: Piston
    stroke: Stroke | None = None
    damping: BodyDamping = 0.0
    drive: Drive = PrescribedDrive()
    axial_modes: int = Field(default=2, strict=True, ge=0, le=4)
    u_axis: Annotated[Vec3, Measure("number")] | None = None

    def _shown(self) -> dict[str, str]:
        width = "" if self.piston.diameter is None else f"{text(self.piston.diameter, 'm', 4)} thick, "
        limits = {} if self.stroke is None else {"stroke": _span(self.stroke.min, self.stroke.max)}
        return {
            "piston": f"{width}{text(self.piston.length, 'm', 4)} long, EA {text(self.piston.EA, 'N', 4)}, "
            f"EI {number(self.piston.EI, 4)} N m^2",
            "cylinder": f"mouth at {text(self.cylinder.mouth, 'm', 4)}, {number(self.cylinder.mass, 4)} kg",
            **limits,
            "drive": self.drive.type,
            "damping": _damped(self.damping),
        }

    @model_validator(mode="after")
    def _axis_has_a_direction(self) -> Leg:
        if self.u_axis is not None and not self.u_axis.any():
            raise InputError("has no direction", key="u_axis", value=self.u_axis.tolist(), allowed="a non-zero vector")
        return self


def _damped(damping: BodyDamping) -> str:
    ratio, time = damping_parts(damping)
    return f"{number(100 * ratio)} %" + (f" and {text(time, 's')} times stiffness" if time else "")


def _span(low: float, high: float) -> str:
    return f"{text(low, 'm', 4)} to {text(high, 'm', 4)} joint to joint"


def _check_axial(axial: float, transverse: float, name: str) -> None:
    # Principal moments of a body of revolution (I, I, Ia): Ia <= 2 I, equal for a flat disc.
    if axial > 2 * transverse * (1 + 1e-9):
        raise InputError(
            "belongs to no body",
            key="axial_inertia",
            value=axial,
            allowed=f"at most twice the {name} of {transverse:g} kg m^2",
        )
