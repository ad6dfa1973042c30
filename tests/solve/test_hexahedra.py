"""Single distorted hexahedra of every kind: rigid motions, definiteness, patch test."""

from dataclasses import replace

import numpy as np
import pytest

from flexapod.model import Rectangle
from flexapod.solve.fem.hexahedra import beam_mesh, element_stiffness, integrals, stiffness

pytestmark = pytest.mark.analytic

LINEAR = ["hex8", "hex8r", "hex8i"]
E, POISSON = 2.0, 0.3


def distorted(kind, layers=1):
    """A bar of layers by 2 by 2 elements; its inner nodes moved about, edges straight."""
    mesh = beam_mesh(Rectangle(width=1.0, height=1.0), float(layers), 0.5 if layers > 1 else 1.0, kind=kind)
    rng = np.random.default_rng(7)
    moved = mesh.nodes.copy()
    inside = (moved[:, 0] > 1e-9) & (moved[:, 0] < layers - 1e-9) & (np.abs(moved[:, 1:]) < 0.5 - 1e-9).all(axis=1)
    if layers == 1:
        inside[:] = True
    corner = np.isin(np.arange(len(moved)), mesh.elements[:, :8])
    moved[inside & corner] += 0.08 * rng.normal(size=(int((inside & corner).sum()), 3))
    return replace(mesh, nodes=moved), inside


@pytest.mark.parametrize("kind", LINEAR)
def test_six_motions_cost_nothing_and_no_other(kind):
    mesh, _ = distorted(kind)
    K = element_stiffness(integrals(mesh), E, POISSON)[0].reshape(24, 24)
    energy = np.linalg.eigvalsh(K)
    # Rounding of a sum of 1e2 products; the weakest hourglass has r G / E = 0.2 % of a stretch, over norms of it.
    np.testing.assert_allclose(energy[:6], 0, atol=1e-14 * energy[-1] * 100)
    assert energy[6] > 1e-5 * energy[-1]
    np.testing.assert_allclose(K, K.T, atol=1e-14 * energy[-1])


@pytest.mark.parametrize("kind", LINEAR)
def test_patch_test(kind):
    """Any linear displacement is in balance at the nodes inside a distorted mesh, and has the energy of its strain."""
    mesh, inside = distorted(kind, layers=2)
    assert inside.sum() >= 3
    parts = integrals(mesh)
    gradient = np.random.default_rng(3).normal(size=(3, 3))
    u = (mesh.nodes @ gradient.T).ravel()
    force = (stiffness(parts, E, POISSON) @ u).reshape(-1, 3)
    np.testing.assert_allclose(force[inside], 0, atol=1e-12 * np.abs(force).max())
    strain = 0.5 * (gradient + gradient.T)
    lame, shear = E * POISSON / (1.3 * 0.4), E / 2.6
    energy = 0.5 * lame * np.trace(strain) ** 2 + shear * (strain**2).sum()
    assert 0.5 * u @ force.ravel() == pytest.approx(energy * 2.0, rel=1e-12)
