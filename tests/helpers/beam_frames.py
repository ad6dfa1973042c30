"""A robot of the model as a platform on beams for the oracle of exact frequencies; drives locked, no weight.

Places and axes of the joints at a pose come from the oracle's chains, stiffness and masses from the model.
"""

import numpy as np
from tests.helpers.chains import NAMED, as_mechanism
from tests.oracles import frames, virtual_power

COUNT = {"R": 1, "U": 2, "S": 3, "F": 0, "": 0}


def as_frame(robot, pose=None):
    """Legs and body, at home or where the coordinates of `pose` are; what the plane of a robot holds is left out."""
    pose = dict.fromkeys(NAMED, 0.0) if pose is None else pose
    mechanism = as_mechanism(robot, tuple(pose))
    still = np.zeros(len(pose))
    if any(pose.values()):
        state = virtual_power.follow(mechanism, list(pose.values()), still, still)
        q, hub = [leg[0] for leg in state.legs], state.platform[0]
    else:
        q, hub = [np.zeros(len(chain.joints)) for chain in mechanism.legs], np.zeros(6)
    place = virtual_power.placed(mechanism.platform, hub)[0][-1]
    legs = [_leg(robot, *parts, place) for parts in zip(robot.legs, mechanism.legs, q, strict=True)]
    free = np.eye(6)
    if robot.plane:
        across = robot.normal != 0
        free = free[~np.concatenate([across, ~across])]
    body = mechanism.platform.bodies[0]
    turn = place[:3, :3]
    com = turn @ body.com + place[:3, 3]
    return legs, frames.Body(mass=body.mass, inertia=turn @ body.inertia @ turn.T, com=com, free=free)


def _leg(robot, leg, chain, q, place):
    places, screws = virtual_power.placed(chain, q)
    letters, beam, planar = leg.letters, leg.piston, robot.plane is not None
    first = int(leg.carriage is not None)
    foot = places[first][:3, :3] @ chain.base + places[first][:3, 3]
    tip = place[:3, :3] @ chain.tip + place[:3, 3]
    way = (tip - foot) / np.linalg.norm(tip - foot)
    base = screws[first : first + COUNT[letters.base], :3]
    end = screws[len(screws) - COUNT[letters.platform] :, :3]
    parts = {}
    if planar:
        base, end = base[:1], end[:1]
        parts = {"first": np.cross(robot.normal, way), "planes": (0,)}
    elif letters.platform == "S":  # nothing resists the turn about the leg: it is idle
        end = _across(way)
        base = _across(way) if letters.base == "S" else base
    else:  # a round section twists with its own inertia where none is given
        inertia = beam.axial_inertia or 2 * beam.rhoA * beam.length * beam.EI / beam.EA
        parts = {"GJ": beam.torsional_stiffness, "spin_inertia": inertia, "spins": letters.stroke == "C"}
    base, base_springs = _flexure(leg.base_joint, way) if letters.base == "F" else (base, ())
    end, tip_springs = _flexure(leg.platform_joint, way) if letters.platform == "F" else (end, ())
    if leg.strut is None:
        c = leg.cylinder
        parts |= {"mouth": c.mouth, "length": beam.length, "inertia": c.inertia + c.mass * c.com**2}
        parts |= {"axial_inertia": c.axial_inertia, "slides": not leg.driven}
    return frames.Leg(
        base=foot, tip=tip, base_axes=base, tip_axes=end, base_springs=base_springs, tip_springs=tip_springs,
        EI=beam.EI, EA=beam.EA, rhoA=beam.rhoA, **parts,
    )  # fmt: skip


def _across(way):
    """Two axes across the leg."""
    x = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(way, x)])


def _flexure(joint, way):
    """Axes of a flexure and the springs about them, across the leg and about it; where there is none it is rigid."""
    x, y = _across(way)
    found = [(x, joint.bending), (y, joint.bending), (way, joint.torsion)]
    held = [(axis, spring) for axis, spring in found if spring is not None]
    return np.array([axis for axis, _ in held]).reshape(-1, 3), tuple(spring for _, spring in held)
