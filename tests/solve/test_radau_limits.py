"""Radau's method at its limits: what it is of without a tolerance, stiff and free motions, horizons, dense tables."""

from itertools import pairwise

import numpy as np
import pytest
from tests.helpers.free_actuator import free, inertia
from tests.helpers.runs import paper_robot, run_actuator, run_robot, with_legs

from flexapod import simulate
from flexapod.model import CsvWrench, Load, StepWrench, override, preset
from flexapod.solve.time import radau
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence


def stretching(study, factor, damping=0.01):
    """The study with pistons that many times as stiff along their axis."""
    return with_legs(
        study, lambda leg: leg.replace(damping=damping, piston=leg.piston.replace(EA=factor * leg.piston.EA))
    )


def test_orders_of_a_platform_that_tumbles(monkeypatch):
    """Steps of one length, solved to the end; vibrations of 100 Hz, which they resolve. Multipliers: of stages."""
    study = stretching(paper_robot(fidelity="lumped", duration=0.4, output_step=8e-3, tolerance=0.9), 1e-3, 0.05)
    turns = {"roll": 0.3, "pitch": 0.3, "yaw": 0.3}
    study = study.replace(motion={"type": "combined", "amplitudes": turns, "duration": 0.4, "profile": "smooth"})
    monkeypatch.setattr(radau, "UNSOLVED", 1e-13)

    def run(h, **how):
        monkeypatch.setattr(radau, "FIRST", h)
        monkeypatch.setattr(radau, "LONGEST", h)
        return run_robot(override(study, **how))

    runs = [run(h) for h in (8e-3, 4e-3, 2e-3, 1e-3)]
    for name, order in (("pose", 5.0), ("v", 5.0), ("lam", 3.0)):
        changes = [np.abs(a[name] - b[name]).max() for a, b in pairwise(runs)]
        np.testing.assert_allclose(np.log2(np.array(changes[:-1]) / changes[1:]), order, atol=0.2)
    # Between the ends of steps places are as exact as there, rates of one order less.
    found, true = (run(h, output_step=1e-3) for h in (4e-3, 1e-3))
    for name, more in (("pose", 1.1), ("v", 5.0)):
        error = np.abs(found[name] - true[name]).max(axis=1)
        assert error.max() < more * error[::4].max()


def test_pistons_that_hardly_stretch_at_all():
    """A million times as stiff: the deviation is rounding, which shorter steps do not reduce; steps fell to 0.1 us."""
    found = []
    for factor in (1e5, 1e6):
        march = prepare(stretching(paper_robot(fidelity="lumped", duration=0.2, tolerance=1e-3), factor))
        found.append(np.concatenate([chunk.recording.drive for chunk in march.chunks]))
        assert march.counters.steps < 50_000
    # Errors of 1e-13 m, a ten-thousandth of the least deviation that counts, are 1 of 1900 N in them.
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-3 * np.ptp(found[0]))


def test_last_bits_do_not_decide_on_steps():
    """The first steps, whose estimates are rounding, once limited those after them: 133 steps became 132.

    What differs then is what rounding leaves: 1e-15 m in each of 100 steps, of a deviation of 2e-5 m 5e-9 of it; a part
    of 1e-3 of the tolerance is 20 times as much, and a twentieth of what one step more would bring.
    """
    study = override(preset("paper-robot"), duration=0.2, output_step=0.01)
    payload, found = study.robot.payload, []
    for digits in (0, 4, -31):
        heavier = payload.replace(mass=payload.mass * (1 + digits * np.finfo(float).eps))
        found.append(simulate(study.replace(robot=study.robot.replace(payload=heavier))))
    assert len({data.attrs["steps"] for data in found}) == 1
    first, *others = (data.com_deviation.values for data in found)
    for other in others:
        assert np.abs(other - first).max() < 1e-3 * study.simulation.tolerance * np.abs(first).max()


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_what_has_no_stiffness_is_within_the_tolerance_too(tolerance):
    """A stiff beam that turns and slides freely: its local errors have no stiffness that would tell them."""
    run = run_actuator(free(tip=0.0, fidelity="rigid", tolerance=tolerance, output_step=2e-2))
    length, turn, feed = run["q"][:, 0, 1], run["v"][:, 0], run["v"][:, 1]
    np.testing.assert_allclose(inertia(length) * turn, inertia(1.83) * 0.785, rtol=tolerance)
    energy = 0.5 * inertia(length) * turn**2 + 0.5 * 4.02 * 3.66 * feed**2
    np.testing.assert_allclose(energy, energy[0], rtol=tolerance)


def test_energy_of_a_beam_that_is_free_and_bent():
    for tolerance in (1e-2, 1e-4):
        energy = run_actuator(free(tolerance=tolerance, output_step=2e-2))["energy"].sum(axis=1)
        assert np.ptp(energy) < tolerance * energy[0]


@pytest.mark.parametrize("duration", [1e-6, 1e-5])
def test_horizons_of_a_microsecond(duration):
    for run, name in ((run_robot, "paper-robot"), (run_actuator, "paper-actuator")):
        found = run(override(preset(name), duration=duration, output_step=1e-6))
        assert found["time"][-1] == pytest.approx(duration)


@pytest.mark.parametrize("output_step", [0.05, 1e-3])
def test_rows_of_a_table_that_are_nearer_than_outputs(output_step):
    """A random load each millisecond: of two outputs 50 ms apart, it was lost between them."""
    force = np.random.default_rng(1).normal(size=201) * np.hanning(201)
    load = CsvWrench(time=np.linspace(0, 0.2, 201), wrench=force[:, None] * [60.0, -40.0, 30.0, 5.0, 4.0, -3.0])
    study = paper_robot(fidelity="lumped", duration=0.2).replace(load=Load(wrench=load))
    study = study.replace(motion=study.motion.replace(amplitude=0.0, duration=0.2))
    coarse, fine = (run_robot(override(study, step=h, output_step=0.05))["pose"] for h in (2e-5, 1e-5))
    found = run_robot(override(study, tolerance=1e-4, output_step=output_step))["pose"][:: round(0.05 / output_step)]
    true = fine + (fine - coarse) / 3
    assert np.abs(found - true).max() < 1e-4 * np.abs(true - true[0]).max()


def test_many_steps_between_two_outputs():
    """8192 of them were called out of reach; those of 10 s are 10,000. Both may be off by the tolerance."""
    study = override(preset("paper-robot"), duration=20.0)
    few, many = (deviations(override(study, output_step=step)) for step in (10.0, 0.1))
    assert np.linalg.norm(few[-1] - many[-1]) <= 2 * study.simulation.tolerance * np.linalg.norm(many, axis=1).max()


def deviations(study):
    return simulate(study)["com_deviation"].values


def test_outputs_far_apart_cost_no_steps():
    """From straight legs nothing tells the scales before they sag: every 0.1 s took five times the steps."""
    study = paper_robot(start="straight", duration=0.2, tolerance=1e-2)
    near, far = (simulate(override(study, output_step=step)) for step in (1e-3, 0.1))
    assert far.attrs["steps"] < 1.2 * near.attrs["steps"]
    apart = (far.com_deviation - near.com_deviation.sel(time=far.time, method="nearest")).values
    assert np.abs(apart).max() < 2e-2 * np.abs(near.com_deviation).max()  # both may be off by the tolerance


@pytest.mark.parametrize("away", [0.0, -2e-7])
def test_jumps_next_to_an_output(away):
    # 3 * 0.05 is the next number after 0.15: a step that ends there is still one before the jump.
    study = paper_robot(fidelity="lumped", duration=0.25, output_step=0.05)
    wrench = StepWrench(amplitude=[60.0, -40.0, 30.0, 5.0, 4.0, -3.0], time=0.15 + away)
    study = study.replace(motion=study.motion.replace(amplitude=0.0), load=Load(wrench=wrench))
    rough, fine = (run_robot(override(study, tolerance=tolerance))["pose"][:, :3] for tolerance in (1e-4, 1e-8))
    assert np.abs(rough - fine).max() < 1e-4 * np.abs(fine[:, 2] - study.robot.home_position[2]).max()
