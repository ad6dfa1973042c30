"""Cylinders that bend against two beams in two bushings, from outside: frequencies, buckling, static answers."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from tests.helpers.machines import machine
from tests.helpers.stepped import function, vector
from tests.oracles.two_beams import TwoBeams

from flexapod import kinematics
from flexapod.mechanics.shapes import axial_basis
from flexapod.model import MATERIALS, Cylinder, Guide, Mounted, Piston, PistonSection, Simulation
from flexapod.model.leg.material import Tube
from flexapod.solve.shapes import robot_shapes
from flexapod.solve.statics.buckling import leg_loads

pytestmark = pytest.mark.consistency

STEEL = MATERIALS["steel"]
WIDE, THIN = Tube(diameter=0.09, inner_diameter=0.07), Tube(diameter=0.06, inner_diameter=0.055)
ROD = Tube(diameter=0.05)
BUSHINGS = Guide(gland=2e8, head=1.5e8)


def of(mouth, length, *, tube=WIDE, guide=BUSHINGS, body=None, sections=None):
    """A robot of legs whose pistons have a length."""
    cylinder = Cylinder.tube(mouth=mouth, section=tube, material=STEEL, body=body)
    sections = sections or [PistonSection(length=length, diameter=ROD.diameter, E=STEEL.E, density=STEEL.density)]
    piston = Piston.stepped(sections)
    if len(sections) == 1:
        piston = piston.replace(sections=())
    return machine(cylinder=cylinder, piston=piston, guide=guide)


def beams(leg, free):
    """The same leg at a free length, from outside."""
    section, body = leg.cylinder.section, leg.cylinder.body or Mounted(mass=0.0)
    E, rho = leg.cylinder.material.E, leg.cylinder.material.density
    tube = E * section.second_moment, rho * section.area, rho * section.second_moment
    sizes = [(one.length, one.diameter) for one in leg.piston.sections] or [(leg.piston.length, ROD.diameter)]
    rod = [(length, E * np.pi / 64 * d**4, rho * np.pi / 4 * d**2) for length, d in sizes]
    guide = leg.guide
    return TwoBeams(
        mouth=leg.cylinder.mouth, head=leg.cylinder.mouth + free - leg.piston.length, tube=tube, rod=rod,
        bushings=None if guide is None else (guide.gland, guide.head), mounted=(body.mass, body.com, body.inertia),
    )  # fmt: skip


class Ours:
    """A leg of a robot with the shapes that a study has, at rest."""

    def __init__(self, robot, free, modes):
        self.leg = robot.legs[0]
        shapes = robot_shapes(robot, Simulation(modes=modes), kinematics.robot_limbs(robot))
        self.shapes = replace(shapes, beam=replace(shapes.beam, axial=axial_basis(0)))
        self.length = self.leg.cylinder.mouth + free

    def matrices(self, thrust=0.0):
        """M, K and J of all coordinates."""
        p = vector(self.leg, self.shapes, self.length)
        q = self.length * np.eye(self.shapes.size)[self.shapes.l_index]
        M, _, K, J = function(self.shapes, 1)(q, np.array([0.0, 0.0, thrust]), p)
        return M, K, J

    def pinned(self, thrust=0.0):
        """M and K with the stroke locked and the tip in place, scaled."""
        M, K, J = self.matrices(thrust)
        J = np.vstack([J[:2], np.eye(self.shapes.size)[self.shapes.l_index]])
        N = np.linalg.svd(J)[2][3:].T
        return N.T @ M @ N, N.T @ K @ N

    def frequencies(self, count):
        """Each of two alike [rad/s]."""
        M, K = self.pinned()
        size = 1 / np.sqrt(np.diag(K))
        return 1 / np.sqrt(eigh(M * np.outer(size, size), K * np.outer(size, size), eigvals_only=True)[::-2][:count])

    def buckling(self):
        """Least thrust [N]."""
        K = self.pinned()[1]
        less = (K - self.pinned(1e3)[1]) / 1e3
        size = 1 / np.sqrt(np.diag(K))
        return 1 / eigh(less * np.outer(size, size), K * np.outer(size, size), eigvals_only=True)[-1]

    def softness(self):
        """Displacement of the tip by a force there, the base joint held [m/N]."""
        _, K, J = self.matrices()
        free = [i for i in range(self.shapes.size) if i not in [self.shapes.index(n) for n in ("alpha", "beta", "l")]]
        return float(J[0, free] @ np.linalg.solve(K[np.ix_(free, free)], J[0, free]))


# mouth, piston, free length: overlaps of 0.25, 0.1 and 0.2 m; the head in the middle and near both ends of the tube
LEGS = {
    "short stroke": ((0.6, 0.65), 0.4, {}),
    "long stroke": ((0.6, 0.65), 0.55, {}),
    "head near the base joint": ((0.45, 0.83), 0.42, {}),
    "soft tube": ((0.45, 0.6), 0.3, {"tube": THIN}),
}


@pytest.mark.parametrize("name", LEGS)
def test_static_answers_are_exact(name):
    # Forces of gland and head and the moment between them: all static shapes are there, and 1e-9 is rounding.
    sizes, free, more = LEGS[name]
    robot = of(*sizes, **more)
    assert Ours(robot, free, 3).softness() == pytest.approx(beams(robot.legs[0], free).softness()[0, 0], rel=1e-9)


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize(("modes", "rtol"), [(3, [1e-4, 2e-3, 1e-2]), (6, [1e-6, 5e-4, 1e-3])])
def test_frequencies(name, modes, rtol):
    # First ones: what is wanted of three and six shapes. Higher ones: what so many shapes leave of the second and third
    # frequency of a straight rod between pins (6.6e-3, and 2.3e-5 and 3.2e-4), the tube having half as many.
    sizes, free, more = LEGS[name]
    robot = of(*sizes, **more)
    exact = beams(robot.legs[0], free).frequencies(3)
    error = np.abs(Ours(robot, free, modes).frequencies(3) / exact - 1)
    assert (error < rtol).all(), error


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize(("modes", "rtol"), [(3, 3e-4), (6, 1e-4)])
def test_buckling(name, modes, rtol):
    # The thrust ends at the head: of the moment's own kink there no shape knows, which counts where the tube bends more
    # than the rod (`soft tube`); an inner part as long as the outer one (`head near the base joint`) has the two shapes
    # that leave 2.4e-4 of a pinned rod. Of the others a tenth of that.
    sizes, free, more = LEGS[name]
    robot = of(*sizes, **more)
    load = Ours(robot, free, modes).buckling()
    ordinary = name.endswith("stroke")
    assert load == pytest.approx(beams(robot.legs[0], free).buckling(), rel=rtol / 10 if ordinary else rtol)


@pytest.mark.parametrize("modes", [3, 6])
def test_a_motor_on_the_tube_has_a_kink_of_its_own(modes):
    # 17 kg at a place: its inertia's kink is in no shape. Three shapes of the tube leave 2e-4 of the first frequency.
    robot = of(0.45, 0.65, body=Mounted(mass=17.0, com=0.13, inertia=0.02))
    found = Ours(robot, 0.45, modes).frequencies(1)
    np.testing.assert_allclose(found, beams(robot.legs[0], 0.45).frequencies(1), rtol=2e-4 if modes == 3 else 5e-5)


def test_a_clamped_piston_in_a_tube_that_bends():
    # Nothing presses at the head, but for the thrust that ends there.
    robot = of(0.6, 0.65, guide=None)
    ours, exact = Ours(robot, 0.4, 3), beams(robot.legs[0], 0.4)
    np.testing.assert_allclose(ours.frequencies(1), exact.frequencies(1), rtol=1e-4)
    assert ours.buckling() == pytest.approx(exact.buckling(), rel=2e-4)


def test_a_stepped_piston_in_a_tube_that_bends():
    cut = [
        PistonSection(length=n, diameter=d, E=STEEL.E, density=STEEL.density) for n, d in ((0.35, 0.05), (0.3, 0.04))
    ]
    robot = of(0.6, 0.65, sections=cut)
    ours, exact = Ours(robot, 0.4, 6), beams(robot.legs[0], 0.4)
    np.testing.assert_allclose(ours.frequencies(1), exact.frequencies(1), rtol=1e-6)
    assert ours.buckling() == pytest.approx(exact.buckling(), rel=1e-5)


@pytest.mark.parametrize("modes", [3, 6])
def test_a_head_behind_the_base_joint_meets_a_straight_tube(modes):
    # The force F at the tip asks F s / d of the head and F (s + d) / d of the gland, which alone bends the tube.
    robot = of(0.25, 0.75)
    leg, s = robot.legs[0], 0.35
    d, EI, tube = 0.75 - s, leg.piston.EI, STEEL.E * WIDE.second_moment
    assert leg.cylinder.mouth - d < 0
    theirs = s**3 / (3 * EI) + s**2 * d / (3 * EI) + (s / d) ** 2 / leg.guide.head
    theirs += ((s + d) / d) ** 2 * (1 / leg.guide.gland + leg.cylinder.mouth**3 / (3 * tube))
    assert Ours(robot, s, modes).softness() == pytest.approx(
        theirs, rel=1e-5
    )  # the kink stays 1e-3 away from the joint


def test_check_says_the_thrust_at_which_such_legs_buckle():
    robot = of(0.6, 0.65)
    free = 0.4
    loads = leg_loads(robot, np.full((1, 6), 0.6 + free))
    np.testing.assert_allclose(loads[0], beams(robot.legs[0], free).buckling(), rtol=1e-4)
