"""How the cost grows with the number of shapes, of stored outputs, and with the horizon."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping

from benchmarks.deviation import marched, roll
from benchmarks.fitting import fitted_polynomial, fitted_power
from benchmarks.report import Section
from benchmarks.timing import Spread, interleaved
from flexapod.model import Study
from flexapod.study import simulate

__all__ = ["scaling"]

COMMAND = "python -m benchmarks scaling"
SHAPES = range(1, 13)
ALL_SHAPES = 6  # the goal's range: at most quadratic there, the cubic share is told above
OUTPUT_STEPS = (5e-4, 1e-3, 2e-3, 4e-3, 1e-2, 2e-2)
HORIZONS = (0.5, 1.0, 2.0, 4.0, 8.0)
REPEATS = 7
STEP = 5e-4


def scaling() -> list[Section]:
    """Sections: shapes; outputs and horizon."""
    return [_shapes(), _outputs_and_horizon()]


def _shapes() -> Section:
    """Cost of a step for k = 1 to 12; least times: noise only adds."""
    studies = {k: roll(modes=k, step=STEP) for k in SHAPES}
    counters = {k: marched(study).counters for k, study in studies.items()}  # and the kernels are compiled
    times = interleaved({str(k): (lambda s=s: _step(s)) for k, s in studies.items()}, REPEATS)
    cost = {k: min(times[str(k)].values) for k in SHAPES}
    few, many = [k for k in SHAPES if k <= ALL_SHAPES], list(SHAPES)
    power, high = fitted_power(few, [cost[k] for k in few]), [k for k in SHAPES if k >= ALL_SHAPES]
    power_high = fitted_power(high, [cost[k] for k in high])
    overall = fitted_polynomial(many, [cost[k] for k in many], 3)
    shares = ", ".join(f"{100 * overall.share(3, k):.0f} % at k = {k}" for k in (6, 9, 12))
    met = "met" if power.exponent <= 2 else "not met"
    return Section(
        title="Cost of a step against the number of shapes k (each of two planes, two axial ones)",
        command=COMMAND,
        header=["k", *(str(k) for k in SHAPES)],
        rows=[
            ["us a step", *(f"{1e6 * cost[k]:.1f}" for k in SHAPES)],
            ["iterations a step", *(f"{c.iterations / c.steps:.2f}" for c in counters.values())],
        ],
        remarks=[
            f"2 s roll with steps of 0.5 ms, least of {REPEATS} interleaved runs; tables of commands included.",
            f"Exponent over k = 1 to 6: {power.text()}; goal at most 2: {met}. Over 6 to 12: {power_high.text()}.",
            f"Share of the cubic term, fitted over 1 to 12 (negative: growth is below quadratic there): {shares}.",
            "The number of legs cannot be varied: a 6-UPS has six, computed side by side in the processor's vectors; "
            "only the payload's system of 12 unknowns is shared.",
        ],
    )


def _step(study: Study) -> float:
    run = marched(study)
    return run.process / run.counters.steps


def _outputs_and_horizon() -> Section:
    by_outputs = {float(round(2.0 / d)): roll(step=STEP, output_step=d) for d in OUTPUT_STEPS}
    by_horizon = {t: roll(step=STEP, duration=t) for t in HORIZONS}
    rows = []
    for name, studies in (("outputs of 2 s", by_outputs), ("horizon [s]", by_horizon)):
        for words, cost in (("march", lambda s: marched(s).process), ("fx.simulate", _call)):
            rows.append(_growth(name, words, studies, cost))
    return Section(
        title="Cost against stored outputs and horizon, k = 3, step 0.5 ms",
        command=COMMAND,
        header=["against", "of", "values", "cost [ms]", "exponent", "goal"],
        rows=rows,
        remarks=[
            "Exponent of a straight line through the logarithms with its standard error. Against outputs it is small: "
            "most of the cost is that of the steps, which stay the same.",
        ],
    )


def _growth(name: str, words: str, studies: Mapping[float, Study], cost: Callable[[Study], float]) -> list[str]:
    times = interleaved({str(x): (lambda s=s: cost(s)) for x, s in studies.items()}, 5)
    least = [_least(times[str(x)]) for x in studies]
    power = fitted_power(list(studies), least)
    met = "met" if power.exponent <= 1 + 2 * power.uncertainty else "not met"
    return [name, words, _join(studies), _join([1e3 * x for x in least]), power.text(), f"at most linear: {met}"]


def _least(times: Spread) -> float:
    return min(times.values)


def _join(numbers: Iterable[float]) -> str:
    return ", ".join(f"{x:.4g}" for x in numbers)


def _call(study: Study) -> float:
    begin = time.process_time()
    simulate(study)
    return time.process_time() - begin
