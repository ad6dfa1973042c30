"""A robot of the model as chains for the oracles: what is read are its own numbers, nothing of `kinematics`."""

import numpy as np
from tests.oracles.mechanisms import HEAVE, PITCH, ROLL, SURGE, SWAY, YAW, Mechanism, chain, platform

NAMED = {"surge": SURGE, "sway": SWAY, "heave": HEAVE, "roll": ROLL, "pitch": PITCH, "yaw": YAW}
PLANES = {"xy": ("surge", "sway", "yaw"), "yz": ("sway", "heave", "roll"), "zx": ("surge", "heave", "pitch")}


def as_mechanism(robot, independent=tuple(NAMED), pivot=(0, 0, 0)):
    """The oracle's mechanism; `independent`: coordinates by name, the others follow; pivot in the platform frame."""
    turn, home = robot.home_rotation, robot.home_position
    legs = []
    for leg, foot, tip, base in zip(robot.legs, robot.home_bases, robot.home_tips, robot.base_joints, strict=True):
        planar = robot.normal if robot.plane else None
        parts = {
            "axis": planar if planar is not None else leg.base_joint.axis,
            "passive": leg.passive,
            "exact": not released(leg.chain).endswith("S"),
        }
        end = leg.platform_joint.axis
        parts["platform_axis"] = planar if planar is not None else None if end is None else turn @ end
        if leg.strut is not None:
            parts["strut"] = (leg.strut.mass, leg.strut.length, leg.strut.axial_inertia)
        else:
            c, p = leg.cylinder, leg.piston
            parts |= {
                "cylinder": (c.mass, c.com, c.inertia, c.axial_inertia),
                "piston": (p.mass, p.length, p.axial_inertia),
            }
        way = leg.carriage
        if way is not None and way.kind == "slider":
            parts |= {"slider": way.axis, "carriage": way.mass}
        elif way is not None:
            parts |= {"crank": (way.axis, foot - base), "carriage": way.inertia}
        legs.append(chain(released(leg.chain), foot, tip, **parts))
    load = robot.payload
    com, tool = (home + turn @ point for point in (load.com, load.tool))
    hub = platform(load.mass, com, turn @ load.inertia @ turn.T, home + turn @ np.asarray(pivot))
    chosen = tuple(NAMED[name] for name in independent)
    return Mechanism(tuple(legs), hub, tool, np.asarray(robot.gravity), chosen)


def released(letters):
    """Letters of the rigid path: a weld or flexure is a cross at the base, a ball at the platform."""
    carried = letters[:1] if len(letters) == 3 and letters[1] not in "PC" else ""
    rest = letters[len(carried) :]
    base = rest[0].replace("F", "U")
    return carried + base + rest[1:].replace("F", "S")
