"""Joints held by springs along and across their legs: limits, closed forms, the same robot another way, energy."""

import numpy as np
import pytest
from tests.helpers.machines import SOFT, light, machine, study, symmetric
from tests.helpers.mechanisms import three_spr
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod import kinematics
from flexapod.common.errors import InputError
from flexapod.model import AxialSpring, Geometry, Simulation, Study
from flexapod.model.leg.joint import Joint
from flexapod.model.motion import AxisMotion
from flexapod.solve.robot_system import robot_system

pytestmark = pytest.mark.consistency

ACROSS, ALONG = 150e6, 200e6


def joint(along, across=None, **more):
    across = across or along
    return Joint(stiffness=np.diag([across, across, along, 0.0, 0.0, 0.0]), leg_axes=True, **more)


def ends(joint):
    return {"base_joint": joint, "platform_joint": joint}


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_endlessly_stiff_joints_are_ideal_ones(fidelity):
    # The joints' share in a leg's compliance, 2 (4.4e8 / 1e17), is what may differ, and rounding of 1e17 N/m.
    ideal, stiff = machine(), machine(**ends(joint(1e17)))
    for compute, name in ((fx.stiffness, "stiffness"), (fx.modes, "frequency")):
        ours, theirs = (compute(robot, fidelity=fidelity)[name].values for robot in (stiff, ideal))
        size = np.sqrt(np.outer(np.diag(theirs), np.diag(theirs))) if theirs.ndim == 2 else theirs
        np.testing.assert_allclose(ours[: len(theirs)] / size, theirs / size, atol=2e-8)


def test_a_run_tends_to_that_of_ideal_joints_as_one_over_the_stiffness():
    runs = [run_robot(study(machine(**more), fidelity="lumped", step=5e-4)) for more in
            ({}, ends(joint(1e12)), ends(joint(1e13)))]  # fmt: skip
    misses = [np.abs(x["pose"][:, :3] - runs[0]["pose"][:, :3]).max() for x in runs[1:]]
    assert misses[0] / misses[1] == pytest.approx(10, rel=1e-2)
    # Frequencies differ by 4e-5, so the phase of 20 um by 4e-3 rad after 15 vibrations: some nanometres.
    assert misses[1] < 1e-8


def test_springs_in_series_with_massless_legs_scale_all_six_frequencies():
    # f ~ sqrt(k): the same factor for every mode, joints alike in all legs. Without gravity nothing else is stiff.
    still = {"gravity": [0, 0, 0]}
    ideal = fx.modes(light(machine(), **still), fidelity="lumped").frequency.values[:6]
    soft = fx.modes(light(machine(base_joint=joint(ALONG, ACROSS), platform_joint=joint(3e8)), **still),
                    fidelity="lumped").frequency.values[:6]  # fmt: skip
    leg = 3.3e8 / 0.75
    np.testing.assert_allclose(soft, ideal / np.sqrt(1 + leg / ALONG + leg / 3e8), rtol=1e-9)


def test_the_sag_of_a_symmetric_machine_is_a_sum_of_compliances():
    # Legs without weight: each carries W / (6 cos) and lets the platform down by that times its compliance / cos. What
    # turns with the sag is in proportion to it over the height: 2e-5.
    robot = light(symmetric(base_joint=SOFT, platform_joint=joint(3e8)))
    sag = fx.modes(robot, fidelity="lumped").com_sag.values
    cos = 1.0 / robot.home_lengths[0]
    compliance = 0.75 / 3.3e8 + 1 / ALONG + 1 / 3e8
    assert sag[2] == pytest.approx(-1000.0 * 9.81 * compliance / (6 * cos**2), rel=1e-4)
    np.testing.assert_allclose(sag[:2], 0.0, atol=1e-12)


@pytest.mark.parametrize("fidelity", ["rigid", "lumped", "assumed-modes"])
def test_springs_along_the_leg_are_flexures_that_are_alike_in_all_directions(fidelity):
    # The same stiffness in all directions is the same in any axes: a flexure's, with angles held by next to nothing,
    # has a closure of six rows and displacements in axes that stay. 1e-3 N m/rad at joints of 1e8 N/m over a metre.
    whole = np.diag([2e8, 2e8, 2e8, 1e-3, 1e-3, 1e-3])
    soft, flexures = machine(**ends(joint(2e8))), machine(**ends(Joint(stiffness=whole)))
    # The flexure's axes turn with the piston's tip, some 1e-6 rad; the leg's do not. Shapes do not depend on joints.
    own = {"fidelity": fidelity} | ({"basis": "clamped-free"} if fidelity == "assumed-modes" else {})
    ours, theirs = (fx.stiffness(robot, **own).stiffness.values for robot in (soft, flexures))
    size = np.sqrt(np.outer(np.diag(theirs), np.diag(theirs)))
    np.testing.assert_allclose(ours / size, theirs / size, atol=1e-8)
    ours, theirs = (fx.modes(robot, **own).frequency.values[:6] for robot in (soft, flexures))
    np.testing.assert_allclose(ours, theirs, rtol=1e-7)


def test_joints_of_some_legs_are_soft():
    some = machine()
    legs = list(some.legs)
    legs[1] = legs[1].replace(base_joint=SOFT)
    legs[4] = legs[4].replace(platform_joint=SOFT)
    some = some.replace(legs=tuple(legs))
    rigid = [leg.replace(**{name: getattr(leg, name) if getattr(leg, name).stiffness is not None else joint(1e16)
                            for name in ("base_joint", "platform_joint")}) for leg in some.legs]  # fmt: skip
    held = robot_system(some, fx.model.Simulation(fidelity="lumped"), 0.0).held
    assert held.sum() == 6 + 2 * 15  # strokes, and five of six joints at either end
    ours, theirs = (
        fx.stiffness(x, fidelity="lumped").stiffness.values for x in (some, some.replace(legs=tuple(rigid)))
    )
    np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6 * np.abs(theirs).max())


@pytest.mark.parametrize("fidelity", ["rigid", "assumed-modes"])
def test_energy_balances(fidelity):
    # The balance closes with the square of the step: its error falls by four where the step is halved.
    robot = machine(**ends(joint(ALONG, ACROSS, loss=0.02)))
    errors = []
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(study(robot, fidelity=fidelity, step=step)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[1] < 0.01 * 75  # of the kinetic energy [J]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2)


def test_the_sag_at_the_start_of_a_run_is_the_static_one():
    robot = machine(**ends(SOFT))
    start = run_robot(study(robot, fidelity="lumped", step=1e-3, duration=0.01))
    sag = start["pose"][0, :3] - robot.home_position - robot.com
    # Newton's last step is below 1e-13 m in both.
    np.testing.assert_allclose(sag, fx.modes(robot, fidelity="lumped").com_sag.values, atol=1e-12)


def test_a_loss_factor_damps_the_first_mode_by_half_of_its_share():
    # c = loss k / omega_1: the ratio of mode 1 is loss / 2 times the joints' share in its strain energy.
    robot = light(symmetric(base_joint=joint(ALONG, ACROSS, loss=0.04), damping=0.0), gravity=[0, 0, 0])
    found = fx.modes(robot, fidelity="lumped")
    leg = 3.3e8 / 0.75
    share = (1 / ALONG) / (1 / ALONG + 1 / leg)
    assert found.damping_ratio.values[0] == pytest.approx(0.02 * share, rel=1e-4)
    given = joint(ALONG, ACROSS, stiffness_damping=0.04 * ALONG / (2 * np.pi * found.frequency.values[0]))
    same = fx.modes(light(symmetric(base_joint=given, damping=0.0), gravity=[0, 0, 0]), fidelity="lumped")
    assert same.damping_ratio.values[0] == pytest.approx(found.damping_ratio.values[0], rel=1e-6)


def test_displacements_move_with_the_legs():
    # Legs that turn by some degrees: displacements along the turning legs, or along axes of base and platform, are the
    # same motion. Integrated in different unknowns it differs by the square of the step.
    whole, motion = np.diag([2e8, 2e8, 2e8, 1e-3, 1e-3, 1e-3]), AxisMotion(type="surge", amplitude=0.1, duration=0.1)
    found = []
    for step in (5e-4, 2.5e-4):
        given = study(machine(**ends(joint(2e8))), fidelity="lumped", step=step).replace(motion=motion)
        other = given.replace(robot=machine(**ends(Joint(stiffness=whole))))
        ours, theirs = run_robot(given), run_robot(other)
        miss = ours["pose"][:, :3] - kinematics.poses(given.robot, motion, ours["time"]).place(given.robot.com)
        found.append(np.abs(ours["pose"] - theirs["pose"]).max() / np.abs(miss).max())
    assert found[1] < 1e-3
    assert found[0] / found[1] == pytest.approx(4, rel=0.5)


def beside_a_flexure(**more):
    """A machine whose first leg stands on a flexure, and whose second has other parts."""
    robot, flexure = machine(), Joint(stiffness=np.diag([1e12, 1.1e12, 1.2e12, 0, 0, 0]))
    first, second, *others = robot.legs
    return robot.replace(legs=(first.replace(base_joint=flexure), second.replace(**more), *others))


def test_a_spring_at_the_base_beside_flexures_of_other_legs_acts_along_its_leg():
    # Displacements then have axes of the base. A leg that swings feels of them what is along it, wherever it points;
    # the joint of the other machine gives way across by 2e8 / 1e13.
    spring = AxialSpring(name="flange", stiffness=2e8, at="base")
    robots = beside_a_flexure(springs=(spring,)), beside_a_flexure(base_joint=joint(2e8, 1e13))
    for pose in (None, {"surge": 0.3}):
        ours, theirs = (fx.stiffness(x, pose, fidelity="lumped").stiffness.values for x in robots)
        np.testing.assert_allclose(ours, theirs, atol=1e-6 * np.abs(theirs).max())


def test_a_leg_that_is_held_across_takes_no_such_spring_beside_flexures():
    spring, held = AxialSpring(name="flange", stiffness=2e8, at="base"), Joint(bending=1e3)
    with pytest.raises(InputError, match=r"leg 2: .* held across") as caught:
        beside_a_flexure(springs=(spring,), platform_joint=held)
    assert caught.value.key == "leg.springs.flange"
    beside_a_flexure(springs=(spring,), base_joint=joint(2e8), platform_joint=held)
    assert machine(springs=(spring,), platform_joint=held).count == 6


@pytest.mark.parametrize("end", ["base_joint", "platform_joint"])
def test_what_joints_give_across_moves_the_platform_of_legs_that_turn_about_themselves(end):
    """The force in a joint over its stiffnesses is a shift of it: what a machine built with that shift would miss.

    A 3-SPR that rolls: its legs turn by 0.07 rad about themselves, and hinges of the platform press across them.
    """
    across, along = 2e8, 5e8
    soft = Joint(stiffness=np.diag([across, across, along, 0.0, 0.0, 0.0]), leg_axes=True)
    robot = three_spr()
    legs = (
        leg.replace(
            cylinder=leg.cylinder.replace(mass=1e-3, inertia=1e-5), piston=leg.piston.replace(rhoA=1e-3), **{end: soft}
        )
        for leg in robot.legs
    )
    robot, motion = robot.replace(legs=tuple(legs)), AxisMotion(type="roll", amplitude=0.3, duration=0.5, hold=0.2)
    one = Study(robot=robot, motion=motion, simulation=Simulation(duration=0.7, fidelity="lumped"))
    data = fx.simulate(one, step=1e-3, output_step=0.1).isel(time=-1)
    pose = kinematics.poses(robot, motion, np.array([0.7]))
    legs = kinematics.inverse_kinematics(robot, pose)
    assert np.abs(legs.spin).max() > 0.05
    limbs, force = kinematics.rigid_limbs(robot), data.joint_force.values
    axes = pose.position[0] + limbs.platform @ pose.rotation[0].T - limbs.base
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    pushed = (force * axes).sum(axis=1, keepdims=True) * axes
    given = pushed / along + (force - pushed) / across
    shift = {"base_joint": {"base_joints": -given}, "platform_joint": {"platform_joints": given @ pose.rotation[0]}}
    built = kinematics.built_poses(robot.replace(geometry=Geometry(**shift[end])), pose)
    moved = (built.place(robot.com) - pose.place(robot.com))[0]
    found = data.deviation_by_cause.sel(cause=end).sum("leg")
    # 10 um of 0.3 m: what is left of second order, 3e-5.
    np.testing.assert_allclose(found, moved, rtol=1e-4, atol=1e-4 * np.abs(moved).max())
