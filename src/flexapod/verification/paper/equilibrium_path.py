"""Equilibria of the paper's robot with its drives locked, one after the other along its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import as_pose
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.rotations import quaternion, rotation_vector
from flexapod.solve.modal.structural_damping import per_loss
from flexapod.solve.rigid_motion import rigid_rest, rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.equilibrium import Equilibrium, equilibrium
from flexapod.solve.statics.static_loads import rest_commands, rest_load
from flexapod.solve.system import State, System
from flexapod.verification.paper.claim import axis_motion
from flexapod.verification.paper.trials import nothing, trial

POSES = 11  # every tenth of the motion: sag and frequency change steadily along it, their extremes are at its ends
FINEST = 2.0**-8 / (POSES - 1)  # share of the motion to which the end of the equilibrium is found: 0.01 deg of 30 deg
NEXT = 0.01  # m; two equilibria further apart than this are not taken for neighbours, but tried again at half the step


@dataclass(frozen=True, kw_only=True)
class EquilibriumPath:
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
    path = kinematics.poses(study.robot, study.motion, path_instants(study))
    changes = kinematics.singularity(study.robot, path).sign_changes
    if not len(changes):
        return None
    return float(np.rad2deg(np.linalg.norm(rotation_vector(quaternion(path.rotation[int(changes[0])])))))


def equilibrium_path(study: model.Study) -> EquilibriumPath:
    """Sag, frequency and end of the static equilibrium along the motion of a study.

    The equilibrium is followed from home, each from the one before, in steps that are halved where it is not found or
    lies elsewhere: beyond a singular pose there may be another one near the rigid pose, which the robot cannot reach.
    """
    target = axis_motion(study).target
    reached, sag = _followed(study)
    if reached < 1:
        return EquilibriumPath(sag=sag, frequency=np.nan, end=reached * float(np.rad2deg(np.abs(target[3:]).max())))
    frequency = np.nan
    for share in np.linspace(0.0, 1.0, POSES):
        try:
            frequency = np.fmin(frequency, float(modes(study, share * target).frequency[0]))
        except ComputationError:  # the equilibrium is too far from the rigid pose for Newton's method to start there
            break
    return EquilibriumPath(sag=sag, frequency=float(frequency), end=None)


def _followed(study: model.Study) -> tuple[float, Array]:
    """Share of the motion that the equilibrium of home lasts, and the largest sag (3,) [m] on the way."""
    system = system_of(study)
    target = axis_motion(study).target
    found, off = locked_equilibrium(study, system, 0.0 * target, None)
    if not found.found:
        return 0.0, np.full(3, np.nan)
    reached, step, sag = 0.0, 1.0 / (POSES - 1), np.abs(off)
    while reached < 1 and step >= FINEST:
        share = min(reached + step, 1.0)
        found, moved = locked_equilibrium(study, system, share * target, before := found.state)
        if found.found and np.abs(moved - off).max() <= NEXT:
            reached, off, sag = share, moved, np.fmax(sag, np.abs(moved))
        else:
            found, step = replace(found, state=before), step / 2
    return reached, sag


def system_of(study: model.Study) -> System:
    """The equations of a study's robot."""
    return robot_system(study.robot, study.simulation, per_loss(study.robot, study.simulation))


def locked_equilibrium(
    study: model.Study, system: System, pose: Sequence[float] | Array, state: State | None
) -> tuple[Equilibrium, Array]:
    """Equilibrium with the drives locked at a rigid pose, and its sag (3,) [m].

    Sought from a state; None: from the rigid pose.
    """
    path = as_pose(study.robot, pose)
    at = kinematics.RigidPoses(study.robot, path)
    start = rigid_state(system, at) if state is None else state
    acts = rest_load(system, at, study.load)
    command = rest_commands(system, study.robot, rigid_rest(system, at).q)
    found = equilibrium(system, start, command[0], acts.force[0], acts.wrench)
    return found, found.state.pose[:3] - path.point(study.robot.payload.com)[0][0]


def trial_along_path(study: model.Study, columns: Sequence[str], step: float | None) -> dict[str, Any]:
    """Columns by name of a simulation, with the equilibrium of its path.

    `lowest_frequency` on the path, NaN if its equilibrium ends; `sag`: largest static deviation on the path, as far as
    there is an equilibrium; `verdict`: empty, or in words why there is no deviation to trust.
    """
    rest, singular = equilibrium_path(study), singular_turn(study)
    lost = {"verdict": words} if (words := _lost(rest, singular)) else {}
    numbers = [name for name in columns if name not in ("sag", "lowest_frequency")]
    tried = nothing(numbers) if singular is not None else trial(study, numbers, step)  # no path where it is singular
    return {**tried, "sag": rest.sag, "lowest_frequency": rest.frequency, **lost}


def _lost(rest: EquilibriumPath, singular: float | None) -> str:
    """Reason why the robot cannot go its path at rest; empty if it can. Text before a colon labels figures."""
    if singular is None:
        return "" if rest.end is None else f"no equilibrium: the one at home ends at {rest.end:.1f} deg of roll"
    words = f"singular path: the rigid robot passes through a singular pose at {singular:.1f} deg of roll"
    if rest.end is None:
        return words
    return f"{words}, and beyond {rest.end:.1f} deg no equilibrium continues the one at home"
