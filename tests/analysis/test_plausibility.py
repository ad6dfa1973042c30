"""Results outside the theory say so: which leg, when, how much, which limit."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.runs import paper_robot, with_legs
from tests.helpers.stepped import STEEL, leg_of, section

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.estimates import STATIONS, buckling_load
from flexapod.analysis.checks.plausibility import leg_stress
from flexapod.analysis.description.leg_description import _stress
from flexapod.analysis.results.bodies import flexible_axes
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import AxisMotion, Rectangle, Tube
from flexapod.model.leg.material import MATERIALS
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.sections import leg_values

pytestmark = pytest.mark.unit

STILL = AxisMotion(type="heave", amplitude=0.0, duration=1.0)
SHORT = {"duration": 0.02, "step": 1e-3}


def still(**robot):
    study = paper_robot().replace(motion=STILL)
    return study.replace(robot=study.robot.replace(**robot)) if robot else study


def remarks(data):
    return data.attrs["warnings"].splitlines()


def only(data, words):
    found = [line for line in remarks(data) if words in line]
    assert len(found) == 1, remarks(data)
    return found[0]


def numbers(text):
    return [float(x) for x in re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", text)]


def test_an_ordinary_study_has_none():
    assert remarks(fx.simulate(paper_robot(), duration=0.1, step=1e-3)) == []


def test_slope_of_a_soft_leg():
    # Gravity across the legs. Leg 5 bends 1500 times more easily and sags by its own weight; the others weigh nothing.
    study = still(gravity=[-9.81, 0, 0])
    payload = study.robot.payload.replace(mass=0.1, inertia=[1e-3] * 3, com=[0, 0, 0], tool=[0, 0, 0])
    light = {"rhoA": 1e-6, "E": None, "density": None}
    soft = {"EI": study.robot.legs[4].piston.EI / 1500, "E": None, "density": None}
    massless = study.robot.legs[0].cylinder.replace(mass=0.0, inertia=0.0)
    legs = [
        leg.replace(cylinder=massless, piston=leg.piston.replace(**(soft if i == 4 else light)))
        for i, leg in enumerate(study.robot.legs)
    ]
    study = study.replace(robot=study.robot.replace(payload=payload, legs=tuple(legs)))
    data = fx.simulate(study, **SHORT)
    words = only(data, "tip slope")
    assert words.startswith("leg 5: ")
    value, at = numbers(words.removeprefix("leg 5: "))[:2]
    assert value > 0.1
    assert "above 0.1" in words
    # The slope again, from the stored amplitudes and the basis.
    basis = lateral_basis("tip-load", 3)
    free = data.leg_stroke.sel(leg=5) - 0.31518
    slope = np.linalg.norm(data.lateral_amplitude.sel(leg=5).values @ basis.tip_slope, axis=1) / free.values
    assert value == pytest.approx(slope.max(), rel=5e-3)
    # It rests: of instants that differ by the last bits alone the first one is said.
    assert slope[np.abs(data.time.values - at).argmin()] == pytest.approx(slope.max(), rel=1e-9)


def test_axial_load_near_the_euler_load():
    # A force on the tool through the centre of the legs: each bears a sixth.
    study = still()
    payload = study.robot.payload.replace(com=[0, 0, 0], tool=[0, 0, 0])
    study = study.replace(robot=study.robot.replace(payload=payload))
    leg, length = study.robot.legs[0], study.robot.home_lengths[0]
    euler = float(buckling_load(leg, length - np.array([leg.cylinder.mouth]))[0])
    upright = 0.9 / length
    for share, warned in ((0.45, False), (0.6, True)):
        load = np.array([0, 0, -6 * share * euler * upright, 0, 0, 0])
        data = fx.simulate(study, load=load, fidelity="lumped", **SHORT)
        found = [line for line in remarks(data) if "Euler load" in line]
        assert bool(found) is warned
    words = only(data, "Euler load")
    per_cent, thrust = numbers(words.split(": ", 1)[1])[:2]
    assert per_cent == pytest.approx(60, abs=3)  # with the robot's own weight, 1 kN, and shorter legs
    assert thrust == pytest.approx(0.6 * euler, rel=0.03)
    assert "also legs" in words


def test_pull_is_no_buckling():
    study = still()
    study = study.replace(robot=study.robot.replace(payload=study.robot.payload.replace(com=[0, 0, 0], tool=[0, 0, 0])))
    data = fx.simulate(study, load=[0, 0, 6 * 60e3, 0, 0, 0], fidelity="lumped", **SHORT)
    assert (data.actuator_force < -50e3).all()
    assert not any("Euler" in line for line in remarks(data))


def test_slenderness():
    # 584 mm outside the cylinder; pistons of 65 mm are 9 times as long as wide.
    thick = Tube(diameter=0.065)
    study = with_legs(still(), lambda leg: leg.replace(
        piston=type(leg.piston).round(length=0.75, section=thick, material=MATERIALS["steel"])))  # fmt: skip
    data = fx.simulate(study, fidelity="lumped", **SHORT)
    words = only(data, "times the width")
    ratio = (study.robot.home_lengths[0] - 0.31518) / 0.065
    assert numbers(words.split(": ", 1)[1])[0] == pytest.approx(ratio, rel=1e-2)
    assert "Below 10 shear, which an Euler-Bernoulli beam leaves out" in words
    # 0.55 and 1.21 (width / length)^2 for a full round bar, less what rotary inertia bends of the second
    found = numbers(words.split("deflects by", 1)[1])
    assert found[:2] == pytest.approx([55 / ratio**2, 121 / ratio**2], rel=0.05)
    solid = only(fx.simulate(study, fidelity="solid-fem", **SHORT), "times the width")
    assert "Below 10 rotary inertia" in solid
    assert "shear" not in solid


def test_yield():
    study = still()
    data = fx.simulate(study, load=[0, 0, 3.5e6, 0, 0, 0], fidelity="lumped", **SHORT)
    words = only(data, "yield stress")
    value, at, limit = numbers(words.split("stress reaches ")[1])[:3]
    assert limit == 650
    area = np.pi / 4 * 0.027**2
    axial = np.linalg.norm(data.joint_force.values, axis=-1).max() / area
    assert value * 1e6 == pytest.approx(axial, rel=1e-3)  # joint forces lie along the legs but for the legs' weight
    assert 0 <= at <= 0.02


def test_stress_of_a_bent_piston_is_that_of_a_cantilever():
    # Static tip-load shape: the moment at the clamp is 3 EI v / s^2, the stress M d / 2 I, on top of N / A.
    leg, v, s, N = paper_robot().robot.legs[0], 1e-3, 0.6, 5e3
    amplitudes = np.zeros((1, 2, 3))
    amplitudes[0, 1, 0] = v
    found = leg_stress(leg, lateral_basis("tip-load", 3), amplitudes, np.array([s]), np.array([-N]))
    area, inertia = np.pi / 4 * 0.027**2, np.pi / 64 * 0.027**4
    moment = 3 * 200e9 * inertia * v / s**2
    np.testing.assert_allclose(found, N / area + moment * 0.0135 / inertia, rtol=1e-12)


@pytest.mark.parametrize(("sections", "depth"), [
    ([section(0.75, 0.05, tip_diameter=0.03)], lambda xi: 0.03 + 0.02 * xi / 0.75),
    ([section(0.4, 0.05), section(0.35, width=0.02, thickness=0.02)], lambda xi: np.where(xi <= 0.35, 0.02, 0.05)),
])  # fmt: skip
def test_stress_of_sections_is_that_of_each_place(sections, depth):
    # Bending where the piston is outside and the thrust there; of a strip the stresses of both planes at its corners.
    leg, free, N = leg_of(sections), np.array([0.4]), 2e4
    basis, zeta, amplitudes = lateral_basis("tip-load", 3), np.linspace(0.0, 1.0, 4001), np.zeros((1, 2, 3))
    amplitudes[0, :, 0] = 1e-3, 5e-4
    bend = np.einsum("ak,akpn->ap", amplitudes[0], leg_values(leg, basis, free, zeta, 2)) / free**2
    xi = (1 - zeta) * free
    d, strip = depth(xi), (xi <= 0.35) & (len(sections) > 1)
    area = np.where(strip, d**2, np.pi / 4 * d**2)
    both = np.where(strip, np.abs(bend).sum(axis=0), np.hypot(*bend)) * STEEL["E"] * d / 2
    found = leg_stress(leg, basis, amplitudes, free, np.array([-N]))
    assert found[0] == pytest.approx((both + N / area).max(), rel=1e-3)


@pytest.mark.parametrize(("free", "thinnest"), [(0.29, 0.05), (0.4, 0.03), (0.6, 0.03)])
def test_stress_before_a_run_is_that_of_the_sections_outside(free, thinnest):
    # By hand: 32 M / pi d^3 of the thinnest section that has come out; from the driven end 40, 30 and 50 mm, of which
    # the last is the first 0.3 m from the tip.
    leg = leg_of([section(0.25, 0.04), section(0.2, 0.03), section(0.3, 0.05)])
    found = _stress(leg, np.zeros(1), np.zeros(1), np.full((len(STATIONS), 1), 70.0), np.array([free]))
    assert found.bending == pytest.approx(32 * 70.0 / (np.pi * thinnest**3), rel=1e-12)


def test_axes_of_legs_are_lines_between_their_joints_where_the_platform_is_turned():
    study = paper_robot()
    robot, angles = study.robot, np.array([0.35, -0.2, 0.3])
    place = np.array([0.03, -0.02, robot.home_height + 0.04])
    turn = Rotation.from_rotvec(angles)
    pose = kinematics.Poses.at_rest(place[None], turn.as_matrix()[None])
    here = locked_poses(robot, study.simulation, pose)
    found = flexible_axes(robot, here.system, here.equilibria.states[here.at])[0]
    lines = place + robot.platform_joints @ turn.as_matrix().T - robot.base_joints
    # The platform sags by some 20 um under its load, legs are a metre long.
    np.testing.assert_allclose(found, lines / np.linalg.norm(lines, axis=1, keepdims=True), atol=2e-4)


def test_no_stress_without_a_section():
    leg = paper_robot().robot.legs[0]
    bare = leg.replace(piston=leg.piston.replace(diameter=None, E=None, density=None))
    assert leg_stress(bare, None, np.zeros((1, 2, 0)), np.ones(1), np.ones(1)) is None


def test_remarks_on_an_actuator():
    study = fx.preset("paper-actuator")
    actuator = type(study.actuator).from_section(
        section=Rectangle(width=0.1, height=0.02), material=MATERIALS["steel"], length=1.0, free_length=0.18
    )
    study = study.replace(actuator=actuator)
    data = fx.simulate_actuator(study, initial=study.initial.replace(tip_displacement=0.05), duration=0.01, step=1e-4)
    found = remarks(data)
    assert any(line.startswith("the beam: the tip slope reaches 0.4") and "above 0.1" in line for line in found)
    assert any("times the width" in line and line.startswith("the beam: the free length is only 9") for line in found)
    assert any("yield stress" in line for line in found)
    # Root stress of the static shape: 3 E v h / 2 s^2 = 4.6 GPa for 200 GPa at the start.
    stress = next(numbers(line.split("stress reaches ")[1])[0] for line in found if "yield" in line)
    start = 3 * MATERIALS["steel"].E * 0.05 * 0.02 / 2 / 0.18**2
    assert stress * 1e6 >= 0.95 * start


def test_the_two_lateral_directions_bend_a_leg_together():
    leg, basis = fx.preset("paper-robot").robot.legs[0], lateral_basis("tip-load", 3)
    both, one = np.zeros((1, 2, 3)), np.zeros((1, 2, 3))
    both[0, :, 0], one[0, 1, 0] = (3e-4, 4e-4), 5e-4  # 3, 4, 5
    free, none = np.array([0.6]), np.zeros(1)
    np.testing.assert_allclose(leg_stress(leg, basis, both, free, none), leg_stress(leg, basis, one, free, none), 1e-14)
