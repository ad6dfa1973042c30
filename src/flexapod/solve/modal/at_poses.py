"""Robot with locked drives at poses, with structural damping of its springs: equilibria, modes, stiffness."""

from flexapod import kinematics
from flexapod.model import Load, Robot, Simulation
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import RobotModes, single_pose_modes
from flexapod.solve.statics.locked_robot import LockedPoses, single_equilibrium
from flexapod.solve.statics.stiffness import PoseStiffness, stiffness_of


def locked_poses(
    robot: Robot, simulation: Simulation, path: kinematics.Poses, load: Load | None = None, time: float = 0.0
) -> LockedPoses:
    """Static equilibria with the drives locked at the lengths of each of P rigid poses.

    The drives' forces and the wrench of ``load`` are those of `static_loads.rest_load` at ``time`` [s].

    Raises
    ------
    InputError
        A pure force drive.
    """
    return ElasticRobot(robot, simulation, load).lock(kinematics.RigidPoses(robot, path), time)


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
    return single_pose_modes(
        locked_poses(robot, simulation, kinematics.home_pose(robot) if path is None else path, load, time)
    )


def robot_stiffness(
    robot: Robot, simulation: Simulation, path: kinematics.Poses | None = None, load: Load | None = None
) -> PoseStiffness:
    """Stiffness against a wrench at the tool, drives locked, about the static equilibrium at a pose (default: home).

    Loads as of `locked_poses`.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (no compliance), or a pure force drive.
    ComputationError
        No equilibrium at this pose.
    """
    return stiffness_at(locked_poses(robot, simulation, kinematics.home_pose(robot) if path is None else path, load))


def stiffness_at(locked: LockedPoses) -> PoseStiffness:
    """Stiffness against a wrench at the tool at the one pose of a locked robot; raises as `robot_stiffness`."""
    rest, found = single_equilibrium(locked), stiffness_of(locked.robot, locked)
    return PoseStiffness(
        total=found.total[0], legs=found.legs[0], load=found.load[0], equilibrium=rest, system=locked.system
    )
