"""The single actuator in space against the planar one, and its tip body against a rigid body in motion."""

import numpy as np
import pytest
from tests.helpers import legs_of_all_kinds as legs
from tests.oracles import chains
from tests.oracles.nonlinear import rotation

pytestmark = pytest.mark.consistency

NAMES = ("beta", "l", "a")


def positions(ours):
    return np.concatenate([np.arange(ours.index(x), ours.index(x) + dict(ours.layout)[x]) for x in NAMES])


@pytest.mark.parametrize("seed", range(5))
def test_in_a_plane_it_is_the_planar_one(seed):
    # alpha, b and the twist at rest: the rows of the plane are the same equations, rounding apart.
    flat, ours = legs.shapes("planar", axial=0), legs.shapes("tip body", axial=0)
    given = legs.numbers(seed)
    x = legs.state(flat, seed, 1e-2, given)
    y = legs.state(ours, seed, 1e-2, given) | {"load": np.zeros(12)}
    for name in ("q", "v", "v_dot"):
        y[name] = np.zeros(ours.size)
        y[name][positions(ours)] = x[name][positions(flat)]
    r, same = (legs.call(s, "leg_residual", z) for s, z in ((flat, x), (ours, y)))
    np.testing.assert_allclose(same["r"][positions(ours)], r["r"][positions(flat)], rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(same["tip"], r["tip"], rtol=1e-13)
    M, N = (legs.call(s, "leg_matrices", z)["M"] for s, z in ((flat, x), (ours, y)))
    at, there = positions(flat), positions(ours)
    np.testing.assert_allclose(N[np.ix_(there, there)], M[np.ix_(at, at)], rtol=1e-12, atol=1e-14)


def test_a_tip_body_moves_as_a_rigid_body_to_second_order():
    # Kinetic energy of the body alone: kernels with and without it. Its place and axes are functions of the coordinates
    # alone (a frame carried along the line), whose rates come from differences: 1e-9. The gap falls as the cube.
    ours, gaps = legs.shapes("tip body"), []
    body = ("tip_mass", "tip_inertia", "tip_axial_inertia")
    for amplitude in (8e-3, 8e-4):
        given = legs.numbers(7)
        x = legs.state(ours, 7, amplitude, given)
        x["v"][ours.index("c") : ours.index("t")] /= 10
        bare = x | {"p": legs.parameters(ours, given | dict.fromkeys(body, 0.0))}
        T = legs.call(ours, "leg_energies", x)["energies"][0] - legs.call(ours, "leg_energies", bare)["energies"][0]
        q, v = legs.pieces(ours, x["q"]), legs.pieces(ours, x["v"])

        def axes(h, q=q, v=v, given=given):
            now = chains.moved(q, v, h)
            return rotation(now["alpha"], now["beta"]) @ chains.tip_axes(now, given, ours.beam.a.values)

        def place(h, q=q, v=v, given=given):
            numbers = {name: given[name] for name in ("base", "R0", "mouth", "Lp")}
            return np.real(chains.place(chains.moved(q, v, h), 0.0, numbers, ours.beam.a.values))

        h = 1e-3
        W = axes(0.0).T @ (8 * (axes(h) - axes(-h)) - axes(2 * h) + axes(-2 * h)) / (12 * h)
        u = (8 * (place(h) - place(-h)) - place(2 * h) + place(-2 * h)) / (12 * h)
        w = np.array([W[2, 1], W[0, 2], W[1, 0]])
        inertia = np.array([given["tip_inertia"], given["tip_inertia"], given["tip_axial_inertia"]])
        gaps.append(abs(T - 0.5 * given["tip_mass"] * u @ u - 0.5 * inertia @ w**2))
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.3)
