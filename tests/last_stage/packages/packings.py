"""A package from outside, installed: its entry point in the group `flexapod.elements` says what it has."""

from typing import Annotated, ClassVar

import flexapod as fx


class Packed(fx.Element):
    """A packing that damps the stroke: `damping` [N s/m]."""

    at: ClassVar[str] = "packed"
    parameters: ClassVar = (("c", 1),)

    damping: Annotated[float, fx.Quantity("damping", above=0, why="of the packing")]

    def numbers(self, leg, standing):
        """The damping."""
        return {"c": self.damping}

    @classmethod
    def energy(cls, p, q, v):
        """Rayleigh's function."""
        return fx.Energies(dissipation=0.5 * p.c * v.l**2)
