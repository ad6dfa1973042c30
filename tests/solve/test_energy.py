"""Energy over time: free vibration, damped and driven motion."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.runs import balance, paper_robot, run_actuator, run_robot, with_legs

from flexapod import kinematics
from flexapod.model import ServoDrive, override, preset
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.solve.time.actuator_march import actuator_system

pytestmark = pytest.mark.conservation

RHO, STEPS, PERIODS = 0.9, 200, 10
CHI, OM = (1 - RHO) / (1 + RHO), 2 * np.pi / STEPS
LOSS = 2 * np.pi * CHI**3 * OM**3  # relative energy loss a period, REFERENCES section 7


def check_loss(energy, vibration):
    """Energy at whole periods: total loss below 1e-6 of the vibration energy, per period within 20 % of theory."""
    lost = (energy[0] - energy[-1]) / vibration
    assert 0 < lost < 1e-6
    assert lost / PERIODS == pytest.approx(LOSS, rel=0.2)


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_free_vibration_of_the_actuator(mode):
    study = preset("paper-actuator")
    still = study.replace(
        motion=study.motion.replace(rotation={"law": "rate", "rate": 0.0}, extension={"law": "rate", "rate": 0.0})
    )
    system = actuator_system(study.actuator, study.simulation)
    basis, p = system.kernel.shapes.beam.a, study.actuator
    omega = basis.shapes[mode].eps ** 2 * np.sqrt(p.EI / p.rhoA) / p.free_length**2
    period = 2 * np.pi / omega
    still = override(still, step=period / STEPS, output_step=period, duration=PERIODS * period)
    run = run_actuator(still, 1e-3 * np.eye(3)[mode])
    check_loss(run["energy"].sum(axis=1), run["energy"][0, 2])


def test_free_vibration_of_the_robot():
    # The lowest mode of the locked robot, started by its velocities, so that the closures hold exactly.
    study = paper_robot(motion={"amplitude": 0.0}, leg={"damping": 0.0})
    found = robot_modes(study.robot, study.simulation)
    period, omega = 1 / found.frequency[0], 2 * np.pi * found.frequency[0]
    study = override(study, step=period / STEPS, output_step=period, duration=PERIODS * period)
    state = replace(found.equilibrium.state, v=1e-3 * omega * found.shapes[0])
    run = run_robot(study, state)
    check_loss(run["energy"].sum(axis=1), 0.5 * (1e-3 * omega) ** 2)
    assert run["closure"].max() < 1e-13  # rounding of metres


@pytest.mark.parametrize("drive", ["prescribed", "servo"])
def test_damped_and_driven_motion_closes_the_balance_at_second_order(drive):
    study = paper_robot(profile="smooth")
    if drive == "servo":
        study = with_legs(study, drive=ServoDrive(stiffness=5e7, damping=2e4))
    study = study.replace(load=study.load.replace(wrench={"law": "constant", "value": [50, -30, 20, 4, 5, -6]}))
    drift = []
    for h in (2e-3, 1e-3, 5e-4):
        run = run_robot(override(study, step=h, output_step=2e-3, duration=1.2))
        drift.append(np.ptp(balance(run)))
        assert run["closure"].max() < 1e-13  # rounding of metres
    assert drift[-1] < 1e-4 * np.ptp(run["sums"][:, 1])
    np.testing.assert_allclose(np.log2(np.array(drift[:-1]) / drift[1:]), 2.0, atol=0.1)
    assert run["sums"][-1, 0] > 0
    assert np.ptp(run["sums"][:, 2]) > 0


def test_sliding_and_turning_actuator_closes_the_balance_at_second_order():
    study = preset("paper-actuator").replace(
        actuator=preset("paper-actuator").actuator.replace(tip_mass=1.0, gravity=9.81, damping=0.01)
    )
    drift = [
        np.ptp(balance(run_actuator(override(study, step=h, output_step=4e-3, duration=2.0))))
        for h in (2e-3, 1e-3, 5e-4)
    ]
    np.testing.assert_allclose(np.log2(np.array(drift[:-1]) / drift[1:]), 2.0, atol=0.1)


def test_momentum_of_a_payload_pulled_by_free_legs():
    # Pure force drives with zero force and no gravity: nothing works on the robot, its energy stays.
    from flexapod.model import ForceDrive

    study = paper_robot(
        leg={"damping": 0.0, "drive": ForceDrive(law="csv", file="none", time=[0.0, 1.0], force=[0.0, 0.0])},
        start="moving",
    )
    study = study.replace(
        robot=study.robot.replace(gravity=[0, 0, 0]), motion=study.motion.replace(profile="smooth", duration=1.0)
    )
    study = override(study, fidelity="lumped", step=5e-4, duration=0.05)
    path = kinematics.poses(study.robot, study.motion, np.array([0.5]))
    from flexapod.solve.rigid_motion import rigid_state
    from flexapod.solve.robot_system import robot_system

    state = rigid_state(robot_system(study.robot, study.simulation, 0.0), kinematics.RigidPoses(study.robot, path))
    run = run_robot(study, replace(state, v_dot=np.zeros_like(state.v_dot)))
    energy = run["energy"].sum(axis=1)
    assert run["energy"][0, 0] > 1.0
    assert np.ptp(energy) < 1e-5 * energy[0]  # order h^2 in a smooth free motion
