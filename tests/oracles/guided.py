"""A piston in two bushings of a cylinder that bends: places of material points by quadrature, nothing dropped.

In the cylinder's frame, whose third axis is the tangent of the cylinder at the base joint, X from there:

- the cylinder is at y(X) = chi(X / m) k + K r(X), drawn back by int (y'^2) / 2; r is what a force at the head bends a
  cantilever less what the chi take of it, by the work that it does on each, with K the last of the amplitudes;
- the piston's outer part (X > m) at V + S (X - m) + phi(zeta) a, zeta = (X - m) / (l - m); the inner one at
  V + S (X - m) + theta(z) h, z = (m - X) / d, d = m - (l - Lp); V, S: y and its slope at m plus g;
- the piston's inner end is drawn back with the cylinder there, further points by int (slope^2) / 2 from there.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from .nonlinear import axial_shapes, rotation
from .ritz import gauss

POINTS = 16
STEP = 1e-5


def _rate(of, q, v):
    """d/dt of a function of q, to fourth order in the step."""
    one, two = (of(q + k * STEP * v) - of(q - k * STEP * v) for k in (1, 2))
    return (8 * one - two) / (12 * STEP)


class Guided:
    """Places of mass points; ``shapes``: outer, inner and cylinder's functions (x, order) -> (k, n)."""

    def __init__(self, layout, physics, outer, inner, cylinder):
        self.layout, self.p, self.outer, self.inner, self.cylinder = layout, physics, outer, inner, cylinder

    def parts(self, q):
        """Coordinates by name."""
        found, start = {}, 0
        for name, size in self.layout:
            found[name] = q[start : start + size]
            start += size
        return found

    def head(self, x):
        """Place of the head from the base joint."""
        return x["l"][0] - self.p["Lp"]

    def left(self, x, X, order):
        """What the head's force bends the cylinder beyond its shapes (n,), over (u (1 - u))^2 of the head; u = X/m."""
        m = self.p["mouth"]
        h, at = self.head(x) / m, X / m
        u, w = gauss(POINTS)
        bends = self.cylinder(u, 2)
        taken = np.linalg.solve((bends * w) @ bends.T, self.cylinder(np.array([h]), 0)[:, 0])
        near, past = np.minimum(at, h), np.maximum(at - h, 0)
        whole = near**2 * (3 * h - near) / 6 + h**2 / 2 * past if order == 0 else near * (2 * h - near) / 2
        return (whole - taken @ self.cylinder(at, order)) / (h * (1 - h)) ** 2 / m**order

    def tube(self, x, X, order):
        """Displacement (0) or slope (1) of the cylinder (2, n)."""
        m, left = self.p["mouth"], self.left(x, X, order)
        both = x["ka"], x["kb"]
        return np.array([k[:-1] @ self.cylinder(X / m, order) / m**order + k[-1] * left for k in both])

    def back(self, x, X):
        """How far the cylinder is drawn back at X (n,)."""
        u, w = gauss(POINTS)

        def drawn(a, b):
            return -0.5 * (b - a) * w @ (self.tube(x, a + (b - a) * u, 1) ** 2).sum(0)

        h = self.head(x)
        return np.array([drawn(0, X_) if X_ <= h else drawn(0, h) + drawn(h, X_) for X_ in X])

    def line(self, x):
        """Displacement and slope (2,) at the mouth."""
        m = np.array([self.p["mouth"]])
        g = np.array([x["ga"], x["gb"]])
        return self.tube(x, m, 0)[:, 0] + g[:, 0], self.tube(x, m, 1)[:, 0] + g[:, 1]

    def rod(self, x, X, order):
        """Displacement or slope of the piston at X (2, n)."""
        m, l = self.p["mouth"], x["l"][0]  # noqa: E741
        V, S = self.line(x)
        s, d = l - m, m - l + self.p["Lp"]
        rigid = V[:, None] + S[:, None] * (X - m) if order == 0 else np.repeat(S[:, None], X.size, 1)
        out = np.array([x[w] @ self.outer(np.clip((X - m) / s, 0, 1), order) / s**order for w in "ab"])
        back = np.array([x[f"h{w}"] @ self.inner(np.clip((m - X) / d, 0, 1), order) / (-d) ** order for w in "ab"])
        return rigid + np.where(X > m, out, back)

    def piston(self, q, xi):
        """Places (n, 3) of points at xi from the tip, from the base joint, in axes that do not turn."""
        x = self.parts(q)
        m, l, head = self.p["mouth"], x["l"][0], x["l"][0] - self.p["Lp"]  # noqa: E741
        X = l - xi
        u, w = gauss(POINTS)

        def drawn(a, b):
            return -0.5 * (b - a) * w @ (self.rod(x, a + (b - a) * u, 1) ** 2).sum(0)

        e = [drawn(head, X_) if X_ <= m else drawn(head, m) + drawn(m, X_) for X_ in X]
        e = np.array(e) + self.back(x, np.array([head]))[0]
        along = x["c"] @ axial_shapes(len(x["c"]), 1 - xi / self.p["Lp"])
        local = np.vstack([self.rod(x, X, 0), X + along + e])
        return (rotation(x["alpha"][0], x["beta"][0]) @ local).T

    def body(self, q, X):
        """Places (n, 3) of points of the cylinder, likewise."""
        x = self.parts(q)
        local = np.vstack([self.tube(x, X, 0), X + self.back(x, X)])
        return (rotation(x["alpha"][0], x["beta"][0]) @ local).T

    def spin(self, q, v, X):
        """Squared angular velocity of sections of the cylinder across it (n,)."""

        def turned(q):
            x = self.parts(q)
            slopes = self.tube(x, X, 1)
            frame = rotation(x["alpha"][0], x["beta"][0])
            return np.array([frame @ Rotation.from_rotvec([-b, a, 0]).as_matrix() for a, b in slopes.T])

        W = np.swapaxes(turned(q), 1, 2) @ _rate(turned, q, v)
        return W[:, 2, 1] ** 2 + W[:, 0, 2] ** 2

    def energies(self, q, v, gravity):
        """Kinetic energy and potential of gravity of piston and cylinder."""
        p, l = self.p, self.parts(q)["l"][0]  # noqa: E741
        s = l - p["mouth"]
        kinetic = potential = 0.0
        for place, start, end, rho in (
            (self.piston, 0.0, s, p["rhoA"]), (self.piston, s, p["Lp"], p["rhoA"]),
            (self.body, 0.0, l - p["Lp"], p["cylinder_rhoA"]), (self.body, l - p["Lp"], p["mouth"], p["cylinder_rhoA"]),
        ):  # fmt: skip
            x, w = gauss(POINTS, start, end)
            now = place(q, x)
            rate = _rate(lambda at, place=place, x=x: place(at, x), q, v)
            kinetic += 0.5 * rho * w @ (rate**2).sum(1)
            potential -= rho * w @ (now @ gravity)
            if place == self.body:
                kinetic += 0.5 * p["cylinder_turning"] * w @ self.spin(q, v, x)
        M, X, J = p["mounted_mass"], np.array([p["mounted_com"]]), p["mounted_inertia"]
        rate = _rate(lambda at: self.body(at, X), q, v)
        kinetic += 0.5 * (M * (rate**2).sum() + J * self.spin(q, v, X)[0])
        return kinetic, potential - M * float(self.body(q, X)[0] @ gravity)
