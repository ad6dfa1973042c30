"""How far a robot gets along the paper's motion at rest: where its rigid path is singular, its equilibrium ends."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod import model, rigid
from flexapod.errors import ComputationError
from flexapod.paper.claim import axis_motion
from flexapod.rigid.rotations import quaternion, rotation_vector
from flexapod.solve.equilibrium import Equilibrium, equilibrium
from flexapod.solve.rest import rest_commands, rest_load
from flexapod.solve.rigid_motion import rigid_rest, rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.system import State, System
from flexapod.study.arguments import as_pose
from flexapod.study.path import path_instants
from flexapod.study.static import modes
from flexapod.typing import Array

POSES = 11  # every tenth of the motion: sag and frequency change steadily along it, their extremes are at its ends
FINEST = 2.0**-8 / (POSES - 1)  # share of the motion to which the end of the equilibrium is found: 0.01 deg of 30 deg
NEXT = 0.01  # m; two equilibria further apart than this are not taken for neighbours, but tried again at half the step


@dataclass(frozen=True, kw_only=True)
class Rest:
    """The resting robot along a motion.

    `sag` (3,) [m]: largest on the way; `frequency` [Hz]: lowest at `POSES` poses, as far as Newton's method finds the
    equilibrium from the rigid pose, NaN where the equilibrium ends (it falls to 0); `end`: turn [deg] at which the
    equilibrium that begins at home ends, because its stiffness vanishes; None if it lasts.
    """

    sag: Array
    frequency: float
    end: float | None


def singular_turn(study: model.Study) -> float | None:
    """Turn of the platform [deg] at which the rigid robot first passes through a singular pose; None: nowhere.

    There the determinant of the scaled Jacobian changes its sign, a fact of the joints' places and the path alone.
    """
    path = rigid.poses(study.robot, study.motion, path_instants(study))
    changes = rigid.singularity(study.robot, path).sign_changes
    if not len(changes):
        return None
    return float(np.rad2deg(np.linalg.norm(rotation_vector(quaternion(path.rotation[int(changes[0])])))))


def at_rest(study: model.Study) -> Rest:
    """Sag, frequency and end of the static equilibrium along the motion of a study.

    The equilibrium is followed from home, each from the one before, in steps that are halved where it is not found or
    lies elsewhere: beyond a singular pose there may be another one near the rigid pose, which the robot cannot reach.
    """
    target = axis_motion(study).target
    reached, sag = _followed(study)
    if reached < 1:
        return Rest(sag=sag, frequency=np.nan, end=reached * float(np.rad2deg(np.abs(target[3:]).max())))
    frequency = np.nan
    for share in np.linspace(0.0, 1.0, POSES):
        try:
            frequency = np.fmin(frequency, float(modes(study, share * target).frequency[0]))
        except ComputationError:  # the equilibrium is too far from the rigid pose for Newton's method to start there
            break
    return Rest(sag=sag, frequency=float(frequency), end=None)


def _followed(study: model.Study) -> tuple[float, Array]:
    """Share of the motion that the equilibrium of home lasts, and the largest sag (3,) [m] on the way."""
    system = robot_system(study.robot, study.simulation)
    found, off = _near(study, system, 0.0, None)
    if not found.found:
        return 0.0, np.full(3, np.nan)
    reached, step, sag = 0.0, 1.0 / (POSES - 1), np.abs(off)
    while reached < 1 and step >= FINEST:
        share = min(reached + step, 1.0)
        found, moved = _near(study, system, share, before := found.state)
        if found.found and np.abs(moved - off).max() <= NEXT:
            reached, off, sag = share, moved, np.fmax(sag, np.abs(moved))
        else:
            found, step = replace(found, state=before), step / 2
    return reached, sag


def _near(study: model.Study, system: System, share: float, state: State | None) -> tuple[Equilibrium, Array]:
    """Equilibrium at a share of the motion, sought from a state (None: the rigid pose); its sag (3,) [m]."""
    robot = study.robot
    path = as_pose(robot, share * axis_motion(study).target)
    start = rigid_state(system, robot, path) if state is None else state
    acts = rest_load(system, robot, path, study.load)
    command = rest_commands(system, robot, rigid_rest(system, robot, path).q)
    found = equilibrium(system, start, command[0], acts.force[0], acts.wrench)
    return found, found.state.pose[:3] - path.point(robot.payload.com)[0][0]
