"""What the time loop says when the tolerance is out of reach, and when it cannot change its step."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, columns
from flexapod.solve.saddle_point import saddle_solve
from flexapod.solve.time import native
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.unit


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
