"""Functions of x in [0, 1] with which the other oracles are built, and their quadrature.

Two families, both clamped at x = 0: the eigenfunctions of the cantilever, unit norm and phi(1) = +-2, and
polynomials with the same two conditions, which know nothing of eigenfunctions.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Legendre

Shapes = Callable[[np.ndarray, int], np.ndarray]
"""shapes(x, order) -> (k, *x.shape): derivative of the given order of every shape."""


def gauss(n: int, a: float = 0.0, b: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights of the n-point Gauss-Legendre rule on [a, b]."""
    x, w = np.polynomial.legendre.leggauss(n)
    return a + (b - a) * (x + 1) / 2, (b - a) * w / 2


def clamped_free_root(i: int) -> float:
    """Return root i = 1, 2, .. of cos(x) + 1/cosh(x) = 0, the cantilever's equation in a well-scaled form."""
    x = 1.875 if i == 1 else (i - 0.5) * np.pi
    for _ in range(8):
        x -= (np.cos(x) + 1 / np.cosh(x)) / (-np.sin(x) - np.tanh(x) / np.cosh(x))
    return float(x)


def clamped_free(i: int) -> Callable[[np.ndarray, int], np.ndarray]:
    """Return phi(x, order): eigenfunction i of the cantilever, unit norm, for real or complex x.

    cosh - sigma sinh is written with exp(-lam x) and exp(-lam (1 - x)), none of which grows: no cancellation
    at any i (the difference of the growing cosh and sinh loses all digits near i = 12).
    """
    lam = clamped_free_root(i)
    em = np.exp(-lam)
    grow = (np.sin(lam) - np.cos(lam) - em) / (1 - em**2 + 2 * em * np.sin(lam))  # (1 - sigma)/2 exp(lam)
    sigma = 1 - 2 * grow * em

    def phi(x: np.ndarray, order: int = 0) -> np.ndarray:
        x = np.asarray(x)
        waves = [-np.cos(lam * x) + sigma * np.sin(lam * x), np.sin(lam * x) + sigma * np.cos(lam * x)]
        wave = waves[order % 2] * (-1) ** (order // 2)
        decay = (1 - grow * em) * np.exp(-lam * x) * (-1) ** order
        return lam**order * (grow * np.exp(-lam * (1 - x)) + decay + wave)

    return phi


def clamped_free_shapes(k: int) -> Shapes:
    """Return the first k cantilever eigenfunctions as one callable (x, order) -> (k, *x.shape)."""
    phis = [clamped_free(i) for i in range(1, k + 1)]
    return lambda x, order=0: np.array([phi(x, order) for phi in phis])


def polynomial_shapes(k: int) -> Shapes:
    """Return the first k polynomials with value and slope 0 at x = 0, as one callable (x, order) -> (k, *x.shape).

    They span x^2 P_j(2 x - 1), j < k, in the form whose curvatures are the Legendre polynomials: bending stiffness is
    diagonal, so low frequencies keep their digits with 30 shapes.
    """
    bend = [Legendre.basis(j, domain=[0, 1]) for j in range(k)]
    twice = [p.integ(2, lbnd=0) for p in bend]
    return lambda x, order=0: np.array([p.deriv(order)(np.asarray(x)) for p in twice])


def gram(f: np.ndarray, g: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return int weight f_i g_j, with f, g (k, n) at the nodes and the rule's weights folded into `weight`."""
    return (f * weight) @ g.T
