"""Sections of a stepped piston, from its driven end to its tip."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table
from flexapod.model.leg.material import OF_MATERIAL, POISSON, Rectangle, Tube, read_material

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

STEPS = 64  # uniform pieces in place of a taper where formulas know no tapers, in pairs
WEIGHTS = (7 / 90, 32 / 90, 12 / 90, 32 / 90, 7 / 90)  # of these places in a mean, exact to the fifth order (Boole)
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)  # of a length: they tell EI of a taper, which is of fourth order


class PistonStep(NamedTuple):
    """A uniform piece of a piston, SI; `EI` and `depth` for bending along leg x and y, `shear`: kappa G A."""

    length: float
    EA: float
    EI: tuple[float, float]
    rhoA: float
    GJ: float
    E: float
    depth: tuple[float, float]
    shear: float
    round: bool


class PistonSection(Table):
    """A section of a piston: round, full or hollow, or a strip; of one material.

    `length`; `diameter`, `tip_diameter` where it tapers towards the tip, `inner_diameter`, or `width` along the axis x
    of the leg (the first axis of its base joint) and `thickness` along y [m]; `E` [Pa], `density` [kg/m^3],
    `yield_stress` [Pa], `poisson`, `expansion` [1/K].
    """

    also: ClassVar[tuple[str, ...]] = ("material",)
    silent: ClassVar[tuple[str, ...]] = ("poisson",)

    length: Annotated[float, Quantity("length", above=0, why="of this section")]
    diameter: Annotated[
        float | None, Quantity("length", above=0, why="outer diameter; at the end nearer to the drive where it tapers")
    ] = None
    tip_diameter: Annotated[
        float | None, Quantity("length", above=0, why="outer diameter at the end nearer to the tip", usual="no taper")
    ] = None
    inner_diameter: Annotated[
        float | None, Quantity("length", above=0, why="inner diameter of a tube", usual="a full bar")
    ] = None
    width: Annotated[
        float | None,
        Quantity("length", above=0, why="of a strip, along the first axis of the base joint (x of the leg)"),
    ] = None
    thickness: Annotated[
        float | None, Quantity("length", above=0, why="of a strip, across that axis (y of the leg)")
    ] = None
    E: Annotated[float, Quantity("stress", above=0, why="elastic modulus")]
    density: Annotated[float, Quantity("density", above=0, why="density")]
    yield_stress: Annotated[
        float | None, Quantity("stress", above=0, why="for the remarks on stresses", usual="that of the material")
    ] = None
    poisson: Annotated[float, Key("Poisson's ratio: torsion and shear", usual="that of the material, or 0.3")] = Field(
        default=POISSON, strict=True, ge=-0.5, le=0.5
    )
    expansion: Annotated[
        float | None, Quantity("expansion", why="thermal expansion, for [heat]", usual="that of the material")
    ] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Material of which it is made."""
        material = read_material(section)
        return {name: getattr(material, name) for name in OF_MATERIAL}

    @model_validator(mode="after")
    def _round_or_strip(self) -> PistonSection:
        strip, hollow = (self.width, self.thickness), (self.inner_diameter, self.tip_diameter)
        if (self.diameter is None) != (None not in strip):
            raise InputError(
                "is missing" if self.diameter is None and strip == (None, None) else "does not fit the other sizes",
                key="diameter",
                value=self.diameter,
                allowed="diameter of a round section, or width and thickness of a strip",
            )
        if self.diameter is None and hollow != (None, None):
            key = "inner_diameter" if self.inner_diameter is not None else "tip_diameter"
            raise InputError("is of a round section", key=key, allowed="diameter in place of width and thickness")
        if self.diameter is not None:
            for outer in (self.diameter, self.tip_diameter or self.diameter):
                Tube(diameter=outer, inner_diameter=self.inner_diameter)
        if self.tapered and min(min(step.EI) for step in self.steps) <= 0:
            raise InputError(
                "tapers too steeply",
                key="tip_diameter",
                value=self.tip_diameter,
                allowed=f"nearer to the diameter of {self.diameter:g} m at the other end, or thicker walls",
                next_step="Divide the section into shorter ones that taper one after the other",
            )
        return self

    @property
    def tapered(self) -> bool:
        """Tell whether its diameter changes along it."""
        return self.tip_diameter not in (None, self.diameter)

    @property
    def samples(self) -> tuple[PistonStep, ...]:
        """The section at `SHARES` of its length from the driven end."""
        return tuple(self._step(self.length, self._diameter(share)) for share in SHARES)

    @property
    def steps(self) -> Iterator[PistonStep]:
        """Uniform pieces, from the driven end: one, or `STEPS` of a taper.

        Each pair has mass and compliance of its piece of the taper, and their first moments: what is left is of the
        fourth order of a step's length.
        """
        if not self.tapered:
            yield self._step(self.length, self.diameter)
            return
        points = [0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5]
        for pair in range(STEPS // 2):
            at = [self._step(self.length / STEPS, self._diameter((pair + x) * 2 / STEPS)) for x in points]
            for way in (-1, 1):
                w = [5 / 18 + way * 5 / 9 * (points[0] * 2 - 1), 8 / 18, 5 / 18 + way * 5 / 9 * (points[2] * 2 - 1)]
                yield _mean(at, w)

    def _diameter(self, share: float) -> float | None:
        if self.diameter is None or self.tip_diameter is None:
            return self.diameter
        return self.diameter + share * (self.tip_diameter - self.diameter)

    def _step(self, length: float, diameter: float | None) -> PistonStep:
        if diameter is not None:
            tube = Tube(diameter=diameter, inner_diameter=self.inner_diameter)
            area, second, depth = tube.area, (tube.second_moment, tube.second_moment), (diameter, diameter)
            twist, shape = 2 * tube.second_moment, tube.cowper(self.poisson)
        else:
            x, y = self.width or 0.0, self.thickness or 0.0
            wide, flat = Rectangle(width=y, height=x), Rectangle(width=x, height=y)
            second, area, depth, shape = (
                (wide.second_moment, flat.second_moment),
                flat.area,
                (x, y),
                flat.cowper(self.poisson),
            )
            a, b = max(x, y) / 2, min(x, y) / 2
            twist = a * b**3 * (16 / 3 - 3.36 * b / a * (1 - (b / a) ** 4 / 12))  # Roark, table 10.1
        G = self.E / (2 * (1 + self.poisson))
        return PistonStep(
            length=length,
            EA=self.E * area,
            EI=(self.E * second[0], self.E * second[1]),
            rhoA=self.density * area,
            GJ=G * twist,
            E=self.E,
            depth=depth,
            shear=shape * G * area,
            round=diameter is not None,
        )


def _mean(steps: Sequence[PistonStep], weights: Sequence[float]) -> PistonStep:
    """A step with the weighted mass and compliances of some."""

    def soft(values: Iterable[float]) -> float:
        return 1.0 / sum(w / x for w, x in zip(weights, values, strict=True))

    return steps[1]._replace(
        EA=soft(x.EA for x in steps),
        EI=(soft(x.EI[0] for x in steps), soft(x.EI[1] for x in steps)),
        rhoA=sum(w * x.rhoA for w, x in zip(weights, steps, strict=True)),
        GJ=soft(x.GJ for x in steps),
        shear=soft(x.shear for x in steps),
    )


def rotary_inertia(parts: Sequence[tuple[float, Sequence[PistonStep]]]) -> Array:
    """Rotary inertia of pieces, each with its length and what it is at `SHARES` of it, (2,) [kg m^2]."""
    weights = np.array(WEIGHTS) * [[length] for length, _ in parts]
    own = np.array([[(x.rhoA * x.EI[0] / x.EA, x.rhoA * x.EI[1] / x.EA) for x in at] for _, at in parts])
    return np.einsum("ps,psd->d", weights, own)


def as_uniform(sections: Sequence[PistonSection]) -> dict[str, Any]:
    """Numbers of a whole piston that follow from its sections; see `Piston.stepped`."""
    steps = [step for section in sections for step in section.steps]
    length = sum(step.length for step in steps)
    grown = [section.length * section.expansion for section in sections if section.expansion is not None]
    moduli = {section.E for section in sections}
    limits = [section.yield_stress for section in sections if section.yield_stress is not None]
    return {
        "length": length,
        "EA": length / sum(step.length / step.EA for step in steps),
        "EI": length / sum(step.length / step.EI[1] for step in steps),
        "GJ": length / sum(step.length / step.GJ for step in steps),
        "rhoA": sum(step.length * step.rhoA for step in steps) / length,
        "expansion": sum(grown) / length if len(grown) == len(sections) else None,
        "E": moduli.pop() if len(moduli) == 1 else None,
        "yield_stress": min(limits) if len(limits) == len(sections) else None,
    }


def has_sections(fields: Mapping[str, Any]) -> bool:
    """Tell whether these fields have sections."""
    sections = fields.get("sections")
    return isinstance(sections, list | tuple) and bool(sections)
