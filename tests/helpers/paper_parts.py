"""The parts of the paper's study for tests: those of `replicate`, each computed once in a process.

Who asks for them belongs to the group "claims" of pytest-xdist, so that one process does.
"""

from functools import cache

from flexapod.verification.paper.study import STEPS, PaperStudy
from flexapod.verification.paper.variants import HALF_ANGLES


def quiet(_):
    pass


@cache
def part(name):
    """One part by its name."""
    return next(step for step in STEPS if step.name == name).compute(quiet)


@cache
def study_parts(angles=HALF_ANGLES):
    """Every part of `replicate` by name, at some of the half-angles: each is computed by itself."""
    parts = {step.name: part(step.name) for step in STEPS}
    sweeps = ("half-angles", "half-angles-radii")
    return parts | {name: parts[name].sel(half_angle=list(angles)) for name in sweeps}


def whole_study(angles=HALF_ANGLES):
    return PaperStudy(parts=study_parts(angles))


def at_hand(result):
    """In the place of what computes a study: its results."""

    def compute(*, engines, progress, keep):
        for name, data in result.parts.items():
            keep(name, data)
        return result

    return compute
