"""The single actuator: its few shapes against solid finite elements that slide out of the same hub, whole calls."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.report import Section
from benchmarks.timing import interleaved
from flexapod.analysis import simulate_actuator, simulate_solid
from flexapod.common.arrays import Array
from flexapod.model import override, preset

__all__ = ["one_actuator"]

COMMAND = "python -m benchmarks one-actuator"
TARGET = 0.01
REPEATS = 7
Call = Callable[[], Array]


def one_actuator() -> list[Section]:
    """One section: both tools at an error of the tip's deflection of at most 1 %."""
    ours = _flexapod(1e-5) + (_flexapod(1e-5) - _flexapod(2e-5)) / 3
    solid = _solid(0.02, 2e-3)
    tools = {
        "flexapod": (ours, [(f"step {1e3 * h:g} ms", partial(_flexapod, h)) for h in (5e-3, 2e-3, 1e-3, 5e-4)]),
        "solid elements": (
            solid,
            [(f"elements of {1e3 * d:g} mm, step {1e3 * h:g} ms", partial(_solid, d, h))
             for d, h in ((0.1, 1e-2), (0.05, 1e-2), (0.03, 5e-3))],
        ),
    }  # fmt: skip
    best = {tool: _first(settings, own) for tool, (own, settings) in tools.items()}
    times = interleaved({tool: partial(_seconds, call) for tool, (_, call) in best.items()}, REPEATS)
    rows = []
    for tool, (name, call) in best.items():
        tip, own = call(), tools[tool][0]
        ratio = times[tool].median / times["flexapod"].median
        rows.append([tool, name, f"{100 * _error(tip, own):.2g} %", f"{100 * _error(tip, ours):.2g} %",
                     times[tool].text("ms", 1e3), f"{ratio:.1f}"])  # fmt: skip
    return [
        Section(
            title="One actuator: 10 s of paper-actuator, k = 3, error of the tip's deflection at most 1 %",
            command=COMMAND,
            header=["tool", "setting", "error, own limit", "error, ours", "whole call", "times flexapod's"],
            rows=rows,
            remarks=[
                f"Medians of {REPEATS} interleaved calls (least to largest), time of the processor. Coarsest setting "
                "that keeps 1 % with all finer ones of its list. Limits: steps of 20 and 10 us extrapolated; elements "
                "of 20 mm, 2 ms.",
                f"The two limits differ by {100 * _error(solid, ours):.2g} %. Solid elements: quadratic hexahedra "
                "condensed onto stations, `fx.simulate_solid`. CalculiX has no guide that slides along a body in time.",
            ],
        )
    ]


def _first(settings: list[tuple[str, Call]], own: Array) -> tuple[str, Call]:
    """Coarsest setting that keeps the target with all finer ones; the finest if none does."""
    found = settings[-1]
    for setting in reversed(settings):
        if _error(setting[1](), own) > TARGET:
            break
        found = setting
    return found


def _flexapod(h: float) -> Array:
    data = simulate_actuator(override(preset("paper-actuator"), step=h, output_step=1e-2))  # type: ignore[arg-type]
    return data.tip_deflection.values


def _solid(size: float, h: float) -> Array:
    data = simulate_solid(override(preset("paper-actuator"), output_step=1e-2), size=size, step=h)  # type: ignore[arg-type]
    return data.tip_deflection.values


def _error(tip: Array, true: Array) -> float:
    return float(np.abs(tip - true).max() / np.abs(true).max())


def _seconds(call: Call) -> float:
    begin = time.process_time()
    call()
    return time.process_time() - begin
