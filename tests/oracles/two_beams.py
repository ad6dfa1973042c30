"""A leg across its axis as two Euler beams in two bushings, by few finite elements of high degree.

The tube reaches from the base joint to its mouth; the rod, of uniform pieces, from its head (at X = `head`) to the tip.
The thrust enters the tube at the head, along the tube's tangent at the base joint: it shortens the tube up to there and
the rod beyond, and what the head is off the tube turns with that tangent. An element ends at every bushing, cut and
body: inside of it all is smooth. Its deflection is a cubic by its ends and Legendre polynomials integrated twice.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from scipy.linalg import eigh

INNER = 12  # shapes of an element beyond the cubic: the fifth frequency of a leg to rounding


def _shapes():
    cubic = ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])
    ends = [Polynomial(c).convert(kind=Legendre, domain=[0, 1]) for c in cubic]
    # Twice integrated from 0, a Legendre polynomial of degree 2 or more has neither place nor slope at 1.
    return ends + [Legendre.basis(n, domain=[0, 1]).integ(2, lbnd=0) for n in range(2, INNER + 2)]


def _gram(order):
    """Integrals of products of derivatives of the shapes over [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(INNER + 6)
    rows = np.array([(p.deriv(order) if order else p)((x + 1) / 2) for p in _shapes()])
    return (rows * w / 2) @ rows.T


GRAMS = [_gram(order) for order in range(3)]


@dataclass(frozen=True)
class TwoBeams:
    """`tube`: EI, mass and rotary inertia per length; `rod`: pieces (length, EI, mass per length) from the head.

    `bushings`: (gland, head) [N/m]; None: the rod is clamped to the tube's mouth and straight inwards of it.
    `mounted`: (mass, place, inertia) on the tube.
    """

    mouth: float
    head: float
    tube: tuple[float, float, float]
    rod: list[tuple[float, float, float]]
    bushings: tuple[float, float] | None
    mounted: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @cached_property
    def cuts(self):
        """Ends of the rod's pieces."""
        return self.head + np.cumsum([0.0, *(piece[0] for piece in self.rod)])

    @cached_property
    def places(self):
        """Nodes of tube and rod."""
        tube = [0.0, self.head, self.mounted[1], self.mouth]
        return [np.unique(np.round(ends, 12)) for ends in (tube, [*self.cuts, self.mouth])]

    def at(self, rod, X):
        """Position of the displacement at a node; its slope follows."""
        return 2 * (rod * self.places[0].size + int(np.abs(self.places[rod] - X).argmin()))

    @cached_property
    def nodes(self):
        """Number of coordinates of nodes."""
        return 2 * sum(x.size for x in self.places)

    @cached_property
    def matrices(self):
        """M, K and what a unit thrust takes off K, of the free beams."""
        spans = [(rod, a, b) for rod in (0, 1) for a, b in pairwise(self.places[rod])]
        n = self.nodes + INNER * len(spans)
        M, K, G = np.zeros((3, n, n))
        for k, (rod, a, b) in enumerate(spans):
            h, first, inner = b - a, self.at(rod, a), self.nodes + INNER * k
            own = np.ix_(*[[*range(first, first + 4), *range(inner, inner + INNER)]] * 2)
            if rod:
                EI, m = self.rod[int(np.searchsorted(self.cuts, (a + b) / 2)) - 1][1:]
                turning, pressed = 0.0, 1.0
            else:
                (EI, m, turning), pressed = self.tube, float(b <= self.head + 1e-9)
            units = np.array([1, h, 1, h, *[1.0] * INNER])
            mass, slope, bend = (np.outer(units, units) * gram for gram in GRAMS)
            M[own] += m * h * mass + turning / h * slope
            K[own] += EI / h**3 * bend
            G[own] += pressed / h * slope
        i = self.at(0, self.mounted[1])
        M[i, i] += self.mounted[0]
        M[i + 1, i + 1] += self.mounted[2]
        gaps = np.zeros((2, n))
        for gap, X in zip(gaps, (self.mouth, self.head), strict=True):
            gap[self.at(1, X)], gap[self.at(0, X)] = 1.0, -1.0
        for gap, k in zip(gaps, self.bushings or (), strict=False):
            K += k * np.outer(gap, gap)
        G[1] += gaps[1]
        G[:, 1] += gaps[1]
        return M, K, G

    def motions(self, *held):
        """Motions (columns) with some coordinates held; of a clamped rod those of one that is straight in the tube."""
        columns, gone = np.eye(len(self.matrices[0])), list(held)
        if self.bushings is None:
            mouth = self.at(0, self.mouth)
            for k, X in enumerate(self.places[1]):
                if X <= self.mouth + 1e-9:
                    i = self.at(1, X)
                    columns[i] = columns[mouth] + (X - self.mouth) * columns[mouth + 1]
                    columns[i + 1] = columns[mouth + 1]
                    element = self.nodes + INNER * (self.places[0].size - 1 + k)
                    gone += [i, i + 1, *(range(element, element + INNER) if X < self.mouth - 1e-9 else ())]
        return np.delete(columns, gone, axis=1)

    def _pinned(self):
        N = self.motions(0, self.nodes - 2)
        return [N.T @ X @ N for X in self.matrices]

    def frequencies(self, count):
        """Of the leg pinned at base and tip, stroke locked [rad/s]."""
        M, K, _ = self._pinned()
        return 1 / np.sqrt(
            eigh(M, K, eigvals_only=True)[: -count - 1 : -1]
        )  # the largest: the lowest keep their digits

    def buckling(self):
        """Least thrust between these pins [N]."""
        _, K, G = self._pinned()
        return 1 / eigh(G, K, eigvals_only=True)[-1]

    def softness(self):
        """Displacement and slope of the tip by a force and a moment there, the base joint held (2, 2)."""
        N = self.motions(0, 1)
        ends = N[self.nodes - 2 : self.nodes].T
        return ends.T @ np.linalg.solve(N.T @ self.matrices[1] @ N, ends)
