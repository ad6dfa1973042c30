"""One leg between ideal, welded and loaded ends against closed forms: compliance, buckling, flutter."""

import numpy as np
import pytest
from scipy.linalg import eig, null_space
from tests.helpers import legs_of_all_kinds as legs
from tests.helpers.layouts import layout

from flexapod.mechanics.shapes import axial_basis, lateral_basis

pytestmark = pytest.mark.analytic

EI, LENGTH = 5217.4, 0.435
HOME = dict.fromkeys(("base_stiffness", "gamma_stiffness", "gravity", "joint", "base", "gamma_home"), np.zeros(3))
FRAMES = dict.fromkeys(("R0", "platform_frame", "leg_frame"), np.eye(3))


def leg(closure, modes, axial=0, **switches):
    lateral = lateral_basis("tip-load", modes, moment=closure != "point")
    more = switches | ({"tip_body": True} if closure == "none" else {})
    return layout(a=lateral, b=lateral, axial=axial_basis(axial), closure=closure, torsion=closure != "point", **more)


def matrices(ours, lam=(), load=(), moving=("a", "b", "c", "t"), **changed):
    """Matrices of the upright leg whose payload sits at its tip, by the amplitudes alone: joints and drive are held."""
    given = legs.numbers(1, **HOME, **FRAMES, **changed)
    x = legs.state(ours, 1, 0.0, given)
    x["q"][:] = 0.0
    x["q"][ours.l_index] = given["mouth"] + LENGTH
    x["pose"] = np.array([0.0, 0.0, given["mouth"] + LENGTH, 1.0, 0.0, 0.0, 0.0])
    x["lam"], x["load"] = np.resize(lam, ours.rows) if len(lam) else np.zeros(ours.rows), np.array(load or 12 * [0.0])
    found = legs.call(ours, "leg_matrices", x)
    names = [name for name, size in ours.layout for _ in range(size)]
    kept = [i for i, name in enumerate(names) if name in moving]
    return found["K"][np.ix_(kept, kept)], found["J"][:, kept], found["M"][np.ix_(kept, kept)]


def first_load(ours, lam, rows):
    """Smallest load factor at which the leg is unstable whose tip is held in the given rows of the closure."""
    K, J, _ = matrices(ours)
    Kg = matrices(ours, lam)[0] - K
    free = null_space(J[list(rows)])
    values = eig(-free.T @ Kg @ free, free.T @ K @ free, right=False).real
    return 1 / values.max()


@pytest.mark.parametrize("modes", [2, 3, 5])
def test_the_tip_gives_way_to_forces_and_moments_as_a_cantilever(modes):
    # Beam, bar and shaft formulas; two shapes in a plane contain them, so that rounding is all that is left.
    ours = leg("pose", modes, axial=1)
    K, J, _ = matrices(ours)
    C = J @ np.linalg.solve(K, J.T)
    p, s, L = legs.PHYSICS, LENGTH, legs.PHYSICS["L_c"]
    bending = np.array([[s**3 / 3, L * s**2 / 2], [L * s**2 / 2, L**2 * s]]) / EI
    np.testing.assert_allclose(C[np.ix_([0, 4], [0, 4])], bending, rtol=1e-11)  # force along x turns about +y
    np.testing.assert_allclose(C[np.ix_([1, 3], [1, 3])], bending * [[1, -1], [-1, 1]], rtol=1e-11)
    np.testing.assert_allclose([C[2, 2], C[5, 5]], [p["Lp"] / p["EA"], L**2 * p["Lp"] / p["GJ"]], rtol=1e-12)


def test_flexures_at_both_ends_are_in_series_with_the_leg():
    # Compliances add; that of the base as seen from the tip, a lever of the leg's whole length away.
    ours = leg("pose", 2, axial=1, spin=True, flexure=True)
    K, J, _ = matrices(ours)
    ends = ("u1", "u2", "u3", "alpha", "beta", "spin", "e1", "e2", "e3", "gamma1", "gamma2", "gamma3")
    K_all, J_all, _ = matrices(ours, moving=("a", "b", "c", "t", *ends))
    length = legs.PHYSICS["mouth"] + LENGTH
    lever = np.eye(6)
    lever[0, 4], lever[1, 3] = length, -length
    scale = np.diag([1.0, 1.0, 1.0, *3 * [legs.PHYSICS["L_c"]]])
    seen = zip((scale @ lever, scale), ("base_flexure", "platform_flexure"), strict=True)
    expected = J @ np.linalg.solve(K, J.T) + sum(A @ np.linalg.inv(legs.PHYSICS[name]) @ A.T for A, name in seen)
    np.testing.assert_allclose(
        J_all @ np.linalg.solve(K_all, J_all.T), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
    )


@pytest.mark.parametrize(("closure", "rows", "factor"), [
    ("pose", (), np.pi**2 / 4), ("pose", (3, 4), np.pi**2), ("point", (0, 1), 20.190728556427),
    ("pose", (0, 1), 20.190728556427), ("pose", (0, 1, 3, 4), 4 * np.pi**2),
], ids=["free", "turns not", "ball", "pinned", "welded"])  # fmt: skip
def test_buckling_loads_of_the_ends(closure, rows, factor):
    # Euler's cases (Timoshenko & Gere, Theory of Elastic Stability, sec. 2.1); twelve polynomials know them to 1e-8.
    lam = (0.0, 0.0, 1.0) if closure == "point" else (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    assert first_load(leg(closure, 12), lam, rows) == pytest.approx(factor * EI / LENGTH**2, rel=1e-8)


def test_buckling_torque_of_a_welded_leg():
    # Greenhill's shaft with both ends held in place and attitude: tan x = x, torque 2 x EI / s (Ziegler, Principles of
    # Structural Stability, ch. 4). Only the second-order turn of the tip by bending in two planes knows of it.
    torque = first_load(leg("pose", 12), (0.0, 0.0, 0.0, 0.0, 0.0, 1.0 / legs.PHYSICS["L_c"]), (0, 1, 3, 4))
    assert torque == pytest.approx(2 * 4.493409457909064 * EI / LENGTH, rel=1e-8)


@pytest.mark.parametrize(("follows", "stable", "unstable"), [(False, 2.46, 2.475), (True, 20.04, 20.06)])
def test_a_thrust_on_a_free_tip_buckles_a_cantilever_or_makes_it_flutter(follows, stable, unstable):
    # Thrust pi^2/4 = 2.467 that keeps its direction: divergence. That follows the tip: flutter at 20.05 (Beck 1952).
    bare = {"tip_mass": 0.0, "tip_inertia": 0.0, "tip_axial_inertia": 0.0, "Lp": LENGTH}
    ours = leg("none", 6)

    def growth(factor):
        load = np.zeros(12)
        load[8 if follows else 2] = -factor * EI / LENGTH**2
        K, _, M = matrices(ours, load=tuple(load), **bare)
        roots = np.sqrt(eig(-K, M, right=False).astype(complex))  # motions exp(root t) and exp(-root t)
        return np.abs(roots.real).max() / np.abs(roots).max()

    assert growth(stable) < 1e-6 < 1e-4 < growth(unstable)
