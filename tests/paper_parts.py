"""The parts of the paper's study for tests: those of `replicate`, each computed once."""

from functools import cache

from flexapod.model import preset
from flexapod.paper.study import STEPS, PaperStudy
from flexapod.paper.variants import HALF_ANGLES, half_angle_sweep

SWEEPS = {"half-angles": "paper-robot", "half-angles-radii": "paper-robot-radii"}


def quiet(_):
    pass


@cache
def part(name):
    """One part by its name."""
    return next(step for step in STEPS if step.name == name).compute(quiet)


@cache
def study_parts(angles=HALF_ANGLES):
    """Every part of `replicate` by name, at some of the half-angles."""
    return {
        step.name: part(step.name)
        if step.name not in SWEEPS or angles == HALF_ANGLES
        else half_angle_sweep(preset(SWEEPS[step.name]), angles, quiet)
        for step in STEPS
    }


def whole_study(angles=HALF_ANGLES):
    return PaperStudy(parts=study_parts(angles))
