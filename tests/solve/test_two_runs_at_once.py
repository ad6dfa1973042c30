"""Runs that take turns, some steps each, give the bits of runs one after the other: their state is their own."""

from dataclasses import replace
from threading import Thread

import numpy as np
import pytest

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.model import override, preset
from flexapod.solve.time import native
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.robot_march import prepare

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]

STEP, STEPS, TURN = 5e-4, 60, 4  # a matrix serves up to 16 steps: most turns begin with one of a turn before


class Run:
    """A robot's steps in turns, each from where the one before ended."""

    def __init__(self, **settings) -> None:
        study = override(preset("machine-hexapod"), step=STEP, **settings)
        march = prepare(study)
        self.system, self.flow, self.before, self.rows = march.system, march.start, None, []
        law = robot_law(
            self.system, study.robot, study.load, lambda t: kinematics.rigid_poses(study.robot, study.motion, t)
        )
        self.tables = law(np.arange(STEPS + 1) * STEP)

    def advance(self, first: int, last: int) -> None:
        part = tuple(x[first : last + 1] for x in self.tables)
        method, flow = GeneralizedAlpha(0.9), self.before.flow if self.before else self.flow
        self.before = native.advance(self.system, method, flow, STEP, part, 1, Counters(), before=self.before)
        assert self.before.status == 0
        self.rows.append(self.before.rows)

    def all(self) -> np.ndarray:
        return np.concatenate(self.rows)


def settings():
    """Runs with more and fewer coordinates, and two that share a kernel."""
    return {"fidelity": "lumped"}, {"fidelity": "assumed-modes"}, {"fidelity": "lumped"}


@pytest.fixture(scope="module")
def alone():
    found = []
    for given in settings():
        run = Run(**given)
        run.advance(0, STEPS)
        found.append(run.all())
    return found


def test_turn_by_turn(alone):
    runs = [Run(**given) for given in settings()]
    for first in range(0, STEPS, TURN):
        for run in runs:
            run.advance(first, first + TURN)
    for run, rows in zip(runs, alone, strict=True):
        np.testing.assert_array_equal(run.all(), rows)


def test_begun_in_one_thread_and_ended_in_another(alone):
    run = Run(**settings()[0])
    run.advance(0, TURN)
    thread = Thread(target=run.advance, args=(TURN, STEPS))
    thread.start()
    thread.join()
    np.testing.assert_array_equal(run.all(), alone[0])


def test_saved_and_restored(alone):
    """A copy of the memory, at another place, goes on with the bits of what it is a copy of."""
    run, again = Run(), Run()
    run.advance(0, TURN + 1)
    size = run.before.memory.size
    elsewhere = native.memory(8 * size + native.LINE)[native.LINE // 8 :]
    elsewhere[:] = run.before.memory
    again.before, again.rows = replace(run.before, memory=elsewhere), [run.rows[0]]
    for one in (run, again):
        one.advance(TURN + 1, STEPS)
        np.testing.assert_array_equal(one.all(), alone[1])


def test_memory_is_zero_and_begins_where_vectors_may():
    system = Run().system
    settings = native.settings(system, GeneralizedAlpha(0.9), STEP, 1)
    found = native.memory(native.loops(system.kernel).march_memory(native.byref(settings)))
    assert not found.any()
    assert found.ctypes.data % native.LINE == 0


def test_loops_for_other_vectors_are_refused(monkeypatch):
    run = Run()
    made = iter((2, 4))
    monkeypatch.setattr(native, "lanes", lambda _: next(made))
    with pytest.raises(ComputationError, match="not compiled for the same processor"):
        run.advance(0, 1)
