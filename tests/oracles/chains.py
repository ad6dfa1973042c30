"""Energies and tip of one leg of any mechanism, by brute-force quadrature and integration of its exact kinematics.

    carriage chi -> displacement u of the base joint -> alpha, beta, spin -> cylinder -> l -> flexible piston -> tip

A material point of the piston sits where `nonlinear.position` puts it in the cylinder's frame; the cylinder's frame is
b(chi) + E(chi) R0 u and E(chi) R0 Rx(alpha) Ry(beta) Rz(spin). Everything is a function of the coordinates alone, so
rates follow by complex step and nothing is dropped. The tip's axes are integrated along the line: a frame that does not
spin about its tangent (Bishop), then the twist. ``q`` and ``v`` are dictionaries by coordinate (a, b, c arrays), ``p``
of parameters.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from . import nonlinear
from .ritz import Shapes, gauss

STEP = 1e-30
POINTS = 16


def about(axis: Any, angle: complex) -> np.ndarray:
    """Rotation about a unit vector, by the exponential's closed form."""
    S = np.cross(np.eye(3), np.asarray(axis))  # row i is e_i x axis: minus the transpose of axis x
    return np.eye(3) + np.sin(angle) * S + (1 - np.cos(angle)) * S @ S


def cylinder_frame(q: dict, p: dict) -> tuple[np.ndarray, np.ndarray]:
    """Origin and axes of the cylinder in the world."""
    origin, axes = np.asarray(p["base"]), np.asarray(p["R0"])
    if "carriage_arm" in p:
        E = about(p["carriage_axis"], q["chi"])
        origin, axes = origin - p["carriage_arm"] + E @ p["carriage_arm"], E @ axes
    elif "carriage_axis" in p:
        origin = origin + q["chi"] * np.asarray(p["carriage_axis"])
    if "u1" in q:
        origin = origin + axes @ [q["u1"], q["u2"], q["u3"]]
    x, y, z = np.eye(3)
    return origin, axes @ about(x, q["alpha"]) @ about(y, q["beta"]) @ about(z, q.get("spin", 0.0))


def place(q: dict, xi: float, p: dict, phi: Shapes) -> np.ndarray:
    """Place of a material point of the piston in the world."""
    origin, axes = cylinder_frame(q, p)
    flat = np.concatenate([[0, 0, q["l"]], q["c"], q["a"], q["b"]])
    return origin + axes @ nonlinear.position(flat, xi, p, phi)


def moved(q: dict, v: dict, by: complex) -> dict:
    """Coordinates after a time ``by`` at the rates ``v``."""
    return {name: np.asarray(q[name]) + by * np.asarray(v[name]) for name in q}


def rate(f: Any, q: dict, v: dict) -> np.ndarray:
    """Time derivative of a function of the coordinates."""
    return np.imag(f(moved(q, v, 1j * STEP))) / STEP


def spin(axes: Any, q: dict, v: dict) -> np.ndarray:
    """Angular velocity of a frame, in its own axes."""
    W = np.real(axes(q)).T @ rate(axes, q, v)
    return np.array([W[2, 1], W[0, 2], W[1, 0]])


def energies(q: dict, v: dict, p: dict, phi: Shapes) -> np.ndarray:
    """T, V_gravity, V_strain of carriage, cylinder and piston; V_gravity is zero at the world's origin."""
    g, s = np.asarray(p["gravity"]), q["l"] - p["mouth"]
    T = Vg = 0.0
    for low, high in ((0.0, s), (s, p["Lp"])):
        for xi, w in zip(*gauss(POINTS, low, high), strict=True):
            # A point keeps its share of the free length when that changes: inside and outside are told apart by `s`.
            T += 0.5 * p["rhoA"] * w * (rate(lambda x, xi=xi: place(x, xi, p, phi), q, v) ** 2).sum()
            Vg -= p["rhoA"] * w * float(g @ place(q, xi, p, phi))
    omega = spin(lambda x: cylinder_frame(x, p)[1], q, v)
    centre = lambda x: (lambda f: f[0] + p["cylinder_com"] * f[1][:, 2])(cylinder_frame(x, p))  # noqa: E731
    T += 0.5 * p["cylinder_mass"] * (rate(centre, q, v) ** 2).sum()
    along = v | {"spin": p["cylinder_spins"] * v["spin"]} if "spin" in v else v
    turning = spin(lambda x: cylinder_frame(x, p)[1], q, along)
    T += 0.5 * p["cylinder_inertia"] * (omega[:2] ** 2).sum() + 0.5 * p["cylinder_axial_inertia"] * turning[2] ** 2
    Vg -= p["cylinder_mass"] * float(g @ centre(q))
    eta, w = gauss(POINTS)
    T += 0.5 * p["piston_axial_inertia"] * float(w @ (omega[2] + eta * v.get("t", 0.0)) ** 2)
    if "carriage_mass" in p:
        on_shaft = "carriage_arm" in p
        inertia = p["carriage_inertia"] if on_shaft else p["carriage_mass"]
        shaft = lambda x: np.asarray(p["base"]) - p["carriage_arm"]  # noqa: E731
        mass = (
            shaft(q) + about(p["carriage_axis"], q["chi"]) @ p["carriage_com"] if on_shaft else cylinder_frame(q, p)[0]
        )
        T += 0.5 * inertia * v["chi"] ** 2
        Vg -= p["carriage_mass"] * float(g @ mass)
    bend = phi(eta, 2)
    Vs = 0.5 * p["EI"] / s**3 * float(((q["a"] @ bend) ** 2 + (q["b"] @ bend) ** 2) @ w)
    Vs += 0.5 * p["EA"] / p["Lp"] * float((q["c"] @ nonlinear.axial_shapes(len(q["c"]), eta, 1)) ** 2 @ w)
    Vs += 0.5 * p.get("GJ", 0.0) / p["Lp"] * q.get("t", 0.0) ** 2
    return np.array([T, Vg, Vs])


def tip_axes(q: dict, p: dict, phi: Shapes, steps: int = 400) -> np.ndarray:
    """Axes of the tip in those of the cylinder: a frame carried along the line without spin, then twisted.

    Along arc length with the unit tangent (v', w', sqrt(1 - v'^2 - w'^2)); the double reflection of Wang, Juettler,
    Zheng & Liu (2008), of fourth order.
    """
    zeta = np.linspace(0, 1, steps + 1)
    s = q["l"] - p["mouth"]
    v, w = (amplitudes @ phi(zeta, 1) / s for amplitudes in (q["a"], q["b"]))
    tangent = np.stack([v, w, np.sqrt(1 - v**2 - w**2)], 1)
    x, W = gauss(8)
    first = np.eye(3)[0]
    for i in range(steps):
        inner = zeta[i] + (zeta[i + 1] - zeta[i]) * x
        vi, wi = (amplitudes @ phi(inner, 1) / s for amplitudes in (q["a"], q["b"]))
        chord = np.stack([vi, wi, np.sqrt(1 - vi**2 - wi**2)], 1).T @ W
        mirror = np.eye(3) - 2 * np.outer(chord, chord) / (chord @ chord)
        middle = mirror @ tangent[i]
        across = tangent[i + 1] - middle
        again = np.eye(3) - 2 * np.outer(across, across) / (across @ across)
        first = again @ mirror @ first
    axes = np.stack([first, np.cross(tangent[-1], first), tangent[-1]], 1)
    return axes @ about([0, 0, 1], q.get("t", 0.0))
