"""Commands of the robot at given instants: strokes with rate and acceleration, feedforward forces, wrench."""

from collections.abc import Callable

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.model import ForceDrive, Load, Robot
from flexapod.solve.statics.static_loads import feed_forward, force_ports, is_turned
from flexapod.solve.system import COLUMNS, System

#: Of instants (T,): the table of the ports (T, legs, ports, 4), and the load (T, load_size), of a payload the wrench
#: at the tool in world axes.
Law = Callable[[Array], tuple[Array, Array]]
#: The rigid robot at instants (T,).
RigidAt = Callable[[Array], kinematics.RigidPoses]


def robot_law(system: System, robot: Robot, load: Load, rigid: RigidAt) -> Law:
    """Return what a robot is commanded as a function of time; ``rigid`` is the rigid path.

    Driven coordinates follow the path; what else is held stays where it is at home, of a flexure at zero; and to both
    comes what the robot as built adds (T16.5).
    """
    chains, shapes = kinematics.robot_limbs(robot), system.kernel.shapes
    names = {shapes.index(name): name for name in COORDINATES if shapes.has(name)}
    driven, home = np.zeros((2, system.legs, system.ports.size))
    for k, port in enumerate(system.ports):
        if port in names:
            place = COORDINATES.index(names[port])
            driven[:, k], home[:, k] = chains.state[:, place] == DRIVEN, chains.home[:, place]
    if shapes.has("r"):  # a rotor's travel follows the length
        names[shapes.index("r")] = "l"
        driven[:, system.ports == shapes.index("r")] = np.array([[leg.gives] for leg in robot.legs])
    driven, ports = driven.astype(bool), list(enumerate(system.ports))
    every = np.ones(system.legs, dtype=bool)
    turned = {shapes.index("r"): np.array([leg.gives for leg in robot.legs])} if shapes.has("r") else {}
    places = {k: (COORDINATES.index(names[port]), turned.get(port, every)) for k, port in ports if port in names}
    pushed = system.ports == force_ports(system, robot)[:, None]

    def command_values(at: kinematics.RigidPoses, t: Array) -> Array:
        legs = at.legs
        parts = np.zeros((3, len(t), system.legs, system.ports.size))
        parts[0] = home
        for k in np.flatnonzero(driven.any(axis=0)):
            which = slice(None) if driven[:, k].all() else driven[:, k]
            for part, values in zip(parts, legs.coordinate(names[system.ports[k]]), strict=True):
                part[:, which, k] = values[:, which]
        if built:
            _as_built(at, t, parts, places)
        return parts

    built = kinematics.built_parts(robot)
    forces = any(isinstance(leg.drive, ForceDrive) or is_turned(leg.drive) for leg in robot.legs)

    def law(t: Array) -> tuple[Array, Array]:
        wrench, at = kinematics.wrench(load, t), rigid(t)
        table = np.zeros((len(t), system.legs, system.ports.size, COLUMNS))
        for column, part in enumerate(command_values(at, t)):
            table[..., column] = part
        if system.floor.any():
            for column, part in enumerate(kinematics.base_law(robot, t)):
                table[:, :, system.floor, column] = part[:, None]
        if forces:
            table[:, pushed, 3] = feed_forward(at, t, wrench)[:, pushed.any(axis=1)]
        return table, wrench

    return law


def _as_built(at: kinematics.RigidPoses, t: Array, parts: Array, ports: dict[int, tuple[int, Mask]]) -> None:
    """Add to the places, rates and accelerations (3, T, legs, ports) of a rigid path what the robot as built adds.

    ``ports``: of each port the coordinate that it follows, and in which legs.
    """
    robot, q = at.robot, kinematics.Law(*np.stack([at.legs.coordinate(name) for name in COORDINATES], axis=-1))
    added = kinematics.added_by_all(robot, t, q)
    for part in filter(kinematics.is_plate, kinematics.built_parts(robot)):
        for more, longer in zip(added, kinematics.plate_grows(part, t, at.poses, robot), strict=True):
            more[..., COORDINATES.index("l")] += longer
    for column, more in enumerate(added):
        for port, (place, legs_there) in ports.items():
            parts[column][:, legs_there, port] += more[:, legs_there, place]
