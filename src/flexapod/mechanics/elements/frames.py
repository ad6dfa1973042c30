"""What passes from part to part along a leg: a moving frame; and what a part adds: energies."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flexapod.mechanics.symbolic.vocabulary import cross, dot, mtimes, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX

__all__ = ["Energies", "Frame"]


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame in a leg.

    ``origin`` in the world and ``axes``, the rotation from the frame to the world; velocity of the origin and angular
    velocity relative to the world, both in the frame's own axes.

    Examples
    --------
    >>> [name for name in fx.Frame.__dataclass_fields__]
    ['origin', 'axes', 'velocity', 'omega']
    """

    origin: SX
    axes: SX
    velocity: SX
    omega: SX

    def turned(self, R: SX, rate: SX) -> Frame:
        """Frame after a joint at the origin: ``R`` from the new axes to the old ones, ``rate`` in the new ones."""
        return Frame(
            origin=self.origin,
            axes=self.axes @ R,
            velocity=R.T @ self.velocity,
            omega=R.T @ self.omega + rate,
        )

    def moved(self, by: SX, rate: SX) -> Frame:
        """Frame displaced along its own axes."""
        velocity = self.velocity + rate + cross(self.omega, by)
        return Frame(origin=self.origin + self.axes @ by, axes=self.axes, velocity=velocity, omega=self.omega)

    def weight(self, gravity: SX, mass: SX, moment: SX) -> SX:
        """Potential of gravity of a mass with the first moment int r dm in the frame, zero at the base plane."""
        return -dot(mtimes(self.axes.T, gravity), moment) - mass * dot(gravity, self.origin)


def _none() -> SX:
    return zeros(1)


@dataclass(frozen=True, kw_only=True)
class Energies:
    """Kinetic energy, potential of gravity, strain energy and Rayleigh function of a part; zero where not given.

    Examples
    --------
    >>> fx.Energies(strain=0.5 * 8.0 * 0.5**2).strain  # J; of numbers, or of coordinates
    1.0
    """

    kinetic: SX = field(default_factory=_none)
    gravity: SX = field(default_factory=_none)
    strain: SX = field(default_factory=_none)
    dissipation: SX = field(default_factory=_none)

    def __add__(self, other: Energies) -> Energies:
        return Energies(
            kinetic=self.kinetic + other.kinetic,
            gravity=self.gravity + other.gravity,
            strain=self.strain + other.strain,
            dissipation=self.dissipation + other.dissipation,
        )
