"""What a base that turns does to a robot that is seen from it, Eqs. (T20.8)-(T20.10), (T20.27)."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import matrix
from flexapod.model import Robot, Simulation
from flexapod.model.study.mount import BaseMotion
from flexapod.solve.linear.beside import carried
from flexapod.solve.linear.motions import flat_forces
from flexapod.solve.linear.plant import Plant
from flexapod.solve.robot_system import robot_system, smooth
from flexapod.solve.statics.stiffness import tool_motion
from flexapod.solve.system import System

__all__ = ["carried_masses", "tilt_stiffness", "turning_forces"]


def turning_forces(plant: Plant, about: Array) -> Array:
    """Forces (P, size, 3) per unit angular acceleration of the base about a point (3,), Eq. (T20.9)."""
    system, x = plant.system, plant.x
    found, first = np.zeros((len(x), system.size, 3)), system.legs * system.n
    found[:, :first] = -carried_masses(plant, about)[0][:, :, 3:].swapaxes(2, 3).reshape(len(x), -1, 3)
    rigid, arm = np.zeros((len(x), system.size, 3)), x.pose[:, :3] - about
    rigid[:, first : first + 3] = np.cross(np.eye(3)[None], arm[:, None]).swapaxes(1, 2)
    rigid[:, first + 3 :] = matrix(x.pose[:, 3:]).swapaxes(1, 2)
    none = np.zeros((len(x), system.legs, system.n, system.n))
    return found - flat_forces(system, none, plant.m.payload_M, rigid)


def carried_masses(plant: Plant, about: Array) -> tuple[Array, Array]:
    """Masses of each leg between a base that moves and its coordinates (P, legs, 6, n), and of the base's motions.

    The latter (P, legs, 6, 6). The base is displaced and turned about a point (3,).
    """
    system, x = plant.system, plant.x
    moved = _on_moved_base(plant.robot, plant.locked.simulation, plant.locked.per_loss, about, plant.as_at_rest)
    own, there = ([(n, k) for n, size in s.kernel.shapes.layout for k in range(size)] for s in (system, moved))
    place = {pair: i for i, pair in enumerate(there)}
    at, base = [place[pair] for pair in own], [place["g", k] for k in range(6)]
    q = np.zeros((len(x), system.legs, moved.n))
    q[..., at] = x.q
    M = carried(moved, q)
    return M[..., at], M[..., base]


def tilt_stiffness(plant: Plant) -> Array:
    """Forces (P, size, 3) against unit small turns of the base: weights, load turn in its axes, (T20.10), (T20.27)."""
    found = -plant.by_gravity @ _turning(plant.robot.gravity)
    wrench, first = plant.locked.acts.wrench, plant.system.legs * plant.system.n
    turned = np.concatenate([_turning(wrench[:3]), _turning(wrench[3:])])
    if turned.any():
        found[:, first:] += tool_motion(plant.robot, plant.x.pose).swapaxes(1, 2) @ turned
    return found


def _turning(vector: Array) -> Array:
    """Change (3, 3) of a vector by unit small turns about the axes: columns e x vector."""
    return np.asarray(np.cross(np.eye(3), vector).T)


def _on_moved_base(robot: Robot, simulation: Simulation, per_loss: float, about: Array, at_rest: bool) -> System:
    still = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)), at=about)
    robot = smooth(robot.replace(base_motion=still))
    return robot_system(robot, simulation.replace(play="static"), per_loss, at_rest=at_rest)
