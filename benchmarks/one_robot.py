"""One robot with fixed steps: microseconds a step, times faster than real time at 1 %; operations of steps."""

from __future__ import annotations

import time

from benchmarks.deviation import Curve, Marched, error, marched, reference, roll
from benchmarks.machine import peak
from benchmarks.operations import Count, casadi_count, counted
from benchmarks.report import Section, goal
from benchmarks.timing import Spread, interleaved
from flexapod.analysis import simulate
from flexapod.model import DEFAULT_TOLERANCE, Study
from flexapod.solve.time.robot_march import prepare

__all__ = ["one_robot"]

COMMAND = "python -m benchmarks one-robot"
STEPS = (2.5e-4, 4e-4, 5e-4, 8e-4, 1e-3, 2e-3, 4e-3)
RADII = (0.9, 0.6, 0.2)  # rho_inf: the default, and two that damp what the steps do not resolve
LARGEST_ERROR = 0.01
REPEATS = 5


def one_robot() -> list[Section]:
    """Sections: errors of fixed steps, cost at an error of 1 %, operations of a step."""
    true = reference(roll())
    runs = {(rho, h): marched(fixed(h, rho)) for rho in RADII for h in STEPS}
    errors = {key: error(run.curve, true) for key, run in runs.items()}
    best = {rho: largest_step({h: errors[rho, h] for h in STEPS}) for rho in RADII}
    return [_errors(errors, best), _costs(best, true), _operations(runs[RADII[0], 5e-4])]


def fixed(h: float, rho: float) -> Study:
    """The roll with a fixed step; stored at every 1 ms, or every step if that is longer."""
    divides = abs(1e-3 / h - round(1e-3 / h)) < 1e-9
    return roll(step=h, output_step=1e-3 if divides else h, rho_inf=rho)


def largest_step(errors: dict[float, float]) -> float | None:
    """Largest step with an error below 1 % such that all smaller ones have it too; None if the smallest has not."""
    found = None
    for h in sorted(errors):
        if errors[h] > LARGEST_ERROR:
            break
        found = h
    return found


def _errors(errors: dict[tuple[float, float], float], best: dict[float, float | None]) -> Section:
    rows = [[f"{rho:g}", *(f"{100 * errors[rho, h]:.2f} %" for h in STEPS), _ms(best[rho])] for rho in RADII]
    return Section(
        title="Error of the deviation, 2 s roll of paper-robot, k = 3",
        command=COMMAND,
        header=["rho_inf", *(_ms(h) for h in STEPS), "largest step with all smaller ones below 1 %"],
        rows=rows,
        remarks=[
            "Largest distance of the centre of mass from where the converged solution (extrapolated from steps of 25 "
            "and 12.5 us) has it, over the largest deviation (21.3 um).",
            "From about 0.8 ms on the steps no longer resolve a vibration of some 0.2 um on a deviation that is "
            "quasi-static otherwise: the error stays near 1 % up to 4 ms. A smaller rho_inf damps what is not "
            "resolved.",
        ],
    )


def _ms(h: float | None) -> str:
    return "none" if h is None else f"{1e3 * h:g} ms"


def _costs(best: dict[float, float | None], true: Curve) -> Section:
    """Cost of the march and of the whole call: within the default tolerance, and with fixed steps."""
    studies = {f"tolerance {DEFAULT_TOLERANCE:g} (default)": roll(output_step=1e-3)}
    studies |= {f"step {_ms(h)}, rho_inf {rho:g}": fixed(h, rho) for rho, h in best.items() if h is not None}
    sample = {name: marched(study) for name, study in studies.items()}
    marches = interleaved({name: (lambda s=study: marched(s).process) for name, study in studies.items()}, REPEATS)
    calls = interleaved({name: (lambda s=study: _whole_call(s)) for name, study in studies.items()}, REPEATS)
    rows = [_cost_row(name, run, marches[name], calls[name], error(run.curve, true)) for name, run in sample.items()]
    return Section(
        title="One robot: cost of the 2 s roll, k = 3",
        command=COMMAND,
        header=["setting", "error", "a step", "steps run", "march", "times real time", "fx.simulate", "goals"],
        rows=rows,
        remarks=[
            f"Medians of {REPEATS} interleaved runs on one core (least to largest), time of the processor.",
            "Fixed steps of 4 ms store results every 4 ms, all else every ms. More tolerances: python -m benchmarks "
            "tolerances.",
            "The start (equilibrium) is part of fx.simulate only; the kernel is compiled and loaded.",
        ],
    )


def _cost_row(name: str, run: Marched, march: Spread, call: Spread, reached: float) -> list[str]:
    step, speed = 1e6 * march.median / run.counters.steps, 2.0 / march.median
    within = "default" in name  # whose steps have three stages each
    wanted = 30.0 if within else 50.0
    goals = [] if within else [goal(step, 20.0, "20 us a step")]
    goals.append(goal(speed, wanted, f"{wanted:g} times", at_least=True))
    return [
        name,
        f"{100 * reached:.3g} %",
        f"{step:.1f} us",
        str(run.counters.steps),
        march.text("ms", 1e3),
        f"{speed:.0f}",
        call.text("ms", 1e3),
        "; ".join(goals),
    ]


def _whole_call(study: Study) -> float:
    begin = time.process_time()
    simulate(study)
    return time.process_time() - begin


def _operations(run: Marched) -> Section:
    """Operations of a step at 0.5 ms, and of one within the default tolerance, against the core's measured peak."""
    within = roll(output_step=1e-2, duration=1.0)  # as `counted_runs.step_within`
    steps = marched(within).counters.steps
    times = interleaved(
        {"fixed": lambda: marched(fixed(5e-4, RADII[0])).process, "within": lambda: marched(within).process}, REPEATS
    )
    generated, parts = _generated(run)
    try:
        whole, radau = (counted(f"benchmarks.counted_runs:{name}") for name in ("roll_step", "step_within"))
    except RuntimeError as reason:
        return Section(
            title="Operations of a step", command=COMMAND, header=["part", "operations"], rows=parts,
            remarks=[f"The hand-written part was not counted: {reason}"],
        )  # fmt: skip
    rest = whole.plus(generated.times(-1))
    rows = [
        *parts,
        ["elimination, solution, update; series for sines", *_numbers(rest)],
        ["a step of 0.5 ms", *_numbers(whole)],
        [f"a step within {DEFAULT_TOLERANCE:g}, three stages", *_numbers(radau)],
    ]
    return Section(
        title="Operations of a step, k = 3",
        command=COMMAND,
        header=["part", "+ - * /", "square roots", "sines and cosines"],
        rows=rows,
        remarks=[
            _share("A step of 0.5 ms", times["fixed"].median / run.counters.steps, whole),
            _share(f"A step within {DEFAULT_TOLERANCE:g}", times["within"].median / steps, radau)
            + " Commands, scales of errors and 100 records, which Python shares in, are in its time.",
            "Peaks: multiply-adds on 1, 2, 4, 8 doubles at a time, measured on the same core with the same compiler.",
            "Generated functions from CasADi's instructions times calls; the whole by compiling the same C with a "
            "number that counts; the rest is the difference. Sines of several legs at once are series, + - * /.",
        ],
    )


def _share(words: str, step: float, count: Count) -> str:
    rate = count.arithmetic / step
    of = [f"{100 * rate / p:.1f} % of {p / 1e9:.1f} GFLOP/s ({w} wide)" for w, p in peak().items() if p]
    return f"{words}: {1e6 * step:.1f} us, {rate / 1e9:.2f} GFLOP/s, {', '.join(of)}."


def _generated(run: Marched) -> tuple[Count, list[list[str]]]:
    """Operations of the generated functions in a step, and their rows."""
    from flexapod.mechanics.leg.kernel_functions import leg_functions, payload_functions

    shapes = prepare(roll()).system.kernel.shapes
    counts = {f.name: casadi_count(f.build()) for f in [*leg_functions(shapes), *payload_functions(shapes)]}
    calls = run.counters
    total, rows = Count(), []
    for kind, name, times in (
        ("residual", "residuals", calls.iterations),
        ("matrices", "matrices", calls.factorisations),
    ):
        once = counts[f"leg_{kind}"].times(6).plus(counts[f"payload_{kind}"])
        part = once.times(times / calls.steps)
        total = total.plus(part)
        rows.append([f"{name}: {times / calls.steps:.3g} a step of {once.arithmetic:.0f}", *_numbers(part)])
    return total, rows


def _numbers(count: Count) -> list[str]:
    return [f"{count.arithmetic:.0f}", f"{count.roots:.0f}", f"{max(count.circular, 0.0):.0f}"]
