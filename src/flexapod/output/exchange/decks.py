"""Decks: finite element models as text for Abaqus and CalculiX; those of a clamped solid beam.

Every keyword here means the same to both programs: solid elements, point masses, axial springs, linear
equations between displacements. Rotations, beam sections and rigid bodies differ between them and do not occur.
"""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space, qr

from flexapod.common.arrays import Array
from flexapod.solve.fem.hexahedra import SolidMesh

Numbers = NDArray[np.int64]
"""Numbers of nodes or elements."""

Term = tuple[int, int]
"""A displacement: the number of a node, and its direction 1, 2 or 3 along the world's x, y, z."""

_WIDTH = 110
_ENTRIES = 8  # numbers in a line; both programs take 16
_TERMS = 4  # terms of an equation in a line


class Deck:
    """A deck that grows: nodes and elements are numbered from 1 as they are added."""

    def __init__(self, title: str) -> None:
        self._lines = ["*HEADING", title]
        self._nodes = self._elements = 0
        self._heavy: list[str] = []

    @property
    def text(self) -> str:
        """The deck so far."""
        return "\n".join(self._lines) + "\n"

    @property
    def mass_sets(self) -> tuple[str, ...]:
        """Names of all sets of elements that have mass."""
        return tuple(self._heavy)

    def comment(self, *paragraphs: str) -> None:
        """Comments, a paragraph each, wrapped."""
        for words in paragraphs:
            self._lines += [f"** {line}".rstrip() for line in textwrap.wrap(words, _WIDTH) or [""]]

    def write(self, *lines: str) -> None:
        """Lines as they are."""
        self._lines += lines

    def nodes(self, points: Array, name: str) -> Numbers:
        """Nodes at `points` (n, 3) or (3,) [m] as the set `name`; their numbers (n,)."""
        first, points = self._nodes + 1, np.atleast_2d(points)
        self._nodes += len(points)
        self.write(f"*NODE, NSET={name}")
        self.write(*(f"{i}, {number(x)}, {number(y)}, {number(z)}" for i, (x, y, z) in enumerate(points, first)))
        return np.arange(first, self._nodes + 1)

    def elements(self, kind: str, connectivity: Numbers, name: str) -> None:
        """Elements of a `kind`, on nodes (n, k) in the order that both programs share, as the set `name`."""
        first = self._elements + 1
        self._elements += len(connectivity)
        self.write(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for i, row in enumerate(connectivity, first):
            self._lines += _wrapped([str(i), *map(str, row)])

    def solid_section(self, name: str, *, E: float, density: float, poisson: float = 0.0) -> None:
        """Material and section of the solid elements `name`: Young's modulus [Pa], density [kg/m^3]."""
        self._heavy.append(name)
        self.write(f"*MATERIAL, NAME={name}", "*ELASTIC", f"{number(E)}, {number(poisson)}")
        self.write("*DENSITY", number(density), f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")

    def mass(self, nodes: Iterable[int], mass: float, name: str) -> None:
        """A point mass [kg] on each of some nodes."""
        self._heavy.append(name)
        self.elements("MASS", np.array([[node] for node in nodes]), name)
        self.write(f"*MASS, ELSET={name}", number(mass))

    def springs(self, pairs: Sequence[tuple[int, int]], stiffness: float, name: str) -> None:
        """A spring [N/m] along the line of each pair of nodes."""
        self.elements("SPRINGA", np.array(pairs), name)
        self.write(f"*SPRING, ELSET={name}", "", number(stiffness))

    def ground_spring(self, node: int, stiffness: float, name: str) -> None:
        """A spring [N/m] on the displacement of a node along x."""
        self.elements("SPRING1", np.array([[node]]), name)
        self.write(f"*SPRING, ELSET={name}", "1", number(stiffness))

    def fix_nodes(self, nodes: Iterable[int]) -> None:
        """Nodes that do not move."""
        self.write("*BOUNDARY", *(f"{node}, 1, 3" for node in nodes))

    def elset(self, name: str, sets: Iterable[str]) -> None:
        """A set of the elements of other sets."""
        self.write(f"*ELSET, ELSET={name}", *_wrapped(list(sets)))

    def nset(self, name: str, nodes: Iterable[int]) -> None:
        """A set of nodes."""
        self.write(f"*NSET, NSET={name}", *_wrapped([str(node) for node in nodes]))

    def equations(self, dependent: Mapping[Term, Mapping[Term, float]]) -> None:
        """Displacements that follow from others: ``dependent[a] = {b: factor}`` says u_a = sum factor u_b."""
        for (node, axis), others in dependent.items():
            terms = [(node, axis, -1.0), *((n, i, factor) for (n, i), factor in others.items())]
            self.write("*EQUATION", str(len(terms)))
            pieces = [f"{n}, {i}, {number(factor)}" for n, i, factor in terms]
            self.write(*(", ".join(pieces[k : k + _TERMS]) for k in range(0, len(pieces), _TERMS)))


def number(value: float) -> str:
    """A number as both programs read it: at most 20 characters, no minus zero, and a point.

    Without a point CalculiX takes the stiffness of a spring for a direction.
    """
    mantissa, exponent, power = f"{float(value) + 0.0:.12G}".partition("E")
    return f"{mantissa if '.' in mantissa else mantissa + '.'}{exponent}{power}"


def _wrapped(entries: Sequence[str]) -> list[str]:
    rows = [", ".join(entries[k : k + _ENTRIES]) for k in range(0, len(entries), _ENTRIES)]
    return [f"{row}," for row in rows[:-1]] + rows[-1:]


_NOTHING = 1e-12  # a factor below this is rounding: factors are ratios of lengths


@dataclass(frozen=True, kw_only=True)
class Tie:
    """Displacements that share a few unknown motions q: ``rows @ u[terms] = motion @ q``.

    `terms`: (n,) displacements; `rows` (m, n) and `motion` (m, k) of like size in every row.
    """

    terms: tuple[Term, ...]
    rows: Array
    motion: Array


def cross_matrix(r: Array) -> Array:
    """The matrix of ``theta -> theta x r``, shape (3, 3)."""
    x, y, z = r
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def dependent_displacements(ties: Sequence[Tie], keep: Collection[Term] = ()) -> dict[Term, dict[Term, float]]:
    """The ties without their q, solved for as many displacements as they determine: ``{a: {b: factor}}``.

    No a is a b. Ties are independent, each with an unknown motion of its own; those in `keep` are not solved for.
    """
    terms = sorted({term for tie in ties for term in tie.terms})
    place = {term: i for i, term in enumerate(terms)}
    blocks = []
    for tie in ties:
        rows = np.zeros((len(tie.rows), len(terms)))
        rows[:, [place[term] for term in tie.terms]] = tie.rows
        blocks.append(null_space(tie.motion.T).T @ rows if tie.motion.shape[1] else rows)
    C = np.vstack(blocks)
    loose = np.array([i for i, term in enumerate(terms) if term not in set(keep)])
    order = qr(C[:, loose], mode="r", pivoting=True)[-1]
    chosen = np.sort(loose[order[: len(C)]])
    others = np.setdiff1d(np.arange(len(terms)), chosen)
    factors = -np.linalg.solve(C[:, chosen], C[:, others])
    return {
        terms[a]: {terms[others[j]]: float(row[j]) for j in np.flatnonzero(np.abs(row) > _NOTHING)}
        for a, row in zip(chosen, factors, strict=True)
    }


#: The element of both programs for a kind of ours; R: integrated at 2 x 2 x 2 points.
ELEMENTS = {
    ("hex8", False): "C3D8",
    ("hex8r", False): "C3D8R",
    ("hex8i", False): "C3D8I",
    ("hex20", False): "C3D20",
    ("hex20", True): "C3D20R",
}


def clamped_frequencies(mesh: SolidMesh, *, E: float, density: float, poisson: float, reduced: bool) -> str:
    """Deck for the lowest six frequencies of a solid whose end x = 0 is clamped at all nodes.

    `mesh` is of the whole section; `E` [Pa], `density` [kg/m^3]; `reduced`: reduced integration, of quadratic elements.
    """
    deck, _ = _clamped(mesh, E, density, poisson, reduced)
    deck.write("*STEP", "*FREQUENCY", "6", "*END STEP")
    return deck.text


def clamped_release(mesh: SolidMesh, *, E: float, density: float, force: float, duration: float, step: float) -> str:
    """Deck for the static shape under a `force` [N] along y on the end, then free vibration from rest.

    The force is shared by the nodes of the end face alike, which at Poisson's ratio 0 only moves it within the section.
    The average acceleration method (ALPHA = 0) keeps the energy. Displacements of set TIP are printed at every step.
    `duration`, `step` [s].
    """
    deck, tip = _clamped(mesh, E, density, 0.0, False)
    share = [f"{node}, 2, {number(force / len(tip))}" for node in tip]
    deck.write("*STEP", "*STATIC", "*CLOAD", *share, "*NODE PRINT, NSET=TIP", "U")
    deck.write("*EL PRINT, ELSET=BODY, TOTALS=ONLY", "ELSE", "*END STEP")  # CalculiX wants the energy from the start
    deck.write(
        f"*STEP, INC={2 * round(duration / step)}", "*DYNAMIC, DIRECT, ALPHA=0.", f"{number(step)}, {number(duration)}"
    )
    deck.write("*CLOAD, OP=NEW", *(f"{node}, 2, 0." for node in tip), "*NODE PRINT, NSET=TIP", "U", "*END STEP")
    return deck.text


def _clamped(mesh: SolidMesh, E: float, density: float, poisson: float, reduced: bool) -> tuple[Deck, Numbers]:
    """The beam without steps, and the nodes at its end."""
    deck = Deck("Clamped beam")
    deck.comment("Written by flexapod. Units: m, kg, s, N, Pa, Hz. Along x, clamped at x = 0.")
    nodes = deck.nodes(mesh.nodes, "BEAM")
    deck.elements(ELEMENTS[mesh.kind, reduced], nodes[mesh.elements.astype(np.int64)], "BODY")
    deck.solid_section("BODY", E=E, density=density, poisson=poisson)
    deck.fix_nodes(nodes[mesh.plane(0).astype(np.int64)])
    tip = nodes[mesh.plane(1).astype(np.int64)]
    deck.nset("TIP", tip)
    return deck, tip
