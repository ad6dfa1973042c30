"""Plate on springs along and about all axes, or moved base: displacement and roll, pitch, yaw, Eq. (T24.1)."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.lazy_imports import lazy_attributes
from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics
from flexapod.mechanics.elements.flexure import flexure
from flexapod.mechanics.elements.frames import Energies, Frame, about_x, about_y, about_z
from flexapod.mechanics.elements.springs import viscous
from flexapod.mechanics.symbolic.vocabulary import dot, identity, matrix33, vertcat, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation
    from flexapod.model.study.mount import Mount

#: Mass of a plate in motion, over that of the payload, at least: between springs nothing else says how it moves
LIGHT = 1e-6

__getattr__: Callable[[str], object] = lazy_attributes(__name__, {}, {"world": "ground_frame"})


class MovedBase(Physics):
    """A base that is moved: displacement and angles g about a point, which follow a table."""

    coordinates: ClassVar[Named] = (("g", 6),)
    parameters: ClassVar[Named] = (("base_motion_at", 3),)  # m

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg: all stand on the moved base."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether the robot has a motion of its base."""
        return robot.base_motion is not None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Point about which the base is moved [m]."""
        return {"base_motion_at": standing.robot.base_motion.at}  # type: ignore[union-attr]

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> tuple[str, ...]:
        """Displacement and angles g, all of which follow the table of the motion."""
        return ("g",)

    @classmethod
    def base_frame(cls, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Frame:
        """Frame of the base as it is moved."""
        return displaced_frame(base or ground_frame(), p.base_motion_at, q.g, v.g)


class _Mounting(Physics):
    """Springs and dampers under a plate, and its displacement and angles; a leg has its share of them."""

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg: all share the plate."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether the robot has a mount at this end."""
        return getattr(robot, f"{cls.end}_mount") is not None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Parameters of the mount, of which a leg has its share."""
        robot, end = standing.robot, self.end
        given = getattr(robot, f"{end}_mount")
        damping = viscous(given.stiffness, given.damping, given.loss, standing.per_loss)
        return {
            f"{end}_mount_at": given.at - (robot.com if end == "platform" else 0.0),
            f"{end}_mount_stiffness": given.stiffness / robot.count,
            f"{end}_mount_damping": damping / robot.count,
        }


class BaseMounting(_Mounting):
    """Mount of the base plate, whose mass and inertia the legs share, too."""

    end: ClassVar[Literal["base", "", "platform"]] = "base"
    coordinates: ClassVar[Named] = (("f", 6),)
    parameters: ClassVar[Named] = (
        ("base_mount_at", 3),  # m, world axes: where springs and the plate's centre of mass are
        ("base_mount_stiffness", 36),  # N/m, N m/rad, column by column, displacements first
        ("base_mount_damping", 36),
        ("base_plate_mass", 1),  # kg
        ("base_plate_weighs", 1),  # kg, of it
        ("base_plate_inertia", 9),  # kg m^2, about that point
    )

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Parameters of the mount, of which a leg has its share."""
        robot = standing.robot
        mass, inertia = plate_mass(robot, robot.base_mount, at_rest=standing.at_rest)  # type: ignore[arg-type]
        weighs = robot.base_mount.mass  # type: ignore[union-attr]
        share = {"base_plate_mass": mass, "base_plate_inertia": inertia, "base_plate_weighs": weighs}
        return super().numbers(leg, standing) | {name: value / robot.count for name, value in share.items()}

    @classmethod
    def base_frame(cls, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Frame:
        """Frame of the base plate on its mount."""
        return displaced_frame(base or ground_frame(), p.base_mount_at, q.f, v.f)

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of the base mount's springs and dampers, and of the plate."""
        p, base = x.p, x.base or ground_frame()
        e = mount(p.base_mount_stiffness, p.base_mount_damping, x.q.f, x.v.f)
        body = p.base_plate_mass, p.base_plate_inertia, p.base_plate_weighs * p.gravity
        return e + plate(base, p.base_mount_at, *body)


class PlatformMounting(_Mounting):
    """Mount of the payload on the plate with the platform joints."""

    end: ClassVar[Literal["base", "", "platform"]] = "platform"
    coordinates: ClassVar[Named] = (("m", 6),)
    parameters: ClassVar[Named] = (
        ("platform_mount_at", 3),  # m, from the CoM in platform axes
        ("platform_mount_stiffness", 36),
        ("platform_mount_damping", 36),
    )

    @classmethod
    def energy(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Energies:
        """Energies of the mount's springs and dampers; those of the plate are in `mechanics.leg.payload`."""
        return mount(p.platform_mount_stiffness, p.platform_mount_damping, q.m, v.m)


def plate_mass(robot: Robot, given: Mount, *, at_rest: bool) -> tuple[float, Array]:
    """Mass [kg] and inertia (3, 3) of a plate; in motion none has nothing, Eq. (T24.12)."""
    load = robot.payload
    mass, size = (1.0, 1.0) if load is None else (load.mass, float(np.trace(load.inertia)) / 3)
    if at_rest:
        return given.mass, given.inertia
    least = LIGHT * size
    more = least * np.eye(3) if np.linalg.eigvalsh(given.inertia)[0] < least else 0.0
    return max(given.mass, LIGHT * mass), given.inertia + more


def ground_frame() -> Frame:
    """Frame of the ground, at rest at the origin."""
    return Frame(origin=zeros(3), axes=identity(3), velocity=zeros(3), omega=zeros(3))


def roll_pitch_yaw(angles: SX) -> SX:
    """Rotation by roll, pitch, yaw about fixed axes x, y, z one after the other: Rz Ry Rx, Eq. (T24.1)."""
    return about_z(angles[2]) @ about_y(angles[1]) @ about_x(angles[0])


def displaced_frame(frame: Frame, at: SX, moved: SX, rate: SX) -> Frame:
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
