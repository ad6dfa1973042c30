"""Spin-up of a flexible beam clamped to a turning hub: Ritz with geometric (centrifugal) stiffening.

m (u_tt - psi'^2 u + psi'' x) + EI u_xxxx - (N u_x)_x = 0 with N = m psi'^2 (L^2 - x^2) / 2; small strain, no stretch.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from .ritz import gauss, gram, polynomial_shapes


def law(t: np.ndarray, rate: float, duration: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return angle, rate and acceleration of psi = (Ws/Ts) [t^2/2 + (Ts/2 pi)^2 (cos(2 pi t/Ts) - 1)], then uniform."""
    t, w = np.asarray(t, float), 2 * np.pi / duration
    rising = t <= duration
    angle = rate / duration * (t**2 / 2 + (np.cos(w * t) - 1) / w**2)
    speed = rate / duration * (t - np.sin(w * t) / w)
    push = rate / duration * (1 - np.cos(w * t))
    after = rate * duration / 2 + rate * (t - duration)
    return np.where(rising, angle, after), np.where(rising, speed, rate), np.where(rising, push, 0.0)


def tip_lag(
    t: np.ndarray,
    *,
    length: float,
    EI: float,
    m: float,
    rate: float,
    duration: float,
    shapes: int = 6,
    stiffening: bool = True,
) -> np.ndarray:
    """Return the lateral tip deflection [m] at times t from rest; negative lags behind the hub.

    The polynomials are first turned into their own modes, `shapes` of which are kept of twice as many.
    Without `stiffening` the centrifugal field only pushes outwards: the result diverges once psi' passes omega_1.
    """
    x, w = gauss(40)
    basis = polynomial_shapes(2 * shapes)
    f, f1, f2 = (basis(x, order) for order in range(3))
    mass, bending = m * length * gram(f, f, w), EI / length**3 * gram(f2, f2, w)
    geometric = m * length * gram(f1, f1, w * (1 - x**2) / 2)  # times psi'^2
    inverse, modes = eigh(mass, bending)  # 1 / omega^2, bending being the well-conditioned matrix
    square, modes = 1 / inverse[::-1], (modes / np.sqrt(inverse))[:, ::-1][:, :shapes]
    stiff = modes.T @ geometric @ modes * stiffening - np.eye(shapes)
    push = m * length**2 * modes.T @ (f @ (w * x))

    def slope(time: float, y: np.ndarray) -> np.ndarray:
        _, speed, acceleration = law(time, rate, duration)
        a = y[:shapes]
        return np.concatenate([y[shapes:], -square[:shapes] * a - speed**2 * stiff @ a - acceleration * push])

    out = solve_ivp(slope, (0, t[-1]), np.zeros(2 * shapes), "DOP853", t_eval=t, rtol=1e-9, atol=1e-12)
    return basis(np.array([1.0]), 0)[:, 0] @ modes @ out.y[:shapes]


def steady_extension(length: float, EA: float, m: float, rate: float) -> tuple[float, float]:
    """Return the tip extension [m] at uniform rate: small strain m W^2 L^3 / 3 EA, and linear elastic rod."""
    a = rate * length * np.sqrt(m / EA)
    return m * rate**2 * length**3 / (3 * EA), length * (np.tan(a) / a - 1)
