"""Exact frequencies of a rigid platform on beam legs with any ends: dynamic stiffness, counted so that none is missed.

A leg is a rigid cylinder that turns on its base joint, and a uniform beam that is clamped in it at its mouth. The beam
bends (Euler and Bernoulli) from the mouth to the tip; the whole piston, from the drive to the tip, stretches and
twists. Joints are sets of axes about which an end may turn. Everything is small motion about an unloaded pose.

The beam's stiffness at a frequency: e.g. J. R. Banerjee, Computers & Structures 63 (1997) 101-103. The count of
frequencies below omega: W. H. Wittrick, F. W. Williams, Q. J. Mech. Appl. Math. 24 (1971) 263-284: as many as the
assembled matrix has negative eigenvalues, and those of the members with both ends clamped.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import factorial

import numpy as np

NONE = np.zeros((0, 3))
ALL = np.eye(3)


@dataclass(frozen=True, kw_only=True)
class Leg:
    """One leg at a pose; world axes, SI.

    `base_axes`, `tip_axes`: rows about which the cylinder may turn against the ground, the tip against the platform
    (three rows: a ball, none: welded); `base_springs`, `tip_springs`: stiffness of each. `turn`: angle of the principal
    axes of bending about the leg, where EI_2 differs from EI. `planes`: directions of bending kept.
    """

    base: np.ndarray
    tip: np.ndarray
    EI: float
    EA: float
    rhoA: float
    base_axes: np.ndarray = field(default_factory=lambda: ALL)
    tip_axes: np.ndarray = field(default_factory=lambda: ALL)
    base_springs: tuple[float, ...] = ()
    tip_springs: tuple[float, ...] = ()
    GJ: float = np.inf
    spin_inertia: float = 0.0  # of the piston about its axis
    mouth: float = 0.0
    length: float | None = None  # of the piston: None: from the mouth to the tip
    inertia: float = 0.0  # of the cylinder about the base joint, across
    axial_inertia: float = 0.0
    slides: bool = False  # the piston is free to move in the cylinder: a passive leg
    spins: bool = False  # and to turn in it
    first: np.ndarray | None = None  # direction of bending with EI; the other one has EI_2
    EI_2: float | None = None
    planes: tuple[int, ...] = (0, 1)

    @property
    def span(self):
        return float(np.linalg.norm(self.tip - self.base))

    @property
    def piston(self):
        return self.span - self.mouth if self.length is None else self.length

    def axes(self):
        """Columns x, y across the leg, z along it."""
        z = (self.tip - self.base) / self.span
        x = np.eye(3)[np.argmin(np.abs(z))] if self.first is None else self.first
        x = x - z * (x @ z)
        x = x / np.linalg.norm(x)
        return np.column_stack([x, np.cross(z, x), z])


@dataclass(frozen=True, kw_only=True)
class Body:
    """The platform with its load: mass, inertia about its centre of mass, where that is; its free directions (k, 6)."""

    mass: float
    inertia: np.ndarray
    com: np.ndarray
    free: np.ndarray = field(default_factory=lambda: np.eye(6))


def _series(x, start, terms=14):
    """Sum of x^n / n! over n = start, start + 4, ..."""
    return sum(x**n / factorial(n) for n in range(start, start + 4 * terms, 4))


def _products(x):
    """1 - cos cosh, sin sinh, sin cosh +- cos sinh, sinh -+ sin, cosh - cos; from 2 on divided by cosh."""
    if x < 2:  # without the differences of nearly equal numbers: powers of 1 + i
        k = range(12)
        one = -sum((-4) ** n * x ** (4 * n) / factorial(4 * n) for n in k if n)
        two = sum(2 * (-4) ** n * x ** (4 * n + 2) / factorial(4 * n + 2) for n in k)
        plus = sum(2 * (-4) ** n * x ** (4 * n + 1) / factorial(4 * n + 1) for n in k)
        minus = sum(4 * (-4) ** n * x ** (4 * n + 3) / factorial(4 * n + 3) for n in k)
        return one, two, plus, minus, 2 * _series(x, 3), 2 * _series(x, 1), 2 * _series(x, 2)
    c, s, t, h = np.cos(x), np.sin(x), np.tanh(x), 1 / np.cosh(x)
    return h - c, s * t, s + c * t, s - c * t, t - s * h, t + s * h, 1 - c * h


def bending(omega, EI, rhoA, s):
    """Stiffness (4, 4) of deflection and slope at both ends, and frequencies below omega with both ends clamped."""
    x = (rhoA * omega**2 / EI) ** 0.25 * s
    if x == 0:
        K = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4.0]])
        count = 0
    else:
        d, ss, plus, minus, less, more, cosines = _products(x)
        a, b, c = x**3 * plus / d, x**2 * ss / d, x * minus / d
        e, f, g = x**3 * more / d, x**2 * cosines / d, x * less / d
        K = np.array([[a, b, -e, f], [b, c, -f, g], [-e, -f, a, -b], [f, g, -b, c]])
        count = _clamped(x, d)
    scale = np.array([1, s, 1, s])
    return EI / s**3 * K * np.outer(scale, scale), count


def _clamped(x, d):
    """Roots of cos cosh = 1 below x: one near each (i + 1/2) pi, i = 1, 2, ...; d, positive before the first, tells."""
    i = int(x / np.pi)  # i - 1 roots lie below i pi surely, and at most one more
    passed = max(i - 1, 0)
    return passed + int(i > 0 and (d > 0) != (passed % 2 == 0))


def rod(omega, stiffness, mass, length):
    """Stiffness (2, 2) of a bar or shaft (EA and mass, GJ and spin inertia), and its count with held ends."""
    if np.isinf(stiffness):
        raise ValueError("a rigid member is not a rod")
    x = omega * np.sqrt(mass * length / stiffness)
    if x == 0:
        return stiffness / length * np.array([[1.0, -1], [-1, 1]]), 0
    K = stiffness / length * x * np.array([[1 / np.tan(x), -1 / np.sin(x)], [-1 / np.sin(x), 1 / np.tan(x)]])
    return K, int(x / np.pi)


def _free_inside(k, count):
    """A rod whose inner end is free: this coordinate is eliminated, and counts where its stiffness is negative."""
    if k[0, 0] == 0 or k[0, 1] == -k[0, 0]:
        return 0 * k, count
    return k - np.outer(k[:, 0], k[0]) / k[0, 0], count + int(k[0, 0] < 0)


def _cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def assembled(omega, legs, body):
    """Stiffness at omega of platform (6) and joint angles, and the count of what is inside the members."""
    sizes = [len(leg.base_axes) + len(leg.tip_axes) for leg in legs]
    n = len(body.free) + sum(sizes)
    K, count = np.zeros((n, n)), 0
    hub = np.zeros((6, n))
    hub[:, : len(body.free)] = body.free.T
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = body.mass * np.eye(3), body.inertia
    K -= omega**2 * hub.T @ mass @ hub
    at = len(body.free)
    for leg, size in zip(legs, sizes, strict=True):
        part, inside = _leg(omega, leg, body, hub, at, n)
        K, count, at = K + part, count + inside, at + size
    return K, count


def _leg(omega, leg, body, hub, at, n):
    A, split = leg.axes(), len(leg.base_axes)
    cylinder, turned = np.zeros((3, n)), hub[3:].copy()
    cylinder[:, at : at + split] = leg.base_axes.T
    turned[:, at + split : at + split + len(leg.tip_axes)] = leg.tip_axes.T
    moved = hub[:3] - _cross(leg.tip - body.com) @ hub[3:]
    cylinder, turned, moved = A.T @ cylinder, A.T @ turned, A.T @ moved
    s, L = leg.span - leg.mouth, leg.piston
    K, count = np.zeros((n, n)), 0
    stiff = (leg.EI, leg.EI if leg.EI_2 is None else leg.EI_2)
    for plane in leg.planes:
        slopes = (cylinder[1], turned[1]) if plane == 0 else (-cylinder[0], -turned[0])
        ends = np.array([leg.mouth * slopes[0], slopes[0], moved[plane], slopes[1]])
        k, inside = bending(omega, stiff[plane], leg.rhoA, s)
        K, count = K + ends.T @ k @ ends, count + inside
        guided = leg.rhoA / 3 * (leg.mouth**3 - (leg.span - L) ** 3)
        K -= omega**2 * (leg.inertia + guided) * np.outer(slopes[0], slopes[0])
    k, inside = rod(omega, leg.EA, leg.rhoA * L, L)
    if leg.slides:
        k, inside = _free_inside(k, inside)
    K, count = K + k[1, 1] * np.outer(moved[2], moved[2]), count + inside
    K -= omega**2 * leg.axial_inertia * np.outer(cylinder[2], cylinder[2])
    if np.isfinite(leg.GJ):
        k, inside = rod(omega, leg.GJ, leg.spin_inertia, L)
        if leg.spins:
            k, inside = _free_inside(k, inside)
        ends = np.array([cylinder[2], turned[2]])
        K, count = K + ends.T @ k @ ends, count + inside
    springs = np.zeros(n)
    springs[at : at + len(leg.base_springs)] = leg.base_springs
    springs[at + split : at + split + len(leg.tip_springs)] = leg.tip_springs
    return K + np.diag(springs), count


def below(omega, legs, body):
    """Frequencies below omega [rad/s]."""
    K, count = assembled(omega, legs, body)
    scale = 1 / np.sqrt(np.abs(K).max(axis=1, initial=1e-300))  # signs do not change, and numbers become alike
    return count + int(np.sum(np.linalg.eigvalsh(K * np.outer(scale, scale)) < 0))


def frequencies(legs, body, count, start=10.0, digits=1e-13):
    """The first frequencies [Hz], with multiplicity."""
    found = []
    for i in range(1, count + 1):
        low, high = found[-1] * (1 - 1e-9) if found else 0.0, max(start, 2 * found[-1] if found else 0.0)
        while below(high, legs, body) < i:
            low, high = high, 2 * high
        while high - low > digits * high:
            middle = (low + high) / 2
            low, high = (middle, high) if below(middle, legs, body) < i else (low, middle)
        found.append((low + high) / 2)
    return np.array(found) / (2 * np.pi)


def stiffness(legs, body):
    """Static stiffness (k, k) of the platform in its free directions, joint angles at rest."""
    K, _ = assembled(0.0, legs, body)
    k = len(body.free)
    rest = np.linalg.lstsq(K[k:, k:], K[k:, :k], rcond=1e-13)[0] if len(K) > k else np.zeros((0, k))
    return K[:k, :k] - K[:k, k:] @ rest
