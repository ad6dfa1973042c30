"""Order two where loads, force tables and commands jump or bend, on the grid of steps and off it."""

import numpy as np
import pytest
from tests.helpers.runs import balance, paper_robot, run_actuator, run_robot, with_legs

import flexapod as fx
from flexapod.model import CsvLaw, CsvWrench, ForceDrive, Load, ServoDrive, StepWrench, override
from flexapod.solve.time import march

pytestmark = pytest.mark.convergence

STEPS = (4e-4, 2e-4, 1e-4)
FINE = 2.5e-5  # error of the reference: 1/16 of the finest run's, which moves its order by 0.09 at most
WRENCH = np.array([60.0, -40.0, 30.0, 5.0, 4.0, -3.0])
GAINS = {"stiffness": 3e6, "damping": 2e4}
T0, T1 = 0.0204, 0.02 + 1 / 3000  # an output, and off the grid of all steps


def pulse(start):
    """A half sine of 20 ms as a table with a row each 0.25 ms; its corners stand at both ends."""
    t = np.linspace(0, 0.02, 81)
    value = np.concatenate([[0], np.sin(np.pi * t / 0.02), [0]])
    return CsvWrench(time=np.concatenate([[0], start + t, [1]]), wrench=value[:, None] * WRENCH)


def table(time, value):
    return CsvWrench(time=time, wrench=np.array(value)[:, None] * WRENCH)


LOADS = {
    "step": StepWrench(amplitude=WRENCH, time=T0),
    "step-between-outputs": StepWrench(amplitude=WRENCH, time=0.02),
    "step-off-the-grid": StepWrench(amplitude=WRENCH, time=T1),
    "two-steps-between-outputs": table([0, T1, T1, T1 + 2.3e-4, T1 + 2.3e-4, 1], [0, 0, 1, 1, -1, -1]),
    "ramp": table([0, T0, 0.05, 1], [0, 0, 1, 1]),
    "ramp-off-the-grid": table([0, T1, 0.05123, 1], [0, 0, 1, 1]),
    "half-sine": pulse(T0),
    "half-sine-off-the-grid": pulse(T1),
}


def robot(profile="smooth", amplitude=0.0, duration=0.08, drive=None, fidelity="lumped"):
    """A robot with its tool beside the centre of mass, pistons damped so that only slow modes ring for long."""
    study = paper_robot(profile=profile, fidelity=fidelity, output_step=1.2e-3, duration=0.084)
    study = study.replace(motion=study.motion.replace(amplitude=amplitude, duration=duration))
    payload = study.robot.payload.replace(tool=[0.1, 0.2, 0.3])
    study = study.replace(robot=study.robot.replace(payload=payload))
    return with_legs(study, damping=0.1, **{"drive": drive} if drive else {})


def errors(study, run, names, steps=STEPS, fine=FINE):
    """Largest error of each quantity over its range, and drift of the energy balance, by step."""
    reference, found = run(override(study, step=fine)), [run(override(study, step=h)) for h in steps]
    measured = {
        name: np.array([np.abs(x[name] - reference[name]).max() for x in found]) / np.ptp(reference[name], axis=0).max()
        for name in names
    }
    return measured, np.array([np.ptp(balance(x)) for x in found])


def order(error):
    return np.log2(error[:-1] / error[1:])


@pytest.mark.parametrize("name", LOADS)
def test_a_wrench_that_jumps_or_bends(name):
    """A step was of first order: 7.2e-3, 3.6e-3, 1.7e-3, 8.1e-4 at 1, 0.5, 0.25, 0.125 ms."""
    found, drift = errors(robot().replace(load=Load(wrench=LOADS[name])), run_robot, ("pose", "v", "lam"))
    for error in found.values():
        np.testing.assert_allclose(order(error)[-1], 2.0, atol=0.1)
    np.testing.assert_allclose(order(drift)[-1], 2.0, atol=0.15)


@pytest.mark.parametrize("duration", [0.048, 0.0777])
@pytest.mark.parametrize(
    "drive",
    [None, ServoDrive(**GAINS), ForceDrive(law="rigid", feedback=GAINS)],
    ids=["prescribed", "servo", "force"],
)
def test_an_acceleration_that_jumps(drive, duration):
    """The profile `trapezoid`: strokes, springs of servos and forces fed forward take the jumps with it."""
    study = robot("trapezoid", 0.01, duration, drive)
    found, drift = errors(study, run_robot, ("pose",), steps=(2e-4, 1e-4, 5e-5), fine=1.25e-5)
    np.testing.assert_allclose(order(found["pose"])[-1], 2.0, atol=0.1)
    np.testing.assert_allclose(order(drift)[-1], 2.0, atol=0.15)


def test_a_rate_that_jumps_between_two_outputs():
    """It was refused."""
    study = robot("linear", 0.001, 0.0205, ServoDrive(**GAINS)).replace(initial={"start": "moving"})
    found, drift = errors(study, run_robot, ("pose",), steps=(2e-4, 1e-4, 5e-5), fine=1.25e-5)
    np.testing.assert_allclose(order(found["pose"])[-1], 2.0, atol=0.1)
    assert order(drift)[-1] > 1.85


@pytest.mark.parametrize("when", [T0, T1])
def test_force_tables_of_drives_that_jump(when):
    drive = ForceDrive(law="csv", time=[0, when, when, 0.05, 1], force=[170, 170, 200, 180, 180], feedback=GAINS)
    found, drift = errors(robot(drive=drive), run_robot, ("pose",), steps=(2e-4, 1e-4, 5e-5), fine=1.25e-5)
    np.testing.assert_allclose(order(found["pose"])[-1], 2.0, atol=0.1)
    np.testing.assert_allclose(order(drift)[-1], 2.0, atol=0.15)


@pytest.mark.parametrize(
    "torque",
    [
        {"law": "step", "amplitude": 20.0, "time": 0.1},
        {"law": "step", "amplitude": 20.0, "time": 0.1003},
        {"law": "linear", "amplitude": 20.0, "duration": 0.0971},
        CsvLaw(time=[0, 0.1003, 0.1003, 0.2, 0.2071, 1], value=[0, 0, 20, 10, 0, 0]),
    ],
    ids=["step", "step-off-the-grid", "ramp", "csv"],
)
def test_torque_and_force_of_a_single_actuator(torque):
    study = fx.preset("paper-actuator")
    study = study.replace(
        actuator=study.actuator.replace(tip_mass=1.0, hub_inertia=2.0),
        motion=study.motion.replace(rotation=None, extension=None),
        load={"torque": torque, "force": {"law": "step", "amplitude": 1.0, "time": 0.0507}},
    )
    study = override(study, output_step=4e-3, duration=0.3, modes=2)
    found, drift = errors(study, run_actuator, ("q", "v"), steps=(1e-3, 5e-4, 2.5e-4), fine=6.25e-5)
    for error in (*found.values(), drift):
        np.testing.assert_allclose(order(error)[-1], 2.0, atol=0.1)


@pytest.mark.parametrize("when", [0.1, 0.10037, 2e-7])
def test_a_constant_force_after_a_jump_is_integrated_exactly(when):
    """The force accelerates all of a straight beam, mass 3.66 m * 4.02 kg/m: a parabola, exact for this method."""
    study = fx.preset("paper-actuator")
    motion = study.motion.replace(extension=None, rotation={"law": "rate", "rate": 0.0})
    study = study.replace(motion=motion, load={"force": {"law": "step", "amplitude": 3.0, "time": when}})
    run = run_actuator(override(study, fidelity="rigid", step=2e-3, output_step=1e-2, duration=0.3))
    late = np.maximum(run["time"] - when, 0)
    travel = run["q"][:, 0, 1] - run["q"][0, 0, 1]
    # Rounding of metres; a break 0.2 us from an instant counts as there: 0.2 N/kg * 2e-7 s * 0.3 s.
    np.testing.assert_allclose(travel, 0.5 * 3.0 / (3.66 * 4.02) * late**2, atol=2e-14 if when > 1e-6 else 2e-8)
    np.testing.assert_allclose(run["sums"][:, 1], 3.0 * travel, atol=1e-13)


def test_the_default_tolerance_is_kept_across_a_step():
    """3e-4 of the deviation at a tolerance of 1e-4, once."""
    study = robot().replace(load=Load(wrench=LOADS["step"]))
    reference, run = (run_robot(override(study, **how)) for how in ({"step": 1.25e-5}, {"tolerance": 1e-4}))
    deviation = reference["pose"] - reference["pose"][0]
    assert np.abs(run["pose"] - reference["pose"]).max() < 1e-4 * np.abs(deviation).max()


@pytest.mark.parametrize("name", ["half-sine", "two-steps-between-outputs"])
def test_tables_made_in_parts_change_no_bit(name, monkeypatch):
    """Of more steps than a chunk's in an output interval, also between breaks."""
    study = override(robot().replace(load=Load(wrench=LOADS[name])), duration=0.036, output_step=0.012, step=1e-4)
    found = []
    for most in (120, 17):  # a chunk is an output interval in both
        monkeypatch.setattr(march, "CHUNK_STEPS", most)
        found.append(run_robot(study))
    assert all(np.array_equal(found[0][name], found[1][name]) for name in ("pose", "lam", "sums"))
