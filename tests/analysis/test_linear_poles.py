"""Poles of the linear model against those of modes of unit stiffness, which are found in another way."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment
from tests.helpers import motor_loops as motors
from tests.helpers.machines import BASE, EVERYTHING, HEAVY, LIGHT, MOUNT, OIL, PLATE, SERVO, SOFT, TOP, machine, study
from tests.helpers.samples import PRESETS, SAMPLES, known, sample_study
from tests.trial_element.maxwell import Maxwell

import flexapod as fx
from flexapod.analysis.results.arguments import as_pose
from flexapod.kinematics import home_pose
from flexapod.model import Motor
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.eigenproblem import poles
from flexapod.solve.modal.modes import loops_of, modal_damping, unit_modes

pytestmark = pytest.mark.consistency

EVENLY = ("planar", "delta", "hexaglide")  # modes mix evenly: there the ratio of a mode is that of its own damper


def of_modes(given, pose=None):
    """Poles by undamped modes, and the loops beside them."""
    at = home_pose(given.robot) if pose is None else as_pose(given.robot, pose)
    locked = locked_poses(given.robot, given.simulation, at, given.load)
    found, loops = unit_modes(locked, shapes=True), loops_of(locked)
    D = modal_damping(locked, found.flat)[0]
    return loops[0].eigenpairs(found.omega[0], D)[0] if loops else poles(found.omega[0], D)


def apart(ours, theirs):
    """Distances of poles, pair by pair, over their size."""
    assert len(ours) == len(theirs)
    away = np.abs(ours[:, None] - theirs) / np.abs(theirs)
    return away[linear_sum_assignment(np.minimum(away, 1.0))]


@pytest.mark.parametrize("friction", ["sliding", "stuck"])
@pytest.mark.parametrize("name", [*PRESETS, *SAMPLES])
def test_poles_of_presets_and_samples(name, friction):
    given = known(name)
    given = given.replace(simulation=given.simulation.replace(friction=friction))
    fixed = given.robot.platform_fixed
    inputs, outputs = ("floor:x", "stroke") if fixed else ("wrench", "tool")
    lin = fx.linearize(given, inputs=inputs, outputs=outputs)
    # either way is right to rounding, 1e-16, times rates 1e4 apart and the size of D over that of its poles
    assert apart(lin.poles(), of_modes(given)).max() < 1e-9
    found, ratio = lin.damp().damping_ratio.values, fx.modes(given).damping_ratio.values[:6]
    away = np.abs(found[:, None] - ratio).min(axis=0)
    if name not in EVENLY:
        assert away.max() < 1e-9


@pytest.mark.parametrize(
    ("fidelity", "modes"), [("finite-segment", 8), ("beam-fem", 4), ("solid-fem", 2), ("lumped", None)]
)
def test_legs_of_every_fidelity(fidelity, modes):
    given = fx.model.override(fx.preset("paper-robot"), fidelity=fidelity, modes=modes)
    assert apart(fx.linearize(given, inputs="wrench", outputs="tool").poles(), of_modes(given)).max() < 1e-9


def test_an_element_from_outside_with_a_damper_alone():
    # of a Maxwell element at rest the point between spring and damper has no mass: a state of first order in each leg
    table = '[leg.maxwell]\nstiffness = "20 kN/m"\nrelaxation = "0.1 s"\n'
    given = fx.loads(fx.model.preset_text("paper-robot").replace("[motion]", f"{table}\n[motion]", 1))
    plain, lin = (fx.linearize(x, inputs="wrench", outputs="tool") for x in (fx.preset("paper-robot"), given))
    assert set(lin.states) - set(plain.states) == {f"leg {k} {Maxwell.at}_z" for k in range(1, 7)}
    assert apart(lin.poles(), of_modes(given)).max() < 1e-9


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes", "rigid"])
@pytest.mark.parametrize("encoder", [motors.BOTH, motors.JOINTS, motors.STROKE, motors.ROTOR])
def test_loops_that_lag_and_sum(encoder, fidelity):
    given = study(motors.real(encoder), fidelity=fidelity)
    lin = fx.linearize(given, inputs="wrench", outputs="tool")
    assert apart(lin.poles(), of_modes(given)).max() < 1e-9
    assert sum("summed error" in name for name in lin.states) == 6
    assert sum("motor force" in name for name in lin.states) == 6


def test_a_sum_about_a_rotor_is_that_of_two_masses():
    # modes leave such a sum out; the payload rises on six legs as two masses on a spring by hand
    hand = motors.Hand(motors.with_loop(Motor(), motors.ROTOR, integral=100.0), gravity=[0, 0, 0])
    found = fx.linearize(study(hand.robot, fidelity="rigid"), inputs="wrench:fz", outputs="tool:z").poles()
    theirs = np.linalg.eigvals(np.delete(np.delete(hand.matrix(), 4, 0), 4, 1))  # without a lag P is no state
    assert len(theirs) == 5
    for value in theirs:
        assert np.abs(found - value).min() < 1e-9 * np.abs(value)


def test_unstable_loops_have_poles():
    given = study(motors.Hand(motors.with_loop(), gravity=[0, 0, 0]).robot, fidelity="rigid")
    lin = fx.linearize(given, inputs="wrench", outputs="tool")
    grows = lin.poles().real.max()
    assert grows > 0.1
    modes = fx.modes(given)
    assert grows == pytest.approx((-2 * np.pi * modes.frequency * modes.damping_ratio).values.max(), rel=1e-6)


BARE = {"mass": 0.0, "inertia": np.zeros((3, 3))}
MASSLESS = {
    "pistons": machine(piston=LIGHT),
    "pistons on servos": machine(piston=LIGHT, drive=SERVO),
    "base on a mount": machine(piston=LIGHT).replace(base_mount=MOUNT),
    "heavy base on a mount": machine(piston=LIGHT).replace(base_mount=HEAVY),
    "platform on a mount": machine(piston=LIGHT).replace(platform_mount=PLATE),
    "both": machine(piston=LIGHT).replace(platform_mount=PLATE, base_mount=MOUNT),
    "plates between springs": machine(base_joint=SOFT, platform_joint=SOFT).replace(
        base_mount=BASE.replace(**BARE, loss=0.02), platform_mount=TOP.replace(**BARE, loss=0.01)
    ),
    "everything": machine(drive=SERVO, **EVERYTHING),
    "oil": machine(drive=OIL),
    "oil and light pistons": machine(drive=OIL, piston=LIGHT),
}


@pytest.mark.parametrize("pose", [None, {"surge": 0.05, "heave": 0.05, "roll": 0.1}], ids=["home", "away"])
@pytest.mark.parametrize("name", list(MASSLESS))
def test_what_has_no_mass_is_condensed_with_its_dampers(name, pose):
    given = study(MASSLESS[name])
    lin = fx.linearize(given, pose, inputs="wrench", outputs="tool")
    theirs = of_modes(given, pose)
    ours = lin.poles()
    # a damper that all but holds what has no mass makes rates 1e8 apart; modes end at 1e-9 there
    slow, all_of_them = np.abs(theirs) < 1e5, np.abs(theirs) > 0
    assert len(ours) == len(theirs[all_of_them])
    away = np.abs(ours[:, None] - theirs[slow]) / np.abs(theirs[slow])
    assert away.min(axis=0).max() < 1e-9


def test_commands_and_floors_add_integrators_alone():
    given = fx.preset("paper-robot")
    lin = fx.linearize(given, inputs=["command", "floor"], outputs="tool")
    alone = fx.linearize(given, inputs="wrench", outputs="tool")
    assert len(lin.states) == len(alone.states) + 12 + 6
    found = lin.poles()
    assert (found[:18] == 0).all()
    assert apart(found[18:], alone.poles()).max() < 1e-9


def test_states_keep_their_names_over_poses():
    given = sample_study("delta")
    names = {fx.linearize(given, x, inputs="wrench", outputs="tool").states for x in (None, {"heave": 0.01})}
    assert len(names) == 1
