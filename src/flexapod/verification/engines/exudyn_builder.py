"""Builder of systems in Exudyn: bodies, trees, chains of cables, joints, springs, friction, sensors, solution.

Models call its methods one by one. A place is Exudyn's number of a marker there. Exudyn itself is loaded by the
first `Builder`: make it in a process of its own (`exudyn_process`). LuGre's friction is computed beside Exudyn,
which asks for it as a user function of a connector. The bristles of a step follow the mean of the rates at its
ends, exactly for a rate that is constant; rates at its end are Newton's, so that the friction of a step is part
of what it solves for.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.verification.engines.exudyn_integration import Integration

Numbers = tuple[float, ...]


class Bristles:
    """LuGre's bristles at one place, a vector (n,), Eqs. (T19.1)-(T19.4).

    `numbers`: force of sliding, its share of the load [m], presliding, what breaks away over it less one, one over the
    rate of Stribeck's law, viscous friction, damping time; `step` [s].
    """

    sliding: float
    arm: float
    presliding: float
    excess: float
    slower: float
    viscous: float
    time: float
    step: float
    bent: Array
    rate: Array

    def __init__(self, numbers: Numbers, step: float, count: int = 1) -> None:
        self.sliding, self.arm, self.presliding, self.excess, self.slower, self.viscous, self.time = numbers
        self.step, self.bent, self.rate = step, np.zeros(count), np.zeros(count)

    def force(self, rate: Array, load: float = 0.0) -> Array:
        """Friction force at a rate (n,) at the step's end, against the sliding."""
        speed = float(np.linalg.norm(rate))
        sliding, z = self.sliding + self.arm * load, self._bent(rate)
        slip = rate - speed * z / self._limit(speed)
        time = self.time / (1 + self.time * speed / (4 * self.presliding))
        return sliding / self.presliding * (z + time * slip) + self.viscous * rate

    def advance(self, rate: Array) -> None:
        """Store bristles and rate at the end of a step."""
        self.bent, self.rate = self._bent(rate), rate.copy()

    def _bent(self, rate: Array) -> Array:
        mean = 0.5 * (self.rate + rate)
        speed = float(np.linalg.norm(mean))
        if not speed:
            return self.bent
        most = self._limit(speed)
        steady = most * mean / speed
        return steady + (self.bent - steady) * np.exp(-speed * self.step / most)

    def _limit(self, speed: float) -> float:
        return self.presliding * (1 + self.excess * float(np.exp(-((speed * self.slower) ** 2))))


CARRIAGE_MASS = 1e-6  # kg, of the body that drives the piston's end; Exudyn finds no start with a body without mass

Load = Callable[[], float]


@dataclass(frozen=True, kw_only=True)
class Link:
    """A link of a tree: Exudyn's name of its `joint`, in a `frame` (3, 3) on the link `on`.

    It is the one before if not given; `mass` [kg], `com` (3,) [m], `inertia` (3, 3) about it [kg m^2], in its own axes.
    """

    joint: str
    frame: Array = field(default_factory=lambda: np.eye(3))
    on: int | None = None
    mass: float = 0.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(frozen=True, kw_only=True)
class Tree:
    """Exudyn's numbers of a tree: the `node` of its coordinates, one a link, and the `body`."""

    node: int
    body: int


@dataclass(frozen=True, kw_only=True)
class CableChain:
    """Exudyn's numbers of a chain of cables, `nodes`, `cables`, markers of their `shapes`; where each `starts` [m]."""

    nodes: list[int]
    cables: list[int]
    shapes: list[int]
    starts: Array
    in_plane: bool


class Builder:
    """A mechanism in Exudyn's terms under construction, with `mbs` Exudyn's own handle on it."""

    def __init__(self, integration: Integration) -> None:
        # As untyped modules: their type stubs do not fit their functions.
        self.exu: Any = importlib.import_module("exudyn")
        self.items: Any = importlib.import_module("exudyn.itemInterface")
        self.integration = integration
        #: Called before each step, at the state with which it begins.
        self.before_step: list[Callable[[], None]] = []
        self.container: Any = self.exu.SystemContainer()  # owns the system
        self.mbs: Any = self.container.AddSystem()
        node = self.mbs.AddNode(self.items.NodePointGround())
        self.ground: int = self.coordinate_marker(node, 0)

    def body(self, mass: float, inertia: Array, place: Array, turn: Array, gravity: Array) -> int:
        """A rigid body that nothing holds: inertia (3, 3) about its centre of mass, which is there; quaternion (4,)."""
        J, items = inertia, self.items
        node = self.mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, *turn]))
        moments = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]]
        body = self.mbs.AddObject(items.ObjectRigidBody(mass=mass, inertia=moments, nodeNumber=node))
        self._weigh(body, gravity)
        return body

    def mass(self, mass: float) -> int:
        """The coordinate of a mass that moves along a line."""
        node = self.mbs.AddNode(self.items.Node1D(referenceCoordinates=[0.0]))
        self.mbs.AddObject(self.items.ObjectMass1D(physicsMass=mass, nodeNumber=node))
        return self.coordinate_marker(node, 0)

    def tree(
        self,
        links: Sequence[Link],
        rest: Sequence[float] | Array,
        rate: Sequence[float] | None = None,
        place: Sequence[float] | Array = (0.0, 0.0, 0.0),
        gravity: Sequence[float] | Array = (0.0, 0.0, 0.0),
    ) -> Tree:
        """Links in minimal coordinates, whose values at the start are `rest`, on a `place` (3,) of the ground."""
        exu, count = self.exu, len(links)
        node = self.mbs.AddNode(
            self.items.NodeGenericODE2(
                referenceCoordinates=list(rest),
                initialCoordinates=[0.0] * count,
                initialCoordinates_t=[0.0] * count if rate is None else list(rate),
                numberOfODE2Coordinates=count,
            )
        )
        body = self.mbs.AddObject(
            self.items.ObjectKinematicTree(
                nodeNumber=node,
                gravity=list(gravity),
                baseOffset=list(place),
                jointTypes=[getattr(exu.JointType, link.joint) for link in links],
                linkParents=[k - 1 if link.on is None else link.on for k, link in enumerate(links)],
                jointTransformations=exu.Matrix3DList([link.frame for link in links]),
                jointOffsets=exu.Vector3DList([[0.0] * 3] * count),
                linkInertiasCOM=exu.Matrix3DList([link.inertia for link in links]),
                linkCOMs=exu.Vector3DList([link.com for link in links]),
                linkMasses=[link.mass for link in links],
            )
        )
        return Tree(node=node, body=body)

    def chain(
        self,
        rest: Array,
        starts: Array,
        sizes: Array | float,
        *,
        rhoA: float,
        EI: float,
        EA: float,
        gravity: Array,
        start: Array | None = None,
        rate: Array | None = None,
    ) -> CableChain:
        """ANCF cables (Euler-Bernoulli, finite strain and rotation) between n + 1 nodes.

        `starts`, `sizes` (n,): where each begins along the chain, and its length [m]; `rest` (n + 1, 4 or 6): places
        and tangents of the nodes, in a plane or in space, of the straight chain; `start`, `rate`: how far they are from
        that at the start, and their rates.
        """
        items, mbs, none = self.items, self.mbs, np.zeros_like(rest)
        in_plane = rest.shape[1] == 4
        if in_plane:
            node, cable, shape = items.NodePoint2DSlope1, items.ObjectANCFCable2D, items.MarkerBodyCable2DCoordinates
        else:
            node, cable, shape = items.NodePointSlope1, items.ObjectANCFCable, items.MarkerBodyBeamShape
        ends = zip(rest, none if start is None else start, none if rate is None else rate, strict=True)
        nodes = [
            mbs.AddNode(node(referenceCoordinates=list(a), initialCoordinates=list(b), initialVelocities=list(c)))
            for a, b, c in ends
        ]
        cables, stuff = [], {"massPerLength": rhoA, "bendingStiffness": EI, "axialStiffness": EA}
        for k, size in enumerate(np.broadcast_to(sizes, len(starts)).tolist()):
            cables.append(mbs.AddObject(cable(length=size, nodeNumbers=nodes[k : k + 2], **stuff)))
            self._weigh(cables[-1], gravity)
        shapes = [mbs.AddMarker(shape(bodyNumber=cable)) for cable in cables]
        return CableChain(nodes=nodes, cables=cables, shapes=shapes, starts=starts, in_plane=in_plane)

    def _weigh(self, body: int, gravity: Array) -> None:
        marker = self.mbs.AddMarker(self.items.MarkerBodyMass(bodyNumber=body))
        self.mbs.AddLoad(self.items.LoadMassProportional(markerNumber=marker, loadVector=gravity))

    def coordinate_marker(self, node: int, number: int) -> int:
        """Add a marker of a coordinate of a node; return its number."""
        return self.mbs.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=number))

    def link_marker(self, tree: Tree, link: int, place: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> int:
        """Add a marker at a place on a link of a tree, in its axes [m]; return its number."""
        items = self.items
        marker = items.MarkerKinematicTreeRigid(objectNumber=tree.body, linkNumber=link, localPosition=list(place))
        return self.mbs.AddMarker(marker)

    def body_marker(self, body: int, place: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> int:
        """Add a marker at a place on a body or a cable, in its axes [m]; return its number."""
        return self.mbs.AddMarker(self.items.MarkerBodyRigid(bodyNumber=body, localPosition=list(place)))

    def node_marker(self, node: int) -> int:
        """Add a marker of a node; return its number."""
        return self.mbs.AddMarker(self.items.MarkerNodePosition(nodeNumber=node))

    def ball(self, first: int, second: int) -> None:
        """Let two places stay together."""
        self.mbs.AddObject(self.items.ObjectJointSpherical(markerNumbers=[first, second]))

    def joint(self, first: int, second: int, held: Sequence[int]) -> None:
        """Hold those of three shifts and three turns that are 1, in the axes of the first place."""
        self.mbs.AddObject(self.items.ObjectJointGeneric(markerNumbers=[first, second], constrainedAxes=list(held)))

    def ring(self, place: int, chain: CableChain, position: float) -> None:
        """Let a chain slide through a place, now at `position` [m] of it: free to turn in space, clamped in a plane."""
        element = int(np.searchsorted(chain.starts, position, side="right")) - 1
        data = self.items.NodeGenericData(initialCoordinates=[element, position], numberOfDataCoordinates=2)
        ends: dict[str, Any] = {
            "markerNumbers": [place, chain.shapes[element]],
            "slidingMarkerNumbers": chain.shapes,
            "slidingMarkerOffsets": chain.starts.tolist(),
            "nodeNumber": self.mbs.AddNode(data),
        }
        if chain.in_plane:
            self.mbs.AddObject(self.items.ObjectJointSliding2D(**ends, constrainRotation=True))
            return
        # Rotations: anything else raises an error; translations are in world axes, the force along the cable is zero.
        held = {"constrainRotations": [0, 0, 0], "constrainTranslations": [1, 1, 1]}
        self.mbs.AddObject(self.items.ObjectJointSliding(**ends, **held))

    def prescribe_coordinate(self, marker: int, displacement: Array) -> int:
        """Let a coordinate follow `displacement` (T,) at the instants of the integration; number of the connector."""

        def offset(_mbs: object, t: float, _number: int, _offset: float) -> float:
            return float(displacement[self._instant(t)])

        return self.mbs.AddObject(
            self.items.ObjectConnectorCoordinate(markerNumbers=[self.ground, marker], offsetUserFunction=offset)
        )

    def spring(
        self, markers: tuple[int, int], stiffness: Array | float, damping: Array | float, travel: Array | float = 0.0
    ) -> int:
        """Spring and damper between two coordinates, slack at `travel`; number of the connector.

        Numbers, or what they are (T,) at the instants of the integration.
        """
        connector = self.items.ObjectConnectorCoordinateSpringDamper
        if np.ndim(stiffness) == np.ndim(travel) == 0:
            numbers = {"stiffness": stiffness, "damping": damping, "offset": travel}
            return self.mbs.AddObject(connector(markerNumbers=list(markers), **numbers))
        k, c, x = (np.broadcast_to(values, self.integration.time.shape) for values in (stiffness, damping, travel))
        rate = np.gradient(x, self.integration.time)

        def force(_mbs: object, t: float, _number: int, u: float, v: float, *_given: float) -> float:
            now = self._instant(t)
            return float(k[now] * (u - x[now]) + c[now] * (v - rate[now]))

        return self.mbs.AddObject(connector(markerNumbers=list(markers), springForceUserFunction=force))

    def bushing(self, first: int, second: int, stiffness: Array, damping: Array) -> int:
        """Springs and dampers (3,) along the axes of the first place; number of the connector."""
        numbers = {"stiffness": stiffness, "damping": damping}
        six = {name: np.diag([*values, 0.0, 0.0, 0.0]) for name, values in numbers.items()}
        return self.mbs.AddObject(self.items.ObjectConnectorRigidBodySpringDamper(markerNumbers=[first, second], **six))

    def coordinate_friction(self, marker: int, numbers: Numbers, load: Load = lambda: 0.0) -> None:
        """Add friction against the rate of a coordinate; `load` [N] presses the contact."""
        bristles = Bristles(numbers, self.step)

        def force(_mbs: object, _t: float, _number: int, _u: float, v: float, *_given: float) -> float:
            return float(bristles.force(np.array([v]), load())[0])

        markers, connector = [self.ground, marker], self.items.ObjectConnectorCoordinateSpringDamper
        number = self.mbs.AddObject(connector(markerNumbers=markers, springForceUserFunction=force))
        self._follow(number, "Velocity", bristles.advance)

    def ball_friction(self, first: int, second: int, numbers: Numbers, load: Load) -> None:
        """Add friction against the rotation of two bodies in a ball joint, in the axes of the first."""
        bristles = Bristles(numbers, self.step, 3)

        def moment(_mbs: object, _t: float, _number: int, _u: Array, _turn: Array, _v: Array, w: Array, *_given: Array):  # type: ignore[no-untyped-def]
            return [0.0, 0.0, 0.0, *bristles.force(np.array(w), load()).tolist()]

        markers, connector = [first, second], self.items.ObjectConnectorRigidBodySpringDamper
        number = self.mbs.AddObject(connector(markerNumbers=markers, springForceTorqueUserFunction=moment))
        self._follow(number, "AngularVelocityLocal", bristles.advance)

    def normal_force(self, connector: int | None) -> Load:
        """Force of a connector after the last step [N], as a function; zero of a rigid joint, None."""
        now = [0.0]
        if connector is not None:
            self._follow(connector, "ForceLocal", lambda force: now.__setitem__(0, float(np.linalg.norm(force))))
        return lambda: now[0]

    def _follow(self, number: int, output: str, action: Callable[[Array], None]) -> None:
        """Let an action take what a connector says before each step."""
        variable = getattr(self.exu.OutputVariableType, output)
        self.before_step.append(lambda: action(np.atleast_1d(self.mbs.GetObjectOutput(number, variable))))

    def add_sensor(self, what: str, number: int, output: str) -> int:
        """Sensor of a "node", "body", "object" or "marker"."""
        sensor = getattr(self.items, f"Sensor{what.capitalize()}")
        variable = getattr(self.exu.OutputVariableType, output)
        where = {f"{what}Number": number}
        return self.mbs.AddSensor(sensor(**where, outputVariableType=variable, storeInternal=True, writeToFile=False))

    def records(self, sensors: Sequence[int]) -> Array:
        """Records of sensors of one kind, (T, sensors, components)."""
        rows = [self.mbs.GetSensorStoredData(sensor)[-(self.integration.steps + 1) :, 1:] for sensor in sensors]
        return np.stack(rows, axis=1)

    def solve(self, *, equilibrium: bool) -> float:
        """Start (static equilibrium if asked for, at rest) and integrate; seconds that the integration took."""
        self.mbs.Assemble()
        settings = self.settings()
        if equilibrium:
            self.mbs.SolveStatic(settings, updateInitialValues=True)
        if self.before_step:
            self.mbs.SetPreStepUserFunction(self._prepared)
        begin = time.perf_counter()
        self.mbs.SolveDynamic(settings)
        return time.perf_counter() - begin

    @property
    def step(self) -> float:
        """Step of the integration [s]."""
        return self.integration.duration / self.integration.steps

    def _prepared(self, _mbs: object, _t: float) -> bool:
        for action in self.before_step:
            action()
        return True

    def _instant(self, t: float) -> int:
        # Newton's method asks at the instants only; t comes with round-off and, from the static solver, 1e-12 late.
        last = self.integration.steps
        return min(round(t * last / self.integration.duration), last)

    def settings(self) -> Any:
        """Exudyn's settings of an integration."""
        plan = self.integration
        settings = self.exu.SimulationSettings()
        settings.linearSolver.solverType = self.exu.LinearSolverType.EigenSparse
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
