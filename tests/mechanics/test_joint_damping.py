"""Damping of the springs of joints: what they lose, against closed forms; loss factors made viscous at home."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.mechanisms import built, leg
from tests.helpers.runs import balance, collect
from tests.helpers.samples import sample_text

import flexapod as fx
from flexapod.kinematics.leg_geometry import limbs
from flexapod.mechanics.elements.flexure import Flexures
from flexapod.model import AxisMotion, Joint, Payload, Simulation, loads, override, preset, preset_text, to_toml
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.piston import Piston
from flexapod.output.text.description import loss_words
from flexapod.solve import parameters
from flexapod.solve.modal.structural_damping import loss_frequency, viscous_losses
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.conservation

LENGTH, STIFF = 0.5, 300.0
LOSSY = "loss = 0.01, stiffness = { axial = 9e7, radial = 1e7, loss = 0.02 }"
BARE = {
    "cylinder": Cylinder(mass=0.0, mouth=0.0),
    "piston": Piston(length=LENGTH, EA=1e10, EI=1e7, rhoA=1e-9),
    "base_joint": Joint(bending=STIFF, torsion=1e6),
}


def pendulum(**joint):
    """A table on four upright legs, rigid but for springs across their feet: 4 (k / L^2) against its mass sideways."""
    corners = [[0.2, 0.2, 0], [-0.2, 0.2, 0], [-0.2, -0.2, 0], [0.2, -0.2, 0]]
    foot = BARE["base_joint"].replace(**joint)
    legs = [leg("FPF", **(BARE | {"base_joint": foot, "platform_joint": foot}))] * 4
    load = Payload(mass=25.0, inertia=[1.0, 1.0, 1.0], com=[0.0, 0.0, 0.0])
    return built("4-FPF", corners, corners, LENGTH, legs, payload=load).replace(gravity=[0, 0, 0])


SIDEWAYS = 4 * 2 * STIFF / LENGTH**2  # two springs a leg turn by x / L


def sway(robot):
    found = fx.modes(robot, fidelity="lumped")
    k = int(np.abs(found.frequency.values - np.sqrt(SIDEWAYS / 25.0) / (2 * np.pi)).argmin())
    return found.frequency.values[k], found.damping_ratio.values[k]


def test_a_damper_on_an_angle():
    """c x_dot / L^2 of eight springs: ratio c / 2 sqrt(k m), which are the angles' over L^2."""
    c = 0.4
    frequency, ratio = sway(pendulum(damping=c))
    assert frequency == pytest.approx(np.sqrt(SIDEWAYS / 25.0) / (2 * np.pi), rel=1e-4)  # EA, EI: 1e-5 as soft
    assert ratio == pytest.approx(8 * c / LENGTH**2 / (2 * np.sqrt(SIDEWAYS * 25.0)), rel=1e-4)


def test_a_loss_factor_is_half_the_damping_ratio_of_the_first_mode():
    robot = pendulum(loss=0.03)
    found = fx.modes(robot, fidelity="lumped")
    assert loss_frequency(robot, Simulation(fidelity="lumped")) == pytest.approx(found.frequency.values[0], rel=1e-9)
    assert found.damping_ratio.values[0] == pytest.approx(0.015, rel=1e-3)  # all of its strain is in these springs


def flexures(**joint):
    """The welded sample robot on flexures, of which the translations give way as well."""
    study = preset("paper-robot")
    spring = {"bending": 15.0, "torsion": 20.0, "stiffness": np.diag([1.3e7, 1.3e7, 9.4e7, 0, 0, 0]), "leg_axes": True}
    legs = [leg("FPF", base_joint=Joint(**spring, **joint), platform_joint=Joint(**spring, **joint))] * 6
    robot = study.robot.replace(type="6-FPF", legs=tuple(legs))
    return study.replace(robot=robot)


@pytest.mark.parametrize("joint", [{"damping": 0.5, "stiffness_damping": 2e3}, {"loss": 0.05}])
def test_what_dampers_lose_is_in_the_balance(joint):
    lost = []
    for h in (5e-4, 2.5e-4):
        study = flexures(**joint)
        study = study.replace(motion=AxisMotion(type="roll", amplitude=0.05, duration=0.05, profile="smooth"))
        study = override(study, modes=2, step=h, output_step=2e-3, duration=0.06)
        run = collect(prepare(study.replace(initial=study.initial.replace(start="straight"))).chunks)
        lost.append((np.ptp(balance(run)), run["sums"][-1, 0]))
    # A dissipative scheme of second order: the balance closes four times as well with half the step
    assert lost[0][1] > 10 * lost[0][0] and lost[1][0] < 0.35 * lost[0][0]


def test_the_moment_of_a_damped_joint_is_in_the_balance_of_the_leg():
    """Of legs without mass: what spring and damper give at the foot is what force and moment at the tip make there."""
    study, light = flexures(damping=3.0), {"cylinder": Cylinder(mass=0.0, mouth=0.3)}
    for end in ("base_joint", "platform_joint"):
        light[end] = getattr(study.robot.legs[0], end).replace(stiffness=None)
    legs = tuple(x.replace(piston=x.piston.replace(rhoA=1e-9, E=None), **light) for x in study.robot.legs)
    study = study.replace(robot=study.robot.replace(legs=legs, gravity=[0, 0, 0]))
    study = study.replace(motion=AxisMotion(type="roll", amplitude=0.05, duration=0.05, profile="smooth"))
    data = fx.run(override(study, fidelity="lumped", step=2.5e-4, output_step=1e-3, duration=0.04))
    base, tip = (data.joint_moment.sel(end=end).values for end in ("base", "platform"))
    R = Rotation.from_quat(data.platform_quaternion.values, scalar_first=True).as_matrix()
    arms = (study.robot.platform_joints - study.robot.com) @ R.swapaxes(1, 2)
    ways = data.com_position.values[:, None] + arms - study.robot.base_joints
    axis = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
    total = base - tip - np.cross(ways, data.joint_force.values)
    across = total - (total * axis).sum(axis=-1, keepdims=True) * axis
    # accelerations of the index 3 integrator on what is left of the mass
    assert np.abs(across).max() < 1e-5 * np.abs(base).max()


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"damping": 1.0, "loss": 0.1, "bending": 2.0}, "is given together with loss"),
        ({"damping": 1.0}, "damps a spring that the joint does not have"),
        ({"loss": 0.1}, "damps a spring that the joint does not have"),
    ],
)
def test_dampers_without_springs_are_refused(joint, message):
    with pytest.raises(fx.InputError, match=message):
        Joint(**joint)


def test_loss_factors_of_a_study_file_are_said(tmp_path):
    """Frequency and dampers are printed; written again, the file says the same."""
    text = sample_text("flexures")
    given = '_joint = { bending = "15 N m/rad", torsion = "20 N m/rad"'
    path = tmp_path / "lossy.toml"
    text = text.replace(f"base{given}", f"base{given}, {LOSSY}")
    path.write_text(text.replace(f"platform{given}", f'platform{given}, damping = "0.01 N m s/rad"'))
    study = fx.load(path)
    joint, other = study.robot.legs[0].base_joint, study.robot.legs[0].platform_joint
    assert (joint.loss, joint.stiffness_loss, joint.damping, other.damping) == (0.01, 0.02, None, 0.01)
    study = override(study, fidelity="lumped")
    f = fx.modes(study).frequency.values[0]
    first, second = loss_words(viscous_losses(study.robot, study.simulation))
    assert first == f"at the first frequency there, {f:.4g} Hz (undamped, drives locked)"
    rigid = loss_words(viscous_losses(study.robot, override(study, fidelity="rigid").simulation))[0]
    assert rigid == f"{first[:-1]}, pistons that stretch)"
    values = [0.01 * 15, 0.01 * 20, 0.02 * 9e7]
    assert [
        float(part.split()[1]) for part in second.split(": ")[1].replace("kN", "e3 N").split(", ")
    ] == pytest.approx([v / (2 * np.pi * f) for v in values], rel=6e-3)
    again = tmp_path / "again.toml"
    again.write_text(fx.model.to_toml(study))
    assert fx.load(again).robot == study.robot


ROWS = {3: np.diag([1.3e7, 1.4e7, 9.4e7]), 6: np.diag([1.3e7, 1.4e7, 9.4e7, 15.0, 15.0, 20.0])}


@pytest.mark.parametrize("count", ROWS)
@pytest.mark.parametrize("own", ["damping = 2000.0", "loss = 0.05"])
def test_rows_of_a_stiffness_have_dampers_of_their_own(count, own):
    text = f"{{ rows = {ROWS[count].tolist()}, {own} }}"
    text = preset_text("paper-robot").replace("[leg] ", f"[leg]\nbase_joint = {{ stiffness = {text} }} ")
    study = loads(text)
    joint = study.robot.legs[0].base_joint
    np.testing.assert_array_equal(joint.stiffness[:count, :count], ROWS[count])
    again = loads(to_toml(study))
    assert again.robot == study.robot
    found = flexures_of(study.robot)
    if "loss" in own:
        np.testing.assert_allclose(found[1], 0.05 * 1e-3 * found[0], atol=1e-9)
    else:
        np.testing.assert_allclose(found[1][:3, :3], 2000.0 * np.eye(3), atol=1e-9)
        assert not found[1][3:].any()


def flexures_of(robot):
    """Stiffness and damping of the first base joint, per_loss 1 ms."""
    standing = parameters.standings(robot, limbs(robot), 1e-3, at_rest=False)[0]
    found = Flexures().numbers(robot.legs[0], standing)
    return found["base_flexure"], found["base_flexure_damping"]
