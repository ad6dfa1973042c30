"""Within a tolerance: times faster than real time, and SciPy on the same equations at equal error."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.deviation import Curve, Marched, error, marched, roll
from benchmarks.ode import Ode, ode
from benchmarks.report import Section, goal
from benchmarks.timing import Spread, interleaved
from flexapod.analysis import run
from flexapod.model import DEFAULT_TOLERANCE, ActuatorStudy, Study, loads, override, preset, preset_text

__all__ = ["at_error", "tolerances"]

COMMAND = "python -m benchmarks tolerances"
SHOWN = (DEFAULT_TOLERANCE, 1e-2, 1e-3, 1e-5, 1e-6)  # the default first
MORE = (1e-1, 3e-2, 1e-7)  # so that errors from 1e-2 to 1e-6 lie between those that are reached
ERRORS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
FASTEST = {1e-2: 60.0, 1e-4: 30.0, 1e-6: 12.0}  # goals: times real time
SLOWER = 8.0  # goal: times of SciPy's
REPEATS, CALLS = 5, 3
LONG = 1.5  # s: what takes longer is run once
CONVERGED = 1e-9  # tolerance of the curves that errors are measured from
Any = Study | ActuatorStudy


@dataclass(frozen=True, kw_only=True)
class Case:
    """A study, the words for it, and the settings of SciPy that are tried: method, tolerance, longest step [s]."""

    words: str
    study: Any
    settings: Sequence[tuple[str, float, float]]
    check: tuple[str, float, float]  # the same of SciPy's converged curve


def tolerances() -> list[Section]:
    """Sections: speed by tolerance; SciPy at equal error."""
    fast, equal, words = [], [], []
    for case in cases():
        rows, more, told = _measured(case)
        fast += rows
        equal += more
        words.append(told)
    return [_fast(fast), _equal(equal, words)]


def cases() -> list[Case]:
    """The studies of both tables, without friction: SciPy's states have no bristles."""
    hexapod = preset("machine-hexapod")
    legs = (
        leg.replace(base_joint=leg.base_joint.replace(friction=None), drive=leg.drive.replace(friction=None))
        for leg in hexapod.robot.legs
    )
    hexapod = hexapod.replace(robot=hexapod.robot.replace(legs=tuple(legs)))
    slow = preset_text("paper-actuator").replace("rate = 0.1 ", "rate = 0.02 ").replace('"10 s"', '"60 s"')
    coarse = [("Radau", 0.1, 2e-2), ("Radau", 0.1, 1e-2), ("Radau", 1e-3, 1e-2), ("Radau", 1e-3, 2e-2)]
    radau = [*coarse, *(("Radau", 10.0**-i, 1e-2) for i in range(4, 8))]
    beam = [("Radau", 1e-4, 0.1), ("Radau", 1e-5, 0.1), *(("LSODA", 10.0**-i, 0.1) for i in range(4, 8))]
    beam += [("DOP853", 10.0**-i, 0.1) for i in range(3, 8)]
    return [
        Case(
            words="paper-robot, roll",
            study=roll(output_step=1e-3),
            settings=radau,
            check=("Radau", 1e-8, 1e-2),
        ),
        Case(
            words="machine-hexapod without friction",
            study=override(hexapod, output_step=1e-3),  # type: ignore[arg-type]
            settings=radau,
            check=("Radau", 1e-8, 1e-2),
        ),
        Case(
            words="paper-actuator, 60 s",
            study=override(loads(slow), output_step=1e-2),  # type: ignore[arg-type]
            settings=beam,
            check=("DOP853", 1e-10, 0.1),
        ),
    ]


def _measured(case: Case) -> tuple[list[list[str]], list[list[str]], str]:
    """Rows of both tables, and how far the converged curves are apart."""
    print(f"  {case.words}", file=sys.stderr, flush=True)
    true = marched(_with(case.study, CONVERGED)).curve
    ours = {f"{x:g}": marched(_with(case.study, x)) for x in (*SHOWN, *MORE)}
    tried = _scipy(case, true)
    actions: dict[str, Callable[[], float]] = {x: partial(_march, case.study, float(x)) for x in ours}
    actions |= {name: each.seconds for name, each in tried.items() if each.once < LONG}
    times = interleaved(actions, REPEATS)
    calls = interleaved({f"{x:g}": partial(_call, _with(case.study, x)) for x in SHOWN}, CALLS)
    errors = {name: error(run.curve, true) for name, run in ours.items()}
    duration = case.study.duration
    fast = [_fast_row(case.words, duration, x, ours, errors, times, calls) for x in map("{:g}".format, SHOWN)]
    best = [(errors[x], times[x].median) for x in ours]
    theirs: dict[str, list[tuple[float, float]]] = {}
    for name, each in tried.items():
        theirs.setdefault(each.method, []).append((each.error, times[name].median if name in times else each.once))
    equal = [row for x in ERRORS if (row := _equal_row(case.words, x, best, theirs))]
    return fast, equal, _apart(case, true)


def _with(study: Any, tolerance: float) -> Any:
    return override(study, tolerance=tolerance)  # type: ignore[arg-type]


def _march(study: Any, tolerance: float) -> float:
    return marched(_with(study, tolerance)).process


def _call(study: Any) -> float:
    begin = time.process_time()
    run(study)
    return time.process_time() - begin


@dataclass(frozen=True, kw_only=True)
class _Tried:
    """A setting of SciPy: the error that it reaches, and the processor's seconds of its first run."""

    method: str
    error: float
    once: float
    seconds: Callable[[], float]


def _scipy(case: Case, true: Curve) -> dict[str, _Tried]:
    try:
        equations = ode(case.study)
    except RuntimeError as reason:
        print(f"  SciPy left out: {reason}", file=sys.stderr)
        return {}
    found = {}
    for method, tolerance, most in case.settings:
        solve = partial(equations.solve, method, tolerance, most, true.time)
        try:
            curve, once, _ = solve()
        except RuntimeError as reason:
            print(f"    {method} at {tolerance:g} failed: {reason}", file=sys.stderr)
            continue
        name = f"{method} {tolerance:g} {most:g}"
        found[name] = _Tried(method=method, error=error(curve, true), once=once, seconds=lambda s=solve: s()[1])
    return found


def _apart(case: Case, true: Curve) -> str:
    """How far SciPy's converged curve is from ours."""
    method, tolerance, most = case.check
    try:
        equations: Ode = ode(case.study)
        curve, _, _ = equations.solve(method, tolerance, most, true.time)
    except RuntimeError as reason:
        return f"{case.words}: not checked ({reason})"
    return f"{error(curve, true):.1g} ({case.words}, {method} at {tolerance:g})"


def _fast_row(
    words: str,
    duration: float,
    name: str,
    ours: dict[str, Marched],
    errors: dict[str, float],
    times: dict[str, Spread],
    calls: dict[str, Spread],
) -> list[str]:
    speed, tolerance = duration / times[name].median, float(name)
    wanted = FASTEST.get(tolerance)
    return [
        words,
        f"{name} (default)" if tolerance == DEFAULT_TOLERANCE else name,
        f"{errors[name]:.1e} ({errors[name] / tolerance:.2f})",
        str(ours[name].counters.steps),
        times[name].text("ms", 1e3),
        f"{speed:.0f}",
        calls[name].text("ms", 1e3),
        goal(speed, wanted, f"{wanted:g} times", at_least=True) if wanted else "",
    ]


def at_error(found: Sequence[tuple[float, float]], target: float) -> float | None:
    """Seconds at an error, out of pairs of error and seconds; None where nothing tried is as exact.

    Between the settings of which none other is both quicker and more exact, a straight line in the logarithms; with an
    error that is coarser than theirs, the quickest of them.
    """
    best: list[tuple[float, float]] = []
    for reached, seconds in sorted(found):  # the most exact first
        if np.isfinite(reached) and (not best or seconds < best[-1][1]):
            best.append((reached, seconds))
    if not best or best[0][0] > target:
        return None
    errors, seconds = np.log(np.array(best)).T
    return float(np.exp(np.interp(np.log(target), errors, seconds)))


def _equal_row(
    words: str, target: float, ours: Sequence[tuple[float, float]], theirs: dict[str, list[tuple[float, float]]]
) -> list[str]:
    mine = at_error(ours, target)
    others = {method: at_error(found, target) for method, found in theirs.items()}
    radau, best = others.get("Radau"), min((x, m) for m, x in [*others.items(), ("", float("inf"))] if x is not None)
    if mine is None:
        return []
    return [
        words,
        f"{target:.0e}",
        f"{1e3 * mine:.3g} ms",
        "not reached" if radau is None else f"{1e3 * radau:.4g} ms ({radau / mine:.1f})",
        f"{best[1]}, {1e3 * best[0]:.4g} ms ({best[0] / mine:.1f})" if best[1] else "not reached",
        goal(radau / mine, SLOWER, f"Radau {SLOWER:g} times", at_least=True) if radau else "",
    ]


def _fast(rows: list[list[str]]) -> Section:
    header = ["study", "tolerance", "error (over the tolerance)", "steps", "march", "times real time", "fx.run", "goal"]
    return Section(
        title="Within a tolerance: the default first",
        command=COMMAND,
        header=header,
        rows=rows,
        remarks=[
            f"Medians of {REPEATS} interleaved runs on one core (least to largest), of fx.run {CALLS}, time of the "
            "processor. All results every ms (of the actuator every 10 ms). The start is part of fx.run only; the "
            "kernels are compiled and loaded.",
            "Error: largest distance of the payload's centre of mass from the converged path, over the largest "
            "deviation; of the actuator that of its tip's deflection.",
        ],
    )


def _equal(rows: list[list[str]], apart: list[str]) -> Section:
    header = ["study", "error", "flexapod", "SciPy's Radau (times)", "SciPy's best (times)", "goal"]
    remarks = [
        f"Medians of {REPEATS} interleaved runs in the same run as the table above; what takes longer than {LONG:g} s "
        "once. Between the errors that settings reach, straight lines in the logarithms, for both.",
        "SciPy gets our equations in independent coordinates (no drift), right-hand sides and Jacobians by differences "
        "compiled to C, absolute tolerances in the units of the deviation, the first step, and longest steps that do "
        "not pass over the motion. Its tolerance is that of a step; errors are a run's.",
        "It stores states at the instants at which flexapod stores these, forces, accelerations and energies.",
        f"Converged: flexapod at {CONVERGED:g}. SciPy differs from it by {'; '.join(apart)}.",
    ]
    title = "SciPy on the same equations at equal error"
    return Section(title=title, command=COMMAND, header=header, rows=rows, remarks=remarks)
