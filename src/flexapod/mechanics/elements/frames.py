"""Frames and energies of the parts of a leg, and rotation matrices, Eqs. (T3.4), (T4.1)-(T4.2), (T13.2).

A part passes a moving frame on to the next one, and adds its energies.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flexapod.mechanics.symbolic.vocabulary import cos, cross, dot, identity, mtimes, sin, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Moving frame in a leg: origin, axes and velocities.

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


def about_x(angle: SX) -> SX:
    """Rotation about the first axis."""
    R, c, s = identity(3), cos(angle), sin(angle)
    R[1, 1], R[1, 2], R[2, 1], R[2, 2] = c, -s, s, c
    return R


def about_y(angle: SX) -> SX:
    """Rotation about the second axis."""
    R, c, s = identity(3), cos(angle), sin(angle)
    R[0, 0], R[0, 2], R[2, 0], R[2, 2] = c, s, -s, c
    return R


def about_z(angle: SX) -> SX:
    """Rotation about the third axis."""
    R, c, s = identity(3), cos(angle), sin(angle)
    R[0, 0], R[0, 1], R[1, 0], R[1, 1] = c, -s, s, c
    return R


def hat(x: SX) -> SX:
    """Matrix of the vector product with x."""
    S = zeros(3, 3)
    S[0, 1], S[0, 2], S[1, 2] = -x[2], x[1], -x[0]
    S[1, 0], S[2, 0], S[2, 1] = x[2], -x[1], x[0]
    return S


def about_axis(axis: SX, angle: SX) -> SX:
    """Rotation about a unit vector, Eq. (T13.2)."""
    c = cos(angle)
    return c * identity(3) + sin(angle) * hat(axis) + (1 - c) * (axis @ axis.T)


def small_rotation(theta: SX) -> SX:
    """exp(theta^) to second order: exact for first and second derivatives at theta = 0, Eq. (T4.2)."""
    S = hat(theta)
    return identity(3) + S + 0.5 * (S @ S)


def from_quaternion(e: SX) -> SX:
    """Rotation matrix of a unit quaternion (w, x, y, z), platform to world, Eq. (T4.1)."""
    w, x, y, z = e[0], e[1], e[2], e[3]
    R = zeros(3, 3)
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R
