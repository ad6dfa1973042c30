"""A meshed beam at rest in its guide: shape under a tip force, frequencies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import cholesky, eigh

from flexapod.fem.beam_contact import Contact, band_solve, settle
from flexapod.fem.beam_guide import Guide
from flexapod.fem.beam_mesh import HALF_BAND, BeamMesh
from flexapod.typing import Array

__all__ = ["contact_at", "frozen_frequencies", "static_shape"]


def contact_at(mesh: BeamMesh, guide: Guide, length: float) -> Contact:
    """Contact when ``length`` [m] of the beam is outside."""
    return Contact.between(mesh, guide.springs(mesh, mesh.beam.length - length), guide.gap)


def static_shape(mesh: BeamMesh, guide: Guide, length: float, tip: float) -> Array:
    """Static shape (2 n + 2,) of the bare beam whose tip a force holds at ``tip`` [m]."""
    contact = contact_at(mesh, guide, length)
    tight = replace(contact, gap=0.0)
    force = np.zeros(mesh.unknowns)
    force[-2] = mesh.beam.EI / length**3
    shape = settle(tight, mesh.bending, force, force)
    shape = shape * (tip / shape[-2])
    if not guide.gap:
        return shape
    held, hold = mesh.bending.copy(), 1e6 * mesh.beam.EI / length**3
    held[HALF_BAND, -2] += hold
    force[-2] = hold * tip
    return settle(contact, held, force, shape)


def frozen_frequencies(mesh: BeamMesh, guide: Guide, length: float, count: int = 3) -> Array:
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
