"""A step of robots of many kinds beside that of a 6-UPS, operations of their legs, and the first compilation."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import flexapod as fx
from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod.mechanics.symbolic.functions import operations
from flexapod.model import Study
from flexapod.solve.kernel import Kernel
from flexapod.solve.time import native
from flexapod.solve.time.robot_march import prepare

__all__ = ["count", "first_run", "least_step", "mechanisms", "with_step"]

COMMAND = "python -m benchmarks mechanisms"
SAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"
NAMES = ("hexapod", "tripod", "tricept", "hexaglide", "eight-legs", "delta", "planar", "flexures")
SHAPES, REPEATS, RUNS, STEP = 3, 9, 5, 1e-4
LANES = 8  # of a vector on this kind of machine; eight legs fill one
FIRST = """
import flexapod as fx, sys, resource
fx.simulate(fx.load(sys.argv[1]), modes=int(sys.argv[4]), **{sys.argv[2]: float(sys.argv[3])}, duration=1e-2)
print(max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))
"""


def with_step(study: Study) -> Study:
    """A study with a fixed step and as many shapes as all have."""
    simulation = study.simulation.replace(modes=SHAPES, step=STEP, tolerance=None, duration=0.1)
    return study.replace(simulation=simulation)


def least_step(study: Study) -> float:
    """Seconds of one step in C: of some runs the least, without what the machine does beside it."""
    return min(_run(study) for _ in range(RUNS))


def _run(study: Study) -> float:
    """Seconds of a step of one run, without the tables of commands."""
    spent, steps, plain = 0.0, 0, native.advance

    def timed(*arguments: object, **more: object) -> native.Advance:
        nonlocal spent, steps
        begin = time.process_time()
        result = plain(*arguments, **more)  # type: ignore[arg-type]
        spent, steps = spent + time.process_time() - begin, steps + result.step
        return result

    native.advance = timed  # type: ignore[assignment]
    try:
        for _ in prepare(study).chunks:
            pass
    finally:
        native.advance = plain
    return spent / steps


def count(kernel: Kernel, name: str) -> float:
    from flexapod.mechanics.leg.kernel_functions import leg_functions

    function = next(f for f in leg_functions(kernel.shapes) if f.name == name)
    return float(sum(operations(function.build()).values()))


def _of_a_step(counts: list[float]) -> float:
    """Operations of a leg in a step: residuals before each of two corrections, matrices in one step of sixteen."""
    return 2 * counts[0] + counts[1] / 16


def first_run(file: Path, *how: str, modes: int = SHAPES) -> tuple[float, float]:
    """Seconds and largest memory [MB] of the first run ever of a study, as a process, with the compiler's.

    ``how``: ``step`` or ``tolerance`` and its value; without, a fixed step. ``modes``: shapes of a plane.
    """
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        environment = os.environ | {"FLEXAPOD_CACHE": folder}
        line = [sys.executable, "-c", FIRST, str(file), *(how or ("step", "1e-3")), str(modes)]
        run = subprocess.run(line, check=True, env=environment, capture_output=True, text=True)
        return time.perf_counter() - begin, float(run.stdout.split()[-1]) / 1024


def mechanisms() -> list[Section]:
    """One section: a row a robot."""
    studies = {name: with_step(fx.load(SAMPLES / f"{name}.toml")) for name in NAMES}
    for study in studies.values():
        least_step(study)
    steps = interleaved({name: (lambda s=study: least_step(s)) for name, study in studies.items()}, REPEATS)
    first = {name: first_run(SAMPLES / f"{name}.toml")[0] for name in NAMES}
    rows, base = [], steps[NAMES[0]].median
    own: list[float] = []
    for name, study in studies.items():
        kernel = prepare(study).system.kernel
        counts = [count(kernel, function) for function in ("leg_residual", "leg_matrices")]
        own = own or counts
        share = _of_a_step(counts) / _of_a_step(own)
        groups = -(-study.robot.count // LANES)
        ratio = steps[name].median / base / groups
        rows.append(
            [
                study.robot.type,
                steps[name].text("us", 1e6),
                f"{ratio:.2f} a group, {goal(ratio, 1.5, 'at most 1.5')}",
                ", ".join(f"{n:.0f} ({n / most:.2f})" for n, most in zip(counts, own, strict=True)),
                f"{share:.2f}, {goal(share, 1.5, 'at most 1.5')}",
                f"{first[name]:.1f} s, {goal(first[name], 10.0, 'at most 10')}",
            ]
        )
    header = [
        "Robot",
        "Step in C",
        "Of a 6-UPS",
        "Operations of a leg: residual, matrices (of a 6-UPS)",
        "Of a step's",
        "First run ever",
    ]
    remarks = [f"{SHAPES} shapes per plane; operations of CasADi's list; two residuals a step, matrices in one of 16."]
    return [Section(title="Robots of many kinds", command=COMMAND, header=header, rows=rows, remarks=remarks)]
