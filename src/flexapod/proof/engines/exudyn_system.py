"""What Exudyn's models of this package share: ground, drive, guide, sensors, solution. Imports Exudyn."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from flexapod.proof.engines.exudyn_integration import Integration
from flexapod.typing import Array

# As untyped modules: their type stubs do not fit their functions.
exu: Any = importlib.import_module("exudyn")
items: Any = importlib.import_module("exudyn.itemInterface")

CARRIAGE_MASS = 1e-6  # kg, of the body that drives the piston's end; Exudyn finds no start with a body without mass


class System:
    """A multibody system of Exudyn under construction, with `mbs` its own handle on it."""

    def __init__(self, integration: Integration) -> None:
        self.integration = integration
        #: Called before each step, at the state with which it begins.
        self.before_step: list[Callable[[], None]] = []
        self.container = exu.SystemContainer()  # owns the system
        self.mbs = self.container.AddSystem()
        ground = self.mbs.AddNode(items.NodePointGround())
        self.ground = self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))

    @property
    def step(self) -> float:
        """Of the integration [s]."""
        return self.integration.duration / self.integration.steps

    def coordinate(self, node: int, coordinate: int) -> int:
        """Marker of a coordinate of a node."""
        return self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))

    def hold(self, marker: int, displacement: Array) -> int:
        """Let the coordinate of a marker follow `displacement` (T,) at the instants of the integration; its number."""

        def offset(_mbs: object, t: float, _number: int, _offset: float) -> float:
            return float(displacement[self._instant(t)])

        return self.mbs.AddObject(
            items.ObjectConnectorCoordinate(markerNumbers=[self.ground, marker], offsetUserFunction=offset)
        )

    def spring(
        self,
        markers: tuple[int, int],
        stiffness: Array | float,
        damping: Array | float,
        travel: Array | float = 0.0,
    ) -> int:
        """Spring and damper between the coordinates of two markers, slack at `travel`; its number.

        Numbers, or what they are (T,) at the instants of the integration.
        """
        if np.ndim(stiffness) == np.ndim(travel) == 0:
            return self.mbs.AddObject(
                items.ObjectConnectorCoordinateSpringDamper(
                    markerNumbers=list(markers), stiffness=stiffness, damping=damping, offset=travel
                )
            )
        k, c, x = (np.broadcast_to(values, self.integration.time.shape) for values in (stiffness, damping, travel))
        rate = np.gradient(x, self.integration.time)

        def force(_mbs: object, t: float, _number: int, u: float, v: float, *_given: float) -> float:
            now = self._instant(t)
            return float(k[now] * (u - x[now]) + c[now] * (v - rate[now]))

        return self.mbs.AddObject(
            items.ObjectConnectorCoordinateSpringDamper(markerNumbers=list(markers), springForceUserFunction=force)
        )

    def _prepared(self, _mbs: object, _t: float) -> bool:
        for action in self.before_step:
            action()
        return True

    def _instant(self, t: float) -> int:
        # Newton's method asks at the instants only; t comes with round-off and, from the static solver, 1e-12 late.
        last = self.integration.steps
        return min(round(t * last / self.integration.duration), last)

    def sliding_data(self, element: int, position: float) -> int:
        """Node that keeps where a guide touches a chain of elements: which one, and the distance from its start."""
        return self.mbs.AddNode(
            items.NodeGenericData(initialCoordinates=[element, position], numberOfDataCoordinates=2)
        )

    def cable(
        self, element: Any, nodes: Sequence[int], length: float, *, rhoA: float, EI: float, EA: float, gravity: Array
    ) -> int:
        """Let an `element` of Exudyn's cables, `length` [m] at rest, join two nodes and weigh; its number."""
        body = self.mbs.AddObject(
            element(length=length, massPerLength=rhoA, bendingStiffness=EI, axialStiffness=EA, nodeNumbers=nodes)
        )
        self.weigh(body, gravity)
        return body

    def weigh(self, body: int, gravity: Array) -> None:
        """Let `gravity` (3,) [m/s^2] act on a body."""
        marker = self.mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        self.mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=gravity))

    def watch_node(self, node: int, variable: Any) -> int:
        """Sensor of a node."""
        return self.mbs.AddSensor(
            items.SensorNode(nodeNumber=node, outputVariableType=variable, storeInternal=True, writeToFile=False)
        )

    def watch_force(self, constraint: int) -> int:
        """Sensor of the force of a constraint."""
        force = exu.OutputVariableType.Force
        return self.mbs.AddSensor(
            items.SensorObject(objectNumber=constraint, outputVariableType=force, storeInternal=True, writeToFile=False)
        )

    def records(self, sensors: Sequence[int]) -> Array:
        """What sensors of one kind recorded, (T, sensors, components)."""
        rows = [self.mbs.GetSensorStoredData(sensor)[-(self.integration.steps + 1) :, 1:] for sensor in sensors]
        return np.stack(rows, axis=1)

    def solve(self, *, equilibrium: bool) -> float:
        """Start (static equilibrium if asked for, at rest) and integrate; seconds that the integration took."""
        self.mbs.Assemble()
        settings = self._settings()
        if equilibrium:
            self.mbs.SolveStatic(settings, updateInitialValues=True)
        if self.before_step:
            self.mbs.SetPreStepUserFunction(self._prepared)
        begin = time.perf_counter()
        self.mbs.SolveDynamic(settings)
        return time.perf_counter() - begin

    def _settings(self) -> Any:
        plan = self.integration
        settings = exu.SimulationSettings()
        settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = plan.duration / plan.steps
        # Its static solver runs time from 0 to 1, drives included, unless told otherwise.
        settings.staticSolver.loadStepDuration = 1e-12
        settings.staticSolver.adaptiveStep = False
        settings.timeIntegration.endTime = plan.duration
        settings.timeIntegration.numberOfSteps = plan.steps
        settings.timeIntegration.generalizedAlpha.spectralRadius = plan.rho_inf
        # A step that fails would be halved again and again, for minutes: fail at once instead.
        settings.timeIntegration.adaptiveStep = False
        settings.timeIntegration.verboseMode = 1
        for newton in (settings.staticSolver.newton, settings.timeIntegration.newton):
            newton.relativeTolerance = plan.tolerance
            newton.absoluteTolerance = plan.tolerance
        settings.timeIntegration.newton.useModifiedNewton = True
        return settings
