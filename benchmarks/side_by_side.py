"""The same robot and motion by flexapod, by Exudyn, and our own equations by SciPy, at equal error of the deviation."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.deviation import Curve, error, marched, reference, roll, undamped
from benchmarks.ode import Ode, ode
from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.model import override
from flexapod.verification.engines.engine import EXUDYN

__all__ = ["Family", "chosen", "side_by_side"]

COMMAND = "python -m benchmarks side-by-side"
TARGETS = (0.02, 0.01, 0.001)
SLOWER = {("Exudyn", 0.01): 25.0}  # goals: times flexapod's
REPEATS = 5
LONG = 2.0  # s: what takes longer is run once
MILLISECONDS: Array = np.linspace(0.0, 2.0, 2001)
Run = Callable[[], tuple[Curve, float]]  # the deviation and the processor's seconds


@dataclass(kw_only=True)
class Family:
    """One way to compute it: settings from coarse to fine, each with what it costs and reaches.

    ``own``: the tool's own converged limit; where it solves our equations, that is ours.
    """

    tool: str
    settings: Sequence[tuple[str, Run]]
    own: Curve
    seconds: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    against_ours: list[float] = field(default_factory=list)

    def measure(self, ours: Curve) -> None:
        """Run every setting once."""
        for name, run in self.settings:
            print(f"  {self.tool}, {name}", file=sys.stderr, flush=True)
            try:
                curve, seconds = run()
            except (RuntimeError, ComputationError) as reason:
                print(f"    failed: {reason}", file=sys.stderr)
                curve, seconds = None, float("inf")
            self.seconds.append(seconds)
            self.errors.append(float("inf") if curve is None else error(curve, self.own))
            self.against_ours.append(float("inf") if curve is None else error(curve, ours))

    def cheapest(self, target: float) -> int | None:
        """Cheapest setting that keeps the target, and keeps it with all finer ones tried, at least one: not by luck."""
        good = [i for i in range(len(self.errors) - 1) if max(self.errors[i:]) <= target]
        return min(good, key=lambda i: self.seconds[i]) if good else None


def chosen(families: Sequence[Family], target: float) -> dict[str, tuple[Family, int]]:
    """The cheapest family and setting of each tool that keeps the target."""
    best: dict[str, tuple[Family, int]] = {}
    for family in families:
        at = family.cheapest(target)
        if at is None:
            continue
        if family.tool not in best or family.seconds[at] < best[family.tool][0].seconds[best[family.tool][1]]:
            best[family.tool] = (family, at)
    return best


def side_by_side() -> list[Section]:
    """A section for each target, and one of what was tried."""
    ours = reference(undamped(roll()))
    families = [*_ours(ours), *_scipy(ours), *(_exudyn() if EXUDYN.is_available() else [])]
    for family in families:
        family.measure(ours)
    return [*(_compared(families, target) for target in TARGETS), _tried(families)]


def _ours(ours: Curve) -> list[Family]:
    def run(h: float, rho: float) -> tuple[Curve, float]:
        result = marched(override(undamped(roll()), step=h, output_step=max(h, 1e-3), rho_inf=rho))
        return result.curve, result.process

    def adaptive(tolerance: float) -> tuple[Curve, float]:
        result = marched(override(undamped(roll()), tolerance=tolerance))
        return result.curve, result.process

    steps = [4e-3 / 2**i for i in range(7)]
    fixed = [
        Family(
            tool="flexapod, fixed step",
            settings=[(f"rho_inf {rho:g}, step {1e3 * h:g} ms", partial(run, h, rho)) for h in steps],
            own=ours,
        )
        for rho in (0.9, 0.6, 0.2)
    ]
    tolerances = [(f"tolerance {t:g}", partial(adaptive, t)) for t in (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4)]
    return [Family(tool="flexapod", settings=tolerances, own=ours), *fixed]


def _scipy(ours: Curve) -> list[Family]:
    try:
        equations = ode(undamped(roll()))
    except RuntimeError as reason:
        print(f"  SciPy left out: {reason}", file=sys.stderr)
        return []

    def of(method: str, settings: Sequence[tuple[float, float]]) -> Family:
        named = [
            (
                f"tolerance {tol:g}, steps up to {1e3 * most:g} ms",
                partial(_solved, equations, method, tol, most),
            )
            for tol, most in settings
        ]
        return Family(tool=f"SciPy {method}", settings=named, own=ours)

    return [
        of("Radau", [(0.1, 2e-2 / 2**i) for i in range(6)]),
        of("Radau", [(10.0**-i, 1e-2) for i in range(2, 7)]),
        of("DOP853", [(10.0**-i, 4e-3) for i in range(2, 6)]),
        of("RK45", [(1e-4, 4e-3)]),
        of("BDF", [(1.0, 4e-3 / 2**i) for i in range(3)]),
        of("LSODA", [(1e-4, 4e-3)]),
    ]


def _solved(equations: Ode, method: str, tolerance: float, most: float) -> tuple[Curve, float]:
    curve, seconds, _ = equations.solve(method, tolerance, most, MILLISECONDS)
    return curve, seconds


def _exudyn() -> list[Family]:
    """Families of Exudyn: few elements with strong numerical damping, more elements with little."""
    own, _ = _asked(15, 0.01, 0.9, 1e-4, 1e-6)
    families = []
    for elements, guide, rho, steps in (
        (3, 0.04, 0.2, (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)),
        (5, 0.03, 0.6, (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)),
        (6, 0.02, 0.9, (1e-3, 5e-4, 2.5e-4, 1.25e-4)),
    ):
        settings = [
            (
                f"{elements} elements, rings {1e3 * guide:g} mm apart, rho_inf {rho:g}, step {1e3 * h:g} ms",
                partial(_asked, elements, guide, rho, h),
            )
            for h in steps
        ]
        families.append(Family(tool="Exudyn", settings=settings, own=own))
    return families


def _asked(elements: int, guide: float, rho: float, h: float, tolerance: float = 1e-4) -> tuple[Curve, float]:
    from benchmarks.exudyn_tuned import solve
    from flexapod.verification.engines.exudyn_integration import Integration
    from flexapod.verification.engines.exudyn_process import solve_in_process
    from flexapod.verification.engines.exudyn_robot import RobotProblem

    # Its process finds this package here, and takes Exudyn's build without range checks.
    os.environ |= {"PYTHONPATH": _with_this(os.environ.get("PYTHONPATH", "")), "EXUDYN_MODULE": "fast"}
    study = undamped(roll())
    plan = Integration(duration=2.0, step=h, rho_inf=rho, tolerance=tolerance)
    problem = RobotProblem(robot=study.robot, motion=study.motion, integration=plan, elements=elements, guide=guide)
    result = solve_in_process(solve, problem)
    every = max(1, round(1e-3 / h))
    return Curve(result.time[::every], result.com_deviation[::every]), result.seconds


def _with_this(path: str) -> str:
    root = str(Path(__file__).parents[1])
    return path if root in path.split(os.pathsep) else os.pathsep.join([root, *filter(None, [path])])


def _compared(families: Sequence[Family], target: float) -> Section:
    best = chosen(families, target)
    times = interleaved(
        {tool: (lambda f=f, i=i: f.settings[i][1]()[1]) for tool, (f, i) in best.items() if f.seconds[i] < LONG},
        REPEATS,
    )
    ours = times["flexapod"].median
    rows = []
    for tool, (family, i) in sorted(best.items(), key=lambda item: item[1][0].seconds[item[1][1]]):
        spread = times.get(tool)
        seconds = spread.median if spread else family.seconds[i]
        own, ours_too = (f"{100 * e[i]:.2g} %" for e in (family.errors, family.against_ours))
        text = spread.text("ms", 1e3) if spread else f"{1e3 * seconds:.0f} ms (once)"
        wanted = SLOWER.get((tool, target))
        met = goal(seconds / ours, wanted, f"{wanted:g} times", at_least=True) if wanted else ""
        rows.append([tool, family.settings[i][0], own, ours_too, text, f"{seconds / ours:.1f}", met])
    missing = sorted({family.tool for family in families} - best.keys())
    return Section(
        title=f"Side by side: 2 s roll of paper-robot without damping, error at most {100 * target:g} %",
        command=COMMAND,
        header=["tool", "setting", "error, own limit", "error, ours", "integration", "times flexapod's", "goal"],
        rows=rows,
        remarks=[
            f"Medians of {REPEATS} interleaved runs on one core (least to largest), time of the processor; the start "
            "and what is stored left out. The cheapest setting tried that keeps the error with all finer ones "
            "of its list too.",
            *([f"Tried, but no setting qualifies (last table): {', '.join(missing)}."] if missing else []),
            *_WORDS,
        ],
    )


_WORDS = (
    "Exudyn: ANCF cables that slide through two rings, universal joints and slides as kinematic trees; "
    "generalized-alpha, modified Newton (tolerance 1e-4), sparse solver, build without range checks, strokes set once "
    "a step. Own limit: 15 elements, rings 10 mm apart, 0.1 ms. Legs that only stretch would miss the deviation by "
    "1.4 %; reduced floating frames know no sliding guide; its other beams have more coordinates a node than its "
    "cables.",
    "SciPy: our equations in 48 independent coordinates (no drift), accelerations compiled to C, differences for the "
    "Jacobian in steps that suit it, steps limited so that none passes over the motion.",
    "No damping, because Exudyn's cables have no counterpart of damping ratios.",
)


def _tried(families: Sequence[Family]) -> Section:
    rows = [
        [family.tool, name, f"{100 * family.errors[i]:.3g} %", f"{100 * family.against_ours[i]:.3g} %",
         f"{1e3 * family.seconds[i]:.0f} ms"]
        for family in families
        for i, (name, _) in enumerate(family.settings)
    ]  # fmt: skip
    return Section(
        title="Side by side: everything that was tried",
        command=COMMAND,
        header=["tool", "setting", "error, own limit", "error, ours", "integration, once"],
        rows=rows,
    )
