"""A robot of the model at home as a platform on beams for the oracle of exact frequencies; drives locked, no weight."""

import numpy as np
from tests.oracles import frames
from tests.oracles.mechanisms import _cross as cross_axes


def as_frame(robot):
    """Legs and body; what the plane of a planar robot holds is left out."""
    turn, home, load = robot.home_rotation, robot.home_position, robot.payload
    legs = [
        _leg(robot, leg, foot, tip)
        for leg, foot, tip in zip(robot.legs, robot.home_bases, robot.home_tips, strict=True)
    ]
    free = np.eye(6)
    if robot.plane:
        across = robot.normal != 0
        free = free[~np.concatenate([across, ~across])]
    com, inertia = home + turn @ load.com, turn @ load.inertia @ turn.T
    return legs, frames.Body(mass=load.mass, inertia=inertia, com=com, free=free)


def _leg(robot, leg, foot, tip):
    way = (tip - foot) / np.linalg.norm(tip - foot)
    letters, beam, guided = leg.letters, leg.piston, leg.strut is None
    axis = leg.platform_joint.axis
    axes = leg.base_joint.axis, None if axis is None else robot.home_rotation @ axis
    axes = (robot.normal, robot.normal) if robot.plane else axes
    base, base_springs = _axes(letters.base, leg.base_joint, axes[0], way)
    end, tip_springs = _axes(letters.platform, leg.platform_joint, axes[1], way)
    parts = {}
    if robot.plane:
        base, end = base[:1] if len(base) else base, end[:1] if len(end) else end
        parts = {"first": np.cross(robot.normal, way), "planes": (0,)}
    if letters.platform == "S":  # nothing resists the turn about the leg: it is idle
        base, end = _without(base, way), _without(end, way)
    elif not robot.plane:  # a round section twists with its own inertia where none is given
        inertia = beam.axial_inertia or 2 * beam.rhoA * beam.length * beam.EI / beam.EA
        parts |= {"GJ": beam.torsional_stiffness, "spin_inertia": inertia, "spins": letters.stroke == "C"}
    if guided:
        c = leg.cylinder
        parts |= {"mouth": c.mouth, "length": beam.length, "inertia": c.inertia + c.mass * c.com**2}
        parts |= {"axial_inertia": c.axial_inertia, "slides": not leg.driven}
    return frames.Leg(
        base=foot, tip=tip, base_axes=base, tip_axes=end, base_springs=base_springs, tip_springs=tip_springs,
        EI=beam.EI, EA=beam.EA, rhoA=beam.rhoA, **parts,
    )  # fmt: skip


def _axes(letter, joint, axis, way):
    """Axes of a joint, and the springs about them: of a flexure, across the leg and about it."""
    if letter == "R":
        return np.array([axis]) / np.linalg.norm(axis), ()
    first, second = cross_axes(way, axis, False)
    if letter in ("U", "S"):
        return np.array([first, second, way] if letter == "S" else [first, second]), ()
    found = [(first, joint.bending), (second, joint.bending), (way, joint.torsion)]
    held = [(axis, spring) for axis, spring in found if spring is not None]
    return np.array([axis for axis, _ in held]).reshape(-1, 3), tuple(spring for _, spring in held)


def _along(axes, way):
    return np.array([abs(axis @ way) > 1 - 1e-12 for axis in axes], dtype=bool)


def _without(axes, way):
    return axes[~_along(axes, way)] if len(axes) else axes
