"""Hydraulic cylinders on the rigid path: thrust, pressure, flow, stiffness of the oil, leakage; remarks on excess."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.analysis.checks.screws import steady_friction
from flexapod.analysis.description.leg_description import Extreme, maximum, minimum
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.results.remarks import Doubt, worst_remarks
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.rotations import matrix, quaternion
from flexapod.mechanics.elements.springs import springs_along
from flexapod.model import Leg, Robot

BAR, LITRES = 1e-5, 6e4  # bar per Pa, l/min per m^3/s
INSTANTS = 200  # at which the frequency on the oil is sought


@dataclass(frozen=True, kw_only=True)
class HydraulicDescription:
    """One cylinder on the rigid path, SI units.

    `thrust`: largest force of the oil, that on its seals included; `pressure`: least of the supply over the return that
    gives it, Eq. (T23.7); `flow` into the cylinder; `stiffness` of the oil, where it is least; `creep`: largest rate at
    which leakage lets the leg give way [m/s].
    """

    leg: int
    thrust: Extreme
    pressure: Extreme
    flow: Extreme
    stiffness: Extreme
    creep: float


def describe_hydraulics(path: RigidPath) -> tuple[HydraulicDescription, ...]:
    """The hydraulic cylinders of a robot on the rigid path of its study."""
    legs, found = path.legs, []
    for i, leg in enumerate(path.robot.legs):
        if leg.cylinder_of_oil is not None:
            rate, force = legs.rate[:, i], path.forces.drive_force[:, i]
            if (friction := leg.cylinder_of_oil.friction) is not None:
                force = force + steady_friction(friction, rate)
            found.append(describe_hydraulic(i, leg, path.time, legs.length[:, i], force, rate))
    return tuple(found)


def describe_hydraulic(i: int, leg: Leg, t: Array, length: Array, thrust: Array, rate: Array) -> HydraulicDescription:
    """The cylinder of leg i at instants `t`, each shape (T,): length [m], force of the oil on it [N], rate [m/s]."""
    push, pull = leg.cylinder_of_oil.areas  # type: ignore[union-attr]
    oil = next(spring for spring in springs_along(leg) if spring.columns)
    k = 1 / oil.at_length(length)
    return HydraulicDescription(
        leg=i + 1,
        thrust=maximum(t, np.abs(thrust)),
        pressure=maximum(t, np.maximum(thrust / push, -thrust / pull)),  # (T23.7)
        flow=maximum(t, np.maximum(rate * push, -rate * pull)),
        stiffness=minimum(t, k),
        creep=float((np.abs(thrust) * oil.creep(length)).max()),
    )


def oil_frequency(path: RigidPath) -> tuple[float, float] | None:
    """Lowest frequencies [Hz] of the platform on its oil alone, least and largest along the path, Eq. (T23.8).

    None of platforms that are not held by as many hydraulic legs as they have motions.
    """
    robot = path.robot
    drives = [leg.driven == "stroke" and leg.cylinder_of_oil is not None for leg in robot.legs]
    if robot.payload is None or not all(drives) or robot.count > 6 or robot.plane:
        return None
    chosen = np.unique(np.linspace(0, len(path.time) - 1, INSTANTS).astype(int))
    columns = sensitivity(path).coordinate[chosen][:, :, COORDINATES.index("l")]
    R = matrix(quaternion(path.poses.rotation))[chosen]
    arm = R @ (robot.com - robot.tool)
    turn, moved = columns[..., 3:], columns[..., :3] + np.cross(columns[..., 3:], arm[:, None])
    inertia = R @ robot.payload.inertia @ R.swapaxes(1, 2)
    mass = robot.payload.mass * moved @ moved.swapaxes(1, 2) + turn @ inertia @ turn.swapaxes(1, 2)
    oils = [next(x for x in springs_along(leg) if x.columns) for leg in robot.legs]
    root = np.sqrt(np.stack([x.at_length(path.legs.length[chosen, i]) for i, x in enumerate(oils)], axis=1))
    slowest = np.linalg.eigvalsh(root[:, :, None] * mass * root[:, None, :])[:, -1]
    frequency = 1 / (2 * np.pi * np.sqrt(slowest))
    return float(frequency.min()), float(frequency.max())


def hydraulic_remarks(robot: Robot, found: tuple[HydraulicDescription, ...]) -> list[str]:
    """Remarks on pressures and flows above the supply: one sentence of a kind, for the worst leg."""
    doubts = []
    for one in found:
        limits = robot.legs[one.leg - 1].cylinder_of_oil.limits  # type: ignore[union-attr]
        for kind, extreme, limit, factor in (
            ("pressure", one.pressure, limits.pressure, BAR),
            ("flow", one.flow, limits.flow, LITRES),
        ):
            if limit is not None and extreme.value > limit:
                numbers = {"value": factor * extreme.value, "time": extreme.time, "limit": factor * limit}
                bad = extreme.value / limit
                doubts.append(Doubt(leg=one.leg - 1, kind=kind, severity=bad, numbers=numbers))
    return worst_remarks(doubts)
