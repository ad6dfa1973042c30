"""The other tools of the benchmarks solve the same problem: our equations as an ODE, and the tuned Exudyn."""

import os

import numpy as np
import pytest
from benchmarks import exudyn_tuned, sweep
from benchmarks.deviation import error, marched, reference, roll, undamped
from benchmarks.ode import ode
from benchmarks.side_by_side import _with_this
from benchmarks.tolerances import cases

from flexapod.model import AxisMotion, override
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_process import solve_in_process
from flexapod.verification.engines.exudyn_robot import RobotProblem, simulate_robot

pytestmark = pytest.mark.consistency


def test_independent_coordinates_give_the_motion_of_the_time_loop():
    study = undamped(roll(duration=0.1))
    study = study.replace(motion=AxisMotion(type="roll", amplitude=0.15, duration=0.1))  # fast: rates matter
    equations = ode(study)
    # In equilibrium: of forces of 1e3 N and masses of grams what rounding and the equilibrium's tolerance leave.
    assert np.abs(equations.rates(0.0, equations.start)).max() < 1e-6
    found, _, _ = equations.solve("DOP853", 1e-5, 4e-3, np.linspace(0.0, 0.1, 11))
    # The march's error of second order, 3e-5 at 12.5 us, is extrapolated away; the next term is smaller by (omega h)^2,
    # 0.06 for 3.5 kHz. Without the closures' curvature the difference is 1e-3.
    assert error(found, reference(study)) < 5e-6


def test_other_studies_as_ordinary_equations():
    """Springs, soft joints and screws; a beam alone: our curve within 1e-7, and SciPy's of the same equations."""
    hexapod, beam = (case.study for case in cases()[1:])
    motion = AxisMotion(type="surge", amplitude=5e-3, duration=0.05)
    for study, method in (
        (override(hexapod.replace(motion=motion), duration=0.1), "Radau"),
        (override(beam, duration=2.0), "DOP853"),
    ):
        ours = marched(override(study, tolerance=1e-7)).curve
        found, _, _ = ode(study).solve(method, 1e-7, 1e-2, ours.time)
        # SciPy's tolerance holds for each of some hundred steps.
        assert error(ours, found) < 1e-5


def test_tuned_exudyn_moves_as_the_untuned(monkeypatch):
    pytest.importorskip("exudyn")
    robot = undamped(roll()).robot
    motion = AxisMotion(type="roll", amplitude=0.1, duration=0.1)
    plan = Integration(duration=0.1, step=1e-3)
    monkeypatch.setenv("PYTHONPATH", _with_this(os.environ.get("PYTHONPATH", "")))
    problem = RobotProblem(robot=robot, motion=motion, integration=plan, elements=3, guide=0.04)
    tuned = solve_in_process(exudyn_tuned.solve, problem)
    plain = simulate_robot(robot, motion, plan, elements=3, guide=0.04)
    # The same equations at the same instants; Newton's tolerance of 1e-6 N leaves less than 1e-6 of forces of 1e3 N.
    scale = np.abs(plain.com_deviation).max()
    assert np.abs(tuned.com_deviation - plain.com_deviation).max() < 1e-6 * scale


def test_a_point_of_a_sweep_is_simulated_bare():
    sweep.bare(sweep.study({"step": 2e-3, "duration": 0.02, "output_step": 2e-3}))
