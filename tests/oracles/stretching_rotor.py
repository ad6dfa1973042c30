"""Lag of a turning beam that stretches: two fields by polynomials, about the straight beam, hub 0."""

import numpy as np
from numpy.polynomial import Polynomial
from scipy.linalg import eig


def lag_frequency(speed, slenderness, count=10):
    """First frequency over sqrt(EI / rhoA L^4) of u'' and v'' coupled by 2 speed; EA L^2 / EI is slenderness^2.

    u_tt - 2 g v_t - g^2 u = slenderness^2 u_xx, v_tt + 2 g u_t - g^2 v = -v_xxxx + (g^2 (1 - x^2) / 2 v_x)_x.
    """
    x = Polynomial([0, 1])
    u, v = ([x**k * Polynomial.fromroots([1]) ** j for j in range(count)] for k in (1, 2))

    def inner(f, g, weight=Polynomial([1])):  # noqa: B008
        products = [[(a * b * weight).integ() for b in g] for a in f]
        return np.array([[p(1.0) - p(0.0) for p in row] for row in products])

    du, dv, ddv = [f.deriv() for f in u], [f.deriv() for f in v], [f.deriv(2) for f in v]
    M = np.block([[inner(u, u), np.zeros((count, count))], [np.zeros((count, count)), inner(v, v)]])
    C = inner(u, v)
    G = 2 * speed * np.block([[np.zeros_like(C), -C], [C.T, np.zeros_like(C)]])
    tension = 0.5 * speed**2 * (1 - x**2)
    stiff = inner(ddv, ddv) + inner(dv, dv, tension)
    K = np.block([[slenderness**2 * inner(du, du), 0 * C], [0 * C.T, stiff]]) - speed**2 * M
    none, one = np.zeros_like(M), np.eye(len(M))
    values = eig(np.block([[none, one], [-K, -G]]), np.block([[one, none], [none, M]]), right=False)
    return np.sort(np.abs(values.imag))[0]
