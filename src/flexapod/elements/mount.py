"""A plate on springs along and about all axes, or one that is moved: displacement and roll, pitch, yaw, (T24.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.elements.flexure import flexure
from flexapod.elements.frame import Energies, Frame
from flexapod.elements.rotations import about_x, about_y, about_z
from flexapod.symbolic.vocabulary import dot, identity, matrix33, vertcat, zeros

if TYPE_CHECKING:
    from flexapod.symbolic.vocabulary import SX

__all__ = ["displaced", "mount", "plate", "turn", "world"]


def world() -> Frame:
    """The frame that stands still."""
    return Frame(origin=zeros(3), axes=identity(3), velocity=zeros(3), omega=zeros(3))


def turn(angles: SX) -> SX:
    """Rotation by roll, pitch, yaw about fixed axes x, y, z one after the other: Rz Ry Rx, Eq. (T24.1)."""
    return about_z(angles[2]) @ about_y(angles[1]) @ about_x(angles[0])


def displaced(frame: Frame, at: SX, moved: SX, rate: SX) -> Frame:
    """Frame of what is displaced (3) at a point of a frame and turned about it (3), origin where it was there."""
    angles, rates = moved[3:], rate[3:]
    there = frame.moved(at, zeros(3)).moved(moved[:3], rate[:3])
    there = there.turned(about_z(angles[2]), vertcat(0, 0, rates[2]))
    there = there.turned(about_y(angles[1]), vertcat(0, rates[1], 0))
    return there.turned(about_x(angles[0]), vertcat(rates[0], 0, 0)).moved(-at, zeros(3))


def mount(stiffness: SX, damping: SX, moved: SX, rate: SX) -> Energies:
    """Springs and dampers between a plate and what it stands on, Eq. (T24.2)."""
    return flexure(stiffness, damping, moved, rate)


def plate(frame: Frame, at: SX, mass: SX, inertia: SX, weight: SX) -> Energies:
    """Energies of a rigid plate whose centre of mass, on which its weight acts, is at a point of its frame, (T24.3)."""
    centre = frame.moved(at, zeros(3))
    turning = dot(centre.omega, matrix33(inertia) @ centre.omega)
    kinetic = 0.5 * (mass * dot(centre.velocity, centre.velocity) + turning)
    return Energies(kinetic=kinetic, gravity=-dot(weight, centre.origin))
