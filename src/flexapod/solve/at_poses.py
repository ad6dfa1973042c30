"""A robot with locked drives at poses, springs with what they lose: equilibria and modes."""

from flexapod import kinematics
from flexapod.model import Load, Robot, Simulation
from flexapod.solve.locked import LockedPoses, lock
from flexapod.solve.loss_factor import per_loss
from flexapod.solve.modes import RobotModes, the_modes

__all__ = ["locked_poses", "robot_modes"]


def locked_poses(
    robot: Robot, simulation: Simulation, path: kinematics.Poses, load: Load | None = None, time: float = 0.0
) -> LockedPoses:
    """Static equilibria with the drives locked at the lengths of each of P rigid poses.

    The drives' forces and the wrench of ``load`` are those of `rest.rest_load` at ``time`` [s].

    Raises
    ------
    InputError
        A pure force drive.
    """
    return lock(robot, simulation, path, load, time, per_loss=per_loss(robot, simulation))


def robot_modes(
    robot: Robot,
    simulation: Simulation,
    path: kinematics.Poses | None = None,
    load: Load | None = None,
    time: float = 0.0,
) -> RobotModes:
    """Modes of the locked robot at a pose (default: home), all degrees of freedom; loads as of `locked_poses`.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    ComputationError
        No equilibrium at this pose, masses that no body can have, or a number that is not finite.
    """
    return the_modes(locked_poses(robot, simulation, kinematics.home_pose(robot) if path is None else path, load, time))
