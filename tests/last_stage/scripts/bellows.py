"""A spring in series with a damper, side by side with the stroke of a leg: what an elastomer bellows does."""

from typing import Annotated, ClassVar

import flexapod as fx

LIGHT = 1e-8  # of k tau^2: a mass that stands for none, as in time every coordinate has one


class Bellows(fx.Element):
    """A Maxwell element: `stiffness` [N/m] of the spring, `relaxation` [s] of the pair, `play` [m] of its seat."""

    at: ClassVar[str] = "bellows"
    coordinates: ClassVar = (("z", 1),)  # m, how far the damper has given way
    parameters: ClassVar = (("k", 1), ("c", 1), ("m", 1), ("home", 1))

    stiffness: Annotated[float, fx.Quantity("stiffness", above=0, why="of the spring")]
    relaxation: Annotated[float, fx.Quantity("time", above=0, why="damping over stiffness")]
    play: Annotated[float, fx.Quantity("length", least=0, why="free travel of its seat")] = 0.0

    def numbers(self, leg, standing):
        """Stiffness, damping, the light mass, and the length at which nothing is stretched."""
        k, tau = self.stiffness, self.relaxation
        mass = 0.0 if standing.at_rest else LIGHT * k * tau**2
        return {"k": k, "c": k * tau, "m": mass, "home": standing.length}

    @classmethod
    def energy(cls, p, q, v):
        """The spring is stretched by what the damper has not followed."""
        return fx.Energies(
            kinetic=0.5 * p.m * v.z**2, strain=0.5 * p.k * stretch(p, q) ** 2, dissipation=0.5 * p.c * v.z**2
        )

    outputs: ClassVar = (
        fx.Output("force", "N", "force of the bellows along the leg", lambda p, q: p.k * stretch(p, q)),
    )

    def errors(self, leg):
        """Its seat is anywhere within its play."""
        return [fx.Contribution("seat", "hysteretic", self.play / 2, "half of the seat's play")] if self.play else []


def stretch(p, q):
    """Of the spring [m]."""
    return q.l - p.home - q.z
