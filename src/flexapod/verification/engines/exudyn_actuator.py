"""The beam that slides out of a turning hub, by Exudyn: cables of finite elements through a ring that clamps.

Hub and slide are a kinematic tree: a hinge, then a slide that holds the inner end of a chain of planar ANCF cables.
Where the beam comes out, a sliding joint clamps it: the point of the chain that passes has the place and the direction
of the hub. A beam that is outside as a whole is clamped at its end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.model import ActuatorStudy
from flexapod.verification.engines.exudyn_builder import CARRIAGE_MASS, Builder, CableChain, Link
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_process import TIME_LIMIT, solve_in_process

_SMALL = 1e-9  # m/s^2, rad/s^2
_HUB = 1.0  # kg, kg m^2: of no consequence, its motion is prescribed


@dataclass(frozen=True, kw_only=True)
class ActuatorProblem:
    """An actuator with prescribed motion and how Exudyn models and integrates it.

    `elements` on the length outside the hub at t = 0, the part behind in elements of about the same size;
    `axial_stiffness` EA [N].
    """

    study: ActuatorStudy
    integration: Integration
    elements: int
    axial_stiffness: float

    def __post_init__(self) -> None:
        actuator = self.study.actuator
        if self.elements < 1:
            raise InputError("leaves no beam", key="elements", value=self.elements, allowed="1, 2 ...")
        if self.axial_stiffness <= 0:
            raise InputError("is not positive", key="axial_stiffness", value=self.axial_stiffness, allowed="above 0 N")
        for key in ("tip_mass", "tip_inertia", "damping"):
            if getattr(actuator, key):
                raise InputError("is not modelled in Exudyn", key=key, value=getattr(actuator, key), allowed="0")
        actuator.refuse_space()
        angle, length = self.law("rotation"), self.law("extension")
        if max(abs(angle.acceleration[0]), abs(length.acceleration[0])) > _SMALL:
            raise InputError("starts with an acceleration, which Exudyn's start leaves out", key="motion")
        reach = actuator.free_length + length.position
        if reach.max() > actuator.length * (1 + 1e-9) or reach.min() <= 0:
            raise InputError(
                "takes the beam out of its hub or into it",
                key="motion.extension",
                allowed=f"a free length above 0, at most {actuator.length:g} m",
            )

    def law(self, name: str) -> kinematics.Law:
        """Rotation [rad] or extension [m] since t = 0 at the instants of the integration."""
        law = getattr(self.study.motion, name)
        if law is None:
            raise InputError("is missing: Exudyn's model has prescribed motions only", key=f"motion.{name}")
        return kinematics.motion_law(law, self.integration.time)


@dataclass(frozen=True, kw_only=True)
class ActuatorResult:
    """Motion of the beam as Exudyn finds it, at T instants.

    Attributes
    ----------
    time : ndarray, shape (T,)
        [s].
    tip_deflection, tip_distance : ndarray, shape (T,)
        Of the tip from the hub's axis, and along it from the pivot [m].
    seconds : float
        That the integration took, without building, start and records.
    """

    time: Array
    tip_deflection: Array
    tip_distance: Array
    seconds: float


def simulate_actuator(
    study: ActuatorStudy,
    integration: Integration,
    *,
    elements: int = 36,
    axial_stiffness: float | None = None,
    time_limit: float = TIME_LIMIT,
) -> ActuatorResult:
    """Motion of a beam with prescribed rotation and extension, computed by Exudyn.

    Parameters
    ----------
    study : ActuatorStudy
        Without tip body and damping; its [simulation] is not used.
    integration : Integration
    elements : int
        ANCF cable elements (Euler-Bernoulli, finite strain and rotation) on the free length at t = 0. A clamp that
        slides through elements is of first order in their length, since the curvature jumps there: extrapolate.
    axial_stiffness : float, optional
        EA [N]; default: a radius of gyration of a thousandth of the length, as good as inextensible.
    time_limit : float
        Seconds after which Exudyn is stopped.

    Raises
    ------
    InputError
        Something that this model does not have, or a beam that leaves its hub.
    ComputationError
        Exudyn is not installed, does not end in time, crashes, or does not converge.
    """
    stiff = study.actuator.EI * (1e3 / study.actuator.length) ** 2
    problem = ActuatorProblem(
        study=study,
        integration=integration,
        elements=elements,
        axial_stiffness=stiff if axial_stiffness is None else axial_stiffness,
    )
    return solve_in_process(solve, problem, time_limit=time_limit)


def solve(problem: ActuatorProblem) -> ActuatorResult:
    """Build the beam, integrate, and read the sensors."""
    actuator, plan, builder = problem.study.actuator, problem.integration, Builder(problem.integration)
    rotation, extension = problem.law("rotation"), problem.law("extension")
    hub = Link(joint="RevoluteZ", mass=_HUB, inertia=_HUB * np.eye(3))
    inner = actuator.hub_radius + (actuator.free_length - actuator.length)  # of the beam's inner end, from the pivot
    tree = builder.tree(
        [hub, Link(joint="PrismaticX", mass=CARRIAGE_MASS)],
        [actuator.angle, inner],
        [rotation.rate[0], extension.rate[0]],
    )
    places = _stations(problem)
    chain = _beam(builder, problem, places)
    behind = -places[0]
    clamped = not behind  # at its end, as nothing of it is in the hub
    builder.joint(builder.link_marker(tree, 1), builder.body_marker(chain.cables[0]), [1, 1, 0, 0, 0, int(clamped)])
    if not clamped:
        builder.ring(builder.link_marker(tree, 0, [actuator.hub_radius, 0.0, 0.0]), chain, behind)
    for number, law in enumerate((rotation, extension)):
        builder.prescribe_coordinate(builder.coordinate_marker(tree.node, number), law.position)
    tip = builder.add_sensor("node", chain.nodes[-1], "Position")
    seconds = builder.solve(equilibrium=False)
    x, y, _ = builder.records([tip])[:, 0].T
    c, s = np.cos(actuator.angle + rotation.position), np.sin(actuator.angle + rotation.position)
    return ActuatorResult(time=plan.time, tip_deflection=c * y - s * x, tip_distance=c * x + s * y, seconds=seconds)


def _stations(problem: ActuatorProblem) -> Array:
    """Places of the nodes at t = 0 from where the beam comes out [m], one of them there: the start is consistent."""
    actuator = problem.study.actuator
    outside = np.linspace(0.0, actuator.free_length, problem.elements + 1)
    behind = actuator.length - actuator.free_length
    count = int(np.ceil(behind / outside[1] - 1e-9))
    return np.concatenate([np.linspace(-behind, 0.0, count + 1)[:-1], outside])


def _beam(builder: Builder, problem: ActuatorProblem, places: Array) -> CableChain:
    """The chain of cables with its nodes at places [m] from where the beam comes out."""
    actuator = problem.study.actuator
    rest, start, rate = (np.array(rows) for rows in zip(*(_node(problem, x) for x in places), strict=True))
    return builder.chain(
        rest,
        places[:-1] - places[0],
        np.diff(places),
        rhoA=actuator.rhoA,
        EI=actuator.EI,
        EA=problem.axial_stiffness,
        gravity=np.array([0.0, -actuator.gravity, 0.0]),
        start=start,
        rate=rate,
    )


def _node(problem: ActuatorProblem, x: float) -> tuple[list[float], ...]:
    """Node at x [m] from where the beam comes out: straight reference, initial displacement, and velocity.

    The start is the static shape under a tip force at rest in x over free length; bent without stretch.
    """
    actuator, spin, feed = problem.study.actuator, problem.law("rotation").rate[0], problem.law("extension").rate[0]
    L, tip = actuator.free_length, problem.study.initial.tip_displacement
    zeta = max(x, 0.0) / L
    v, slope, bend = (
        tip / 2 * np.array([3 * zeta**2 - zeta**3, (6 * zeta - 3 * zeta**2) / L, (6 - 6 * zeta) / L**2 * (x > 0)])
    )
    drawn_back = -(tip**2) / (8 * L) * (12 * zeta**3 - 9 * zeta**4 + 9 / 5 * zeta**5)  # -1/2 int v'^2 dx
    c, s = np.cos(actuator.angle), np.sin(actuator.angle)
    hub = np.array([[c, -s], [s, c]])
    place = np.array([actuator.hub_radius + x + drawn_back, v])
    tangent = np.array([np.sqrt(1 - slope**2), slope])
    tangent_dot = np.array([-slope / tangent[0], 1.0]) * (bend * (1 - zeta) - slope / L) * feed * (x > 0)
    turned = spin * np.array([[0.0, -1.0], [1.0, 0.0]])
    place_dot = np.array([feed, slope * (1 - zeta) * feed]) + turned @ place
    straight = np.array([actuator.hub_radius + x, 0.0])
    return (
        [*(hub @ straight), c, s],
        [*(hub @ (place - straight)), *(hub @ (tangent - np.array([1.0, 0.0])))],
        [*(hub @ place_dot), *(hub @ (tangent_dot + turned @ tangent))],
    )
