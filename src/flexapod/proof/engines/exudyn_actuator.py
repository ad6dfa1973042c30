"""The beam that slides out of a turning hub, by Exudyn: cables of finite elements through a ring that clamps."""

from __future__ import annotations

from dataclasses import dataclass

from flexapod import rigid
from flexapod.errors import InputError
from flexapod.model import ActuatorStudy
from flexapod.proof.engines.exudyn_integration import Integration
from flexapod.proof.engines.exudyn_process import TIME_LIMIT, ask
from flexapod.typing import Array

_SMALL = 1e-9  # m/s^2, rad/s^2


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
        angle, length = self.rotation, self.extension
        if max(abs(angle.acceleration[0]), abs(length.acceleration[0])) > _SMALL:
            raise InputError("starts with an acceleration, which Exudyn's start leaves out", key="motion")
        reach = actuator.free_length + length.position
        if reach.max() > actuator.length * (1 + 1e-9) or reach.min() <= 0:
            raise InputError(
                "takes the beam out of its hub or into it",
                key="motion.extension",
                allowed=f"a free length above 0, at most {actuator.length:g} m",
            )

    @property
    def rotation(self) -> rigid.Law:
        """Angle [rad] since t = 0 at the instants of the integration."""
        return self._law("rotation")

    @property
    def extension(self) -> rigid.Law:
        """Length [m] fed since t = 0 at the instants of the integration."""
        return self._law("extension")

    def _law(self, name: str) -> rigid.Law:
        law = getattr(self.study.motion, name)
        if law is None:
            raise InputError("is missing: Exudyn's model has prescribed motions only", key=f"motion.{name}")
        return rigid.motion_law(law, self.integration.time)


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
    return ask("flexapod.proof.engines.exudyn_actuator_model", problem, time_limit=time_limit)
