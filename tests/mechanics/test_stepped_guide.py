"""Pistons of several sections in two bushings: equal sections, exact beams, moments and turns."""

import numpy as np
import pytest
from scipy.linalg import expm
from tests.helpers.machines import machine
from tests.helpers.stepped import (
    function,
    leg_of,
    root_near,
    section,
    shapes_of,
    squared_frequencies,
    steps_of,
    thrust_of_shapes,
    vector,
)

from flexapod.common.errors import InputError
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import MATERIALS, Cylinder, Guide, Piston
from flexapod.model.leg.material import Tube

pytestmark = pytest.mark.consistency

BUSHINGS = Guide(gland=4e6, head=3e6)
FREE, MOUTH = 0.6, 0.4


def guided(sections, **more):
    """A leg in bushings, and the shapes of its kernel."""
    return leg_of(sections, guide=BUSHINGS, **more), lateral_basis("tip-load", 3)


def test_equal_sections_are_a_uniform_guided_piston():
    # A cut outside and a cut inside; everything moves: other sums of the same integrals, to rounding
    one, inner = guided([section(0.9, 0.03)])
    cut, _ = guided([section(0.15, 0.03), section(0.35, 0.03), section(0.4, 0.03)])
    uniform = one.replace(piston=one.piston.replace(sections=()))
    rng = np.random.default_rng(5)
    found = []
    for leg, sections in ((cut, 3), (uniform, 0)):
        shapes = shapes_of(3, 2, sections, guide=inner)
        if not found:
            q, v = 1e-3 * rng.uniform(-1, 1, shapes.size), rng.uniform(-1, 1, shapes.size)
            q[:3] = 0.3, -0.2, MOUTH + FREE
        p = vector(leg, shapes, MOUTH + FREE)
        residual = function(shapes, 0)(q, v, v[::-1], np.array([3.0, -5.0, 800.0]), np.zeros(2), p)
        found.append([*residual[:1], *function(shapes, 2)(q, v, np.zeros(2), p)])
    for ours, theirs in zip(*found, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-9 * float(np.abs(theirs).max()))


def misfit(leg, omega=0.0, thrust=0.0, direction=0):
    """Determinant of a stepped beam in two bushings of a rigid cylinder, pinned at the tip, by transfer matrices."""
    k_g, k_h, head = leg.guide.gland, leg.guide.head, MOUTH + FREE - leg.piston.length
    J = leg.cylinder.inertia + leg.cylinder.mass * leg.cylinder.com**2
    # columns: deflection and slope of the head, angle of the cylinder; the thrust acts along this at the head
    state = np.zeros((4, 3))
    state[0, 0] = state[1, 1] = 1.0
    gap_head = np.array([1.0, 0.0, -head])
    state[3] = -k_h * gap_head + thrust * np.array([0.0, 0.0, 1.0])
    at, cylinder = head, -k_h * head * gap_head
    cylinder = cylinder + np.array([-thrust, 0.0, thrust * head - omega**2 * J])
    for step in steps_of(leg)[::-1]:
        for low, high in ((at, min(at + step.length, MOUTH)), (max(at, MOUTH), at + step.length)):
            A = np.zeros((4, 4))
            A[0, 1], A[1, 2], A[2, 1], A[2, 3], A[3, 0] = 1, 1 / step.EI[direction], -thrust, 1, step.rhoA * omega**2
            if high > low:
                state = expm(A * (high - low)) @ state
            if high == MOUTH and low < MOUTH:
                gap = state[0] - np.array([0.0, 0.0, MOUTH])
                state[3] -= k_g * gap
                cylinder = cylinder - k_g * MOUTH * gap
        at += step.length
    whole = np.array([state[0], state[2], cylinder])
    return np.linalg.det(whole / np.abs(whole).max(axis=1)[:, None])


@pytest.mark.parametrize("sections", [
    [section(0.37, 0.04), section(0.35, 0.03)],  # overlap of a fifth of the free length, the cut outside
    [section(0.06, 0.04), section(0.66, 0.03)],  # the cut between the bushings
    [section(0.5, 0.04), section(0.4, 0.03)],  # overlap of half of it
    [section(0.9, 0.035, inner_diameter=0.02)],
])  # fmt: skip
def test_stepped_pistons_in_two_bushings(sections):
    leg, inner = guided(sections)
    found = np.sqrt(squared_frequencies(leg, FREE, guide=inner)[::2][:2])
    np.testing.assert_allclose(found, [root_near(lambda w: misfit(leg, w), x) for x in found], rtol=1e-6)
    load = thrust_of_shapes(leg, FREE, guide=inner)
    assert load == pytest.approx(root_near(lambda P: misfit(leg, thrust=P), load), rel=1e-6)


def test_cuts_between_bushings_that_overlap_by_half():
    # The shapes inside are three: their loads are by mass alone, and one is missing where a thrust loads them.
    leg, inner = guided([section(0.2, 0.04), section(0.7, 0.03)])
    load = thrust_of_shapes(leg, FREE, guide=inner)
    assert load == pytest.approx(root_near(lambda P: misfit(leg, thrust=P), load), rel=2e-6)


def test_strips_in_bushings_bend_in_each_plane_with_their_own_stiffness():
    # The cut between the bushings. The softer plane buckles.
    leg, inner = guided([section(0.06, width=0.06, thickness=0.03), section(0.66, width=0.04, thickness=0.02)])
    both = {"strips": True, "guide": inner}
    found = np.sqrt(squared_frequencies(leg, FREE, 5, **both)[:4])
    planes = 1, 0, 1, 0
    exact = [root_near(lambda w, k=k: misfit(leg, w, direction=k), x) for x, k in zip(found, planes, strict=True)]
    np.testing.assert_allclose(found, exact, rtol=1e-6)
    load = thrust_of_shapes(leg, FREE, 5, **both)
    assert load == pytest.approx(root_near(lambda P: misfit(leg, thrust=P, direction=1), load), rel=1e-6)


@pytest.mark.parametrize(("part", "key"), [
    ({"guide": BUSHINGS}, "guide"),
    ({"cylinder": Cylinder.tube(mouth=0.6, section=Tube(diameter=0.09), material=MATERIALS["steel"])}, "diameter"),
])  # fmt: skip
def test_thick_pistons_in_what_gives_way_are_refused(part, key):
    piston = Piston.stepped([section(0.75, 0.06)]).replace(shear=True)
    with pytest.raises(InputError, match=rf"leg\..*{key}.*does not go together with pistons that shear"):
        machine(piston=piston, **part)
