"""The energy balance of stored results is constant to the integrator's order, whatever drives and damps the motion."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod.model import ForceDrive, ServoDrive, SineWrench

pytestmark = pytest.mark.conservation

STEPS = (2e-3, 1e-3, 5e-4)
GAINS = {"stiffness": 3e7, "damping": 2e4}
WRENCH = SineWrench(amplitude=[60, -40, 30, 5, 4, -3], frequency=3.0, phase=0.4)


def balance(data):
    """Constant of the balance over time [J]."""
    stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
    return (stored - data.work_drive - data.work_external).values


def drifts(run):
    return np.array([np.ptp(balance(run(h))) for h in STEPS])


@pytest.mark.parametrize("drive", ["prescribed", "servo", "force", "mixed"])
def test_balance_of_a_damped_and_driven_robot(drive):
    kinds = {
        "prescribed": {"type": "prescribed"},
        "servo": ServoDrive(**GAINS),
        "force": ForceDrive(law="rigid", feedback=GAINS),
    }
    study = paper_robot(motion={"duration": 0.6, "hold": 0.0}, profile="smooth", duration=0.6)
    names = list(kinds) * 2 if drive == "mixed" else [drive] * 6
    legs = [leg.replace(drive=kinds[name], damping=0.02) for name, leg in zip(names, study.robot.legs, strict=True)]
    study = study.replace(robot=study.robot.replace(legs=tuple(legs)))
    runs = [fx.simulate(study, load=WRENCH, step=h, output_step=2e-3) for h in STEPS]
    found = np.array([np.ptp(balance(data)) for data in runs])
    np.testing.assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.1)
    data = runs[-1]
    assert found[-1] < 1e-4 * np.ptp(data.work_drive.values)
    assert (np.diff(data.energy_dissipated.values) >= -1e-15).all()  # losses only grow
    assert np.ptp(data.work_external.values) > 100 * found[-1]
    assert data.closure_residual.max() < 1e-13  # rounding of metres


@pytest.mark.parametrize("drive", [None, ServoDrive(**GAINS)], ids=["prescribed", "servo"])
def test_balance_of_a_robot_shaken_at_its_first_frequency(drive):
    # Nothing moves but what bends, stretches and gives: the wrench's work goes into damping.
    study = paper_robot(motion={"amplitude": 0.0}, duration=0.5)
    study = with_legs(study, damping=0.02, **{} if drive is None else {"drive": drive})
    frequency = float(fx.modes(study).frequency[0])
    shake = SineWrench(amplitude=[100, 50, 30, 5, 4, -3], frequency=frequency)
    runs = [fx.simulate(study, load=shake, step=h, output_step=2e-3) for h in (1e-3, 5e-4, 2.5e-4)]
    found = np.array([np.ptp(balance(data)) for data in runs])
    np.testing.assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.1)
    data = runs[-1]
    assert float(data.energy_dissipated[-1]) > 20 * found[-1]
    assert float(data.work_external[-1]) > float(data.energy_dissipated[-1])
    assert np.abs(data.work_drive).max() == 0.0


def test_balance_of_a_driven_actuator():
    study = fx.preset("paper-actuator")
    study = study.replace(
        actuator=study.actuator.replace(tip_mass=1.0, gravity=9.81, damping=0.02, hub_inertia=2.0),
        motion=study.motion.replace(rotation=None, extension={"law": "smooth", "amplitude": 0.3, "duration": 1.0}),
        load={"torque": {"law": "sine", "amplitude": 20.0, "frequency": 1.0}},
    )
    runs = [fx.simulate_actuator(study, step=h, output_step=4e-3, duration=1.0) for h in STEPS]
    found = np.array([np.ptp(balance(data)) for data in runs])
    np.testing.assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.1)
    data = runs[-1]
    assert data.energy_dissipated[-1] > 0
    # The work of the drives again, from the stored torque, force and rates.
    power = (data.torque * data.angle_rate + data.force * data.length_rate).values
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1])) * 4e-3])
    np.testing.assert_allclose(data.work_drive, work, atol=2e-3 * np.ptp(work))  # trapezoids over 4 ms


def test_potential_energy_is_the_height_of_all_masses():
    # Rigid legs at home: payload, cylinders and pistons at their heights above the base plane.
    study = paper_robot(leg={"damping": 0.0})
    data = fx.simulate(study, fidelity="rigid", duration=2e-3, step=1e-3).isel(time=0)
    robot, leg = study.robot, study.robot.legs[0]
    upright = robot.home_height / robot.home_lengths
    along = leg.cylinder.mass * leg.cylinder.com + leg.piston.mass * (robot.home_lengths - leg.piston.length / 2)
    height = robot.payload.mass * (robot.home_height + robot.payload.com[2]) + (along * upright).sum()
    assert float(data.energy_potential) == pytest.approx(9.81 * height, rel=1e-12)
    assert float(data.energy_kinetic) < 1e-20  # start values of the integrator round at 1e-15 m/s
    assert float(data.energy_strain) == 0.0


def test_strain_energy_at_rest_is_half_the_work_of_the_forces():
    # Linear springs: half of force times stretch in pistons of hardly any weight, and in servos.
    study = with_legs(paper_robot(), lambda leg: leg.replace(
        drive=ServoDrive(**GAINS), cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
        piston=leg.piston.replace(rhoA=1e-3, E=None, density=None)))  # fmt: skip
    data = fx.simulate(study, fidelity="lumped", duration=1e-3, step=1e-3).isel(time=0)
    piston = study.robot.legs[0].piston
    flexibility = piston.length / piston.EA + 1 / GAINS["stiffness"]
    expected = 0.5 * flexibility * float((data.actuator_force**2).sum())
    assert float(data.energy_strain) == pytest.approx(expected, rel=1e-4)  # 7 mN of weight in 170 N
