"""Stiffness of robots of lower mobility against closed forms: tripods on hinges, tables on fixed legs."""

import numpy as np
import pytest
from tests.helpers.mechanisms import THREE, built, leg, ring, tangents

from flexapod.design.sweeps.outputs import select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.design.sweeps.worker import compute_point
from flexapod.model import MATERIALS, AxisMotion, ConstantWrench, Load, Simulation, Study
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.material import Tube
from flexapod.model.leg.piston import Piston
from flexapod.model.study.payload import Payload
from flexapod.solve.modal.at_poses import robot_modes, robot_stiffness

pytestmark = pytest.mark.analytic

PISTON = Piston(length=0.75, EA=1.1e8, EI=5e3, rhoA=4.5)
WEIGHTLESS = Payload(mass=1e-6, inertia=[1e-8, 1e-8, 1e-8], com=[0, 0, 0])
BASE, TOP, HEIGHT, MOUTH = 0.35, 0.2, 0.6, 0.25
FLEXIBLE = Simulation(fidelity="assumed-modes", modes=2, basis="tip-load")


def tripod(**more):
    """3-RPS whose legs weigh nothing."""
    parts = {"cylinder": Cylinder(mass=0, com=0, inertia=0, mouth=MOUTH), "piston": PISTON.replace(rhoA=0.0)}
    legs = [leg("RPS", axis, **parts) for axis in tangents(THREE)]
    robot = built("3-RPS", ring(BASE, THREE), ring(TOP, THREE), HEIGHT, legs, payload=WEIGHTLESS, **more)
    return robot.replace(gravity=[0, 0, 0])


def test_a_tripod_is_stiff_sideways_as_its_pistons_bend():
    """Legs stretch along themselves and bend across the hinges' planes; about the hinges they turn freely."""
    length = np.hypot(BASE - TOP, HEIGHT)
    rise, radial = HEIGHT / length, (TOP - BASE) / length
    k, kb = PISTON.EA / PISTON.length, 3 * PISTON.EI / (length - MOUTH) ** 3
    sideways, up = 1.5 * (k * radial**2 + kb), 3 * k * rise**2
    tilt, turn, coupling = 1.5 * k * TOP**2 * rise**2, 3 * kb * TOP**2, -1.5 * k * TOP * rise * radial
    expected = np.diag([sideways, sideways, up, tilt, tilt, turn])
    expected[0, 4] = expected[4, 0] = coupling
    expected[1, 3] = expected[3, 1] = -coupling
    found = robot_stiffness(tripod(), FLEXIBLE)
    # No load: no sag. Rounding of sums of 1e8 N/m.
    np.testing.assert_allclose(found.total, expected, atol=1e-9 * up)
    np.testing.assert_allclose(found.legs.sum(axis=0), found.total, atol=1e-9 * up)
    # Without bending the determinant of the x-pitch block would vanish: the tripod's own tilt.
    assert abs(sideways * tilt - coupling**2) == pytest.approx(1.5 * kb * tilt, rel=1e-12)


def test_shares_of_the_legs_turn_with_them():
    found = robot_stiffness(tripod(), FLEXIBLE)
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    R = np.kron(np.eye(2), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
    np.testing.assert_allclose(found.legs[1], R @ found.legs[0] @ R.T, atol=1e-9 * np.abs(found.total).max())


@pytest.mark.parametrize("count", [4, 6])
def test_a_table_on_upright_legs_fixed_at_both_ends(count):
    """Each leg bends as a clamped beam whose end moves sideways without turning: 12 EI / s^3."""
    corners, s = np.linspace(0, 360, count, endpoint=False) + 45.0, 0.6
    parts = {"cylinder": Cylinder(mass=0, com=0, inertia=0, mouth=MOUTH), "piston": PISTON}
    legs = [leg("FPF", **parts)] * count
    robot = built(f"{count}-FPF", ring(0.5, corners), ring(0.5, corners), s + MOUTH, legs, payload=WEIGHTLESS)
    found = robot_stiffness(robot.replace(gravity=[0, 0, 0]), FLEXIBLE).total
    k = 12 * PISTON.EI / s**3
    along = PISTON.EA / PISTON.length
    # The table does not tilt: it is the block of translations and the turn about the vertical that are closed forms.
    np.testing.assert_allclose(np.diag(found)[:2], count * k, rtol=1e-9)
    np.testing.assert_allclose(found[2, 2], count * along, rtol=1e-9)
    tilt = count * (along * 0.5**2 / 2 + 4 * PISTON.EI / s)
    np.testing.assert_allclose(np.diag(found)[3:5], tilt, rtol=1e-9)
    twist = count * (k * 0.5**2 + PISTON.torsional_stiffness / PISTON.length)
    assert found[5, 5] == pytest.approx(twist, rel=1e-9)
    np.testing.assert_allclose(np.abs(found[0, 4]), count * k * s / 2, rtol=1e-9)


def test_the_slowest_modes_of_a_tripod_are_those_of_its_bending():
    """A heavy payload on light legs: frequencies of the stiffness matrix and the payload's mass alone."""
    robot = tripod().replace(payload=Payload(mass=100.0, inertia=[4.0, 4.0, 5.0], com=[0, 0, 0]))
    K = robot_stiffness(robot, FLEXIBLE).total
    expected = np.sort(np.sqrt(np.linalg.eigvals(np.diag([1 / 100] * 3 + [1 / 4, 1 / 4, 1 / 5]) @ K).real)) / (
        2 * np.pi
    )
    np.testing.assert_allclose(robot_modes(robot, FLEXIBLE).frequency[:6], expected, rtol=1e-7)


def test_the_stress_that_a_sweep_keeps_is_that_at_the_clamp():
    """A torque about the vertical bends each leg across its hinge's plane by M / 3R at its tip; none is pushed."""
    torque, width = 60.0, 0.026
    robot = tripod().replace(payload=Payload(mass=100.0, inertia=[4.0, 4.0, 5.0], com=[0, 0, 0]))
    light = MATERIALS["steel"].replace(name="given", density=1e-3)
    piston = Piston.round(length=0.75, section=Tube(diameter=width), material=light)
    robot = robot.replace(legs=tuple(leg.replace(piston=piston) for leg in robot.legs))
    study = Study(
        robot=robot, motion=AxisMotion(type="heave", amplitude=0.0, duration=1e-3),
        load=Load(wrench=ConstantWrench(value=[0, 0, 0, 0, 0, torque])),
        simulation=FLEXIBLE.replace(step=5e-4, duration=1e-3, tolerance=None),
    )  # fmt: skip
    plan = read_plan({"vary": [{"key": "payload.mass", "values": [100]}], "keep": {"scalars": ["stress_peak_by_leg"]}})
    points = Points(study, plan)
    found = compute_point(select_outputs(plan.keep, study, points.resolve()), points.study(0))
    assert found.failure == ""
    free = np.hypot(BASE - TOP, HEIGHT) - MOUTH
    moment = torque / (3 * TOP) * free
    # The platform turns by 1.4 mrad, legs with it: second order in that. Over the whole length it would be 40 % less.
    np.testing.assert_allclose(found.values["stress_peak_by_leg"], moment / (np.pi / 32 * width**3), rtol=1e-3)
