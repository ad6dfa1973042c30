"""Forces of runs within a tolerance of the deviation: what their estimate says, and that the remark's advice does."""

import re
from functools import cache

import numpy as np
import pytest
from tests.helpers.runs import paper_robot
from tests.helpers.samples import sample_study

from flexapod import simulate
from flexapod.model import override, preset

pytestmark = pytest.mark.convergence


def quick(study, **motion):
    """The study with a motion of 0.3 s and a rest of 0.2 s."""
    motion = study.motion.replace(duration=0.3, hold=0.2, **motion)
    return override(study.replace(motion=motion), duration=0.5, output_step=2e-4)


STUDIES = {
    "paper-robot": lambda: quick(paper_robot()),
    "paper-robot, jumps": lambda: quick(paper_robot(profile="trapezoid")),
    "tripod": lambda: quick(preset("tripod")),
    "tricept": lambda: override(sample_study("tricept"), duration=0.5),
    "machine": lambda: override(preset("machine-hexapod"), duration=0.5),
}


@cache
def reference(name):
    """Drive forces with fixed steps of 20 and 10 us, extrapolated: another method."""
    coarse, fine = (simulate(override(STUDIES[name](), step=h)).drive_force.values for h in (2e-5, 1e-5))
    return fine + (fine - coarse) / 3


def error(name, found):
    true = reference(name)
    return np.abs(found.drive_force.values - true).max() / np.abs(true).max()


@pytest.mark.parametrize("name", STUDIES)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_the_estimate_is_honest(name, tolerance):
    """Not below the true error but for a fifth, since vibrations add up in any phase, and not above ten times it.

    It adds up what damping ends, and so does not know that vibrations after jumps die out, or those of screws, which
    servo drives and friction damp: more there.
    """
    found = simulate(override(STUDIES[name](), tolerance=tolerance))
    ratio = found.attrs["estimated_force_error"] / error(name, found)
    assert 0.8 < ratio < (10.0 if name not in ("machine", "paper-robot, jumps") else 30.0)


def test_forces_beyond_ten_tolerances_are_told_and_the_advice_does():
    """Deviation of a tripod within the default tolerance, drive forces 18 times as wrong: bending makes the former."""
    study = override(STUDIES["tripod"](), tolerance=1e-4)
    found = simulate(study)
    remark = next(line for line in found.attrs["warnings"].splitlines() if line.startswith("forces of the legs"))
    assert error("tripod", found) > 10 * 1e-4
    advised = float(re.search(r"simulation.tolerance = (\S+)$", remark)[1])
    better = simulate(override(study, tolerance=advised))
    assert error("tripod", better) < 10 * 1e-4 and better.attrs["estimated_force_error"] < 10 * 1e-4
    assert "forces of the legs" not in simulate(override(STUDIES["paper-robot"](), tolerance=1e-4)).attrs["warnings"]


def test_fixed_steps_have_no_estimate():
    assert "estimated_force_error" not in simulate(paper_robot(step=1e-3, duration=0.05)).attrs
