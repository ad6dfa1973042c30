"""Contact of a meshed beam with its guide by a convex minimisation, Eq. (T11.5), and the beam at rest in it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh, solveh_banded

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.solve.fem.beam_guide import GuideContact, Springs
from flexapod.solve.fem.beam_mesh import HALF_BAND, BeamMesh, band_product

#: Newton's steps for one equilibrium, and halvings of one of them, after which it is given up.
MOST_STEPS, MOST_HALVINGS = 200, 40
#: Share of the springs that joins the matrix (not the residual) where the beam floats in its gap.
CENTRING = 1e-14


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Springs of a guide on a mesh at one instant; `gap` [m] on either side of the guide's axis."""

    mesh: BeamMesh
    springs: Springs
    gap: float
    rows: Array = field(repr=False)

    @classmethod
    def from_springs(cls, mesh: BeamMesh, springs: Springs, gap: float) -> Contact:
        """Contact with the springs' rows, (P, 4), evaluated once."""
        return cls(mesh=mesh, springs=springs, gap=gap, rows=mesh.rows(springs.local, springs.order))

    def matrix(self, touching: Mask | None = None) -> Array:
        """Band matrix of the springs, or of those ``touching`` (P,)."""
        stiffness = self.springs.stiffness if touching is None else np.where(touching, self.springs.stiffness, 0.0)
        products = stiffness[:, None, None] * self.rows[:, :, None] * self.rows[:, None, :]
        return self.mesh.assemble_band(self.springs.element, products)

    def penetration(self, u: Array) -> Array:
        """Signed distance of each point beyond the gap [m], (P,); 0 within."""
        nodes = 2 * self.springs.element[:, None] + np.arange(4, dtype=int)
        offset = (self.rows * u[nodes]).sum(axis=1)
        return np.sign(offset) * np.maximum(np.abs(offset) - self.gap, 0.0)

    def force(self, u: Array) -> Array:
        """Force of the springs on the unknowns, (N,): towards the axis."""
        push = -self.springs.stiffness * self.penetration(u)
        return self.mesh.assemble_vector(self.springs.element, push[:, None] * self.rows)


def solve_contact(contact: Contact, stiffness: Array, load: Array, u: Array) -> Array:
    """State (N,) with ``stiffness`` u = ``load`` + force of the contact, from the guess ``u``.

    The minimum of a convex function of pieces that are quadratic: Newton's method with halved steps ends on the piece
    of the solution, where a whole step is exact. ComputationError: it does not end, or the matrix is not positive
    definite.
    """
    if not contact.gap:
        return band_solve(stiffness + contact.matrix(), load)
    centring = CENTRING * contact.matrix()

    def energy(x: Array) -> float:
        springs = contact.springs.stiffness @ contact.penetration(x) ** 2
        return float(0.5 * (x @ band_product(stiffness, x) + springs) - load @ x)

    for _ in range(MOST_STEPS):
        touching = contact.penetration(u) != 0
        force = load - band_product(stiffness, u) + contact.force(u)
        change = band_solve(stiffness + contact.matrix(touching) + centring, force)
        fall, start = force @ change, energy(u)
        share = 1.0
        rounding = 1e-12 * abs(start)
        while energy(u + share * change) > start + rounding - 1e-4 * share * fall and share > 2.0**-MOST_HALVINGS:
            share /= 2
        u = u + share * change
        if share == 1.0 and ((contact.penetration(u) != 0) == touching).all():
            return u
        if fall <= 1e-13 * abs(start):  # points that barely touch change sides by rounding
            return u
    raise ComputationError("contact with the guide does not settle", next_step="Take a softer guide, or no gap.")


def band_solve(band: Array, load: Array) -> Array:
    """Solution of a symmetric positive definite system in upper band form."""
    try:
        return np.asarray(solveh_banded(band, load, check_finite=False))
    except LinAlgError as error:
        raise ComputationError(
            "the matrix of the meshed beam is not positive definite",
            next_step="Take a smaller step or a less stiff guide; a beam that spins this fast may be unstable.",
        ) from error


def contact_at(mesh: BeamMesh, guide: GuideContact, length: float) -> Contact:
    """Contact when ``length`` [m] of the beam is outside."""
    return Contact.from_springs(mesh, guide.springs(mesh, mesh.beam.length - length), guide.gap)


def static_shape(mesh: BeamMesh, guide: GuideContact, length: float, tip: float) -> Array:
    """Static shape (2 n + 2,) of the bare beam whose tip a force holds at ``tip`` [m]."""
    contact = contact_at(mesh, guide, length)
    tight = replace(contact, gap=0.0)
    force = np.zeros(mesh.unknowns)
    force[-2] = mesh.beam.EI / length**3
    shape = solve_contact(tight, mesh.bending, force, force)
    shape = shape * (tip / shape[-2])
    if not guide.gap:
        return shape
    held, hold = mesh.bending.copy(), 1e6 * mesh.beam.EI / length**3
    held[HALF_BAND, -2] += hold
    force[-2] = hold * tip
    return solve_contact(contact, held, force, shape)


def frozen_frequencies(mesh: BeamMesh, guide: GuideContact, length: float, count: int = 3) -> Array:
    """Lowest frequencies [Hz] of the beam at rest with ``length`` [m] outside a guide without gap, (count,)."""
    K = mesh.bending + contact_at(mesh, guide, length).matrix()
    # Largest values of the flexibility: the small ones of the stiffness drown in the rounding of its stiff springs.
    half = cholesky(_full(mesh.mass), lower=True)
    flexibility = half.T @ band_solve(K, half)
    last = mesh.unknowns - 1
    values = eigh(flexibility, eigvals_only=True, subset_by_index=(last - count + 1, last))
    return 1 / (2 * np.pi * np.sqrt(values[::-1]))


def _full(band: Array) -> Array:
    upper = sum(np.diag(band[HALF_BAND - d, d:], d) for d in range(HALF_BAND + 1))
    return np.asarray(upper + np.triu(upper, 1).T)
