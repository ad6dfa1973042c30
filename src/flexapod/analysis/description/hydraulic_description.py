"""Hydraulic cylinders on the rigid path: thrust, pressure, flow, stiffness of the oil, leakage; remarks on excess."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.analysis.checks.plausibility import worst_of_each
from flexapod.analysis.checks.screws import steady_friction
from flexapod.analysis.description.leg_description import Extreme, largest, least
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.quantities import number
from flexapod.common.ranking import most
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
        thrust=largest(t, np.abs(thrust)),
        pressure=largest(t, np.maximum(thrust / push, -thrust / pull)),  # (T23.7)
        flow=largest(t, np.maximum(rate * push, -rate * pull)),
        stiffness=least(t, k),
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
    columns = sensitivity(robot, path.poses).coordinate[chosen][:, :, COORDINATES.index("l")]
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


def oil_words(path: RigidPath, found: tuple[HydraulicDescription, ...]) -> tuple[str, ...]:
    """How fast the platform may vibrate on its oil, and how fast it sinks, without full stops."""
    words, frequency = [], oil_frequency(path)
    if frequency is not None:
        low, high = (number(x, 3) for x in frequency)
        words.append(
            f"the platform on its oil alone vibrates at {low}" + (f" to {high}" if high != low else "") + " Hz at least"
        )
    worst = most(found, key=lambda x: x.creep)
    if worst.creep:
        words.append(
            f"leakage lets leg {worst.leg} give way by up to {number(1e6 * worst.creep, 3)} um/s where nothing "
            "corrects it; positions and frequencies are those of valves that do"
        )
    return tuple(words)


def hydraulic_remarks(robot: Robot, found: tuple[HydraulicDescription, ...]) -> list[str]:
    """What a motion asks beyond the supply: one sentence of a kind, of the leg that is worst."""
    remarks = []
    for one in found:
        limits = robot.legs[one.leg - 1].cylinder_of_oil.limits  # type: ignore[union-attr]
        for kind, what, extreme, limit, unit, factor in (
            ("pressure", "the thrust needs a pressure of", one.pressure, limits.pressure, "bar", BAR),
            ("flow", "the motion needs a flow of", one.flow, limits.flow, "l/min", LITRES),
        ):
            if limit is not None and extreme.value > limit:
                words = (
                    f"{what} {number(factor * extreme.value, 4)} {unit} at t = {extreme.time:.6g} s, above the limit "
                    f"of {number(factor * limit, 4)} {unit}"
                )
                remarks.append((one.leg - 1, kind, extreme.value / limit, words))
    return worst_of_each(remarks)


def hydraulic_table(found: tuple[HydraulicDescription, ...]) -> tuple[list[str], list[list[str]]]:
    """Heads, and a row of texts for each cylinder, its leg first."""
    head = ["thrust [N]", "pressure [bar]", "flow [l/min]", "least stiffness of the oil [N/um]", "creep [um/s]"]
    return head, [
        [
            f"{x.leg}",
            f"{x.thrust.value:.4g}",
            f"{BAR * x.pressure.value:.3g}",
            f"{LITRES * x.flow.value:.3g}",
            f"{1e-6 * x.stiffness.value:.3g}",
            f"{1e6 * x.creep:.3g}",
        ]
        for x in found
    ]
