"""Parallel mechanisms as chains of hinges and slides: nothing but points, axes and bodies at home, in world axes.

A leg is written with the letters of its joints, base to platform: R hinge, P slide, U cross, C slide and turn about the
leg, S ball, F weld. The platform is moved by six joints of its own: slides along x, y, z, turns about z, y, x through
the pivot, so that they are surge, sway, heave, yaw, pitch, roll.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

AXES = np.eye(3)
SURGE, SWAY, HEAVE, YAW, PITCH, ROLL = range(6)  # coordinates of the platform, in the order of its joints


@dataclass(frozen=True)
class Joint:
    """Hinge ("R") or slide ("P") with its axis and a point on it; a name for the coordinate."""

    kind: str
    axis: np.ndarray
    point: np.ndarray
    name: str = ""


@dataclass(frozen=True)
class Body:
    """Mass, its centre, inertia (3, 3) about the centre, carried by the first `after` joints of the chain."""

    mass: float
    com: np.ndarray
    inertia: np.ndarray
    after: int


@dataclass(frozen=True)
class Chain:
    """Joints in a row from the ground, bodies on them, which joint is driven; base joint and tip at home."""

    joints: tuple[Joint, ...]
    bodies: tuple[Body, ...]
    drive: int | None
    base: np.ndarray
    tip: np.ndarray
    ball: bool = False  # the last three joints are the ball at the platform


@dataclass(frozen=True)
class Mechanism:
    """Legs, and the platform with its load as a chain of six joints; what acts on it."""

    legs: tuple[Chain, ...]
    platform: Chain
    tool: np.ndarray
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    independent: tuple[int, ...] = tuple(range(6))  # coordinates of the platform that are given; the others follow


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


def slender(mass, end, along, length, axial=0.0):
    """Mass, centre and inertia of a uniform rod that reaches from `end` back by `length`; `along` is its direction."""
    return _revolved(mass, end - along * length / 2, along, mass * length**2 / 12, axial)


def _revolved(mass, com, along, across, axial):
    turned = np.outer(along, along)
    return mass, com, across * (np.eye(3) - turned) + axial * turned


def _cross(along, axis, exact):
    """Axes of a cross at home: first as given, or its part normal to the leg; second normal to it and to the leg."""
    if axis is None:
        axis = np.cross(AXES[2], along)
        axis = AXES[0] if np.linalg.norm(axis) < 1e-9 else axis
    first = unit(axis) if exact else unit(np.asarray(axis) - along * np.dot(axis, along))
    return first, unit(np.cross(along, first))


def _expanded(letter, along, axis, at, end, exact):
    """Hinges and slides of one letter."""
    if letter == "R":
        return [Joint("R", unit(axis), at, "turn")]
    if letter == "P":
        return [Joint("P", along, at, "length")]
    if letter == "C":
        return [Joint("P", along, at, "length"), Joint("R", along, at, "spin")]
    if letter == "U":
        first, second = _cross(along, axis, exact)
        pair = [Joint("R", first, at, "alpha"), Joint("R", second, at, "beta")]
        return pair[::-1] if end else pair
    if letter == "S":
        first, second = _cross(along, axis, exact)
        return [Joint("R", a, at, "ball") for a in (first, second, along)]
    return []  # F


def chain(
    letters, base, tip, *, axis=None, platform_axis=None, slider=None, crank=None,
    carriage=None, cylinder=None, piston=None, strut=None, passive=False, exact=False,
):  # fmt: skip
    """A leg. Points and axes at home, world axes.

    `slider`: direction of a rail at the base joint; `crank`: (axis, arm), the arm from the shaft to the base joint;
    `carriage`: mass of the slider, or inertia of the crank about its shaft. `cylinder`: mass, centre from the base
    joint, inertia across and along. `piston`, `strut`: mass, length, inertia along; they end at the tip. `exact`: the
    axes of a cross on base and platform need not be normal to the leg.
    """
    base, tip = np.asarray(base, float), np.asarray(tip, float)
    along = unit(tip - base)
    joints: list[Joint] = []
    bodies: list[Body] = []
    rest = letters
    if slider is not None:
        joints.append(Joint("P", unit(slider), base, "carriage"))
        rest = letters[1:]
        bodies += [Body(carriage, base, np.zeros((3, 3)), 1)] if carriage else []
    elif crank is not None:
        shaft, arm = unit(crank[0]), np.asarray(crank[1], float)
        joints.append(Joint("R", shaft, base - arm, "carriage"))
        rest = letters[1:]
        bodies += [Body(0.0, base - arm, carriage * np.eye(3), 1)] if carriage else []
    joints += _expanded(rest[0], along, axis, base, end=False, exact=exact)
    if cylinder:
        mass, com, across, axial = cylinder
        bodies.append(Body(*_revolved(mass, base + com * along, along, across, axial), len(joints)))
    if len(rest) > 1 and rest[1] in "PC":
        joints += _expanded(rest[1], along, None, base, end=False, exact=exact)
        rest = rest[1:]
    for rod in (piston, strut):
        if rod:
            mass, length, axial = rod
            bodies.append(Body(*slender(mass, tip, along, length, axial), len(joints)))
    last = rest[1] if len(rest) > 1 else "F"
    joints += _expanded(last, along, platform_axis if platform_axis is not None else axis, tip, end=True, exact=exact)
    driven = next((i for i, j in enumerate(joints) if j.kind == "P"), 0)
    return Chain(tuple(joints), tuple(bodies), None if passive else driven, base, tip, last == "S")


def platform(mass, com, inertia, pivot=(0, 0, 0)):
    """The platform with its load; centre, pivot at home, inertia about the centre, world axes at home."""
    pivot = np.asarray(pivot, float)
    names = ("surge", "sway", "heave", "yaw", "pitch", "roll")
    joints = tuple(Joint("P" if i < 3 else "R", AXES[i if i < 3 else 5 - i], pivot, names[i]) for i in range(6))
    body = Body(mass, np.asarray(com, float), np.asarray(inertia, float), 6)
    return Chain(joints, (body,), None, pivot, pivot)
