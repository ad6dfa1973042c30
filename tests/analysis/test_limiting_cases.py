"""Limits of drives and stiffness that results must approach."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod.model import ForceDrive, ServoDrive

pytestmark = pytest.mark.property

SHORT = {"duration": 0.4, "step": 5e-4, "output_step": 2e-3}


def rolling(profile="smooth", **leg_changes):
    study = paper_robot(motion={"duration": 0.4, "hold": 0.0}, profile=profile)
    return with_legs(study, **leg_changes) if leg_changes else study


def servo(stiffness):
    """Servo of about 5 % damping of the payload on it."""
    return ServoDrive(stiffness=stiffness, damping=0.1 * np.sqrt(stiffness * 100))


def test_a_stiff_servo_is_a_prescribed_stroke():
    held = fx.simulate(rolling(), fidelity="lumped", **SHORT)
    apart, force, share = [], [], []
    for stiffness in (1e10, 1e11):
        data = fx.simulate(rolling(drive=servo(stiffness)), fidelity="lumped", **SHORT)
        apart.append(float(np.abs(data.com_position - held.com_position).max()))
        force.append(float(np.abs(data.actuator_force - held.actuator_force).max()))
        share.append(float(np.abs(data.deviation_by_cause.sel(cause="drive")).max()))
    # All fall as force over stiffness; what shifts the phase of the vibration is piston over servo stiffness, 1.5 %.
    for limit in (apart, share, force):
        assert limit[0] / limit[1] == pytest.approx(10, rel=0.05)
    assert force[1] < 2e-3 * float(np.abs(held.actuator_force).max())


def test_shares_follow_their_own_stiffness():
    # Ten times stiffer pistons leave a tenth of the stretch and all of what the servos give; and the other way round.
    def shares(factor, stiffness):
        study = with_legs(rolling(drive=servo(stiffness)), lambda leg: leg.replace(
            piston=leg.piston.replace(EA=factor * leg.piston.EA, E=None, density=None)))  # fmt: skip
        data = fx.simulate(study, fidelity="lumped", **SHORT)
        by_cause = np.abs(data.deviation_by_cause.isel(time=0)).max(("leg", "axis"))
        return by_cause.sel(cause=["axial-strain", "drive"]).values

    plain, stiff_piston, stiff_servo = shares(1, 1e8), shares(10, 1e8), shares(1, 1e9)
    np.testing.assert_allclose(plain / stiff_piston, [10, 1], rtol=1e-4)  # the sag turns the legs by 1e-5
    np.testing.assert_allclose(plain / stiff_servo, [1, 10], rtol=1e-4)


@pytest.mark.parametrize("cause", ["axial-strain", "bending"])
def test_stiff_pistons_leave_no_deviation(cause):
    study = with_legs(rolling(), lambda leg: leg.replace(
        piston=leg.piston.replace(EA=1e4 * leg.piston.EA, EI=1e4 * leg.piston.EI, E=None, density=None)))  # fmt: skip
    soft, stiff = (fx.simulate(s, duration=0.4, step=1e-3, output_step=2e-3) for s in (rolling(), study))
    share = [np.abs(data.deviation_by_cause.sel(cause=cause)).max() for data in (soft, stiff)]
    # Bending shortens with the square of the deflection; lengths round at 1e-16 m, times 100 at the payload.
    assert share[1] < max(2e-4 * share[0], 1e-13)
    assert np.abs(stiff.com_deviation).max() < 2e-4 * np.abs(soft.com_deviation).max()


def test_replayed_forces_move_rigid_legs_on_the_rigid_path():
    # No feedback: only the integrator's error, of second order, leads the open-loop robot off its path.
    study = rolling(drive=ForceDrive(law="rigid")).replace(initial={"start": "moving"})
    off = []
    for h in (2e-3, 1e-3, 5e-4):
        data = fx.simulate(study, fidelity="rigid", duration=0.4, step=h, output_step=2e-3)
        off.append(float(np.abs(data.com_deviation).max()))
    assert off[-1] < 1e-5
    np.testing.assert_allclose(np.log2(np.array(off[:-1]) / off[1:]), 2.0, atol=0.1)
    np.testing.assert_allclose(data.actuator_force, data.actuator_force_rigid, atol=1e-9)


def test_replayed_forces_with_feedback_keep_the_elastic_robot_near_its_path():
    drive = ForceDrive(law="rigid", feedback={"stiffness": 1e8, "damping": 1e5})
    data = fx.simulate(rolling(drive=drive), **SHORT)
    servo_only = fx.simulate(rolling(drive=ServoDrive(stiffness=1e8, damping=1e5)), **SHORT)
    give, sag = (np.abs(x.deviation_by_cause.sel(cause="drive")).max() for x in (data, servo_only))
    # Feed-forward takes the load off the spring, all but what the bending and stretching legs need beyond rigid ones.
    assert give < 0.1 * sag
    np.testing.assert_allclose(
        data.actuator_force, data.actuator_force_rigid, atol=0.05 * np.abs(data.actuator_force_rigid).max()
    )


def test_forces_of_the_elastic_robot_are_near_the_rigid_ones():
    data = fx.simulate(rolling(), **SHORT)
    # A smooth 0.4 s roll against eigenfrequencies from 20 Hz: quasi-static, but for the vibration it excites.
    assert np.abs(data.actuator_force - data.actuator_force_rigid).max() < 0.1 * np.abs(data.actuator_force_rigid).max()
    at_rest = data.isel(time=0)
    # Static forces differ with the sagged pose, 2e-5 m over 0.1 m.
    np.testing.assert_allclose(at_rest.actuator_force, at_rest.actuator_force_rigid, rtol=2e-3)
    np.testing.assert_allclose(at_rest.joint_force, at_rest.joint_force_rigid, atol=1.0)
