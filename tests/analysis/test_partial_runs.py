"""What is kept of a run that ends early, and what a run keeps in memory."""

import gc
import logging
import tracemalloc

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod.analysis import Interrupted
from flexapod.model import ActuatorLoad, ForceDrive, override
from flexapod.solve.time import robot_march

pytestmark = pytest.mark.unit


def falling():
    """Drives without force: the payload falls until a piston has slid into its cylinder."""
    drive = ForceDrive(law="csv", file="none.csv", time=[0.0, 2.0], force=[0.0, 0.0])
    return paper_robot(leg={"drive": drive}, start="moving", fidelity="lumped", step=1e-3)


@pytest.mark.parametrize("how", [{}, {"tolerance": 1e-4}], ids=["fixed step", "tolerance"])
def test_a_failed_run_keeps_what_was_computed(how, caplog):
    with caplog.at_level(logging.WARNING, logger="flexapod"):
        data = fx.simulate(falling(), **how)
    assert data.attrs["partial"] == 1
    # Everything up to the last output before the failure.
    assert data.attrs["time_reached"] == float(data.time[-1]) == pytest.approx(0.357)
    assert data.sizes["time"] == 358
    assert np.isfinite(data.com_position).all()
    assert (data.leg_stroke > 0.31518).all()
    # Time, cause, leg and advice, in the attributes and in the log.
    failure = data.attrs["failure"]
    assert "leg 1 left the range of the model at t = 0.358 s: its piston has slid wholly into the cylinder" in failure
    assert failure.endswith("Check drive forces and feedback of this leg, or the start.")
    assert failure in caplog.text
    # Free fall of everything: half g t^2, before the motion of the legs counts.
    drop = float(data.com_position_rigid[0, 2] - data.com_position.sel(time=0.05, method="nearest")[2])
    assert drop == pytest.approx(0.5 * 9.81 * 0.05**2, rel=0.05)


@pytest.mark.parametrize("leg", range(6))
def test_a_number_that_becomes_infinite_names_its_leg(leg, monkeypatch):
    """Legs are computed side by side: a NaN of one must not be lost among the numbers of the others."""
    whole = robot_march.robot_law

    def broken(*arguments):
        law = whole(*arguments)

        def spoilt(t):
            table, wrench = law(t)
            table[np.abs(t - 0.0105) < 1e-9, leg] = np.nan
            return table, wrench

        return spoilt

    monkeypatch.setattr(robot_march, "robot_law", broken)
    data = fx.simulate(paper_robot(fidelity="lumped", step=5e-4), duration=0.02)
    assert data.attrs["time_reached"] == pytest.approx(0.01)
    assert f"numbers became infinite in leg {leg + 1}." in data.attrs["failure"]
    assert np.isfinite(data.com_position).all()


def test_what_was_computed_is_what_a_whole_run_has():
    data = fx.simulate(falling())
    whole = fx.simulate(falling(), duration=float(data.time[-1]))
    assert whole.attrs["partial"] == 0
    assert "failure" not in whole.attrs
    # Chunks of other lengths renew Newton's matrix at other steps: equal to its residual test.
    np.testing.assert_allclose(data.com_position, whole.com_position, atol=1e-10)


def test_a_run_that_fails_within_the_first_outputs():
    def drive(force):
        return ForceDrive(law="csv", file="none.csv", time=[0.0, 2.0], force=[force, force])

    data = fx.simulate(with_legs(falling(), drive=drive(-5e4)))
    assert data.attrs["partial"] == 1
    assert 2 < data.sizes["time"] < 30
    # The first thing that went wrong, not what came of it some steps later.
    assert "left the range of the model at t = 0.018 s" in data.attrs["failure"]
    with pytest.raises(fx.ComputationError) as error:  # not one output
        fx.simulate(with_legs(falling(), drive=drive(-5e9)))
    assert error.value.next_step


def test_a_lost_equilibrium_is_told_at_the_start():
    with pytest.raises(fx.ComputationError, match="cannot start at rest: no equilibrium"):
        fx.simulate(paper_robot(), load=[0, 0, -1e6, 0, 0, 0], duration=0.01)


def test_a_failed_actuator_keeps_what_was_computed(caplog):
    study = fx.preset("paper-actuator")
    study = study.replace(
        motion=study.motion.replace(extension=None), load=ActuatorLoad(force={"law": "constant", "value": 20.0})
    )
    data = fx.simulate_actuator(study, step=2e-3)
    assert data.attrs["partial"] == 1
    assert "has left the hub at t = " in data.attrs["failure"]
    assert (data.length <= 3.66).all()
    assert data.attrs["failure"] in caplog.text


class Stop:
    """Ctrl-C once the simulated time has reached an instant."""

    def __init__(self, at):
        self.at, self.calls = at, []

    def __call__(self, reached, whole):
        self.calls.append((reached, whole))
        if reached >= self.at:
            raise KeyboardInterrupt


@pytest.mark.parametrize("preset", ["paper-robot", "paper-actuator"])
def test_an_interrupt_brings_what_was_computed(preset, caplog):
    study, stop = fx.preset(preset), Stop(0.15)
    with pytest.raises(Interrupted, match=r"stopped at t = 0\.34 s") as error:
        fx.run(study, progress=stop)
    data = error.value.dataset
    assert isinstance(error.value, KeyboardInterrupt)
    assert data.attrs["partial"] == 1
    assert data.attrs["failure"] == "stopped by the user"
    assert data.attrs["time_reached"] == pytest.approx(0.34)
    assert data.sizes["time"] == 341
    assert [reached for reached, _ in stop.calls] == pytest.approx([0.0, 0.004, 0.02, 0.084, 0.34])
    assert {whole for _, whole in stop.calls} == {study.duration}
    assert "stopped by the user" in caplog.text


def test_an_interrupt_before_the_first_step_leaves_nothing():
    with pytest.raises(KeyboardInterrupt) as error:
        fx.run(paper_robot(), progress=Stop(0.0))
    assert not isinstance(error.value, Interrupted)


def memory(study):
    """Largest memory in use during a run, and size of what it stores, MB."""
    gc.collect()
    tracemalloc.start()
    try:
        stored = fx.run(study).nbytes
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    return peak / 1e6, stored / 1e6


def test_memory_grows_with_the_stored_output_not_with_the_steps():
    # Warm, so that kernels and imports are not counted. 200 outputs from 200 to 40,000 steps.
    study = paper_robot(fidelity="lumped", duration=2.0, output_step=1e-2, step=1e-2)
    fx.run(study)
    (coarse, stored), (fine, same) = (memory(paper_robot(
        fidelity="lumped", duration=2.0, output_step=1e-2, step=h)) for h in (1e-2, 5e-5))  # fmt: skip
    assert stored == same
    # Beyond it a chunk's tables of at most 2,000 steps, 54 numbers each, with intermediate results: a few MB.
    assert fine - coarse < 5.0


def test_memory_does_not_grow_with_the_simulated_time():
    kept = []
    for duration in (2.0, 16.0):
        study = paper_robot(fidelity="lumped", duration=duration, output_step=duration / 100, step=2e-3)
        fx.run(study)
        kept.append(memory(study))
    (short, a), (long, b) = kept
    assert a == b
    assert long - short < 3.0


def test_memory_does_not_grow_with_the_steps_between_two_outputs():
    """Tables of commands were made for all of them: 1.2 kB a step, 60 MB here."""
    study = paper_robot(fidelity="lumped", duration=0.2, output_step=0.1, step=5e-5)
    fx.run(study)
    few, many = memory(study), memory(override(study, step=2e-6))
    assert few[1] == many[1]
    assert many[0] - few[0] < 3.0  # 8 bytes a step for its instant


def test_memory_within_a_tolerance_does_not_grow_with_the_simulated_time():
    # Both long enough that checks look at all instants of a path, as many in both.
    study = paper_robot(duration=16.0, output_step=0.16, tolerance=1e-4)
    fx.run(study)
    (short, a), (long, b) = memory(study), memory(override(study, duration=32.0, output_step=0.32))
    assert a == b
    assert long - short < 1.0


def test_memory_is_a_small_multiple_of_what_is_stored():
    kept = [memory(paper_robot(fidelity="lumped", duration=T, output_step=5e-3, step=5e-3)) for T in (4.0, 20.0)]
    # Stored once as a record, once as results, and copies while they are computed.
    assert (kept[1][0] - kept[0][0]) < 4 * (kept[1][1] - kept[0][1])


def test_a_piston_pulled_out_by_its_drive_is_told():
    """Drives that push too hard once pushed pistons out of their cylinders without a word."""
    drive = ForceDrive(law="csv", file="much.csv", time=[0.0, 2.0], force=[500.0, 500.0])
    data = fx.simulate(with_legs(falling(), drive=drive))
    assert data.attrs["partial"] == 1
    assert "its piston has been pulled out of the cylinder" in data.attrs["failure"]
    assert (data.leg_stroke <= 0.31518 + 0.75).all()
    # On the way the legs leave their strokes: no command did, so it is a remark.
    assert "its drive leaves the stroke of 0.7 to 1.05 m by 1" in data.attrs["warnings"]


def test_a_run_that_is_whole_but_less_exact_than_asked_says_so(caplog):
    """It once said that only 0.004 s of 0.004 s were computed."""
    with caplog.at_level(logging.WARNING, logger="flexapod"):
        data = fx.simulate(paper_robot(fidelity="lumped", duration=0.004, output_step=0.002, tolerance=1e-15))
    assert data.attrs["partial"] == 1 and data.sizes["time"] == 3
    assert "All 0.004 s were computed, but not as exactly as was asked: tolerance 1e-15" in caplog.text
