"""Energies of one sliding, bending, stretching leg in space by brute-force quadrature of its exact kinematics.

A material point of the piston is labelled by its distance xi from the tip in the reference state. With the length
s = l - mouth outside the cylinder, zeta = 1 - xi / s and eta = 1 - xi / Lp it sits, in the cylinder's frame, at

    (v, w, l - xi + u + e)  for xi < s,      (0, 0, l - xi + u)  for xi > s,
    v = sum a_i phi_i(zeta),  w = sum b_i phi_i(zeta),  u = c_0 eta + sum_n c_n sin(n pi eta),
    e = -1/(2 s) int_0^zeta (v_z^2 + w_z^2),  R = Rx(alpha) Ry(beta) from the cylinder to the leg's home frame.

Nothing is dropped: T holds every power of the amplitudes. Rates follow by the chain rule at fixed xi, through
zeta_dot = (1 - zeta) s_dot / s; `position` accepts complex coordinates, so that a test can repeat them by complex step.
Coordinates q = (alpha, beta, l, c_0.., a_1..a_k, b_1..b_k); rates in the same order. SI units throughout.

params: rhoA, EI, EA, Lp, mouth, cyl_mass, cyl_com, cyl_inertia, cyl_axial, piston_axial, gravity (3,) in the leg's
home frame. The number of lateral shapes is that of `phi(zeta, order) -> (k, ...)`, the rest of q is axial.
"""

from typing import Any

import numpy as np

from .ritz import Shapes, gauss

POINTS = 40


def rotation(alpha: complex, beta: complex) -> np.ndarray:
    """Return Rx(alpha) Ry(beta), (3, 3)."""
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    return np.array([[cb, 0 * cb, sb], [sa * sb, ca, -sa * cb], [-ca * sb, sa, ca * cb]])


def split(q: np.ndarray, k: int) -> tuple[Any, Any, Any, np.ndarray, np.ndarray, np.ndarray]:
    """Split q (or its rates) into alpha, beta, l, c (n,), a (k,), b (k,)."""
    n = len(q) - 3 - 2 * k
    return q[0], q[1], q[2], q[3 : 3 + n], q[3 + n : 3 + n + k], q[3 + n + k :]


def axial_shapes(n: int, eta: np.ndarray, order: int = 0) -> np.ndarray:
    """Return eta, sin(pi eta), sin(2 pi eta), .. (n, *eta.shape), or their first derivative."""
    j = np.pi * np.arange(1, n).reshape(-1, *[1] * np.ndim(eta))
    if order == 0:
        return np.concatenate([eta[None], np.sin(j * eta)])[:n]
    return np.concatenate([np.ones_like(eta)[None], j * np.cos(j * eta)])[:n]


def position(q: np.ndarray, xi: float, params: dict, phi: Shapes) -> np.ndarray:
    """Return the place of material point xi in the leg's home frame (3,); q may be complex."""
    alpha, beta, length, c, a, b = split(q, len(phi(np.zeros(1), 0)))
    eta = np.array([1 - xi / params["Lp"]])
    local = [0, 0, length - xi + (c @ axial_shapes(len(c), eta))[0]]
    s = length - params["mouth"]
    if xi < s.real:
        zeta = 1 - xi / s
        x, w = gauss(POINTS)
        slopes = phi(zeta * x, 1)  # a straight line from 0 to zeta, also in the complex plane
        local[:2] = [a @ phi(np.array([zeta]), 0)[:, 0], b @ phi(np.array([zeta]), 0)[:, 0]]
        local[2] -= zeta / (2 * s) * (((a @ slopes) ** 2 + (b @ slopes) ** 2) @ w)
    return rotation(alpha, beta) @ np.array(local)


def _outside(q: np.ndarray, v: np.ndarray, params: dict, phi: Shapes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return local places and rates (n, 3) in the cylinder's frame, and weights d xi (n,), of the part outside."""
    k = len(phi(np.zeros(1), 0))
    _, _, length, c, a, b = split(q, k)
    _, _, l_dot, c_dot, a_dot, b_dot = split(v, k)
    s = length - params["mouth"]
    zeta, w = gauss(POINTS)
    xi = s * (1 - zeta)
    zeta_dot = (1 - zeta) * l_dot / s  # at fixed xi
    f, fz = phi(zeta, 0), phi(zeta, 1)
    x, wx = gauss(POINTS)
    inner = phi(np.outer(zeta, x), 1)  # (k, n, POINTS): slopes between 0 and each zeta
    va, vb, ra, rb = (np.tensordot(y, inner, 1) for y in (a, b, a_dot, b_dot))
    stretch = zeta * ((va**2 + vb**2) @ wx)
    stretch_dot = 2 * zeta * ((va * ra + vb * rb) @ wx) + ((a @ fz) ** 2 + (b @ fz) ** 2) * zeta_dot
    eta = 1 - xi / params["Lp"]
    u, u_dot = (y @ axial_shapes(len(c), eta) for y in (c, c_dot))
    local = np.stack([a @ f, b @ f, length - xi + u - stretch / (2 * s)], 1)
    e_dot = stretch * l_dot / (2 * s**2) - stretch_dot / (2 * s)
    rate = np.stack([a_dot @ f + (a @ fz) * zeta_dot, b_dot @ f + (b @ fz) * zeta_dot, l_dot + u_dot + e_dot], 1)
    return local, rate, w * s


def _inside(q: np.ndarray, v: np.ndarray, params: dict, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return local places and rates (n, 3) in the cylinder's frame, and weights d xi (n,), of the part inside."""
    _, _, length, c, _, _ = split(q, k)
    _, _, l_dot, c_dot, _, _ = split(v, k)
    xi, w = gauss(POINTS, length - params["mouth"], params["Lp"])
    u, u_dot = (y @ axial_shapes(len(c), 1 - xi / params["Lp"]) for y in (c, c_dot))
    zero = np.zeros_like(xi)
    return np.stack([zero, zero, length - xi + u], 1), np.stack([zero, zero, l_dot + u_dot], 1), w


def energies(q: np.ndarray, v: np.ndarray, params: dict, phi: Shapes) -> tuple[float, float, float]:
    """Return T, V_gravity, V_strain [J] of piston and cylinder; V_gravity is zero at the universal joint."""
    q, v = np.asarray(q, float), np.asarray(v, float)
    k = len(phi(np.zeros(1), 0))
    alpha, beta, length, c, a, b = split(q, k)
    s = length - params["mouth"]
    if not 0 < s <= params["Lp"]:
        raise ValueError(f"free length {s} outside (0, {params['Lp']}]")
    turn = rotation(alpha, beta)
    omega = np.array([v[0] * np.cos(beta), v[1], v[0] * np.sin(beta)])  # in the cylinder's frame
    kinetic = potential = 0.0
    for local, rate, weight in (_outside(q, v, params, phi), _inside(q, v, params, k)):
        speed = rate + np.cross(omega, local)
        kinetic += 0.5 * params["rhoA"] * float(weight @ (speed**2).sum(1))
        potential -= params["rhoA"] * float(weight @ (local @ turn.T @ params["gravity"]))
    across = omega[0] ** 2 + omega[1] ** 2
    kinetic += 0.5 * (params["cyl_mass"] * params["cyl_com"] ** 2 + params["cyl_inertia"]) * across
    kinetic += 0.5 * (params["cyl_axial"] + params["piston_axial"]) * omega[2] ** 2
    potential -= params["cyl_mass"] * params["cyl_com"] * float(turn[:, 2] @ params["gravity"])
    x, w = gauss(POINTS)
    bend = phi(x, 2)
    strain = 0.5 * params["EI"] / s**3 * float(((a @ bend) ** 2 + (b @ bend) ** 2) @ w)
    strain += 0.5 * params["EA"] / params["Lp"] * float((c @ axial_shapes(len(c), x, 1)) ** 2 @ w)
    return kinetic, potential, strain
