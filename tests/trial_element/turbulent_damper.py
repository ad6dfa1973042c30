"""A damper whose oil is turbulent: its force grows with the square of the rate."""

from typing import Annotated, ClassVar

import flexapod as fx
from flexapod.mechanics.symbolic.elementary import fabs


class TurbulentDamper(fx.Element):
    """An orifice along the stroke: `force` [N] at a `rate` [m/s], as the square of it."""

    at: ClassVar[str] = "turbulent_damper"
    parameters: ClassVar = (("c", 1),)

    force: Annotated[float, fx.Quantity("force", above=0, why="at the rate")]
    rate: Annotated[float, fx.Quantity("velocity", above=0, why="at which it has the force")]

    def numbers(self, leg, standing):
        """Force over the square of the rate."""
        return {"c": self.force / self.rate**2}

    @classmethod
    def damping_force(cls, p, q, v):
        """Against the stroke's rate."""
        return {"l": p.c * v.l * fabs(v.l)}
