"""Legs with stepped pistons, and what is exact of them, by transfer matrices and by material points."""

from functools import lru_cache

import numpy as np
from scipy.linalg import eigh, expm, null_space
from scipy.optimize import brentq
from tests.helpers.layouts import layout

from flexapod.mechanics.leg.kernel_functions import leg_functions
from flexapod.mechanics.leg.layout import leg_parameters
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.mechanics.symbolic.functions import Interpreted
from flexapod.model import Cylinder, Leg, Piston, PistonSection
from flexapod.solve.parameters import _inside, _leg
from flexapod.solve.sections import section_parameters

STEEL = {"E": 200e9, "density": 7800.0}


def section(length, diameter=None, **others):
    return PistonSection(length=length, diameter=diameter, **STEEL, **others)


def leg_of(sections, mouth=0.4, mass=5.0, **others):
    """A leg whose cylinder is a uniform rod up to its mouth."""
    cylinder = Cylinder(mass=mass, mouth=mouth, com=mouth / 2, inertia=mass * mouth**2 / 12)
    return Leg(piston=Piston.stepped(sections), cylinder=cylinder, **others)


def vector(leg, shapes, home):
    """Its parameters as kernels read them; length at home [m]."""
    values = {"R0": np.eye(3).ravel(), "gravity": np.zeros(3), "base": np.zeros(3)}
    values |= (
        (_inside(leg, 0.0) if shapes.beam.guide or shapes.beam.cylinder else {})
        | _leg(leg, at_rest=False)
        | (section_parameters(leg, shapes.beam, home) if shapes.beam.sections else {})
    )
    return np.concatenate([np.ravel(values[name]) for name, _ in leg_parameters(shapes)])


def shapes_of(modes, axial, sections, **others):
    lateral = lateral_basis("tip-load", modes)
    return layout(a=lateral, b=lateral, axial=axial_basis(axial), sections=sections, **others)


@lru_cache(maxsize=16)
def function(shapes, which):
    """Residual (0), matrices at rest (1) or energies (2) of a leg, interpreted."""
    return Interpreted(leg_functions(shapes)[which])


@lru_cache(maxsize=16)
def _shapes(*arguments, **others):
    return shapes_of(*arguments, **others)


def pinned(leg, free, modes=6, thrust=0.0, **others):
    """M and K of a leg at rest under a thrust with its stroke locked and its tip pinned, both planes."""
    tapers = any(s.tapered for s in leg.piston.sections)
    count = max(len(leg.piston.sections), 2)  # one kernel for all of them
    shapes = _shapes(modes, 0, count, tapers=tapers, **others)
    length, unit = leg.cylinder.mouth + free, np.eye(shapes.size)
    inputs = length * unit[2], np.array([0.0, 0.0, thrust]), vector(leg, shapes, length)
    M, _, K, J = function(shapes, 1)(*inputs)
    N = null_space(np.vstack([unit[2], J]))
    return N.T @ M @ N, N.T @ K @ N


def squared_frequencies(leg, free, *arguments, **others):
    """omega^2 of a pinned leg."""
    M, K = pinned(leg, free, *arguments, **others)
    return eigh(K, M, eigvals_only=True)


def thrust_of_shapes(leg, free, *arguments, **others):
    """The thrust at which a pinned leg has no stiffness left [N]."""
    K = pinned(leg, free, *arguments, **others)[1]
    less = K - pinned(leg, free, *arguments, thrust=1.0, **others)[1]
    return 1 / eigh(less, K, eigvals_only=True)[-1]


def steps_of(leg):
    """Uniform pieces of a piston from the tip to the driven end."""
    return leg.piston.steps_or_one[::-1]


def outside(leg, free):
    """(length, step) of the pieces outside the cylinder, from mouth to tip; inertia of the rest about the joint."""
    found, start, tip, mouth = [], 0.0, leg.cylinder.mouth + free, leg.cylinder.mouth
    inertia = leg.cylinder.inertia + leg.cylinder.mass * leg.cylinder.com**2
    for step in steps_of(leg):
        out = min(max(free - start, 0.0), step.length)
        if out > 0:
            found.append((out, step))
        near, far = tip - start - step.length, min(tip - start, mouth)
        inertia += step.rhoA * max(far**3 - near**3, 0.0) / 3
        start += step.length
    return found[::-1], inertia


def misfit(leg, free, omega=0.0, thrust=0.0, direction=1):
    """Vanishes at frequencies and buckling loads of the leg: joint pinned, rigid to the mouth, tip pinned."""
    pieces, inertia = outside(leg, free)
    mouth = leg.cylinder.mouth
    # state: deflection, slope, moment, force across; unknown at the joint: slope, force
    ends = []
    for slope, force in ((1.0, 0.0), (0.0, 1.0)):
        moment = force * mouth - thrust * mouth * slope - inertia * omega**2 * slope
        ends.append([mouth * slope, slope, moment, force])
    state = np.array(ends).T
    for length, step in pieces:
        A = np.zeros((4, 4))
        A[0, 1], A[1, 2], A[2, 1], A[2, 3], A[3, 0] = 1.0, 1 / step.EI[direction], -thrust, 1.0, step.rhoA * omega**2
        state = expm(A * length) @ state
    return np.linalg.det(state[[0, 2]])


def root_near(function, guess):
    """Root of a function next to a guess of it."""
    for width in (1e-5, 1e-4, 1e-3, 1e-2, 5e-2):
        low, high = guess * (1 - width), guess * (1 + width)
        if function(low) * function(high) < 0:
            return brentq(function, low, high, xtol=1e-14, rtol=1e-13)
    raise AssertionError(f"no root near {guess}")
