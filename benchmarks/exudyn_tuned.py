"""Exudyn's robot with what makes it faster and changes nothing else: runs in a process of its own (`ask`).

Its build without range checks (set by the caller: EXUDYN_MODULE=fast); strokes set once a step in place of a Python
call for each drive and each evaluation; no output. The solver stays its sparse one: with dense ones, 15 elements a
piston take seven to eight times as long.
"""

from __future__ import annotations

import time
from unittest.mock import patch

from flexapod.proof.engines import exudyn_robot_model
from flexapod.proof.engines.exudyn_robot import RobotProblem, RobotResult
from flexapod.proof.engines.exudyn_system import System, items
from flexapod.typing import Array

__all__ = ["solve"]


class Tuned(System):
    """The system with drives that are set at the beginning of a step."""

    def hold(self, marker: int, displacement: Array) -> int:
        number = self.mbs.AddObject(
            items.ObjectConnectorCoordinate(markerNumbers=[self.ground, marker], offset=float(displacement[0]))
        )
        self.drives: list[tuple[int, list[float]]] = [*getattr(self, "drives", []), (number, displacement.tolist())]
        return number

    def solve(self, *, equilibrium: bool) -> float:
        step, last = self.integration.duration / self.integration.steps, self.integration.steps

        def set_strokes(mbs: object, t: float) -> bool:
            k = min(round(t / step), last)
            for number, displacement in self.drives:
                self.mbs.SetObjectParameter(number, "offset", displacement[k])
            return True

        self.mbs.Assemble()
        settings = self._settings()
        settings.timeIntegration.verboseMode = 0
        if equilibrium:
            self.mbs.SolveStatic(settings, updateInitialValues=True)
        self.mbs.SetPreStepUserFunction(set_strokes)
        begin = time.process_time()
        self.mbs.SolveDynamic(settings)
        return time.process_time() - begin


def solve(problem: RobotProblem) -> RobotResult:
    """Result of the package's own model in the tuned system; its seconds are those of the processor."""
    with patch.object(exudyn_robot_model, "System", Tuned):
        return exudyn_robot_model.solve(problem)
