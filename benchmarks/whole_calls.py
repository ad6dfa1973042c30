"""`python -m benchmarks.whole_calls OTHER [runs]`: what users call, here and in another checkout, and over the march.

Processor time. Both checkouts take turns, as in `two_checkouts`; commands are processes of their own. The march is the
time integration alone, prepared before, of the checkout here.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.report import Section
from benchmarks.timing import Spread
from benchmarks.two_checkouts import HERE, Checkout
from flexapod.model import preset_text

RUNS, COMMAND_RUNS = 9, 5
SIMULATED = [(preset, tolerance) for preset in ("paper-robot", "machine-hexapod") for tolerance in (1e-4, 1e-2)]
# Seconds of a simulation, of one whose results are all read, of a point of a sweep, of the march, as a line tells:
# "what preset tolerance".
PROGRAM = """
import sys, time
import flexapod as fx
from flexapod.model import override
from flexapod.solve.time.robot_march import prepare
from flexapod.design.sweeps.worker import compute_point
from flexapod.design.sweeps.outputs import select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points

def prepared(what, study):
    if what == "march":
        chunks = prepare(study).chunks
        return lambda: list(chunks)
    if what == "simulate":
        return lambda: fx.simulate(study)
    if what == "all-results":
        return lambda: fx.simulate(study).load()
    points = Points(study, read_plan({"random": {"count": 2, "tolerance": [{"key": "payload.mass", "normal": "1 %"}]}}))
    keep, one = select_outputs(points.plan.keep, study, points.resolve()), points.study(1)
    return lambda: compute_point(keep, one)

print("ready", flush=True)
for line in sys.stdin:
    what, preset, tolerance = line.split()
    call = prepared(what, override(fx.preset(preset), tolerance=float(tolerance)))
    begin = time.process_time()
    call()
    print(time.process_time() - begin, flush=True)
"""
COMMANDS = {
    "flexapod check": ("check", "{file}"),
    "flexapod run --no-figures": ("run", "{file}", "--quiet", "--no-figures"),
    "flexapod run": ("run", "{file}", "--quiet"),
}


def calls(other: Path, runs: int) -> list[list[str]]:
    """Rows of a table: simulations, with none or all of their results read, and points of sweeps."""
    checkouts, rows = [Checkout(root, PROGRAM) for root in (HERE, other)], []
    try:
        for preset, tolerance in SIMULATED:
            of_preset = f"{preset} {tolerance:g}"
            march = _turns([lambda of=of_preset: checkouts[0].ask(f"march {of}")], runs)[0].median
            for what in ("simulate", "all-results", "point"):
                asked = [lambda one=one, of=of_preset, what=what: one.ask(f"{what} {of}") for one in checkouts]
                rows.append(_row(f"{what}, {preset}, {tolerance:g}", *_turns(asked, runs), march))
    finally:
        for checkout in checkouts:
            checkout.close()
    return rows


def commands(other: Path, runs: int) -> list[list[str]]:
    """Rows of a table: commands as processes, of the preset paper-robot."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.toml"
        file.write_text(preset_text("paper-robot"), encoding="utf-8")
        for name, words in COMMANDS.items():
            given = [word.format(file=file) for word in words]
            asked = [lambda root=root, given=given: _command(root, given, folder) for root in (HERE, other)]
            rows.append(_row(name, *_turns(asked, runs), None))
    return rows


def _turns(actions: list[Callable[[], float]], runs: int) -> list[Spread]:
    """Spreads of actions that take turns; each is called once before."""
    for action in actions:
        action()
    found = [[action() for action in actions] for _ in range(runs)]
    return [Spread(values) for values in zip(*found, strict=True)]


def _row(name: str, ours: Spread, theirs: Spread, march: float | None) -> list[str]:
    ratio = statistics.median(a / b for a, b in zip(ours.values, theirs.values, strict=True))
    over = ["", "", ""] if march is None else [f"{1e3 * march:.3g} ms", *(_times(x, march) for x in (theirs, ours))]
    return [name, theirs.text("ms", 1e3), ours.text("ms", 1e3), f"{ratio:.2f}", *over]


def _times(whole: Spread, march: float) -> str:
    return f"{whole.median / march:.2f}"


def _command(root: Path, words: list[str], folder: str) -> float:
    """Seconds of the processor that a command takes; the bytecode of its checkout is kept in the folder."""
    own = {"PYTHONPATH": str(root / "src"), "PYTHONPYCACHEPREFIX": folder, "OPENBLAS_NUM_THREADS": "1"}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | own
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "flexapod", *words], check=True, stdout=subprocess.DEVNULL, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(arguments: list[str]) -> int:
    """Print the comparison."""
    if not 1 <= len(arguments) <= 2 or not (Path(arguments[0]) / "src" / "flexapod").is_dir():
        print(
            "usage: python -m benchmarks.whole_calls OTHER [runs]; OTHER is the folder of a checkout", file=sys.stderr
        )
        return 2
    other, runs = Path(arguments[0]).resolve(), int(arguments[1]) if len(arguments) > 1 else RUNS
    print(
        Section(
            title="Whole calls",
            command="python -m benchmarks.whole_calls OTHER",
            header=["call", "other", "here", "ratio", "march", "other over the march", "here over the march"],
            rows=[*calls(other, runs), *commands(other, min(runs, COMMAND_RUNS))],
        ).text()
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
