"""Tolerances at the tool: covariance, worst case over a box, exact samples, (T16.10)-(T16.12).

The density of pistons acts by their weight at rest, Eq. (T16.23).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.bent_legs import axial_sensitivity, bending_sensitivity, bow_sensitivity
from flexapod.analysis.pose_errors.sensitivity import Sensitivity
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.kinematics.rotations import quaternion, rotation_vector
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Robot, Study
from flexapod.solve.batch import residual
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.locked_robot import LockedPoses, single_equilibrium
from flexapod.solve.statics.stiffness import displacement, tool_motion
from flexapod.solve.system import System

CHI, L = COORDINATES.index("chi"), COORDINATES.index("l")
BLOCK = 2000  # machines whose poses are sought side by side


@dataclass(frozen=True, kw_only=True)
class ToleranceEffect:
    """One tolerance at one pose.

    ``effect`` (n, m, 6): what an error of one standard deviation, or at the edge of the box, of each of m numbers of
    each leg does to the tool; ``boxed``: which of both. ``square`` (n, 6): what it does by its square beside that.
    """

    name: str
    effect: Array
    boxed: bool
    square: Array

    @property
    def covariance(self) -> Array:
        """Covariance of the tool's six components, (6, 6); errors in a box are spread evenly, Eq. (T16.10)."""
        by_square = self._of_squares * np.einsum("ni,nj->ij", self.square, self.square)
        return np.einsum("nmi,nmj->ij", self.effect, self.effect) / (3 if self.boxed else 1) + by_square

    @property
    def sigma(self) -> Array:
        """Standard deviations by leg, (n, 6)."""
        linear = (self.effect**2).sum(axis=1) / (3 if self.boxed else 1)
        return np.sqrt(linear + self._of_squares * self.square**2)

    @property
    def _of_squares(self) -> float:
        """Variance of x^2: of x even in [-1, 1], or normal with the standard deviation 1."""
        return 4 / 45 if self.boxed else 2.0

    @property
    def worst(self) -> Array:
        """Largest size of each component that errors in the box can make, by leg, (n, 6), Eq. (T16.11)."""
        return (np.abs(self.effect).sum(axis=1) + np.abs(self.square)) * self.boxed


def tolerance_effects(robot: Robot, at: Sensitivity, push: Array, weigh: Callable[[], Array]) -> list[ToleranceEffect]:
    """The tolerances of a robot at the first pose of its sensitivity, its pistons under thrusts `push` (n,) [N].

    `weigh`: what more density of the pistons of each leg, relative to it, does to the tool, (n, 6).
    """
    found = []
    for name, size, boxed in _given(robot):
        square = np.zeros((robot.count, 6))
        effect = weigh()[:, None] if name == "density" else _effect(robot, at, name, push)
        if name == "bow":
            square = size**2 * _longer(robot, at, name, push)[1][:, None] * at.coordinate[0, :, L]
        found.append(ToleranceEffect(name=name, effect=size * effect, boxed=boxed, square=square))
    return found


def _given(robot: Robot) -> list[tuple[str, float, bool]]:
    """Name and size of the tolerances, and whether it is that of a box."""
    tolerances, found = robot.tolerances, []
    for name in () if tolerances is None else type(tolerances).model_fields:
        spread = getattr(tolerances, name)
        if spread is not None:
            boxed = spread.box is not None
            found.append((name, float(spread.box if boxed else spread.sigma), boxed))
    return found


def _effect(robot: Robot, at: Sensitivity, name: str, push: Array) -> Array:
    """Displacement of the tool by unit errors of one tolerance, (n, m, 6)."""
    if name in ("base_joints", "platform_joints"):
        return getattr(at, name.removesuffix("_joints"))[0]
    weights = _weights(robot, name, at, push)[0]
    return (weights[..., None] * at.coordinate[0]).sum(axis=1, keepdims=True)


def _weights(robot: Robot, name: str, at: Sensitivity, push: Array) -> Array:
    """Change of held and driven coordinates by a unit error, (1, n, 8)."""
    legs, q = kinematics.rigid_limbs(robot), at.q[:1]
    found = np.zeros_like(q)
    if name != "lead":
        longer = _longer(robot, at, name, push)[0]
        found[..., L] = np.where(legs.given[:, L], longer, 0.0)
    else:
        driven = (legs.state[:, [CHI, L]] == DRIVEN) & [legs.carriage != "crank", True]
        driven &= np.array([[leg.measured == "rotor"] for leg in robot.legs])
        found[..., [CHI, L]] = np.where(driven, (q - legs.home)[..., [CHI, L]], 0.0)
    return found


def _longer(robot: Robot, at: Sensitivity, name: str, push: Array) -> tuple[Array, Array]:
    """Elongation of the legs by an error x, c1 x + c2 x^2: c1, c2, (n,)."""
    outside, none = np.array([leg.measured != "joint-to-joint" for leg in robot.legs]), np.zeros(robot.count)
    if name == "leg_offset":
        return np.ones(robot.count), none
    if name == "bow":
        first, second = bow_sensitivity(robot, at, push)
        return outside * first, outside * second
    return outside * (axial_sensitivity(robot, push) if name == "EA" else bending_sensitivity(robot, at, push)), none


def sample_displacements(
    robot: Robot,
    path: kinematics.Poses,
    at: Sensitivity,
    push: Array,
    weigh: Callable[[], Array],
    *,
    count: int,
    seed: int,
) -> Array:
    """Displacements of the tool of machines sampled within the tolerances, exact kinematics, (count, 6).

    Of EA, EI, bow and density as of `tolerance_effects`. NaN where legs do not fit together without strain.
    """
    rng, legs = np.random.default_rng(seed), kinematics.rigid_limbs(robot)
    parts = []
    for first in range(0, count, BLOCK):
        size = min(BLOCK, count - first)
        q = np.repeat(at.q[:1], size, axis=0)
        shift, more = {end: np.zeros((size, len(legs), 3)) for end in ("base", "platform")}, np.zeros((size, 6))
        for name, spread, boxed in _given(robot):
            many = (size, len(legs), 3 if name.endswith("joints") else 1)
            drawn = spread * (rng.uniform(-1, 1, many) if boxed else rng.normal(size=many))
            if name.endswith("joints"):
                shift[name.removesuffix("_joints")] += drawn
            elif name == "density":
                more = more + drawn[..., 0] @ weigh()
            else:
                if name == "bow":
                    q[..., L] += drawn[..., 0] ** 2 * _longer(robot, at, name, push)[1]
                q = q + drawn * _weights(robot, name, at, push)
        start = path.part(np.zeros(size, dtype=int))
        found, gap = kinematics.nearby(legs, q, start, shift["base"], shift["platform"])
        moved = tool_displacement(robot, start, found) + more
        parts.append(np.where((gap < kinematics.TAKEN * legs.L_c)[:, None], moved, np.nan))
    return np.concatenate(parts)


def tool_displacement(robot: Robot, before: kinematics.Poses, after: kinematics.Poses) -> Array:
    """Displacement of the tool and rotation vector from poses to others, world axes, (T, 6)."""
    turn = rotation_vector(quaternion(after.rotation @ before.rotation.swapaxes(1, 2)))
    return np.concatenate([after.place(robot.tool) - before.place(robot.tool), turn], axis=1)


def thermal_drift(robot: Robot, pose: kinematics.Poses, times: Array) -> Array:
    """Displacement of the tool at a pose by errors and by the temperatures of instants, (t, 6)."""
    many = pose.part(np.zeros(len(times), dtype=int))
    return tool_displacement(robot, many, kinematics.built_poses(robot, many, times))


def density_effect(study: Study, pose: kinematics.Poses) -> Array:
    """Displacement and rotation of the tool by more density of the piston of each leg, relative to it, (n, 6).

    Raises
    ------
    ComputationError
        There is no equilibrium.
    """
    locked = locked_poses(study.robot, study.simulation, pose, study.load)
    pose_there = single_equilibrium(locked).state.pose
    heavier = _balance(locked, locked.system) - _balance(locked, _twice_as_heavy(locked.system))
    count = len(heavier)
    loads = np.zeros((1, *heavier.shape, count))
    loads[0, np.arange(count), :, np.arange(count)] = heavier  # of each leg alone
    y = displacement(locked, loads, np.zeros((1, 6, count)))
    return (tool_motion(study.robot, pose_there[None]) @ y)[0].T


def _balance(locked: LockedPoses, system: System) -> Array:
    """Balance of the leg coordinates at the equilibrium, (n, any) [N, N m], but for what drives do."""
    states = locked.equilibria.states
    still = np.zeros((1, system.legs, len(system.ports)))
    return residual(system, states, still, still, np.zeros(6))[0].reshape(system.legs, -1)


def _twice_as_heavy(system: System) -> System:
    layout, leg_p = leg_parameters(system.kernel.shapes), system.leg_p.copy()
    for name in ("rhoA", "section_rhoA"):
        if name in dict(layout):
            leg_p[:, columns(layout, name)] *= 2.0
    return replace(system, leg_p=leg_p)
