"""Exudyn's robot with what makes it faster and changes nothing else: runs in a process of its own (`ask`).

Its build without range checks (set by the caller: EXUDYN_MODULE=fast); strokes set once a step in place of a Python
call for each drive and each evaluation; no output. The solver stays its sparse one: with dense ones, 15 elements a
piston take seven to eight times as long.
"""

from __future__ import annotations

import time

from flexapod.common.arrays import Array
from flexapod.verification.engines import exudyn_robot
from flexapod.verification.engines.exudyn_builder import Builder
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_robot import RobotProblem, RobotResult

__all__ = ["solve"]


class Tuned(Builder):
    """The system with drives that are set at the beginning of a step."""

    def __init__(self, integration: Integration) -> None:
        super().__init__(integration)
        self.drives: list[tuple[int, list[float]]] = []

    def prescribe_coordinate(self, marker: int, displacement: Array) -> int:
        connector = self.items.ObjectConnectorCoordinate
        number = self.mbs.AddObject(connector(markerNumbers=[self.ground, marker], offset=float(displacement[0])))
        self.drives.append((number, displacement.tolist()))
        return number

    def solve(self, *, equilibrium: bool) -> float:
        step, last = self.step, self.integration.steps

        def set_strokes(mbs: object, t: float) -> bool:
            k = min(round(t / step), last)
            for number, displacement in self.drives:
                self.mbs.SetObjectParameter(number, "offset", displacement[k])
            return True

        self.mbs.Assemble()
        settings = self.settings()
        settings.timeIntegration.verboseMode = 0
        if equilibrium:
            self.mbs.SolveStatic(settings, updateInitialValues=True)
        self.mbs.SetPreStepUserFunction(set_strokes)
        begin = time.process_time()
        self.mbs.SolveDynamic(settings)
        return time.process_time() - begin


def solve(problem: RobotProblem) -> RobotResult:
    """Result of the package's own model in the tuned system; its seconds are those of the processor."""
    return exudyn_robot.solve(problem, Tuned)
