"""What pistons that are heavier than drawn do to the tool at rest, Eq. (T16.23)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Study
from flexapod.solve.batch import residual
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.locked_robot import LockedPoses, the_equilibrium
from flexapod.solve.statics.stiffness import displacement, tool_motion
from flexapod.solve.system import System

__all__ = ["by_density"]


def by_density(study: Study, pose: kinematics.Poses) -> Array:
    """Displacement and rotation of the tool by more density of the piston of each leg, relative to it, (n, 6).

    Raises
    ------
    ComputationError
        There is no equilibrium.
    """
    locked = locked_poses(study.robot, study.simulation, pose, study.load)
    pose_there = the_equilibrium(locked).state.pose
    heavier = _balance(locked, locked.system) - _balance(locked, _twice_as_heavy(locked.system))
    count = len(heavier)
    loads = np.zeros((1, *heavier.shape, count))
    loads[0, np.arange(count), :, np.arange(count)] = heavier  # of each leg alone
    y = displacement(locked, loads, np.zeros((1, 6, count)))
    return (tool_motion(study.robot, pose_there[None]) @ y)[0].T


def _balance(locked: LockedPoses, system: System) -> Array:
    """Balance of the leg coordinates at the equilibrium, (n, any) [N, N m], but for what drives do."""
    states = locked.equilibria.states
    still = np.zeros((1, system.legs, len(system.ports)))
    return residual(system, states, still, still, np.zeros(6))[0].reshape(system.legs, -1)


def _twice_as_heavy(system: System) -> System:
    layout, leg_p = leg_parameters(system.kernel.shapes), system.leg_p.copy()
    for name in ("rhoA", "section_rhoA"):
        if name in dict(layout):
            leg_p[:, columns(layout, name)] *= 2.0
    return replace(system, leg_p=leg_p)
