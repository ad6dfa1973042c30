"""A robot in the fidelity of a simulation, under its load: loss time, equations, equilibria with locked drives."""

from __future__ import annotations

from functools import cached_property

from flexapod.kinematics import RigidPoses
from flexapod.model import Load, Robot, Simulation
from flexapod.solve.modal.structural_damping import per_loss
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.locked_robot import LockedPoses, lock
from flexapod.solve.system import System


class ElasticRobot:
    """A robot in the fidelity and shapes of a simulation; each part is made when it is asked for, once.

    Parameters
    ----------
    robot : Robot
    simulation : Simulation
    load : Load, optional
        At the tool; none without it.
    """

    def __init__(self, robot: Robot, simulation: Simulation, load: Load | None = None) -> None:
        self.robot = robot
        self.simulation = simulation
        self.load = load

    @cached_property
    def per_loss(self) -> float:
        """Viscous damping over stiffness of a spring of loss factor 1 [s], see `structural_damping.per_loss`."""
        return per_loss(self.robot, self.simulation)

    @cached_property
    def moving(self) -> System:
        """Equations of motion."""
        return robot_system(self.robot, self.simulation, self.per_loss)

    @cached_property
    def resting(self) -> System:
        """Equations at rest: loops that sum their errors have left none, Eq. (T23.16)."""
        return robot_system(self.robot, self.simulation, self.per_loss, at_rest=True)

    def lock(self, at: RigidPoses, time: float = 0.0) -> LockedPoses:
        """Static equilibria with the drives locked at the lengths of each of P rigid poses.

        The drives' forces and the wrench of the load are those of `static_loads.rest_load` at ``time`` [s].

        Raises
        ------
        InputError
            A pure force drive.
        """
        return lock(self.robot, self.simulation, at, self.load, time, per_loss=self.per_loss)
