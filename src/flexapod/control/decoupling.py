"""Matrices that decouple sensors and actuators: by Jacobians, modes, singular vectors, (T21.36)-(T21.39)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arguments import integer, matrix, number, numbers
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.control.controllers import Decoupled
from flexapod.control.filters import ControlLaw
from flexapod.control.state_space import Names, check_system

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace
    from flexapod.model import Robot, Study

INDEPENDENT = 1e-9  # smallest over largest singular value of what still has an inverse


@dataclass(frozen=True, kw_only=True)
class Decoupling:
    """Directions by readings ``into`` (k, sensors), actuators by directions ``out`` (actuators, k), Eq. (T21.16)."""

    into: Array
    out: Array

    def controller(
        self, law: ControlLaw | Sequence[ControlLaw], *, sensor: Names = "stroke", actuator: Names = "drive"
    ) -> Decoupled:
        """A controller with a law, or one each, in these directions."""
        return Decoupled(law, into=self.into, out=self.out, sensor=sensor, actuator=actuator)


def by_jacobian(jacobian: ArrayLike) -> Decoupling:
    """Motion of a point by strokes, drive forces by its wrench, Eq. (T21.36), from strokes by its motion (m, d).

    With the centre of mass masses do not couple, with the centre of stiffness springs do not.
    """
    inverse = _inverse(matrix(jacobian, "jacobian", "(m, d)"), "jacobian")
    return Decoupling(into=inverse, out=inverse.T)


def robot_jacobian(
    robot: Robot | Study, at: Literal["com", "cok"] | ArrayLike = "com", stiffness: ArrayLike = 1.0
) -> Array:
    """Rates of the drives by the twist of a point of the platform at home, (m, 6); see `kinematics.drive_jacobian`.

    Parameters
    ----------
    robot : Robot or Study
    at : {"com", "cok"} or array_like, shape (3,)
        Centre of mass of the payload, centre of stiffness, or a point in platform axes [m].
    stiffness : float or array_like, shape (m,)
        Of the drives [N/m], for "cok".
    """
    from flexapod import kinematics
    from flexapod.model import Robot

    robot = getattr(robot, "robot", robot)
    if not isinstance(robot, Robot):
        raise InputError("is no robot", key="robot", value=type(robot).__name__, allowed="a Robot, or the Study of one")
    home = kinematics.home_pose(robot)
    point = robot.com if isinstance(at, str) else numbers(at, "at", '"com", "cok", or three numbers [m]')
    if len(point) != 3:
        raise InputError("is no point", key="at", value=at, allowed='"com", "cok", or three numbers [m]')
    found = kinematics.drive_jacobian(robot, home, point)[0]
    if not (isinstance(at, str) and at == "cok"):
        if isinstance(at, str) and at != "com":
            raise InputError("is no point", key="at", value=at, allowed='"com", "cok", or three numbers')
        return found
    if len(numbers(stiffness, "stiffness", "one number, or one for each drive [N/m]")) not in (1, len(found)):
        raise InputError("is not one for each drive", key="stiffness", value=stiffness, allowed=f"1 or {len(found)}")
    away = home.rotation[0].T @ centre_of_stiffness(found, stiffness)  # in platform axes
    return kinematics.drive_jacobian(robot, home, point + away)[0]


def centre_of_stiffness(jacobian: ArrayLike, stiffness: ArrayLike = 1.0) -> Array:
    """Vector from the point of a Jacobian (m, 6) to where forces turn and moments move least, (3,) [m].

    The stiffness of translation with rotation, K_tr, at a point beside it by a is K_tr + K_tt [a]x, Eq. (T21.37), with
    the least sum of squares there.
    """
    J = matrix(jacobian, "jacobian", "(m, 6)")
    springs = numbers(stiffness, "stiffness", "one number, or one for each drive [N/m]")
    if J.shape[1] != 6 or len(springs) not in (1, len(J)):
        raise InputError(
            "do not fit", key="jacobian, stiffness", allowed=f"(m, 6) and (m,), not {J.shape} and {springs.shape}"
        )
    K = J.T @ (np.broadcast_to(springs, len(J))[:, None] * J)
    turns = [K[:3, :3] @ np.cross(np.eye(3), axis) for axis in np.eye(3)]
    system = np.stack([turn.ravel() for turn in turns], axis=1)
    return np.asarray(np.linalg.lstsq(system, -K[:3, 3:].ravel(), rcond=None)[0], dtype=float)


def by_modes(
    system: StateSpace, *, sensor: Names = "stroke", actuator: Names = "drive", count: int | None = None,
    above: float | str = 0.0,
) -> Decoupling:  # fmt: skip
    """Amplitudes of the slowest modes by readings, and forces that drive each alone, Eq. (T21.38).

    Parameters
    ----------
    system : StateSpace
    sensor, actuator : names
    count : int, optional
        Modes, as many as sensors and actuators at most; by itself as many as these.
    above : float or str
        Frequency [Hz] below which poles are no modes.

    Raises
    ------
    ComputationError
        Modes that sensors or actuators do not tell apart.
    """
    part = check_system(system).select(actuator, sensor)
    if not part.D.size:
        raise InputError("has no such channels", key="sensor, actuator", allowed="at least one of each")
    k = min(part.D.shape) if count is None else integer(count, "count", 1, min(part.D.shape))
    values, right = np.linalg.eig(part.A)
    try:
        left = np.linalg.solve(right, part.B.astype(complex))
    except np.linalg.LinAlgError:
        raise ComputationError("modes of equal poles have equal shapes: they are not told apart") from None
    shown = part.C @ right
    edge = 2 * np.pi * number(above, "above", "frequency", least=0.0)
    slowest = np.argsort(np.abs(values), kind="stable")
    modes = [i for i in slowest if np.imag(values[i]) > 0 and abs(values[i]) > edge]
    if len(modes) < k:
        raise ComputationError(f"there are {len(modes)} modes that vibrate, fewer than {k}")
    into = np.stack([_real(shown[:, i]) for i in modes[:k]], axis=1)
    out = np.stack([_real(left[i]) for i in modes[:k]])
    return Decoupling(into=_inverse(into, "sensor"), out=_inverse(out, "actuator"))


def by_singular_vectors(
    system: StateSpace, hz: float | str, *, sensor: Names = "stroke", actuator: Names = "drive"
) -> Decoupling:
    """Singular vectors of a real matrix near the response at a frequency, Eq. (T21.39): G ~ U S V'."""
    at = number(hz, "hz", "frequency", least=0.0)
    G = check_system(system).select(actuator, sensor).at(at)[:, :, 0]
    if G.shape[0] != G.shape[1]:
        raise InputError("is not square", key="sensor", allowed="as many sensors as actuators")
    D = np.linalg.pinv((G.conj().T @ G).real)
    turn = np.exp(0.5j * np.angle(np.diag(G @ D @ G.T)))
    real = np.linalg.pinv(D @ (G.conj().T @ np.diag(turn)).real)
    U, _, Vt = np.linalg.svd(real)
    return Decoupling(into=U.T, out=Vt.T)


def _real(shape: np.ndarray) -> Array:
    """A complex shape as the real one that is nearest, of its size, its largest part positive."""
    turned = shape * np.exp(-0.5j * np.angle((shape**2).sum()))
    real = np.real(turned)
    return real * np.sign(real[np.abs(real).argmax()] or 1.0)


def _inverse(matrix: Array, key: str) -> Array:
    """Pseudo-inverse of a matrix; refuse one whose directions are dependent."""
    values = np.linalg.svd(matrix / (np.linalg.norm(matrix, axis=0) + 1e-300), compute_uv=False)
    if values.min(initial=np.inf) <= INDEPENDENT * values.max(initial=0.0):
        raise ComputationError(f"directions are not told apart by {key}", next_step="Ask for fewer directions")
    return np.asarray(np.linalg.pinv(matrix), dtype=float)
