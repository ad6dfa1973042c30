"""Exact frequencies of a 6-UPS robot with locked drives, undeformed and without prestress, by counting.

Dynamic stiffness of uniform members, transcendental in omega, no shape functions. Equations (T7.9)-(T7.15). A second
road to the frequencies that `flexapod.modes` finds: plain NumPy, nothing of the package is used here.

References
----------
W. H. Wittrick, F. W. Williams, "A general algorithm for computing natural frequencies of elastic structures",
Q. J. Mech. Appl. Math. 24 (1971) 263-284: the count, and the clamped-clamped frequencies of a beam.
R. W. Clough, J. Penzien, "Dynamics of Structures", 2nd ed. (1993), ch. 20; A. Y. T. Leung, "Dynamic Stiffness and
Substructures" (1993), ch. 2: the stiffnesses of bar and beam.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

__all__ = ["Body", "Leg", "bar", "beam", "below", "lateral", "robot", "robot_frequencies", "roots"]

Count = Callable[[float], int]
Stiffness = tuple[np.ndarray, int]
"""Dynamic stiffness, and how many frequencies with all its coordinates held lie below omega."""


@dataclass(frozen=True, kw_only=True)
class Leg:
    """A leg between its joints at the pose: ``base``, ``tip`` and ``first_axis`` of the universal joint, world axes.

    ``inertia`` [kg m^2]: transverse, of the cylinder about the universal joint; ``axial_inertia``: cylinder and piston;
    ``compliance`` [m/N] of the drive; ``shapes``: of the exact bar keep only so many of the functions eta, sin n pi eta
    (rigid drives only).
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

    @property
    def length(self) -> float:
        """Joint to joint [m]."""
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


@dataclass(frozen=True, kw_only=True)
class Body:
    """The payload at the pose: mass, centre of mass (3,) and inertia about it (3, 3), world axes."""

    mass: float
    com: np.ndarray
    inertia: np.ndarray


def bar(omega: float, leg: Leg) -> tuple[float, int]:
    """Return force over displacement at the tip of the piston, driven at its inner end, Eqs. (T7.9)-(T7.10)."""
    wave = omega * np.sqrt(leg.rhoA / leg.EA)
    x, shift = wave * leg.Lp, np.arctan(leg.EA * wave * leg.compliance)
    if leg.shapes is None:
        return leg.EA * wave / np.tan(x + shift), int((x + shift) // np.pi)
    roots = np.arange(1, leg.shapes) * np.pi
    ritz = 1 - x**2 / 3 - sum(2 * x**4 / (r**2 * (r**2 - x**2)) for r in roots)
    return leg.EA / leg.Lp * ritz, int(np.sum(roots < x))


def beam(omega: float, length: float, EI: float, rhoA: float) -> Stiffness:
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


def lateral(omega: float, leg: Leg, inertia: float) -> Stiffness:
    """Return the stiffness of one plane on (angle of the cylinder, slope at the tip, displacement of the tip)."""
    K, count = beam(omega, leg.length - leg.mouth, leg.EI, leg.rhoA)
    ends = np.array([[leg.mouth, 0, 0], [1, 0, 0], [0, 0, 1], [0, 1, 0]])
    return ends.T @ K @ ends - np.diag([omega**2 * inertia, 0, 0]), count


def robot(omega: float, legs: Sequence[Leg], body: Body) -> Stiffness:
    """Return the stiffness on the payload's 6 and each leg's 4 inner coordinates, Eq. (T7.13)."""
    K, count = np.zeros((6 + 4 * len(legs), 6 + 4 * len(legs))), 0
    K[:3, :3], K[3:6, 3:6] = -(omega**2) * body.mass * np.eye(3), -(omega**2) * body.inertia
    for i, leg in enumerate(legs):
        arm = leg.tip - body.com
        x, y, z = leg.axes().T
        rows = [np.concatenate([n, np.cross(arm, n)]) for n in (x, y, z)]  # n . (dx + theta x arm)
        along, held = bar(omega, leg)
        K[:6, :6] += along * np.outer(rows[2], rows[2])
        for plane, inertia in enumerate(leg.pivot_inertias()):
            local, within = lateral(omega, leg, inertia)
            place = np.zeros((3, len(K)))
            place[[0, 1], [6 + 4 * i + 2 * plane, 7 + 4 * i + 2 * plane]] = 1
            place[2, :6] = rows[plane]
            K += place.T @ local @ place
            held += within
        count += held
    return K, count


def below(stiffness: tuple[np.ndarray | float, int]) -> int:
    """Return the number of frequencies below omega, J = J_0 + s{K(omega)}, Eq. (T7.14)."""
    K, held = np.atleast_2d(stiffness[0]), stiffness[1]
    scale = 1 / np.sqrt(np.linalg.norm(K, axis=0))  # a congruence: signs stay, units go
    return held + int(np.sum(np.linalg.eigvalsh(K * np.outer(scale, scale)) < 0))


def roots(count: Count, n: int, start: float = 1.0, tolerance: float = 1e-12) -> np.ndarray:
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


def robot_frequencies(legs: Sequence[Leg], body: Body, n: int) -> np.ndarray:
    """Return the first n frequencies [Hz] of the robot."""
    return roots(lambda omega: below(robot(omega, legs, body)), n)
