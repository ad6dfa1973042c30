"""What is counted: runs in a process whose kernel counts its operations (see `operations.counted`)."""

from __future__ import annotations

import numpy as np

from benchmarks.deviation import roll
from benchmarks.operations import KINDS, Count, reader
from flexapod.model import override
from flexapod.solve.time.native import loops
from flexapod.solve.time.robot_march import RobotMarch, prepare

__all__ = ["residual_of_a_leg", "roll_step", "step_within"]

STEPS = 400


def roll_step() -> Count:
    """Mean of a step of the roll at 0.5 ms, records left out."""
    run = prepare(override(roll(), step=5e-4, duration=STEPS * 5e-4, output_step=STEPS * 5e-4))
    chunks = iter(run.chunks)
    next(chunks)  # the start
    before = _counted(run)
    for _ in chunks:
        pass
    return _count((_counted(run) - before) / run.counters.steps)


def step_within() -> Count:
    """Mean of a step of the roll within the default tolerance, records included, to the end of the motion."""
    run = prepare(override(roll(), output_step=1e-2, duration=1.0))
    chunks = iter(run.chunks)
    next(chunks)  # the start
    before = _counted(run)
    for _ in chunks:
        pass
    return _count((_counted(run) - before) / run.counters.steps)


def residual_of_a_leg() -> Count:
    """One call of the generated residual, for comparison with CasADi's list of instructions."""
    run = prepare(override(roll(), step=5e-4))
    kernel, n = run.system.kernel, run.system.n
    before = _counted(run)
    kernel.leg_residual(np.ones(n), np.ones(n), np.ones(n), np.ones(3), np.ones(2), run.system.leg_p[0])
    return _count(_counted(run) - before)


def _counted(run: RobotMarch) -> np.ndarray:
    """What equations and time loops have counted so far, (6,)."""
    library = run.system.kernel.library
    if library is None:
        raise RuntimeError("the kernel is interpreted")
    return reader(library) + reader(loops(run.system.kernel))


def _count(numbers: np.ndarray) -> Count:
    return Count(**{kind: float(x) for kind, x in zip(KINDS, numbers, strict=True)})
