"""Order two of positions, velocities and multipliers of the flexible robot over the whole of a smooth motion."""

from itertools import pairwise

import numpy as np
import pytest
from tests.helpers.runs import collect, paper_robot, run_robot

from flexapod import kinematics
from flexapod.model import override
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence

STEPS = (2e-3, 1e-3, 5e-4, 2.5e-4)


@pytest.fixture(scope="module")
def runs():
    # C-infinity law from equilibrium: the stiff axial modes follow quasi-statically and are not part of the error.
    study = override(paper_robot(profile="smooth"), fidelity="lumped", output_step=4e-3, duration=1.2)
    return [run_robot(override(study, step=h)) for h in STEPS]


@pytest.mark.parametrize("name", ["pose", "v", "lam", "drive"])
def test_second_order(runs, name):
    # Successive differences need no reference solution: they fall by 4 when the error is h^2.
    difference = [np.abs(a[name] - b[name]).max() for a, b in pairwise(runs)]
    np.testing.assert_allclose(np.log2(np.array(difference[:-1]) / difference[1:]), 2.0, atol=0.1)


def test_second_order_with_assumed_modes():
    study = override(paper_robot(profile="smooth"), output_step=4e-3, duration=1.2)
    runs = [run_robot(override(study, step=h)) for h in STEPS]
    for name in ("pose", "v", "lam"):
        difference = [np.abs(a[name] - b[name]).max() for a, b in pairwise(runs)]
        np.testing.assert_allclose(np.log2(np.array(difference[:-1]) / difference[1:]), 2.0, atol=0.1)
    assert max(run["closure"].max() for run in runs) < 1e-10


def test_the_start_leaves_the_closure_by_the_square_of_the_step():
    """Rates at the start have a normal part of order h^2 (T6.14) where it moves at once: half a step, a quarter."""
    study = override(paper_robot(profile="linear", start="moving"), fidelity="lumped", output_step=4e-3, duration=4e-3)
    starts = [run_robot(override(study, step=h))["v"][0] for h in STEPS]
    gaps = [np.abs(a - b).max() for a, b in pairwise(starts)]
    assert gaps[0] > 1e-9
    np.testing.assert_allclose(np.divide(gaps[:-1], gaps[1:]), 4.0, rtol=0.02)


def test_tolerance_is_kept():
    # The tolerance bounds the true error (measured against a fine fixed step).
    study = paper_robot(duration=0.5, modes=2)
    reference = run_robot(override(study, step=2e-5, output_step=1e-3))
    path = kinematics.poses(study.robot, study.motion, reference["time"])
    com = path.position + path.rotation @ study.robot.payload.com
    peak = np.abs(reference["pose"][:, :3] - com).max()
    for tolerance in (1e-2, 1e-3, 1e-4):
        run = run_robot(override(study, tolerance=tolerance))
        assert np.abs(run["pose"][:, :3] - reference["pose"][:, :3]).max() < tolerance * peak


def test_a_step_may_span_many_outputs():
    """A slow motion with dense outputs."""
    study = paper_robot(profile="linear", start="moving", fidelity="lumped", output_step=2e-4, duration=0.1414)
    study = study.replace(motion=study.motion.replace(duration=0.1002, amplitude=0.01))
    chunks = list(prepare(override(study, tolerance=0.5)).chunks)
    run, reference = collect(chunks), run_robot(override(study, step=2e-5))
    assert max(chunk.step for chunk in chunks[1:]) > 5 * 2e-4
    np.testing.assert_allclose(run["time"], reference["time"], atol=1e-12)
    path = kinematics.poses(study.robot, study.motion, reference["time"])
    com = path.position + path.rotation @ study.robot.payload.com
    peak = np.abs(reference["pose"][:, :3] - com).max()
    assert np.abs(run["pose"][:, :3] - reference["pose"][:, :3]).max() < 0.5 * peak
