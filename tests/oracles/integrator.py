"""Closed forms about time integration and rest-to-rest motion of one oscillator."""

import numpy as np


def constants(rho_inf: float) -> tuple[float, float, float, float]:
    """Return alpha_m, alpha_f, beta, gamma of generalized-alpha (Chung & Hulbert 1993)."""
    am, af = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    return am, af, (1 - am + af) ** 2 / 4, 0.5 - am + af


def amplification(rho_inf: float, step: float) -> np.ndarray:
    """Return the 3 x 3 map of (u, h v, h^2 a) over one step of u'' = -omega^2 u, step = omega h."""
    am, af, beta, gamma = constants(rho_inf)
    new = np.array([[1, 0, -beta], [0, 1, -gamma], [(1 - af) * step**2, 0, 1 - am]])
    old = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-af * step**2, 0, -am]])
    return np.linalg.solve(new, old)


def spectral_radius(rho_inf: float, step: float) -> float:
    """Return the largest |eigenvalue| of the amplification."""
    return float(np.abs(np.linalg.eigvals(amplification(rho_inf, step))).max())


def numerical_damping(rho_inf: float, step: float) -> tuple[float, float]:
    """Return damping ratio and relative period elongation that the scheme gives an undamped oscillator."""
    values = np.linalg.eigvals(amplification(rho_inf, step))
    log = np.log(values[np.argmax(values.imag)])
    return float(-log.real / abs(log)), float(step / log.imag - 1)


def leading_errors(rho_inf: float, step: float) -> tuple[float, float]:
    """Return the same two to leading order: chi^3 Om^3 / 2 and Om^2 (1/12 + 3 chi^2 / 8), chi = (1 - r)/(1 + r)."""
    chi = (1 - rho_inf) / (1 + rho_inf)
    return chi**3 * step**3 / 2, step**2 * (1 / 12 + 3 * chi**2 / 8)


def energy_loss_per_period(rho_inf: float, step: float) -> float:
    """Return the share of the vibration energy lost in one period: 2 pi chi^3 Om^3."""
    return 4 * np.pi * leading_errors(rho_inf, step)[0]


def shaper(name: str, damping: float = 0.0, tolerance: float = 0.05) -> tuple[np.ndarray, np.ndarray]:
    """Return impulses of ZV, ZVD, ZVDD or EI (undamped) and their times in damped periods."""
    if name == "EI":
        return np.array([1 + tolerance, 2 - 2 * tolerance, 1 + tolerance]) / 4, np.array([0, 0.5, 1])
    order = {"ZV": 1, "ZVD": 2, "ZVDD": 3}[name]
    K = np.exp(-damping * np.pi / np.sqrt(1 - damping**2))
    binomial = {1: [1, 1], 2: [1, 2, 1], 3: [1, 3, 3, 1]}[order]
    impulses = np.array(binomial) * K ** np.arange(order + 1) / (1 + K) ** order
    return impulses, 0.5 * np.arange(order + 1)


def residual(impulses: np.ndarray, times: np.ndarray, omega: float, damping: float = 0.0) -> float:
    """Return the vibration left by impulses at times [s], relative to one unit impulse."""
    damped = omega * np.sqrt(1 - damping**2)
    total = impulses @ np.exp((damping * omega + 1j * damped) * times)
    return float(np.exp(-damping * omega * times[-1]) * abs(total))


def residual_of_motion(profile: str, s: float) -> float:
    """Return residual amplitude / stroke after a rest-to-rest base motion of duration T, s = omega T."""
    if profile == "bang-bang":
        return 16 * np.sin(s / 4) ** 2 / s**2
    if profile == "cycloidal":
        return 8 * np.pi**2 * abs(np.sin(s / 2)) / (s * abs(s**2 - 4 * np.pi**2))
    if profile == "quintic":
        return 120 / s**5 * abs((12 - s**2) * np.sin(s / 2) - 6 * s * np.cos(s / 2))
    raise ValueError(profile)
