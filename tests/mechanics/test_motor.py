"""Motors of screws: ripple in torque and in position, its row of the budget, currents."""

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.helpers.machines import SCREW, machine, study
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod import model
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import InputError
from flexapod.model import Loop, Motor, Ripple, Rotor
from flexapod.output.text.check import check_items
from flexapod.output.text.terminal import print_items

pytestmark = pytest.mark.consistency

RIPPLE = Ripple(torque=0.4, per_turn=6, harmonics=[1.0, 0.0, 0.3])
MOTOR = Motor(ripple=RIPPLE, torque_constant=0.8)
DRIVE = SCREW.replace(motor=MOTOR, rotor=Rotor(inertia=2e-3, ratio=2))
LOOP = Loop(stiffness=2e3, damping=60.0)
TEXT = model.preset_text("machine-hexapod")
OLD = 'command = "position"         # ours'


def torque(angle, at=RIPPLE):
    """Of the motor on the screw by its own angle: harmonics by hand, twice as fast as the screw."""
    return -2 * at.torque * sum(h * np.sin(k * 2 * at.per_turn * angle) for k, h in enumerate(at.harmonics, start=1))


def test_a_held_rotor_shows_it_in_its_torque_alone():
    ours, theirs = (
        fx.simulate(study(machine(drive=x), fidelity="lumped", step=1e-3))
        for x in (DRIVE, DRIVE.replace(motor=Motor()))
    )
    np.testing.assert_allclose(ours.com_position, theirs.com_position, rtol=0, atol=1e-12)
    # The motor gives what the ripple takes, 0.4 N m of 3; differences of two solutions of 1e-6 N.
    expected = -torque(theirs.drive_position.values)
    np.testing.assert_allclose((ours.drive_force - theirs.drive_force).values, expected, rtol=0, atol=1e-6)
    assert np.abs(expected).max() > 0.5


def test_a_rotor_in_a_loop_yields_to_it():
    drive = DRIVE.replace(command="servo", loop=LOOP)
    given = study(machine(drive=drive), fidelity="lumped", step=1e-3, duration=0.002)
    data = fx.simulate(given.replace(motion=given.motion.replace(amplitude=0.0))).isel(time=0)
    command, thrust = data.drive_command.values, data.actuator_force.values * drive.per_turn
    for i in range(6):
        # Loop and ripple bear the thrust; its share by the screw's softening is 1e-5 of it.
        def left(angle, i=i):
            return LOOP.stiffness * (command[i] - angle) + torque(angle) - thrust[i]

        alone = brentq(left, command[i] - 0.01, command[i] + 0.01, xtol=1e-14)
        assert float(data.drive_position[i]) == pytest.approx(alone, abs=1e-7)


def test_energy_closes_to_second_order():
    errors, drive = [], DRIVE.replace(command="servo", loop=LOOP)
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(study(machine(drive=drive), fidelity="lumped", step=step, duration=0.1)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)


def test_row_of_the_budget_is_the_spread_over_phases():
    small = RIPPLE.replace(torque=0.02)
    drive = DRIVE.replace(command="servo", loop=LOOP, motor=Motor(ripple=small))
    robot = machine(drive=drive)
    found = fx.budget(study(robot, fidelity="lumped"))
    # A rotor anywhere in a period, under the loop: (0.02 * 2 * 12 / 2000)^2, 6e-8, is what first order leaves out.
    phase = np.random.default_rng(3).uniform(0, 2 * np.pi / 12, 40_000)
    moved = torque(phase, small) / LOOP.stiffness * drive.per_turn
    assert small.spread(drive) == pytest.approx(np.std(moved), rel=0.02)
    # Of one leg at the tool, by the encoder's row of the same size.
    encoder = model.Encoder(resolution=small.spread(drive) * np.sqrt(12) / drive.per_turn * 2)
    other = fx.budget(study(machine(drive=drive.replace(motor=Motor(), encoder=encoder)), fidelity="lumped"))
    np.testing.assert_allclose(
        found.budget.sel(part="ripple", kind="random"), other.budget.sel(part="encoder", kind="random"), rtol=1e-9
    )
    # It returns with the stroke: the same at each approach of a pose, and nothing of the repeatability.
    assert str(found.nature.sel(part="ripple").values) == "" and not found.repeatability_unidirectional.any()
    assert found.pose_accuracy[0, 2] > found.pose_accuracy[1, 2] + 2 * found.budget.sel(part="ripple")[2, 2]
    assert "standard deviations of ripple" in found.attrs["summary"]
    # What is systematic is not touched by it, nor are modes.
    plain = machine(drive=drive.replace(motor=Motor()))
    np.testing.assert_array_equal(fx.modes(robot).frequency, fx.modes(plain).frequency)
    for change in ({"command": "position", "loop": None}, {"loop": LOOP.replace(integral=1e3)}):
        assert small.spread(drive.replace(**change)) == 0


def test_currents_are_in_check(capsys):
    ours = TEXT.replace(OLD, f'motor = {{ torque_constant = "0.5 N m/A" }}\n{OLD}')
    found = describe(model.loads(ours))
    one = found.screws[0]
    assert one.current == pytest.approx(one.torque.value / 0.5) and one.rms_current == pytest.approx(
        one.rms_torque / 0.5
    )
    print_items(check_items(found))
    assert "current [A]" in capsys.readouterr().out
    print_items(check_items(describe(model.loads(TEXT))))
    assert "current [A]" not in capsys.readouterr().out


@pytest.mark.parametrize(("text", "key"), [
    ('{ ripple = { torque = "0.1 N m" } }', "per_turn"),
    ('{ ripple = { torque = "0.1 N m", per_turn = 0 } }', "per_turn"),
    ('{ ripple = { torque = "-0.1 N m", per_turn = 6 } }', "torque"),
    ('{ ripple = { torque = "0.1 N m", per_turn = 6, harmonics = [1, 1, 1, 1, 1] } }', "harmonics"),
    ('{ torque_constant = "0.1 N m" }', "torque_constant"),
])  # fmt: skip
def test_refused(text, key):
    with pytest.raises(InputError) as caught:
        model.loads(TEXT.replace(OLD, f"motor = {text}\n{OLD}"))
    assert caught.value.key.endswith(key)


def test_files():
    text = 'motor = { torque_constant = 0.5, ripple = { torque = "50 mN m", per_turn = 24, harmonics = [1, 0.2] } }'
    given = model.loads(TEXT.replace(OLD, f"{text}\n{OLD}"))
    np.testing.assert_array_equal(given.robot.legs[0].screw.motor.ripple.harmonics, [1, 0.2])
    assert model.loads(model.to_toml(given)).robot == given.robot
