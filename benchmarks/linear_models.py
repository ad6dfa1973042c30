"""The linear model: one pose, its response at many frequencies, many poses."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod.analysis import linearize
from flexapod.model import preset

__all__ = ["linear_models"]

COMMAND = "python -m benchmarks linear-models"
POSES, REPEATS = 1000, 7
HZ = np.geomspace(1.0, 1e3, 1000)
INPUTS, OUTPUTS = ["wrench", "floor"], ["tool", "stroke", "drive-force", "accelerometer:tool", "com"]


def linear_models() -> list[Section]:
    """One section, processor time."""
    robots = {name: preset(name) for name in ("paper-robot", "machine-hexapod")}
    models = {name: linearize(one, inputs=INPUTS, outputs=OUTPUTS) for name, one in robots.items()}  # compiles
    heave = {"heave": np.linspace(-0.01, 0.01, POSES)}
    actions: dict[str, Callable[[], object]] = {}
    for name, one in robots.items():
        actions[f"{name}, one pose"] = lambda one=one: linearize(one, inputs="wrench", outputs="tool")
        actions[f"{name}, all channels"] = lambda one=one: linearize(one, inputs=INPUTS, outputs=OUTPUTS)
        actions[f"{name}, response"] = lambda name=name: models[name].frequency_response(HZ)
        actions[f"{name}, {POSES} poses"] = lambda one=one: linearize(one, heave, inputs="wrench", outputs="tool")
    times = interleaved({name: (lambda a=a: _seconds(a)) for name, a in actions.items()}, REPEATS)
    limits = {"paper-robot, one pose": (0.015, "15 ms"), "machine-hexapod, one pose": (0.020, "20 ms")}
    limits |= {f"{name}, response": (0.1, "0.1 s") for name in robots}
    limits |= {f"{name}, {POSES} poses": (2.0, "2 s") for name in robots}
    rows = [
        [what, spread.text(), goal(spread.median, *limits[what]) if what in limits else ""]
        for what, spread in times.items()
    ]
    size = f"{len(INPUTS) * 6} x {len(models['paper-robot'].outputs)}"
    return [
        Section(
            title="Linear models",
            command=COMMAND,
            header=["what", "cost", "goal"],
            rows=rows,
            remarks=[
                f"Medians of {REPEATS} interleaved runs on one core; responses of {size} at {HZ.size} frequencies."
            ],
        )
    ]


def _seconds(action: Callable[[], object]) -> float:
    begin = time.process_time()
    action()
    return time.process_time() - begin
