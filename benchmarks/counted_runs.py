"""What is counted: runs in a process whose kernel counts its operations (see `operations.counted`)."""

from __future__ import annotations

from ctypes import CDLL

import numpy as np

from benchmarks.deviation import roll
from benchmarks.operations import KINDS, Count, reader
from flexapod.model import override
from flexapod.solve.robot_march import RobotMarch, prepare

__all__ = ["residual_of_a_leg", "roll_step", "step_within"]

STEPS = 400


def roll_step() -> Count:
    """Mean of a step of the roll at 0.5 ms, records left out."""
    run = prepare(override(roll(), step=5e-4, duration=STEPS * 5e-4, output_step=STEPS * 5e-4))
    counters = reader(_library(run))
    chunks = iter(run.chunks)
    next(chunks)  # the start
    before = counters.copy()
    for _ in chunks:
        pass
    return _count((counters - before) / run.counters.steps)


def step_within() -> Count:
    """Mean of a step of the roll within the default tolerance, records included, to the end of the motion."""
    run = prepare(override(roll(), output_step=1e-2, duration=1.0))
    counters, chunks = reader(_library(run)), iter(run.chunks)
    next(chunks)  # the start
    before = counters.copy()
    for _ in chunks:
        pass
    return _count((counters - before) / run.counters.steps)


def residual_of_a_leg() -> Count:
    """One call of the generated residual, for comparison with CasADi's list of instructions."""
    run = prepare(override(roll(), step=5e-4))
    kernel, n = run.system.kernel, run.system.n
    counters = reader(_library(run))
    before = counters.copy()
    kernel.leg_residual(np.ones(n), np.ones(n), np.ones(n), np.ones(3), np.ones(2), run.system.leg_p[0])
    return _count(counters - before)


def _library(run: RobotMarch) -> CDLL:
    library = run.system.kernel.library
    if library is None:
        raise RuntimeError("the kernel is interpreted")
    return library


def _count(numbers: np.ndarray) -> Count:
    return Count(**{kind: float(x) for kind, x in zip(KINDS, numbers, strict=True)})
