"""What the time loop says when the tolerance is out of reach, and when it cannot change its step."""

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.runs import paper_robot

import flexapod as fx
from flexapod.mechanics.layout import LEG_PARAMETERS, columns
from flexapod.solve import march, native
from flexapod.solve.robot_march import prepare
from flexapod.solve.saddle import saddle_solve


def test_the_message_pairs_the_error_with_the_steps_it_was_measured_with(monkeypatch):
    """It once named the steps of the next try, up to eight times those that gave the error."""
    runs, errors = [], []

    def recorded(self, flow, grid, per_output):
        runs.append(per_output)
        return run(self, flow, grid, per_output)

    def measured(self, *arguments):
        errors.append(error(self, *arguments))
        return errors[-1]

    run, error = march._Control._run, march._Control._error
    monkeypatch.setattr(march._Control, "_run", recorded)
    monkeypatch.setattr(march._Control, "_error", measured)
    found = prepare(paper_robot(fidelity="lumped", duration=0.02, tolerance=1e-11))
    with pytest.raises(fx.ComputationError, match="out of reach") as raised:
        list(found.chunks)
    words = re.search(r"from (\d+) to (\d+) steps per output the result still changes by (\S+),", str(raised.value))
    assert words is not None
    assert [int(words[1]), int(words[2])] == runs[-2:]
    assert words[3] == f"{errors[-1]:.2g}"


def test_a_step_that_cannot_be_changed_is_told():
    """Legs without any mass: the metric that splits off the normal velocities is singular. Once it went on."""
    ready = prepare(paper_robot(duration=0.01, tolerance=1e-4))
    system, flow = ready.system, ready.start
    assert np.isfinite(native.scaled_defect(system, flow, 4.0).v).all()
    leg_p = system.leg_p.copy()
    for name in ("rhoA", "cylinder_mass", "cylinder_inertia"):
        leg_p[:, columns(LEG_PARAMETERS, name)] = 0.0
    with pytest.raises(fx.ComputationError, match="mass matrix is singular"):
        native.scaled_defect(replace(system, leg_p=leg_p), flow, 4.0)


def test_equations_of_motion_that_are_singular_are_told():
    """Once a bare LinAlgError, for pistons of 1e-300 kg/m."""
    with pytest.raises(fx.ComputationError, match="a leg has next to no mass"):
        saddle_solve(np.diag([1.0, 0.0]), np.array([[1.0, 0.0]]), np.ones(2), np.zeros(1))


@pytest.mark.parametrize("needed", [4, 16])
def test_steps_too_long_for_newton_are_shortened_before_giving_up(needed, monkeypatch):
    """Eight steps an output are tried; where these fail as well, it is the robot and not the step."""
    run = march._Control._run

    def failing(self, flow, grid, per_output):
        if per_output < needed:
            raise fx.ComputationError("the step's equations were not solved")
        return run(self, flow, grid, per_output)

    monkeypatch.setattr(march._Control, "_run", failing)
    chunks = prepare(paper_robot(fidelity="lumped", duration=0.02, tolerance=0.5)).chunks
    if needed > march.SHORT / 2:  # the coarse run has half as many
        with pytest.raises(fx.ComputationError, match="not solved"):
            list(chunks)
        return
    found = list(chunks)
    assert found[-1].recording.time[-1] == pytest.approx(0.02)
    assert {round(1e-3 / chunk.step) for chunk in found[1:]} == {march.SHORT}
