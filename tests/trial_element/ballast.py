"""A mass on the cylinder of a leg, beside its axis."""

from typing import Annotated, ClassVar

import flexapod as fx
from flexapod.mechanics.symbolic.vocabulary import dot, vertcat, zeros


class Ballast(fx.Element):
    """A point of some `mass` [kg], `along` the leg from its base joint [m] and `beside` its axis, in its x [m]."""

    at: ClassVar[str] = "ballast"
    end: ClassVar = "base"
    parameters: ClassVar = (("mass", 1), ("along", 1), ("beside", 1))

    mass: Annotated[float, fx.Quantity("mass", above=0, why="of the point")]
    along: Annotated[float, fx.Quantity("length", why="from the base joint along the leg")]
    beside: Annotated[float, fx.Quantity("length", why="from the axis of the leg")] = 0.0

    def numbers(self, leg, standing):
        """Mass and place."""
        return {"mass": self.mass, "along": self.along, "beside": self.beside}

    @classmethod
    def energy_along(cls, x):
        """The point moves with the cylinder's frame."""
        point = x.cylinder.moved(vertcat(x.p.beside, 0, x.p.along), zeros(3))
        return fx.Energies(
            kinetic=0.5 * x.p.mass * dot(point.velocity, point.velocity),
            gravity=point.weight(x.p.gravity, x.p.mass, zeros(3)),
        )
