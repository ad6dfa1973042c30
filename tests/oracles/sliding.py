"""Equation of motion of a planar beam that slides out of a turning hub; constants by quadrature.

Notation of the underlying report: exposed length L(t), hub angle th(t), rho mass per length, tip mass m_e, total
length Lt. u = (rho L)^(-1/2) sum phi_i(x / L) q_i with the cantilever's eigenfunctions phi.
Two roads to the same motion:

- `q_equation`: the closed form in q; `Lagrangian`: energies and their exact derivatives, for q, th and L at once;
- `pde_equation`: the field equation projected on any set of shapes, with no Lagrangian behind it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from .ritz import Shapes, clamped_free_root, clamped_free_shapes, gauss, gram

Equation = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
Motion = Callable[[float], tuple[float, float, float, float, float, float]]
"""motion(t) -> L, L', L'', th, th', th''."""


@dataclass(frozen=True)
class Constants:
    """Integrals of the cantilever eigenfunctions: e, f, b (k,), E4, B, C, G0, G1, Gt (k, k)."""

    e: np.ndarray
    f: np.ndarray
    b: np.ndarray
    E4: np.ndarray
    B: np.ndarray
    C: np.ndarray
    G0: np.ndarray
    G1: np.ndarray
    Gt: np.ndarray


@lru_cache
def constants(k: int) -> Constants:
    """Return the integrals for k shapes, by 80-point quadrature (exact to rounding for k <= 12)."""
    x, w = gauss(80)
    shapes = clamped_free_shapes(k)
    phi, slope = shapes(x, 0), shapes(x, 1)
    a = (1 - x) * slope - phi / 2
    return Constants(
        e=phi @ w,
        f=phi @ (w * x),
        b=shapes(np.array([1.0]), 0)[:, 0],
        E4=np.diag([clamped_free_root(i) ** 4 for i in range(1, k + 1)]),
        B=gram(phi, a, w),
        C=gram(a, a, w),
        G0=gram(slope, slope, w * (1 - x)),
        G1=gram(slope, slope, w * (1 - x**2) / 2),
        Gt=gram(slope, slope, w),
    )


def q_equation(
    L: float,
    L_dot: float,
    L_ddot: float,
    th: float,
    th_dot: float,
    th_ddot: float,
    *,
    g: float,
    m_e: float,
    rho: float,
    EI: float,
    k: int,
) -> Equation:
    """Return M_q, C_q, K_q (k, k) and rhs (k,) of M_q q'' + C_q q' + K_q q = rhs (closed form)."""
    z = constants(k)
    r, mu = L_dot / L, m_e / (rho * L)
    r_dot = L_ddot / L - r**2
    bb, one = np.outer(z.b, z.b), np.eye(k)
    M = one + mu * bb
    C = r * (2 * z.B - mu * bb)
    K = EI / (rho * L**4) * z.E4 + th_dot**2 * (z.G1 + mu * z.Gt - M) - r**2 * z.C + r_dot * z.B
    K = K + mu * bb * (r**2 / 4 - r_dot / 2) - (L_ddot + g * np.sin(th)) / L * (z.G0 + mu * z.Gt)
    rhs = -np.sqrt(rho) * L**1.5 * th_ddot * z.f - 2 * th_dot * L_dot * np.sqrt(rho * L) * z.e
    rhs = rhs - m_e * np.sqrt(L / rho) * (th_ddot + 2 * r * th_dot) * z.b
    rhs = rhs - g * np.cos(th) * (np.sqrt(rho * L) * z.e + m_e * z.b / np.sqrt(rho * L))
    return M, C, K, rhs


@dataclass(frozen=True)
class Lagrangian:
    """Energies of beam, hub and tip mass in x = (q_1..q_k, th, L) and their exact equations of motion."""

    k: int
    rho: float
    EI: float
    Lt: float
    m_e: float = 0.0
    J_h: float = 0.0
    g: float = 0.0

    def shortening_moment(self, q: np.ndarray, L: complex) -> complex:
        """Return S = 1/2 [rho int (L - x) u_x^2 + m_e int u_x^2]."""
        z = constants(self.k)
        return q @ (z.G0 + self.m_e / (self.rho * L) * z.Gt) @ q / (2 * L)

    def __call__(self, x: np.ndarray, v: np.ndarray) -> complex:
        """Return T - V [J]; complex arguments allowed."""
        z, rho, m_e = constants(self.k), self.rho, self.m_e
        q, th, L = x[:-2], x[-2], x[-1]
        qd, thd, Ld = v[:-2], v[-2], v[-1]
        r, mu, root = Ld / L, m_e / (rho * L), np.sqrt(rho * L)
        u_L, u_Ld = z.b @ q / root, z.b @ (qd - r / 2 * q) / root
        S_q = (z.G0 + mu * z.Gt) @ q / L
        S_L = -(q @ (z.G0 + 2 * mu * z.Gt) @ q) / (2 * L**2)
        S = self.shortening_moment(q, L)
        T = self.J_h * thd**2 + rho * self.Lt * Ld**2 + rho * (L**3 - (L - self.Lt) ** 3) / 3 * thd**2
        T += qd @ qd + 2 * r * (qd @ z.B @ q) + r**2 * (q @ z.C @ q) + thd**2 * (q @ q)
        T += -2 * Ld * thd * root * (z.e @ q) + 2 * thd * root * L * (z.f @ qd + r * ((1.5 * z.f - z.e) @ q))
        T += m_e * ((L**2 + u_L**2) * thd**2 + Ld**2 + u_Ld**2 + 2 * thd * (L * u_Ld - Ld * u_L))
        V = self.EI / (2 * rho * L**4) * (q @ z.E4 @ q) + thd**2 / 2 * (q @ (z.G1 + mu * z.Gt) @ q)
        V += rho * self.g * np.sin(th) * (L * self.Lt - self.Lt**2 / 2) + m_e * self.g * L * np.sin(th)
        V += self.g * np.cos(th) * (root * (z.e @ q) + m_e * u_L) - self.g * np.sin(th) * S
        return T / 2 - Ld * (S_q @ qd + S_L * Ld) - V

    def momenta(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return dLag/dv; the central difference of a quadratic is exact whatever the step."""
        unit = np.eye(len(x))
        return np.array([(self(x, v + d) - self(x, v - d)) / 2 for d in unit])

    def residual(self, x: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Return d/dt dLag/dv - dLag/dx for (q, th, L): zeros, hub torque T, feed force F."""
        h = 1e-30  # complex step: derivatives exact to rounding
        rate = self.momenta(x + 1j * h * v, v + 1j * h * a).imag / h
        slope = np.array([self(x + 1j * h * d, v.astype(complex)).imag / h for d in np.eye(len(x))])
        return rate - slope


@lru_cache
def _sampled(shapes: Shapes) -> tuple[np.ndarray, ...]:
    """Return nodes, weights, values, slopes and curvatures of the shapes there, and tip values."""
    x, w = gauss(60)
    return x, w, *(shapes(x, order) for order in range(3)), shapes(np.array([1.0]), 0)[:, 0]


def pde_equation(
    state: tuple[float, float, float, float, float, float],
    *,
    g: float,
    m_e: float,
    rho: float,
    EI: float,
    shapes: Shapes,
) -> Equation:
    """Project the field equation on u = sum shapes_j(x / L) a_j: M a'' + C a' + K a = rhs.

    Inertia at a fixed x, D^2u/Dt^2 = u_tt + 2 L' u_xt + L'^2 u_xx + L'' u_x; state = L, L', L'', th, th', th''.
    """
    L, L_dot, L_ddot, th, th_dot, th_ddot = state
    x, w, f, f1, f2, tip = _sampled(shapes)
    r = L_dot / L
    r_dot = L_ddot / L - r**2
    weight = w * L
    tension = rho * (th_dot**2 * L**2 * (1 - x**2) / 2 - (L_ddot + g * np.sin(th)) * L * (1 - x))
    tension = tension + m_e * (th_dot**2 * L - L_ddot - g * np.sin(th))
    rate = -2 * r * x * f1 + 2 * L_dot * f1 / L  # what multiplies a'
    place = r**2 * x**2 * f2 + (r**2 - r_dot) * x * f1  # u_tt
    place = place - 2 * L_dot * r * (x * f2 + f1) / L + L_dot**2 * f2 / L**2 + L_ddot * f1 / L - th_dot**2 * f
    M = rho * gram(f, f, weight) + m_e * np.outer(tip, tip)
    C = rho * gram(f, rate, weight)  # d^2/dt^2 of u(L(t), t) = tip . a'' only: the tip's x / L does not change
    K = rho * gram(f, place, weight) + EI / L**4 * gram(f2, f2, weight) + gram(f1, f1, weight * tension) / L**2
    K = K - m_e * th_dot**2 * np.outer(tip, tip)
    push = x * L * th_ddot + 2 * th_dot * L_dot + g * np.cos(th)
    tip_push = L * th_ddot + 2 * th_dot * L_dot + g * np.cos(th)
    return M, C, K, -rho * f @ (weight * push) - m_e * tip_push * tip


def uniform_motion(length: float, feed: float, rotation: float) -> Motion:
    """Return the motion of constant feed L' and rotation rate th' from L = length, th = 0."""
    return lambda t: (length + feed * t, feed, 0.0, rotation * t, rotation, 0.0)


def march(
    equation: Callable[[float], Equation], a0: np.ndarray, v0: np.ndarray, t: np.ndarray, step: float = 1e-3
) -> np.ndarray:
    """Integrate M a'' + C a' + K a = rhs from amplitudes a0 and rates v0; return a at times t, (len(t), k).

    Three-stage Gauss collocation (order 6, A-stable, keeps energy): polynomial shapes carry stiff motions that hardly
    take part, at which an explicit method would crawl. The equation is linear: one solve a step.
    """
    k, y, out = len(a0), np.concatenate([a0, v0]), [a0]
    w = np.sqrt(15)
    nodes = np.array([0.5 - w / 10, 0.5, 0.5 + w / 10])
    stages = np.array(
        [
            [5 / 36, 2 / 9 - w / 15, 5 / 36 - w / 30],
            [5 / 36 + w / 24, 2 / 9, 5 / 36 - w / 24],
            [5 / 36 + w / 30, 2 / 9 + w / 15, 5 / 36],
        ]
    )
    for start, end in pairwise(t):
        n = int(np.ceil((end - start) / step - 1e-9))
        h = (end - start) / n
        for time in start + h * np.arange(n):
            big, free = np.eye(6 * k), np.empty((3, 2 * k))
            rates, pushes = [], []
            for node in nodes:
                M, C, K, rhs = equation(time + node * h)
                lower = np.linalg.solve(M, np.column_stack([-K, -C, rhs]))
                rates.append(np.vstack([np.eye(k, 2 * k, k), lower[:, :-1]]))
                pushes.append(np.concatenate([np.zeros(k), lower[:, -1]]))
            for i in range(3):  # slopes Y_i = A_i (y + h sum_j a_ij Y_j) + p_i
                free[i] = rates[i] @ y + pushes[i]
                for j in range(3):
                    big[2 * k * i : 2 * k * (i + 1), 2 * k * j : 2 * k * (j + 1)] -= h * stages[i, j] * rates[i]
            slopes = np.linalg.solve(big, free.ravel()).reshape(3, 2 * k)
            y = y + h * np.array([5, 8, 5]) @ slopes / 18
        out.append(y[:k])
    return np.array(out)


def tip_history(
    t: np.ndarray, motion: Motion, q0: np.ndarray, *, rho: float, EI: float, m_e: float, g: float = 0.0
) -> np.ndarray:
    """Return the tip deflection [m] at times t by the closed q-equation, from q(0) = q0 and q'(0) = 0."""
    k = len(q0)
    q = march(lambda time: q_equation(*motion(time), g=g, m_e=m_e, rho=rho, EI=EI, k=k), q0, np.zeros(k), t)
    length = np.array([motion(time)[0] for time in t])
    return q @ constants(k).b / np.sqrt(rho * length)


def tip_history_pde(
    t: np.ndarray,
    motion: Motion,
    u0: Callable[[np.ndarray], np.ndarray],
    *,
    shapes: Shapes,
    rho: float,
    EI: float,
    m_e: float,
    g: float = 0.0,
) -> np.ndarray:
    """Return the tip deflection [m] at times t by the projected field equation.

    It starts from the shape u0(x / L), projected, whose mode amplitudes q = sqrt(rho L) u are momentarily at rest:
    u = (rho L)^(-1/2) phi q gives a' = -r/2 a at fixed x / L.
    """
    x, w, f, *_, tip = _sampled(shapes)
    a0 = np.linalg.solve(gram(f, f, w), f @ (w * u0(x)))
    length, feed = motion(t[0])[:2]
    a = march(
        lambda time: pde_equation(motion(time), g=g, m_e=m_e, rho=rho, EI=EI, shapes=shapes),
        a0,
        -feed / length / 2 * a0,
        t,
    )
    return a @ tip
