"""A piston in two bushings of a cylinder that bends: places of material points by quadrature, nothing dropped.

In the cylinder's frame, whose third axis is the tangent of the cylinder at the base joint, X from there:

- the cylinder is at y(X) = chi(X / m) k, drawn back by int (y'^2) / 2;
- the piston's outer part (X > m) at V + S (X - m) + phi(zeta) a, zeta = (X - m) / (l - m); the inner one at
  V + S (X - m) + theta(z) h, z = (m - X) / d, d = m - (l - Lp); V, S: y and its slope at m plus g;
- the piston's inner end is drawn back with the cylinder there, further points by int (slope^2) / 2 from there.
"""

import numpy as np

from .nonlinear import axial_shapes, rotation
from .ritz import gauss

POINTS = 16
STEP = 1e-5


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

    def tube(self, x, X, order):
        """Displacement (0) or slope (1) of the cylinder (2, n)."""
        m = self.p["mouth"]
        return np.array([x[f"k{w}"] @ self.cylinder(X / m, order) / m**order for w in "ab"])

    def back(self, x, X):
        """How far the cylinder is drawn back at X (n,)."""
        u, w = gauss(POINTS)
        return -0.5 * np.array([X_ * w @ (self.tube(x, X_ * u, 1) ** 2).sum(0) for X_ in X])

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

    def energies(self, q, v, gravity):
        """Kinetic energy and potential of gravity of piston and cylinder."""
        p, l = self.p, self.parts(q)["l"][0]  # noqa: E741
        s = l - p["mouth"]
        kinetic = potential = 0.0
        for place, start, end, rho in (
            (self.piston, 0.0, s, p["rhoA"]), (self.piston, s, p["Lp"], p["rhoA"]),
            (self.body, 0.0, p["mouth"], p["cylinder_rhoA"]),
        ):  # fmt: skip
            x, w = gauss(POINTS, start, end)
            now = place(q, x)
            rate = (8 * (place(q + STEP * v, x) - place(q - STEP * v, x))
                    - (place(q + 2 * STEP * v, x) - place(q - 2 * STEP * v, x))) / (12 * STEP)  # fmt: skip
            kinetic += 0.5 * rho * w @ (rate**2).sum(1)
            potential -= rho * w @ (now @ gravity)
        return kinetic, potential
