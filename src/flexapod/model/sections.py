"""Sections of a stepped piston, from its driven end to its tip."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, NamedTuple

from pydantic import Field, model_validator

from flexapod.errors import InputError
from flexapod.model.base import Frozen, Measure, Number, Positive
from flexapod.model.material import POISSON, Rectangle, Tube

STEPS = 8  # uniform pieces in place of a taper


class Step(NamedTuple):
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


class PistonSection(Frozen):
    """A section of a piston: round, full or hollow, or a strip; of one material.

    `length`; `diameter`, `tip_diameter` where it tapers towards the tip, `inner_diameter`, or `width` along the axis x
    of the leg (the first axis of its base joint) and `thickness` along y [m]; `E` [Pa], `density` [kg/m^3],
    `yield_stress` [Pa], `poisson`, `expansion` [1/K].
    """

    length: Annotated[Positive, Measure("length")]
    diameter: Annotated[Positive, Measure("length")] | None = None
    tip_diameter: Annotated[Positive, Measure("length")] | None = None
    inner_diameter: Annotated[Positive, Measure("length")] | None = None
    width: Annotated[Positive, Measure("length")] | None = None
    thickness: Annotated[Positive, Measure("length")] | None = None
    E: Annotated[Positive, Measure("stress")]
    density: Annotated[Positive, Measure("density")]
    yield_stress: Annotated[Positive, Measure("stress")] | None = None
    poisson: float = Field(default=POISSON, strict=True, ge=-0.5, le=0.5)
    expansion: Annotated[Number, Measure("expansion")] | None = None

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
        return self

    @property
    def steps(self) -> Iterator[Step]:
        """Uniform pieces, from the driven end: one, or of a taper `STEPS` with the sizes at their middles."""
        if self.diameter is None or self.tip_diameter in (None, self.diameter):
            yield self._step(self.length, self.diameter)
            return
        for k in range(STEPS):
            share = (k + 0.5) / STEPS
            yield self._step(self.length / STEPS, self.diameter + share * (self.tip_diameter - self.diameter))  # type: ignore[operator]

    def _step(self, length: float, diameter: float | None) -> Step:
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
        return Step(
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
