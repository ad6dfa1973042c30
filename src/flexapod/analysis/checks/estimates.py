"""Estimates before a simulation: Euler loads, stresses, vibration (T8.11)-(T8.18), thick pistons (T8.19)-(T8.21).

Pistons with sections buckle by Eq. (T8.23).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from flexapod import kinematics
from flexapod.analysis.results.legs import base_motion, drive_values
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.rotations import matrix
from flexapod.model import Actuator, Leg, Piston, Robot, Tube
from flexapod.solve.modal.modes import RobotModes
from flexapod.solve.rigid_motion import rigid_rates
from flexapod.solve.statics.buckling import leg_loads
from flexapod.solve.statics.static_loads import feed_forward
from flexapod.solve.system import System

HALVINGS = 60


def stepped_buckling(leg: Leg, free: Array) -> Array:
    """Least thrust under which a leg between pinned ends buckles, rigid to the mouth, (T,) [N]; free lengths (T,) [m].

    Of a strip in its weaker direction.
    """
    steps = leg.piston.steps[::-1]  # from the tip
    starts = np.concatenate([[0.0], np.cumsum([step.length for step in steps])[:-1]])
    out = np.clip(free - starts[:, None], 0.0, np.array([[step.length] for step in steps]))[::-1]  # from the mouth
    found = [_least(leg.cylinder.mouth, out, np.array([step.EI[k] for step in steps[::-1]])) for k in (0, 1)]
    return np.minimum(*found)


def _least(mouth: float, out: Array, EI: Array) -> Array:
    """Least thrust at which the deflection comes back to the line of the joints, by halving."""
    whole = out.sum(axis=0)
    low, high = np.zeros_like(whole), EI.max() * (np.pi / whole) ** 2
    for _ in range(HALVINGS):
        thrust = 0.5 * (low + high)
        back = _phase(mouth, out, EI, thrust) >= np.pi
        low, high = np.where(back, low, thrust), np.where(back, thrust, high)
    return 0.5 * (low + high)


def _phase(mouth: float, out: Array, EI: Array, thrust: Array) -> Array:
    """Phase p at the tip of v = r sin p, v' = k r cos p, k^2 = P / EI, which grows with the thrust."""
    wave = np.sqrt(thrust / EI[:, None])
    phase, turns, before = np.arctan(wave[0] * mouth), np.zeros_like(thrust), wave[0]
    for k, length in zip(wave, out, strict=True):
        phase = np.arctan(k / before * np.tan(phase))  # (T8.23)  deflection and slope go on
        phase = phase + k * length
        half = np.round(phase / np.pi)
        turns, phase, before = turns + half, phase - half * np.pi, k
    return phase + turns * np.pi


POISSON = 0.3  # of metals; materials give none


@dataclass(frozen=True, kw_only=True)
class BendingSection:
    """Data of a section for its shear: radius of gyration [m], Cowper's coefficient kappa."""

    gyration: float
    kappa: float


def piston_section(piston: Piston) -> BendingSection:
    """Section of a piston: a tube where its bore is known, else the full round bar with its EI and EA."""
    return _section_of(piston)


def _section(piston: Piston) -> BendingSection:
    tube = Tube(diameter=piston.diameter or 1.0, inner_diameter=piston.inner_diameter)
    return BendingSection(gyration=math.sqrt(piston.EI / piston.EA), kappa=tube.cowper(POISSON))


_section_of = cast("Callable[[Piston], BendingSection]", lru_cache(maxsize=64)(_section))


def beam_section(actuator: Actuator) -> BendingSection | None:
    """Section of an actuator's beam, where it is known."""
    section = actuator.section
    if section is None:
        return None
    gyration = math.sqrt(section.second_moment / section.area)
    return BendingSection(gyration=gyration, kappa=section.cowper(POISSON))


def bending_errors(section: BendingSection, free: float) -> tuple[float, float, float]:
    """Relative errors of an Euler-Bernoulli beam of a free length [m].

    Returns
    -------
    deflection : float
        By which a clamped beam deflects too little under a force at its end, Eq. (T8.20).
    frequency : float
        By which the first frequency of bending, both ends pinned, is too high, Eq. (T8.21): other ends, less.
    inertia : float
        The part of it without shear.
    """
    ratio, a = 2 * (1 + POISSON) / section.kappa, (math.pi * section.gyration / free) ** 2
    deflection = 3 * ratio * (section.gyration / free) ** 2  # (T8.20)
    half = 1 + a * (1 + ratio)
    square = 2 / (half + math.sqrt(half**2 - 4 * ratio * a**2))  # (T8.21)
    return deflection, 1 / math.sqrt(square) - 1, math.sqrt(1 + a) - 1


STATIONS = np.linspace(0.0, 1.0, 11)


def buckling_load(leg: Leg, free: Array) -> Array:
    """Euler load of a leg [N]: elastic over its free length, rigid to the mouth, Eqs. (T8.11) and (T8.22).

    Its ends are pinned, but clamped where they are fixed without a spring. Of a hinge the plane counts in which it
    turns: there the leg buckles first.

    Parameters
    ----------
    leg : Leg
    free : ndarray, shape (T,)
        Free length s [m].

    Returns
    -------
    ndarray, shape (T,)
        EI k^2 with the smallest root k; for pinned ends of tan(k s) + k m = 0, m from the base joint to the mouth. Of
        a piston of several sections that of pinned ends, which is less than what clamped ones bear.
    """
    free = np.asarray(free, dtype=float)
    if leg.piston.sections:
        return stepped_buckling(leg, free)
    x = _ROOTS[_clamped(leg)](leg.cylinder.mouth / free)
    return leg.piston.EI * (x / free) ** 2  # (T8.11)


def buckling_loads(robot: Robot, length: Array, system: System | None = None) -> Array:
    """Euler loads of all legs at lengths (T, n), with bushings and cylinders that bend where they have them, [N].

    ``system``: see `solve.statics.buckling`.
    """
    found = np.stack([buckling_load(leg, x - leg.cylinder.mouth) for leg, x in zip(robot.legs, length.T, strict=True)])
    inside = soft_guide_legs(robot)
    return np.where(inside, leg_loads(robot, length, system), found.T) if inside.any() else found.T


def soft_guide_legs(robot: Robot) -> Mask:
    """Mask of the legs that have bushings or a cylinder that bends, (n,)."""
    return np.array([leg.guide is not None or leg.cylinder.section is not None for leg in robot.legs])


def _clamped(leg: Leg) -> tuple[bool, bool]:
    """Pair of flags: base end and platform end of a leg are clamped."""
    letters, joints = leg.letters, (leg.base_joint, leg.platform_joint)
    base, platform = (
        letter in ("F", "") and joint.bending is None and joint.stiffness is None
        for letter, joint in zip((letters.base, letters.platform), joints, strict=True)
    )
    return base, platform


def pinned_root(ratio: Array) -> Array:
    """Root of tan x + ratio x = 0 between pi/2 and pi."""
    # x + arctan(ratio x) = pi has one root between pi/2 and pi; its left side is concave and rising: Newton converges.
    x = np.full_like(ratio, np.pi / 2)
    for _ in range(50):
        value = x + np.arctan(ratio * x) - np.pi
        x = x - value / (1 + ratio / (1 + (ratio * x) ** 2))
        if np.abs(value).max(initial=0.0) < 1e-14:
            break
    return x


def _clamped_at_the_platform(ratio: Array) -> Array:
    """Root between pi and 4.5 of the leg that is pinned at its base and clamped at its tip."""
    low, high = np.full_like(ratio, np.pi), np.full_like(ratio, 4.5)
    for _ in range(60):  # (T8.22)
        x = 0.5 * (low + high)
        sine, cosine = np.sin(x), np.cos(x)
        positive = ratio * x * cosine + sine - (1 + ratio) * x * (cosine - ratio * x * sine) > 0
        low, high = np.where(positive, x, low), np.where(positive, high, x)
    return 0.5 * (low + high)


_ROOTS = {
    (False, False): pinned_root,
    (False, True): _clamped_at_the_platform,
    (True, False): lambda ratio: np.full_like(ratio, 4.493409457909064),  # tan x = x: the mouth does not move
    (True, True): lambda ratio: np.full_like(ratio, 2 * np.pi),
}
"""Smallest root k s by what is clamped, base and platform; of the mouth's distance over the free length."""


def bending_moments(path: RigidPath) -> Array:
    """Bending moments at `STATIONS` of the free part of each piston on the rigid path, (stations, T, legs) [N m].

    Eqs. (T8.12)-(T8.13), stations from the tip.

    The piston is loaded by force and moment of the joint at its tip, its weight and its inertia as a rigid rod; the
    leg's own vibration is left out.
    """
    robot, legs, axis = path.robot, path.legs, path.axes
    tip, tip_dot, tip_ddot = path.poses.point(robot.platform_joints)
    foot_dot, foot_ddot = base_motion(kinematics.rigid_limbs(robot), legs)
    axis_dot = (tip_dot - foot_dot - legs.rate[..., None] * axis) / legs.length[..., None]

    def across(vector: Array) -> Array:
        return vector - np.einsum("tni,tni->tn", vector, axis)[..., None] * axis

    base = foot_ddot + 2 * legs.rate[..., None] * axis_dot  # (T8.12)  of a piston point at the base joint, across
    at_tip = across(tip_ddot)
    slope = (at_tip - across(base)) / legs.length[..., None]
    load = across(np.broadcast_to(robot.gravity, tip.shape)) - at_tip
    force, tip_moment = across(path.forces.joint_force), np.zeros_like(tip)
    if path.forces.joint_moment is not None:
        tip_moment = np.cross(axis, path.forces.joint_moment)
    rhoA = np.array([leg.piston.rhoA for leg in robot.legs])[:, None]
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    found = np.zeros((len(STATIONS), *legs.length.shape))
    for k, share in enumerate(STATIONS):
        d = (share * (legs.length - mouth))[..., None]
        moment = tip_moment - d * force + rhoA * (load * d**2 / 2 + slope * d**3 / 6)  # (T8.13)
        found[k] = np.linalg.norm(moment, axis=-1)
    return found


@dataclass(frozen=True, kw_only=True)
class VibrationEstimate:
    """Residual vibration after a motion, mode by mode.

    ``frequency`` (m,) [Hz]; ``damping_ratio`` (m,); ``amplitude`` (m,) of the tool [m] at the end of the motion;
    ``settling`` (m,) [s] until each amplitude has fallen to `band` [m]; inf without damping.
    """

    frequency: Array
    damping_ratio: Array
    amplitude: Array
    settling: Array
    band: float

    @property
    def total(self) -> float:
        """Upper bound of the tool's vibration at the end of the motion [m]: all modes in phase."""
        return float(self.amplitude.sum())

    def time_to_band(self) -> float:
        """Time after the motion until the sum of all modes is down to the band [s], Eq. (T8.18); inf if it never is."""
        rates = 2 * np.pi * self.frequency * self.damping_ratio
        damped = rates > 0
        amplitude, rates = self.amplitude[damped], rates[damped]
        allowed = self.band - self.amplitude[~damped].sum()
        if self.total <= self.band:
            return 0.0
        if allowed <= 0:
            return float("inf")
        low, high = 0.0, float(np.log(amplitude.sum() / allowed) / rates.min())
        for _ in range(60):
            middle = 0.5 * (low + high)
            left = float((amplitude * np.exp(-rates * middle)).sum())  # (T8.18)
            low, high = (middle, high) if left > allowed else (low, middle)
        return high


def residual_vibration(
    robot: Robot, modes: RobotModes, t: Array, path: kinematics.Poses, band: float = 1e-6, *, from_rest: bool = True
) -> VibrationEstimate:
    """Residual vibration of the tool after a motion, Eqs. (T8.14)-(T8.17).

    A single-mode estimate: each mode of the end pose with ten instants a period or more answers by itself to the
    inertial forces of the rigid path, less what force drives of law "rigid" feed forward of them, with the masses and
    directions of the end pose. Jumps of the commanded rate, at the start and the end too, are impacts.

    Parameters
    ----------
    robot : Robot
    modes : RobotModes
        About the end pose.
    t : ndarray, shape (T,)
        Equally spaced instants of the motion, from 0 to its end [s].
    path : Poses
        At these instants.
    band : float
        Amplitude at which the tool counts as settled [m].
    from_rest : bool
        Whether the payload rests at t = 0 whatever the command's rate, or moves with it.
    """
    keep = (modes.frequency > 0) & (modes.damping_ratio < 1) & (modes.frequency * (t[1] - t[0]) <= 0.1)
    frequency, ratio = modes.frequency[keep], modes.damping_ratio[keep]
    shapes, omega = modes.shapes[keep], 2 * np.pi * frequency
    damped = omega * np.sqrt(1 - ratio**2)
    mass = modes.system.matrices(modes.equilibrium.state, np.zeros(6)).M
    at = kinematics.RigidPoses(robot, path)
    rates = rigid_rates(modes.system, at)
    before = np.zeros(rates.shape[1]) if from_rest else rates[0]
    steps = np.diff(rates, axis=0, prepend=before[None], append=np.zeros((1, rates.shape[1])))
    impulse = -steps @ (mass @ shapes.T) + _fed_forward(at, t) @ _ways(robot, modes, shapes).T  # (T8.14)  Q_j dt
    answer = np.abs(_rung_on(impulse, 1j * damped - ratio * omega, t)) / damped  # (T8.15)
    amplitude = answer * _tool_amplitudes(robot, modes, shapes)  # (T8.16)
    with np.errstate(divide="ignore", invalid="ignore"):
        settling = np.where(amplitude > band, np.log(amplitude / band) / (ratio * omega), 0.0)  # (T8.17)
    return VibrationEstimate(
        frequency=frequency, damping_ratio=ratio, amplitude=amplitude, settling=settling, band=band
    )


def _rung_on(impulse: Array, rate: NDArray[Any], t: Array) -> NDArray[Any]:
    """Sum at the end of impulses (T + 1, m), at the start, between equally spaced instants, at the end: (T8.15).

    Between them exponentials of few times, of products of two, stand for those of all.
    """
    between, step = impulse[-2:0:-1], t[1] - t[0]  # latest first
    count, modes = between.shape
    row = math.isqrt(count - 1) + 1
    rows = np.zeros((modes, row * row))
    rows[:, :count] = between.T
    at = np.arange(row)[:, None]
    early, late = np.exp(rate * (row * step) * at), np.exp(rate * step * (at + 0.5))
    of_rows = rows.reshape(modes, row, row) @ np.ascontiguousarray(late.T)[..., None].view(float)
    inside = (early.T * of_rows.view(complex)[..., 0]).sum(axis=1)
    return impulse[0] * np.exp(rate * (t[-1] - t[0])) + inside + impulse[-1]


def _fed_forward(at: kinematics.RigidPoses, t: Array) -> Array:
    """Impulses (T + 1, legs) [N s] of what drives feed forward of inertia: none at jumps at the start and the end."""
    none = np.zeros((len(t), 6))  # no wrench
    force = feed_forward(at, t, none) - feed_forward(at.resting(), t, none)
    return np.pad(0.5 * (force[1:] + force[:-1]) * np.diff(t)[:, None], ((1, 1), (0, 0)))


def _ways(robot: Robot, modes: RobotModes, shapes: Array) -> Array:
    """Ways of the drives in every shape, (m, legs)."""
    system = modes.system
    of_legs = shapes[:, :-6].reshape(len(shapes), system.legs, system.n)
    return drive_values(kinematics.rigid_limbs(robot), system.kernel.shapes, of_legs)


def _tool_amplitudes(robot: Robot, modes: RobotModes, shapes: Array) -> Array:
    """Displacement of the tool per unit of each mode's coordinate, (m,)."""
    R = matrix(modes.equilibrium.state.pose[3:])
    turn = np.cross(shapes[:, -3:], robot.tool - robot.com)
    return np.linalg.norm(shapes[:, -6:-3] + turn @ R.T, axis=1)
