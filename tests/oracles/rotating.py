"""Flap and lag frequencies of a uniform rotating cantilever with hub radius and tip mass (spectral Ritz).

Dimensionless: lengths in L, time in sqrt(rhoA L^4 / EI). g = Omega sqrt(rhoA L^4 / EI), delta = hub radius / L,
mu = tip mass / (rhoA L). Tension N(x) = g^2 [delta (1 - x) + (1 - x^2)/2 + mu (delta + 1)]. Axial stretch is left out.
Shapes are polynomials: they know nothing of the eigenfunctions of the beam at rest.
"""

import numpy as np
from scipy.linalg import eigh

from .ritz import gauss, gram, polynomial_shapes


def matrices(delta: float, mu: float, shapes: int = 30) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mass, bending stiffness and geometric stiffness at g = 1."""
    x, w = gauss(60)
    basis = polynomial_shapes(shapes)
    f, f1, f2 = (basis(x, order) for order in range(3))
    tip = basis(np.array([1.0]), 0)[:, 0]
    tension = delta * (1 - x) + (1 - x**2) / 2 + mu * (delta + 1)
    return gram(f, f, w) + mu * np.outer(tip, tip), gram(f2, f2, w), gram(f1, f1, w * tension)


def lowest(stiffness: np.ndarray, mass: np.ndarray, n: int) -> np.ndarray:
    """Return W_1..W_n; as the largest 1 / W^2, because the stiffness is the well-conditioned one of the two."""
    return 1 / np.sqrt(eigh(mass, stiffness, eigvals_only=True)[::-1][:n])


def flap(g: float, delta: float = 0.0, mu: float = 0.0, n: int = 3) -> np.ndarray:
    """Return W_1..W_n of bending out of the plane of rotation."""
    mass, bending, geometric = matrices(delta, mu)
    return lowest(bending + g**2 * geometric, mass, n)


def lag(g: float, delta: float = 0.0, mu: float = 0.0, n: int = 3) -> np.ndarray:
    """Return W_1..W_n of bending in the plane of rotation: the centrifugal field there lowers W^2 by g^2."""
    mass, bending, geometric = matrices(delta, mu)
    return lowest(bending + g**2 * (geometric - mass), mass, n)
