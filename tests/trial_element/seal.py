"""A seal that rubs along the stroke of a leg."""

from typing import Annotated, ClassVar

import flexapod as fx
from flexapod.model import StrokeFriction

NONE = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)  # a leg without it: nothing rubs, and what could bend is a unit long


class Seal(fx.Element):
    """A seal with friction of a `force` [N] along the stroke."""

    at: ClassVar[str] = "seal"
    parameters: ClassVar = (("friction", 8),)
    absent: ClassVar = {"friction": (*NONE, 0.0)}

    force: Annotated[float, fx.Quantity("force", above=0, why="along the stroke")]

    def numbers(self, leg, standing):
        """As those of a drive's friction; it slides in one direction alone."""
        return {"friction": (*StrokeFriction(force=self.force).numbers, 0.0)}

    @classmethod
    def sliding_speed(cls, p, q, v):
        """With the stroke."""
        return v.l

    @classmethod
    def friction_directions(cls, has):
        """One."""
        return ("",)
