"""The false root of orientation closures, half a turn off, where their rows vanish as well: nobody takes it."""

from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.moving import moving

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.kinematics.closures import Closed, Task, gaps, solve_closures
from flexapod.kinematics.leg_geometry import COORDINATES, limbs
from flexapod.kinematics.screws import screws
from flexapod.solve.batch import RestStates
from flexapod.solve.rigid_motion import rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.assembly_mode import assembly_changes, refuse_assembly_change
from flexapod.solve.time.robot_march import _Range, prepare

pytestmark = pytest.mark.consistency

SPIN, GAMMA3 = COORDINATES.index("spin"), COORDINATES.index("gamma3")


def test_rigid_legs_are_not_closed_there():
    legs = limbs(ROBOTS["6-UCU"](), rigid=True)
    turned = legs.home.copy()
    turned[2, SPIN] += np.pi  # the cross at the platform stands upside down
    pose = kinematics.Poses.at_rest(legs.position, legs.rotation)
    assert np.abs(gaps(legs, screws(legs, turned[None]), pose)).max() < 1e-12
    task = Task(legs.unknown, np.zeros(6, dtype=bool), np.zeros(3))
    there = Closed(q=turned[None], x=np.zeros((1, 6)), gap=np.zeros((1, 6)))
    assert np.isnan(solve_closures(legs, task, legs.home[None], pose, there).q).all()
    assert not np.isnan(solve_closures(legs, task, legs.home[None], pose).q).any()


@pytest.fixture(scope="module")
def turned():
    """A study, its system, and the state at its start with a leg half a turn off."""
    study = moving("6-UCU", fidelity="rigid", modes=None, duration=0.004)
    system = robot_system(study.robot, study.simulation, 0.0)
    state = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1)))
    q = state.q.copy()
    q[2, system.kernel.shapes.index("spin")] += np.pi
    return study, system, state, replace(state, q=q)


def test_a_march_does_not_start_there(turned):
    study, _, right, wrong = turned
    assert prepare(study, right)
    with pytest.raises(ComputationError, match="leg 3 meets the platform half a turn off"):
        prepare(study, wrong)


def test_a_march_stops_there(turned):
    study, system, right, wrong = turned
    for state, message in (
        (right, ""),
        (wrong, "leg 3 left .* at t = 0.5 s: its joint at the platform has turned over"),
    ):
        recorded = SimpleNamespace(time=np.array([0.5]), q=state.q[None], pose=state.pose[None])
        with pytest.raises(ComputationError, match=message) if message else nullcontext():
            _Range(study, system, controlled=False)(recorded)


def test_it_is_not_an_equilibrium(turned):
    study, system, right, wrong = turned
    right, wrong = RestStates.from_state(right), RestStates.from_state(wrong)
    assert assembly_changes(system, study.robot, right, wrong).all()
    assert not assembly_changes(system, study.robot, right, right).any()
    with pytest.raises(ComputationError, match="leg 3 meets the platform half a turn off"):
        refuse_assembly_change(system, study.robot, right, wrong)
