"""Frequencies of uniform Euler-Bernoulli beams from their exact transcendental equations.

The shape is A exp(-lam x) + B exp(-lam (1 - x)) + C cos(lam x) + D sin(lam x) on x in [0, 1]: no term grows, so the
4 x 4 determinant of the end conditions stays well scaled at any lam. omega = lam^2 sqrt(EI / (rhoA L^4)).
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

Rows = Callable[[float], np.ndarray]


def waves(lam: float, x: float) -> np.ndarray:
    """Return value, slope, curvature and third derivative (rows, divided by lam^order) of the four terms at x."""
    fall, rise, c, s = np.exp(-lam * x), np.exp(-lam * (1 - x)), np.cos(lam * x), np.sin(lam * x)
    return np.array([[fall, rise, c, s], [-fall, rise, -s, c], [fall, rise, -c, -s], [-fall, rise, s, -c]])


def roots(function: Callable[[float], float], n: int, start: float = 0.05, step: float = 0.02) -> np.ndarray:
    """Return the first n sign changes of a continuous function above `start`, refined to rounding."""
    found, low, f_low = [], start, function(start)
    while len(found) < n:
        high = low + step
        f_high = function(high)
        if f_low * f_high < 0:
            found.append(brentq(function, low, high, xtol=1e-14, rtol=1e-14))
        low, f_low = high, f_high
    return np.array(found)


ENDS = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3), "guided": (1, 3)}
"""Orders of the derivatives that vanish at an end."""


def beam_roots(left: str, right: str, n: int) -> np.ndarray:
    """Return lam_1..lam_n of a beam with two of the ends clamped, pinned, free, guided (rigid motions left out)."""
    picks = [list(ENDS[left]), list(ENDS[right])]
    return roots(
        lambda lam: np.linalg.det(np.vstack([waves(lam, x)[p] for x, p in zip((0, 1), picks, strict=True)])), n
    )


def tip_body_roots(mu: float, n: int, inertia: float = 0.0, offset: float = 0.0) -> np.ndarray:
    """Return lam_1..lam_n of a cantilever with a rigid body at its tip.

    mu = M / (rhoA L), inertia = J / (rhoA L^3) about the body's CoM, which lies offset * L beyond the tip:
    y'' = lam^4 [J y' + mu c (y + c y')], y''' = -lam^4 mu (y + c y').
    """

    def determinant(lam: float) -> float:
        y, y1, y2, y3 = waves(lam, 1.0)
        com = y + offset * lam * y1
        moment = y2 - lam**2 * (inertia * lam * y1 + mu * offset * com)
        shear = y3 + lam * mu * com
        return float(np.linalg.det(np.vstack([waves(lam, 0.0)[:2], moment / (1 + lam**3), shear / (1 + lam)])))

    return roots(determinant, n)


def frequency(lam: np.ndarray, length: float, EI: float, rhoA: float) -> np.ndarray:
    """Return lam^2 sqrt(EI / (rhoA L^4)) / 2 pi [Hz]."""
    return np.asarray(lam) ** 2 * np.sqrt(EI / rhoA) / length**2 / (2 * np.pi)


def ups_leg_frequencies(
    c: float, mc: float, Lf: float, EI: float, rhoA: float, n: int, cylinder_inertia_about_pivot: float | None = None
) -> np.ndarray:
    """Return the first n frequencies [Hz] of a UPS leg with locked actuator.

    Rigid cylinder (length c, mass mc, uniform unless its inertia about the pivot is given) pivoted at the base, piston
    of free length Lf clamped in its mouth, tip pinned: y = c y', I omega^2 y' = c EI y''' - EI y'' at the mouth.
    """
    inertia = mc * c**2 / 3 if cylinder_inertia_about_pivot is None else cylinder_inertia_about_pivot
    ratio, reach = inertia / (rhoA * Lf**3), c / Lf

    def determinant(lam: float) -> float:
        y, y1, y2, y3 = waves(lam, 0.0)
        hinge = y - reach * lam * y1
        turn = ratio * lam**3 * y1 - reach * lam * y3 + y2
        scaled = [hinge / (1 + reach * lam), turn / (1 + lam * reach + ratio * lam**3)]
        return float(np.linalg.det(np.vstack([*scaled, waves(lam, 1.0)[[0, 2]]])))

    return frequency(roots(determinant, n), Lf, EI, rhoA)


def pinned_pinned_under_load(n: int, thrust: float, length: float, EI: float, rhoA: float) -> float:
    """Return frequency n [Hz] of a pinned-pinned beam under compression: factor sqrt(1 - P / (n^2 P_cr))."""
    critical = (n * np.pi / length) ** 2 * EI
    return float(frequency(n * np.pi, length, EI, rhoA) * np.sqrt(1 - thrust / critical))


def round_section(diameter: float, E: float, density: float) -> dict[str, float]:
    """Return EA, EI, rhoA of a solid round bar."""
    area, second = np.pi * diameter**2 / 4, np.pi * diameter**4 / 64
    return {"EA": E * area, "EI": E * second, "rhoA": density * area}
