"""Cost laws: against shapes, legs, tolerance, stored outputs and horizon; with fixed steps and within the tolerance."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.deviation import error, marched, roll
from benchmarks.fitting import Power, fitted_polynomial, fitted_power
from benchmarks.report import Section
from benchmarks.timing import interleaved
from flexapod.analysis import simulate
from flexapod.model import DEFAULT_TOLERANCE, Study, loads, override, preset_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Law", "scaling", "with_legs"]

COMMAND = "python -m benchmarks scaling"
SHAPES, SOME_SHAPES = range(1, 13), (1, 2, 3, 4, 6, 8, 12)
ALL_SHAPES = 6  # the goal's range: at most quadratic there, the cubic share is told above
LEGS = (6, 8, 10, 12, 14, 16)
LANES = 8  # legs that are computed at once where vectors are of eight doubles
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
TIGHT = 1e-3  # from here on the order is seen: coarser tolerances pass over the vibration
OUTPUT_STEPS = (5e-4, 1e-3, 2e-3, 4e-3, 1e-2, 2e-2)
HORIZONS = (0.5, 1.0, 2.0, 4.0, 8.0)
REPEATS = 5
STEP = 5e-4
FIXED, WITHIN = "step 0.5 ms", f"tolerance {DEFAULT_TOLERANCE:g}"


@dataclass(frozen=True, kw_only=True)
class Law:
    """A cost in `unit` against x, the least of some runs, as noise only adds; its power law over the points `of`."""

    against: str
    words: str
    unit: str
    x: Sequence[float]
    cost: Sequence[float]
    of: slice = field(default_factory=lambda: slice(None))
    most: float | None = None  # exponent that is asked for

    @property
    def power(self) -> Power:
        """Straight line through the logarithms."""
        return fitted_power(self.x[self.of], self.cost[self.of])

    def row(self) -> list[str]:
        """For a table."""
        power, most = self.power, self.most
        met = (
            ""
            if most is None
            else f"at most {most:g}: {'met' if power.exponent <= most + 2 * power.uncertainty else 'not met'}"
        )
        x, cost = (", ".join(f"{value:.3g}" for value in values) for values in (self.x, self.cost))
        return [self.against, self.words, x, f"{cost} {self.unit}", power.text(), met]


def scaling() -> list[Section]:
    """Sections: shapes in detail; all laws, with a figure."""
    section, law = _shapes()
    laws = [law, *_within_shapes(), *_legs(), *_tolerances(), *_outputs_and_horizon()]
    return [section, _laws(laws)]


def _least(studies: Mapping[float, Study], cost: Callable[[Study], float], repeats: int = REPEATS) -> list[float]:
    times = interleaved({str(x): (lambda s=s: cost(s)) for x, s in studies.items()}, repeats)
    return [min(times[str(x)].values) for x in studies]


def _march(study: Study) -> float:
    return 1e3 * marched(study).process


def _step(study: Study) -> float:
    run = marched(study)
    return 1e6 * run.process / run.counters.steps


def _call(study: Study) -> float:
    begin = time.process_time()
    simulate(study)
    return 1e3 * (time.process_time() - begin)


def _shapes() -> tuple[Section, Law]:
    """Cost of a fixed step for k = 1 to 12."""
    studies = {float(k): roll(modes=k, step=STEP) for k in SHAPES}
    counters = [marched(study).counters for study in studies.values()]  # and the kernels are compiled
    cost, many = _least(studies, _step), list(SHAPES)
    law = Law(against="k", words=f"a step, {FIXED}", unit="us", x=many, cost=cost, of=slice(0, ALL_SHAPES), most=2.0)
    high, overall = fitted_power(many[ALL_SHAPES - 1 :], cost[ALL_SHAPES - 1 :]), fitted_polynomial(many, cost, 3)
    shares = ", ".join(f"{100 * overall.share(3, k):.0f} % at k = {k}" for k in (6, 9, 12))
    section = Section(
        title="Cost of a step against the number of shapes k (each of two planes, two axial ones)",
        command=COMMAND,
        header=["k", *(str(k) for k in SHAPES)],
        rows=[
            ["us a step", *(f"{x:.1f}" for x in cost)],
            ["iterations a step", *(f"{c.iterations / c.steps:.2f}" for c in counters)],
        ],
        remarks=[
            f"2 s roll with steps of 0.5 ms, least of {REPEATS} interleaved runs; tables of commands included.",
            f"Exponent over k = 6 to 12: {high.text()}; below, see the next table.",
            f"Share of the cubic term, fitted over 1 to 12 (negative: growth is below quadratic there): {shares}.",
        ],
    )
    return section, law


def _within_shapes() -> list[Law]:
    studies = {float(k): roll(modes=k) for k in SOME_SHAPES}
    cost = _least(studies, _march)
    few = slice(0, SOME_SHAPES.index(ALL_SHAPES) + 1)
    return [Law(against="k", words=f"roll, {WITHIN}", unit="ms", x=SOME_SHAPES, cost=cost, of=few, most=2.0)]


def with_legs(count: int, **settings: object) -> Study:
    """The roll of `paper-robot` on an even number of legs, in pairs as its six are."""
    pair = np.arange(count) // 2 * 4 * np.pi / count
    side = np.where(np.arange(count) % 2, 1.0, -1.0) * np.radians(10.0)
    # On the base pairs (1, 2), (3, 4), ... ; on the platform (2, 3), (4, 5), ..., half a pair on.
    base, platform = pair + side, np.roll(pair + 2 * np.pi / count + side, 1)
    text = re.sub(r'type = "6-UPS"', f'type = "{count}-UPS"', preset_text("paper-robot"))
    for name, radius, angles in (("base", 0.25, base), ("platform", 0.15, platform)):
        joints = [[float(radius * np.cos(x)), float(radius * np.sin(x)), 0.0] for x in angles]
        text = re.sub(rf"^{name} *= .*$", f"{name} = {{ joints = {joints} }}", text, flags=re.MULTILINE)
    return override(loads(text), **settings)  # type: ignore[arg-type,return-value]


def _legs() -> list[Law]:
    """Cost of a step: numbers of steps differ, as robots do."""
    fixed = {float(n): with_legs(n, step=STEP) for n in LEGS}
    within = {float(n): with_legs(n) for n in LEGS}
    return [
        Law(against="legs", words=f"a step, {words}", unit="us", x=LEGS, cost=_least(studies, _step), most=1.0)
        for words, studies in ((FIXED, fixed), (WITHIN, within))
    ]


def _tolerances() -> list[Law]:
    """Cost against one over the tolerance, and the error against the number of steps, whose slope is the order."""
    studies = {1 / x: roll(tolerance=x, output_step=1e-3) for x in TOLERANCES}
    true = marched(roll(tolerance=1e-10, output_step=1e-3)).curve
    runs = [marched(study) for study in studies.values()]
    cost, inverse = _least(studies, _march), list(studies)
    tight = slice(TOLERANCES.index(TIGHT), None)
    errors, steps = [error(run.curve, true) for run in runs], [float(run.counters.steps) for run in runs]
    return [
        Law(against="1 / tolerance", words="roll, 2000 outputs", unit="ms", x=inverse, cost=cost, of=tight),
        Law(against="1 / tolerance", words="steps", unit="", x=inverse, cost=steps, of=tight),
        Law(against="steps", words="error", unit="", x=steps, cost=errors, of=tight),
    ]


def _outputs_and_horizon() -> list[Law]:
    laws = []
    for words, settings in ((FIXED, {"step": STEP}), (WITHIN, {})):
        outputs = {float(round(2.0 / d)): roll(output_step=d, **settings) for d in OUTPUT_STEPS}
        horizons = {t: roll(duration=t, output_step=1e-3, **settings) for t in HORIZONS}
        for against, studies in (("outputs of 2 s", outputs), ("horizon [s]", horizons)):
            for of, cost in (("march", _march), ("fx.simulate", _call)):
                law = Law(
                    against=against, words=f"{of}, {words}", unit="ms", x=list(studies), cost=_least(studies, cost),
                    most=1.0,
                )  # fmt: skip
                laws.append(law)
    return laws


def _laws(laws: list[Law]) -> Section:
    lanes = f"in the processor's vectors, {LANES} at a time where these are of {LANES} doubles"
    return Section(
        title="Cost laws of the 2 s roll",
        command=COMMAND,
        header=["against", "of", "values", "cost", "exponent", "goal"],
        rows=[law.row() for law in laws],
        remarks=[
            f"Least of {REPEATS} interleaved runs on one core, time of the processor; k = 3, six legs, a result every "
            "ms where nothing else is said. Exponent of a straight line through the logarithms with its standard "
            f"error: of k up to {ALL_SHAPES}, of tolerances from {TIGHT:g} on.",
            "A method whose error falls with the p-th power of the step costs tolerance^(-1/p): 0.2 for order 5. "
            "Error against steps shows the order itself; what outputs and Python cost does not fall with the steps.",
            f"Legs are computed side by side {lanes}: cost rises by steps. paper-robot's roll on more pairs of legs.",
            "Cost against outputs is small until there are as many as steps; then it is that of what is stored.",
        ],
        pictures={"cost-laws": _figure(laws)},
    )


def _figure(laws: Sequence[Law]) -> Figure:
    """A panel for each quantity, logarithmic; dashed: the straight lines."""
    from flexapod.output.figures.style import figure, house_style
    from flexapod.output.scene.style import FLEXIBLE

    against = dict.fromkeys(law.against for law in laws)

    @house_style
    def draw() -> Figure:
        fig = figure(height=6.0, gap=0.06)
        panels = fig.subplots(-(-len(against) // 3), 3).ravel()
        for panel, name in zip(panels, against, strict=False):
            for i, law in enumerate(law for law in laws if law.against == name):
                color = FLEXIBLE if i == 0 else f"C{i}"
                power, x = law.power, np.array(law.x[law.of])
                unit = f" [{law.unit}]" if law.unit else ""
                label = f"{law.words}{unit}, {power.exponent:.2f}"
                panel.loglog(law.x, law.cost, ".-", color=color, linewidth=0.8, label=label)
                panel.loglog(x, power.factor * x**power.exponent, "--", color=color, linewidth=0.8)
            panel.set_xlabel(name)
            panel.minorticks_off()
            first = next(law for law in laws if law.against == name)
            if max(first.x) < 50 * min(first.x):
                ticks = first.x[:: 1 + len(first.x) // 5]
                panel.set_xticks(ticks, [f"{x:g}" for x in ticks])
            panel.legend(fontsize=6.0, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.0)
        for panel in panels[len(against) :]:
            panel.remove()
        return fig

    return draw()
