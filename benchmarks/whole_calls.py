"""`python -m benchmarks.whole_calls OTHER [runs]`: what users call, here and in another checkout, and over the march.

Processor time, and of responses at 1e5 frequencies the memory. OTHER is a folder with any commit. Both checkouts take
turns, as in `two_checkouts`; commands are processes of their own, the first of them with nothing compiled before. The
march is the time integration alone, prepared before, of the checkout here.
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
HEXAPODS = [(preset, tolerance) for preset in ("paper-robot", "machine-hexapod") for tolerance in ("1e-4", "1e-2")]
SAMPLES = HERE / "examples" / "mechanisms"
OTHERS = [  # read whole, with the march by itself
    "8-UPS", "12-UPS", "tripod", "flight-simulator", *(f"{SAMPLES / name}.toml" for name in ("delta", "tricept")),
    *(f"{SAMPLES / name}.toml" for name in ("hexaglide", "planar")),
]  # fmt: skip
LINEAR = [("responses", "s"), ("responses-memory", "MiB"), ("h2", "ms")]
SLOW = {"time-optimal": 3, "shape": 5}  # runs
# Seconds of the processor, or MiB, of what a line names: "what study tolerance". A study is a preset, a file, or N-UPS:
# the paper's robot with so many legs in pairs. Names of modules are those of both the checkouts, the newer first.
PROGRAM = """
import sys, time, tracemalloc, warnings
import numpy as np
warnings.simplefilter("ignore")
import flexapod as fx
from flexapod.model import override
from flexapod.solve.time.robot_march import prepare
try:
    from flexapod.design.sweeps.worker import compute_point
    from flexapod.design.sweeps.outputs import select_outputs
    from flexapod.design.sweeps.plan import read_plan
    from flexapod.design.sweeps.samples import Points
except ImportError:
    from flexapod.surveys.sweeps.batch import compute_point
    from flexapod.surveys.sweeps.kept import kept as select_outputs
    from flexapod.surveys.sweeps.plan import read_plan
    from flexapod.surveys.sweeps.points import Points

HZ = np.geomspace(1.0, 1e3, 100_000)
MASSES = {"random": {"count": 2, "tolerance": [{"key": "payload.mass", "normal": "1 %"}]}}

def pairs(count, radius, half):
    middle = np.arange(count // 2) * 720.0 / count
    angle = np.radians(middle[:, None] + [-half, half]).ravel()
    return [[radius * float(np.cos(a)), radius * float(np.sin(a)), 0] for a in angle]

def study_of(name, tolerance):
    if name.endswith(".toml"):
        return override(fx.load(name), tolerance=float(tolerance))
    if not name.endswith("-UPS"):
        return override(fx.preset(name), tolerance=float(tolerance))
    count = int(name.split("-")[0])
    lines = fx.model.preset_text("paper-robot").splitlines()
    own = {"type": f'"{name}"', "base": f"{{ joints = {pairs(count, 0.25, 10.0)} }}",
           "platform": f"{{ joints = {pairs(count, 0.15, 360.0 / count - 10.0)} }}"}
    for key, value in own.items():
        at = next(i for i, line in enumerate(lines) if line.split("=")[0].strip() == key)
        lines[at] = f"{key} = {value}"
    return override(fx.loads(chr(10).join(lines)), tolerance=float(tolerance))

def peak(call):
    tracemalloc.start()
    call()
    return tracemalloc.get_traced_memory()[1] / 2**20

def prepared(what, study):
    if what == "march":
        chunks = prepare(study).chunks
        return lambda: list(chunks)
    if what == "simulate":
        return lambda: fx.simulate(study)
    if what == "all-results":
        return lambda: fx.simulate(study).load()
    if what == "shape":
        return lambda: fx.shape(study)
    if what == "time-optimal":
        return lambda: fx.time_optimal(study, end={"heave": 5e-3}, force="2 kN")
    if what == "h2":
        model = fx.linearize(study, inputs=["wrench", "floor"], outputs=["tool", "stroke", "com"])
        return lambda: model.h2()
    if what.startswith("responses"):
        model = fx.linearize(study, inputs="wrench", outputs="tool")
        return lambda: model.at(HZ)
    study = override(study, duration=0.05) if what == "short-point" else study
    points = Points(study, read_plan(MASSES))
    keep, one = select_outputs(points.plan.keep, study, points.resolve()), points.study(1)
    return lambda: compute_point(keep, one)

print("ready", flush=True)
for line in sys.stdin:
    what, name, tolerance = line.split()
    call = prepared(what, study_of(name, tolerance))
    if what == "responses-memory":
        print(peak(call), flush=True)
        tracemalloc.stop()
        continue
    begin = time.process_time()
    call()
    print(time.process_time() - begin, flush=True)
"""
COMMANDS = {
    "flexapod check": ("check", "{file}"),
    "flexapod run --no-figures": ("run", "{file}", "--quiet", "--no-figures"),
    "flexapod run": ("run", "{file}", "--quiet"),
    "flexapod keys": ("keys",),
    "first flexapod run --no-figures": ("run", "{file}", "--quiet", "--no-figures"),
}
FIRST = "first "  # commands for which nothing has been compiled


def calls(other: Path, runs: int) -> list[list[str]]:
    """Rows of a table: simulations, points of sweeps, commands made ahead, linear models."""
    checkouts, rows = [Checkout(root, PROGRAM) for root in (HERE, other)], []

    def ask(what: str, study: str, tolerance: str = "1e-4", *, alone: bool = False) -> list[Spread]:
        asked = [lambda one=one: one.ask(f"{what} {study} {tolerance}") for one in checkouts[: 1 if alone else 2]]
        return _turns(asked, min(runs, SLOW.get(what, runs)))

    try:
        for preset, tolerance in HEXAPODS:
            march = ask("march", preset, tolerance, alone=True)[0].median
            for what in ("simulate", "all-results", "point"):
                rows.append(_row(f"{what}, {preset}, {tolerance}", *ask(what, preset, tolerance), march))
        for study in OTHERS:
            march = ask("march", study)
            rows.append(_row(f"all-results, {Path(study).stem}", *ask("all-results", study), march[0].median))
            rows.append(_row(f"march, {Path(study).stem}", *march))
        rows.append(_row("point, paper-robot, 0.05 s", *ask("short-point", "paper-robot")))
        for preset in ("paper-robot", "machine-hexapod"):
            rows.append(_row(f"shape, {preset}", *ask("shape", preset)))
        rows.append(_row("time-optimal, paper-robot", *ask("time-optimal", "paper-robot")))
        for what, unit in LINEAR:
            for preset in ("paper-robot", "machine-hexapod"):
                rows.append(_row(f"{what}, {preset}", *ask(what, preset), unit=unit))
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
            given, first = [word.format(file=file) for word in words], name.startswith(FIRST)
            asked = [lambda root=root, given=given, first=first: _command(root, given, folder, first=first)
                     for root in (HERE, other)]  # fmt: skip
            rows.append(_row(name, *_turns(asked, runs)))
    return rows


def _turns(actions: list[Callable[[], float]], runs: int) -> list[Spread]:
    """Spreads of actions that take turns; each is called once before."""
    for action in actions:
        action()
    found = [[action() for action in actions] for _ in range(runs)]
    return [Spread(values) for values in zip(*found, strict=True)]


def _row(name: str, ours: Spread, theirs: Spread, march: float | None = None, unit: str = "ms") -> list[str]:
    ratio = statistics.median(a / b for a, b in zip(ours.values, theirs.values, strict=True))
    over = ["", "", ""] if march is None else [f"{1e3 * march:.3g} ms", *(_times(x, march) for x in (theirs, ours))]
    factor = 1e3 if unit == "ms" else 1.0
    return [name, theirs.text(unit, factor), ours.text(unit, factor), f"{ratio:.2f}", *over]


def _times(whole: Spread, march: float) -> str:
    return f"{whole.median / march:.2f}"


def _command(root: Path, words: list[str], folder: str, *, first: bool) -> float:
    """Seconds of the processor that a command takes; the bytecode of its checkout is kept in the folder.

    ``first``: with an empty cache of compiled equations.
    """
    own = {"PYTHONPATH": str(root / "src"), "PYTHONPYCACHEPREFIX": folder, "OPENBLAS_NUM_THREADS": "1"}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | own
    with tempfile.TemporaryDirectory() as empty:
        environment |= {"FLEXAPOD_CACHE": empty} if first else {}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        line = [sys.executable, "-m", "flexapod", *words]
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
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
