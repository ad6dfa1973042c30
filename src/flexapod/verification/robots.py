"""Robots that cases compute: parallel robots of many kinds, by their letters, and the preset varied."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.model import Robot
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Carriage, Joint
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston, Strut
from flexapod.model.study.payload import Payload

THREE, FOUR = np.arange(3) * 120.0, np.arange(4) * 90.0
LOWER, UPPER = np.array([-10.0, 10, 110, 130, 230, 250]), np.array([-50.0, 50, 70, 170, 190, 290])
PISTON = Piston(length=0.75, EA=1.1e8, EI=5e3, rhoA=4.5)
CYLINDER = Cylinder(mass=3.0, com=0.15, inertia=0.025, mouth=0.25)
LOAD = Payload(mass=100.0, inertia=[18.0, 18.0, 18.0], com=[0.0, 0.05, 0.1], tool=[0.1, 0.0, 0.2])


def ring(radius: float, degrees: ArrayLike) -> Array:
    """Points on a level circle, (n, 3)."""
    a = np.deg2rad(degrees)
    return np.stack([radius * np.cos(a), radius * np.sin(a), np.zeros(len(a))], axis=-1)


def tangents(degrees: ArrayLike) -> Array:
    """Directions along the circle at its points, (n, 3)."""
    return ring(1.0, np.asarray(degrees) + 90.0)


def leg(chain: str, base_axis: Array | None = None, platform_axis: Array | None = None, **more: Any) -> Leg:
    """A leg of the parts above unless others are given."""
    parts = {} if "strut" in more else {"cylinder": CYLINDER, "piston": PISTON}
    joints = {"base_joint": Joint(axis=base_axis), "platform_joint": Joint(axis=platform_axis)}
    return Leg(chain=chain, **{**joints, **parts, **more})


def build_robot(kind: str, base: Array, top: Array, height: float, legs: Sequence[Leg], **more: Any) -> Robot:
    """A robot with a platform of 100 kg unless another is given."""
    given = {"payload": LOAD, "gravity": [0, 0, -9.81]} | more
    return Robot(
        type=kind, base_joints=base, platform_joints=top, home_height=height, legs=tuple(legs), **given,
    )  # fmt: skip


def hexapod(
    chain: str = "UPS", lower: ArrayLike = LOWER, upper: ArrayLike = UPPER, joint: Joint | None = None
) -> Robot:
    """Legs of one kind between two circles; `joint`: flexure at both ends of each."""
    own = leg(chain)
    own = own if joint is None else own.replace(base_joint=joint, platform_joint=joint)
    legs = [own] * np.size(lower)
    return build_robot(f"{len(legs)}-{chain}", ring(0.35, lower), ring(0.2, upper), 0.8, legs)


def eight_legs() -> Robot:
    """8-UPS, two drives more than motions."""
    corners = np.repeat(FOUR, 2)
    return hexapod(lower=corners + np.tile([-12, 12], 4), upper=corners + np.tile([-35, 35], 4) + 8.0)


def tripod(chain: str = "RPS", **more: Any) -> Robot:
    """3-RPS, hinges along the base circle, or with a letter changed."""
    legs = [leg(chain, axis, axis if chain.endswith("U") else None, **more) for axis in tangents(THREE)]
    return build_robot(f"3-{chain}", ring(0.35, THREE), ring(0.2, THREE), 0.6, legs)


def tricept() -> Robot:
    """3-UPS+UP, the passive leg in the middle."""
    base, top = (np.vstack([ring(r, THREE), np.zeros((1, 3))]) for r in (0.35, 0.2))
    legs = [*[leg("UPS")] * 3, leg("UP", np.eye(3)[0], passive=True)]
    return build_robot("3-UPS+UP", base, top, 0.7, legs)


def rod(length: float) -> Strut:
    """Rod of fixed length."""
    return Strut(length=length, EA=1e7, EI=200.0, rhoA=0.8)


def sliders(chain: str = "PUS", length: float = 0.65, mass: float = 3.0) -> Robot:
    """Six rods PUS, or three with other letters, whose feet move on vertical rails below the platform."""
    few = chain != "PUS"
    lower, upper = (THREE, THREE) if few else (LOWER, UPPER)
    axes = list(tangents(THREE)) if few else [None] * 6
    carriage = Carriage(kind="slider", axis=np.array([0.0, 0.0, 1.0]), mass=mass, side=-1)
    ends = [axis if chain.endswith("U") else None for axis in axes]
    pairs = zip(axes, ends, strict=True)
    legs = [leg(chain, a, e, carriage=carriage, strut=rod(length)) for a, e in pairs]
    return build_robot(f"{len(legs)}-{chain}", ring(0.3, lower), ring(0.15, upper), 0.6, legs)


def planar() -> Robot:
    """3-PRR in a level plane, rails along the circle."""
    ways = [Carriage(kind="slider", axis=axis, mass=0.2, side=-1) for axis in tangents(THREE)]
    legs = [leg("PRR", carriage=way, strut=rod(0.4)) for way in ways]
    return build_robot("3-PRR", ring(0.35, THREE), ring(0.08, THREE + 10.0), 0.0, legs, plane="xy")


def table(chain: str, *, mass: float, inertia: float, height: float = 0.8, **rod: Any) -> Robot:
    """Platform on four vertical legs all of which is piston, its centre of mass among the tips."""
    sizes: dict[str, Any] = {"length": height, "EA": 1.1e8, "EI": 5e3, "rhoA": 4.5}
    piston = Piston(**(sizes | rod))
    own = leg(chain, cylinder=Cylinder(mass=0.0, mouth=0.0), piston=piston)
    load = Payload(mass=mass, inertia=[inertia] * 3, com=[0.0, 0.0, 0.0])
    return build_robot(f"4-{chain}", ring(0.3, FOUR), ring(0.3, FOUR), height, [own] * 4, payload=load)


def with_legs(robot: Robot, **changes: Any) -> Robot:
    """The robot with these parts in every leg."""
    return robot.replace(legs=tuple(leg.replace(**changes) for leg in robot.legs))


def without_gravity(robot: Robot) -> Robot:
    """The robot where nothing has weight."""
    return robot.replace(gravity=[0, 0, 0])


def without_cylinders(robot: Robot) -> Robot:
    """The robot with pistons of 1 m that reach from joint to joint."""
    bare = robot.legs[0].cylinder.replace(mouth=0.0, mass=0.0, com=0.0, inertia=0.0)
    rod = robot.legs[0].piston.replace(length=1.0)  # longer than any leg at the poses used: nothing is pulled out
    return with_legs(robot, cylinder=bare, piston=rod)


def with_unequal_legs(robot: Robot) -> Robot:
    """The robot with legs that differ in all they have, axial inertias and universal joints included."""
    return robot.replace(legs=[_unlike(i, leg) for i, leg in enumerate(robot.legs)])


def _unlike(i: int, leg: Leg) -> Leg:
    rod, cylinder = leg.piston, leg.cylinder
    rod = rod.replace(
        length=rod.length * (1 - 0.03 * i), EI=rod.EI * (1 + 0.3 * i), EA=rod.EA / (1 + i), axial_inertia=2e-3 * i
    )
    cylinder = cylinder.replace(mass=1.0 + i, com=0.1 + 0.02 * i, mouth=0.25 + 0.03 * i, axial_inertia=4e-3 * (i % 3))
    u_axis = [1.0, 0.2 * i, 0.3] if i % 2 else None
    return leg.replace(piston=rod, cylinder=cylinder, u_axis=u_axis)


STEEL, ROUND = model.Material(name="steel", E=200e9, density=7800.0), model.Tube(diameter=0.027)
HELD = 1e12  # kg, and kg m^2


def round_piston(length: float) -> Piston:
    """The paper's steel piston of a length [m]."""
    return Piston.round(length=length, section=ROUND, material=STEEL)


def heavy_robot(*, mouth: float, mass: float, free: float) -> model.Robot:
    """A robot without gravity whose platform cannot move, so that each leg vibrates by itself between its joints.

    Parameters
    ----------
    mouth, mass : float
        Length [m] and mass [kg] of a cylinder, uniform.
    free : float
        Length of the piston `round_piston` [m], all of it outside.
    """
    layout = model.preset("paper-robot")
    robot = layout.robot
    across = np.linalg.norm((robot.base_joints - robot.platform_joints)[:, :2], axis=1)[0]
    leg = robot.legs[0].replace(
        cylinder=model.Cylinder(mass=mass, com=mouth / 2, inertia=mass * mouth**2 / 12, mouth=mouth),
        piston=round_piston(free),
        stroke=None,
        damping=0.0,
    )
    payload = robot.payload.replace(mass=HELD, inertia=HELD * np.eye(3), com=np.zeros(3), tool=np.zeros(3))
    height = float(np.sqrt((mouth + free) ** 2 - across**2))
    return robot.replace(legs=(leg,) * 6, payload=payload, home_height=height, gravity=np.zeros(3))
