"""Pistons that turn in their cylinders and take the nut of their screw along: lengths, moments, energy."""

import numpy as np
import pytest
from tests.helpers.machines import NUT, SCREW, machine, study
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod import model
from flexapod.common.errors import InputError
from flexapod.model import Encoder

pytestmark = pytest.mark.consistency

STIFF = SCREW.replace(bearing=SCREW.bearing.replace(stiffness=1e12), nut=NUT.replace(stiffness=1e12), root_diameter=5.0,
                      material=SCREW.material.replace(density=1e-2))  # fmt: skip
POSE = {"yaw": 0.15, "surge": 0.05}


def robot(drive=SCREW, keyed=False, lead=0.04):
    """6-UCU on screws with a long lead."""
    given = ROBOTS["6-UCU"]()
    drive = drive.replace(lead=lead)
    legs = [leg.replace(drive=drive, piston=leg.piston.replace(keyed=keyed)) for leg in given.legs]
    return given.replace(legs=tuple(legs))


def at_rest(given, pose=POSE):
    return fx.budget(study(given, fidelity="lumped"), pose)


def test_length_is_wrong_by_lead_times_turn():
    # Screws that hardly give way: what is left are the pistons, the same with and without a key.
    free, held = (at_rest(robot(STIFF, keyed)) for keyed in (False, True))
    assert "unkeyed" in free.part.values and "unkeyed" not in held.part.values
    moved = (free.budget_total - held.budget_total).sel(kind="systematic", component=["x", "y", "z"]).values
    row = free.budget.sel(part="unkeyed", kind="systematic", component=["x", "y", "z"]).values
    np.testing.assert_allclose(moved, row, rtol=0, atol=0.03 * np.abs(row).max())
    assert np.abs(row).max() > 1e-5


def test_twice_the_lead_twice_the_error():
    one, two = (
        at_rest(robot(STIFF, lead=lead)).budget.sel(part="unkeyed", kind="systematic").values for lead in (0.01, 0.02)
    )
    np.testing.assert_allclose(two, 2 * one, rtol=0, atol=2e-2 * np.abs(two).max())


def test_energy_closes_to_second_order():
    errors = []
    for step in (1e-3, 5e-4):
        given = study(robot(), fidelity="lumped", step=step, duration=0.1)
        given = given.replace(motion=model.AxisMotion(type="yaw", amplitude=0.05, duration=0.1))
        found = balance(run_robot(given))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)


def test_the_thrust_turns_the_piston():
    given = study(robot(), fidelity="lumped", step=1e-3, duration=0.002)
    given = given.replace(motion=given.motion.replace(amplitude=0.0))
    free, held = (fx.simulate(given.replace(robot=robot(keyed=x))).isel(time=0) for x in (False, True))
    axis = free.joint_force.values / np.linalg.norm(free.joint_force.values, axis=1)[:, None]
    more = ((free.joint_moment - held.joint_moment).sel(end="platform").values * axis).sum(axis=1)
    # The leg's thrust along its axis; its weight lets joint forces lean from it by some hundredths.
    expected = free.actuator_force.values * 0.04 / (2 * np.pi)
    np.testing.assert_allclose(np.abs(more), np.abs(expected), rtol=0.1)


def test_inside_a_loop_it_does_not_count():
    drive = SCREW.replace(encoder=Encoder(at="stroke"))
    assert "unkeyed" not in at_rest(robot(drive)).part.values


def test_elsewhere_it_is_refused():
    piston = machine().legs[0].piston.replace(keyed=False)
    with pytest.raises(InputError, match="keyed"):
        machine(drive=SCREW, piston=piston)
    given = ROBOTS["6-UCU"]()
    with pytest.raises(InputError, match="keyed"):
        given.legs[0].replace(piston=given.legs[0].piston.replace(keyed=False))


def test_files():
    given = study(robot())
    again = model.loads(model.to_toml(given))
    assert again.robot == given.robot and not again.robot.legs[0].piston.keyed
    assert "keyed" not in model.to_toml(study(machine()))
