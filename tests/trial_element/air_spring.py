"""A closed chamber of air beside the stroke of a leg, at one temperature: a spring that hardens as it gets short."""

import math
from typing import Annotated, ClassVar

import flexapod as fx
from flexapod.mechanics.symbolic.elementary import log

AMBIENT = 101325.0  # Pa


class AirSpring(fx.Element):
    """An isothermal air spring: `pressure` [Pa, absolute] at home, in a `bore` [m] with a `height` [m] of air."""

    at: ClassVar[str] = "air_spring"
    parameters: ClassVar = (("area", 1), ("pressure", 1), ("height", 1), ("home", 1))
    absent: ClassVar = {"height": 1.0}  # in a leg without it: the others are 0, and nothing is divided by 0

    pressure: Annotated[float, fx.Quantity("stress", above=0, why="absolute, at home")]
    bore: Annotated[float, fx.Quantity("length", above=0, why="diameter of the chamber")]
    height: Annotated[float, fx.Quantity("length", above=0, why="of the air at home")]

    def numbers(self, leg, standing):
        """Area, pressure and height at home, and the length of the leg there."""
        area = math.pi / 4 * self.bore**2
        return {"area": area, "pressure": self.pressure, "height": self.height, "home": standing.length}

    @classmethod
    def energy(cls, p, q, v):
        """Work on the air: pressure times height stays what it is."""
        outside = AMBIENT * (q.l - p.home)
        return fx.Energies(strain=p.area * (outside - p.pressure * p.height * log(taller(p, q))))

    outputs: ClassVar = (
        fx.Output("pressure", "Pa", "absolute pressure in the air spring", lambda p, q: p.pressure / taller(p, q)),
    )


def taller(p, q):
    """Height of the air over that at home."""
    return 1 + (q.l - p.home) / p.height
