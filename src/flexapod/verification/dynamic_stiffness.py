"""Exact frequencies of a parallel robot with locked drives, undeformed and without prestress, by counting.

Dynamic stiffness of uniform members, transcendental in omega, no shape functions. Equations (T7.9)-(T7.15). A
second road to the frequencies that `flexapod.modes` finds: plain NumPy; of the package only the study's robot
is read. For comparison, the errors of the frequencies by a finite number of shapes are estimated.

References
----------
W. H. Wittrick, F. W. Williams, "A general algorithm for computing natural frequencies of elastic structures",
Q. J. Mech. Appl. Math. 24 (1971) 263-284: the count, and the clamped-clamped frequencies of a beam.
R. W. Clough, J. Penzien, "Dynamics of Structures", 2nd ed. (1993), ch. 20; A. Y. T. Leung, "Dynamic Stiffness and
Substructures" (1993), ch. 2: the stiffnesses of bar and beam.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import spherical_jn

from flexapod.common.arrays import Array
from flexapod.model import Leg, Robot

Count = Callable[[float], int]
Stiffness = tuple[np.ndarray, int]
"""Dynamic stiffness, and how many frequencies with all its coordinates held lie below omega."""


@dataclass(frozen=True, kw_only=True)
class UniformLeg:
    """A leg between its joints at the pose: ``base``, ``tip`` and ``first_axis`` of the universal joint, world axes.

    ``inertia`` [kg m^2]: transverse, of the cylinder about the universal joint; ``axial_inertia``: cylinder and piston;
    ``compliance`` [m/N] of the drive; ``shapes``: of the exact bar keep only so many of the functions eta, sin n pi eta
    (rigid drives only). A passive leg has a drive of infinite compliance.

    ``base_axes``, ``tip_axes`` (k, 3): about which the cylinder turns against the ground, the tip against the platform;
    none given: a universal joint, a ball. ``GJ`` [N m^2], ``spin_inertia`` [kg m^2]: of a piston whose tip is no ball,
    twisted from the drive on; ``planes``: those in which the leg bends, x and y.
    """

    base: np.ndarray
    tip: np.ndarray
    first_axis: np.ndarray
    EA: float
    EI: float
    rhoA: float
    Lp: float
    mouth: float
    inertia: float = 0.0
    axial_inertia: float = 0.0
    shapes: int | None = None
    compliance: float = 0.0
    base_axes: np.ndarray | None = None
    tip_axes: np.ndarray | None = None
    GJ: float = 0.0
    spin_inertia: float = 0.0
    planes: tuple[int, ...] = (0, 1)

    @property
    def length(self) -> float:
        """Length from joint to joint [m]."""
        return float(np.linalg.norm(self.tip - self.base))

    def axes(self) -> np.ndarray:
        """Columns x, y, z: across (turned about y), second axis of the universal joint, along the leg."""
        z = (self.tip - self.base) / self.length
        y = np.cross(z, self.first_axis)
        y /= np.linalg.norm(y)
        return np.stack([np.cross(y, z), y, z], axis=1)

    def pivot_inertias(self) -> tuple[float, float]:
        """Inertia about the universal joint of all that is rigid, for motion along x and along y, Eq. (T7.12)."""
        inner = self.length - self.Lp
        total = self.inertia + self.rhoA * (self.mouth**3 - inner**3) / 3
        x, _, z = self.axes().T
        spin = (z @ self.first_axis) / (x @ self.first_axis)  # tan beta
        return total, total + self.axial_inertia * spin**2

    def turns(self) -> tuple[np.ndarray, np.ndarray]:
        """Axes (k, 3) about which either end turns; the ball's turn about the leg is idle."""
        x, y, _ = self.axes().T
        base = np.array([self.first_axis, y]) if self.base_axes is None else self.base_axes
        return base, np.array([x, y]) if self.tip_axes is None else self.tip_axes


@dataclass(frozen=True, kw_only=True)
class LockedPayload:
    """The payload at the pose: mass, centre of mass (3,) and inertia about it (3, 3), world axes.

    ``free`` (k, 6): shifts of the centre of mass and turns that nothing holds.
    """

    mass: float
    com: np.ndarray
    inertia: np.ndarray
    free: np.ndarray = field(default_factory=lambda: np.eye(6))


def bar_stiffness(omega: float, leg: UniformLeg) -> tuple[float, int]:
    """Return force over displacement at the tip of the piston, driven at its inner end, Eqs. (T7.9)-(T7.10)."""
    wave = omega * np.sqrt(leg.rhoA / leg.EA)
    x, shift = wave * leg.Lp, np.arctan(leg.EA * wave * leg.compliance)
    if leg.shapes is None:
        return leg.EA * wave / np.tan(x + shift), int((x + shift) // np.pi)
    roots = np.arange(1, leg.shapes) * np.pi
    ritz = 1 - x**2 / 3 - sum(2 * x**4 / (r**2 * (r**2 - x**2)) for r in roots)
    return leg.EA / leg.Lp * ritz, int(np.sum(roots < x))


def beam_stiffness(omega: float, length: float, EI: float, rhoA: float) -> Stiffness:
    """Return the stiffness of a beam on (v, v') at both ends and its clamped-clamped count, Eqs. (T7.11), (T7.15)."""
    lam = length * np.sqrt(omega) * (rhoA / EI) ** 0.25
    c, s, th, sech = np.cos(lam), np.sin(lam), np.tanh(lam), 1 / np.cosh(lam)  # all divided by cosh: no term grows
    gap = sech - c
    force, coupled = lam**3 * np.array([c * th + s, -(s * sech + th)]), lam**2 * np.array([s * th, 1 - c * sech])
    turn = lam * np.array([s - c * th, th - s * sech])
    (f, g), (p, q), (m, n) = force / gap, coupled / gap, turn / gap
    unit = np.array([1.0, length, 1.0, length])
    K = EI / length**3 * np.array([[f, p, g, q], [p, m, -q, n], [g, -q, f, -p], [q, n, -p, m]]) * np.outer(unit, unit)
    i = int(lam // np.pi)
    return K, i - int(1 - (-1) ** i * np.sign(gap)) // 2


def lateral_stiffness(omega: float, leg: UniformLeg, inertia: float) -> Stiffness:
    """Return the stiffness of one plane on (angle of the cylinder, slope at the tip, displacement of the tip)."""
    K, count = beam_stiffness(omega, leg.length - leg.mouth, leg.EI, leg.rhoA)
    ends = np.array([[leg.mouth, 0, 0], [1, 0, 0], [0, 0, 1], [0, 1, 0]])
    return ends.T @ K @ ends - np.diag([omega**2 * inertia, 0, 0]), count


def shaft_stiffness(omega: float, leg: UniformLeg) -> Stiffness:
    """Return the stiffness on the turns about the leg at both ends of the piston, as (T7.9) of a bar."""
    x = omega * np.sqrt(leg.spin_inertia * leg.Lp / leg.GJ)
    cot, cosec = 1 / np.tan(x), 1 / np.sin(x)
    return leg.GJ / leg.Lp * x * np.array([[cot, -cosec], [-cosec, cot]]), int(x // np.pi)


def robot_stiffness(omega: float, legs: Sequence[UniformLeg], body: LockedPayload) -> Stiffness:
    """Return the stiffness on the payload's coordinates and the turns of each leg's ends, Eq. (T7.13)."""
    return assemble_stiffness(legs, body)(omega)


def assemble_stiffness(legs: Sequence[UniformLeg], body: LockedPayload) -> Callable[[float], Stiffness]:
    """Return `robot` as a function of omega: where its legs stand is found once."""
    free, turns = len(body.free), [sum(map(len, leg.turns())) for leg in legs]
    twist, mass = np.zeros((6, free + sum(turns))), np.zeros((6, 6))
    twist[:, :free], mass[:3, :3], mass[3:, 3:] = body.free.T, body.mass * np.eye(3), body.inertia
    starts = free + np.cumsum([0, *turns])[: len(turns)]
    placed = [(leg, *_placed(leg, leg.tip - body.com, twist, at)) for leg, at in zip(legs, starts, strict=True)]

    def at_frequency(omega: float) -> Stiffness:
        K, count = -(omega**2) * twist.T @ mass @ twist, 0
        for leg, inertia, cylinder, turn, moved in placed:
            part, held = _leg(omega, leg, inertia, cylinder, turn, moved)
            K, count = K + part, count + held
        return K, count

    return at_frequency


def _placed(
    leg: UniformLeg, arm: np.ndarray, twist: np.ndarray, at: int
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Inertia about the universal joint; turns of the cylinder and at the tip, and shifts of the tip, in leg axes.

    Ends turn by the coordinates from `at` on; the tip is at `arm` from the centre of mass.
    """
    base, tip = leg.turns()
    middle = at + len(base)
    cylinder, turn = np.zeros((3, twist.shape[1])), twist[3:].copy()
    cylinder[:, at:middle], turn[:, middle : middle + len(tip)] = base.T, tip.T
    moved = twist[:3] + np.cross(twist[3:], arm, axis=0)
    axes = leg.axes().T
    return leg.pivot_inertias()[0], axes @ cylinder, axes @ turn, axes @ moved


def _leg(
    omega: float, leg: UniformLeg, inertia: float, cylinder: np.ndarray, turn: np.ndarray, moved: np.ndarray
) -> Stiffness:
    """Dynamic stiffness of one leg in the robot's coordinates, from what `_placed` returns."""
    along, count = bar_stiffness(omega, leg)
    K = along * np.outer(moved[2], moved[2]) - omega**2 * leg.axial_inertia * np.outer(cylinder[2], cylinder[2])
    slopes = ((cylinder[1], turn[1]), (-cylinder[0], -turn[0]))
    local, held = lateral_stiffness(omega, leg, inertia)
    for plane in leg.planes:
        place = np.stack([*slopes[plane], moved[plane]])
        K, count = K + place.T @ local @ place, count + held
    if leg.GJ:
        local, held = shaft_stiffness(omega, leg)
        place = np.stack([cylinder[2], turn[2]])
        K, count = K + place.T @ local @ place, count + held
    return K, count


def frequency_count(stiffness: tuple[np.ndarray | float, int]) -> int:
    """Return the number of frequencies below omega, J = J_0 + s{K(omega)}, Eq. (T7.14)."""
    K, held = np.atleast_2d(stiffness[0]), stiffness[1]
    scale = 1 / np.sqrt(np.linalg.norm(K, axis=0))  # a congruence: signs stay, units go
    return held + int(np.sum(np.linalg.eigvalsh(K * np.outer(scale, scale)) < 0))


def bisect_frequencies(count: Count, n: int, start: float = 1.0, tolerance: float = 1e-12) -> np.ndarray:
    """Return the first n frequencies [Hz] by halving, each as often as the count jumps there."""
    high = start
    while count(high) < n:
        high *= 2
    found, open_intervals = [], [(0.0, 0, high, count(high))]
    while open_intervals and len(found) < n:
        low, n_low, high, n_high = open_intervals.pop()
        middle = (low + high) / 2
        if high - low <= tolerance * high:
            found += [middle] * (n_high - n_low)
        else:
            n_middle = count(middle)
            halves = [(middle, n_middle, high, n_high), (low, n_low, middle, n_middle)]
            open_intervals += [h for h in halves if h[3] > h[1]]
    return np.array(found[:n]) / (2 * np.pi)


def robot_frequencies(legs: Sequence[UniformLeg], body: LockedPayload, n: int) -> np.ndarray:
    """Return the first n frequencies [Hz] of the robot."""
    stiffness = assemble_stiffness(legs, body)
    return bisect_frequencies(lambda omega: frequency_count(stiffness(omega)), n)


def legs_and_body(
    robot: Robot, pose: Sequence[float], shapes: int | None = None, compliance: float = 0.0
) -> tuple[list[UniformLeg], LockedPayload]:
    """Legs and payload at a pose (6,) from home [m, rad]; geometry written anew, not that of `flexapod.kinematics`.

    Carriages and platforms that are not where six legs UPS would have them: at home only.

    `shapes` and `compliance` [m/N] of the drives: see `dynamic_stiffness.UniformLeg`.
    """
    R = Rotation.from_euler("xyz", pose[3:]).as_matrix()
    at = np.array([0, 0, robot.home_height]) + pose[:3]
    places = zip(robot.legs, robot.home_bases, at + robot.platform_joints @ R.T, robot.home_vectors, strict=True)
    legs = [_stiff_leg(leg, base, tip, home, shapes, compliance) for leg, base, tip, home in places]
    load, free = robot.payload, np.eye(6)
    if robot.plane:
        normal = robot.normal != 0
        free = free[np.concatenate([~normal, normal])]
        legs = [_flat(leg, robot.normal) for leg in legs]
    else:
        legs = [replace(own, **_ends(leg)) for own, leg in zip(legs, robot.legs, strict=True)]
    return legs, LockedPayload(mass=load.mass, com=at + R @ load.com, inertia=R @ load.inertia @ R.T, free=free)


def _flat(leg: UniformLeg, normal: Array) -> UniformLeg:
    """The leg hinged at both ends about the normal of the plane, across which alone it bends."""
    return replace(leg, first_axis=normal, base_axes=normal[None], tip_axes=normal[None], planes=(1,))


def _ends(leg: Leg) -> dict[str, Array | float]:
    """Joints that are not universal at the base or not a ball at the platform."""
    none, found = np.zeros((0, 3)), {}
    if leg.letters.base in "RF":
        found["base_axes"] = none if leg.base_joint.axis is None else leg.base_joint.axis[None]
    if leg.letters.platform != "S":  # a round piston has twice the inertia that bending has
        rod = leg.piston
        inertia = rod.axial_inertia or 2 * rod.rhoA * rod.length * rod.EI / rod.EA
        found |= {"tip_axes": none, "GJ": rod.torsional_stiffness, "spin_inertia": inertia}
    return found


def _stiff_leg(leg: Leg, base: Array, tip: Array, home: Array, shapes: int | None, compliance: float) -> UniformLeg:
    axis = np.cross([0.0, 0.0, 1.0], home) if leg.u_axis is None else leg.u_axis
    if not axis.any():  # an upright leg has no axis of its own across it
        axis = np.array([1.0, 0.0, 0.0])
    axis = axis - (axis @ home) / (home @ home) * home  # across the leg at home
    cylinder, rod = leg.cylinder, leg.piston
    return UniformLeg(
        base=base,
        tip=tip,
        first_axis=axis / np.linalg.norm(axis),
        EA=rod.EA,
        EI=rod.EI,
        rhoA=rod.rhoA,
        Lp=rod.length,
        mouth=cylinder.mouth,
        inertia=cylinder.inertia + cylinder.mass * cylinder.com**2,
        axial_inertia=cylinder.axial_inertia + (rod.axial_inertia if leg.letters.platform == "S" else 0.0),
        shapes=shapes,
        compliance=np.inf if leg.passive else compliance,
    )


def wave_number(legs: Sequence[UniformLeg], frequency: Array) -> Array:
    """Largest lambda = s (rhoA omega^2 / EI)^(1/4) of the legs at frequencies [Hz]."""
    slowest = max((leg.length - leg.mouth) * (leg.rhoA / leg.EI) ** 0.25 for leg in legs)
    return slowest * np.sqrt(2 * np.pi * np.asarray(frequency))


def sine_truncation(legs: Sequence[UniformLeg], frequency: Array, axial: int) -> Array:
    """Relative error of frequencies [Hz] from the axial shapes left out, at most: half the rest of (T7.10)'s series.

    To first order the shift is the tip's strain energy that the rest adds over twice the whole, and the whole is at
    least the static one of the bars.
    """
    x = 2 * np.pi * np.asarray(frequency) * max(leg.Lp * np.sqrt(leg.rhoA / leg.EA) for leg in legs)
    squares = (np.pi * np.arange(axial, 2000)) ** 2
    return np.array([np.sum(y**4 / (squares * (squares - y**2))) for y in x])


def twist_truncation(legs: Sequence[UniformLeg], frequency: Array) -> Array:
    """Relative error of frequencies [Hz] from one shape of twist, as `sine_truncation` of a shaft in place of a bar."""
    slow = max((np.sqrt(leg.spin_inertia * leg.Lp / leg.GJ) for leg in legs if leg.GJ), default=0.0)
    squares = (np.pi * np.arange(1, 2000)) ** 2
    return np.array([np.sum(y**4 / (squares * (squares - y**2))) for y in 2 * np.pi * slow * np.asarray(frequency)])


def polynomial_truncation(legs: Sequence[UniformLeg], frequency: Array, k: int) -> Array:
    """Relative error of frequencies [Hz] from k shapes a plane: what polynomials of degree < k lack of a sine.

    The curvature of `tip-load` has degree k; the free tip takes one. Legendre coefficient n of sin(lambda z + phase) is
    (2 n + 1) j_n(lambda / 2); the mean square of the sine is a half, and half the energy's error is the frequency's.
    """
    n = np.arange(k, 60)[:, None]
    return np.sum((2 * n + 1) * spherical_jn(n, wave_number(legs, frequency) / 2) ** 2, axis=0)
