"""From nothing to a result: import, help, check, run with its report, cold and warm, the paper's study."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.machine import all_cores, one_core
from benchmarks.report import Section, goal
from flexapod.model import preset_text

__all__ = ["startup"]

COMMAND = "python -m benchmarks start-up"
ROLL = (
    "import flexapod as fx\n"
    "study = fx.preset('paper-robot')\n"
    "fx.simulate(study.robot, study.motion, modes=3, step=5e-4)\n"
)
NO_COMPILER = (
    "import time\n"
    "from flexapod.model import override, preset\n"
    "from flexapod.solve.time.robot_march import prepare\n"
    "def seconds(duration):\n"
    "    run = prepare(override(preset('paper-robot'), step=5e-4, duration=duration))\n"
    "    begin = time.perf_counter()\n"
    "    list(run.chunks)\n"
    "    return time.perf_counter() - begin\n"
    "short, long = seconds(0.02), seconds(0.12)\n"
    "print((long - short) / 200)\n"
)


def startup() -> list[Section]:
    """One section, times of the clock on the wall."""
    imported = _median(lambda: _seconds("-c", "import flexapod") - _seconds("-c", "pass"))
    study = _median(lambda: _seconds("-c", "import flexapod.analysis") - _seconds("-c", "pass"))
    helped = _median(lambda: _seconds("-m", "flexapod", "--help"))
    cold, warm = _median(_cold, 3), _median(lambda: _seconds("-c", ROLL))
    new = _median(_new_kind, 3)
    (check, ran), step, paper = _commands(), _interpreted(), _replicate()
    rows = [
        ["import flexapod", f"{imported:.3f} s", goal(imported, 0.3, "0.3 s")],
        ["import flexapod.analysis", f"{study:.2f} s", ""],
        ["flexapod --help", f"{helped:.3f} s", goal(helped, 0.5, "0.5 s")],
        ["flexapod check, preset paper-robot", f"{check:.2f} s", ""],
        ["flexapod run of it: figures, report", f"{ran:.2f} s", goal(ran, 3.5, "3.5 s")],
        ["first roll ever, all compiled, whole process", f"{cold:.2f} s", goal(cold, 10.0, "10 s")],
        ["first roll of a new kind of robot, equations compiled", f"{new:.2f} s", goal(new, 2.5, "2.5 s")],
        ["2 s roll at 0.5 ms, warm, whole process", f"{warm:.2f} s", goal(warm, 1.0, "1 s")],
        ["a step without a C compiler, k = 3", f"{1e3 * step:.2f} ms", ""],
        ["flexapod replicate, the paper's whole study", f"{paper:.1f} s", goal(paper, 90.0, "90 s")],
    ]
    return [Section(title="Start", command=COMMAND, header=["what", "time", "goal"], rows=rows)]


def _median(action: Callable[[], float], repeats: int = 7) -> float:
    return statistics.median(action() for _ in range(repeats))


def _seconds(*arguments: str, **environment: str) -> float:
    """Seconds of a whole Python process, which keeps what it compiles, as an installed package does."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    begin = time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=kept | environment,
    )  # fmt: skip
    return time.perf_counter() - begin


def _cold() -> float:
    with tempfile.TemporaryDirectory() as folder:
        return _seconds("-c", ROLL, FLEXAPOD_CACHE=folder)


def _new_kind() -> float:
    """Seconds where another robot has run before, so that time loops are there."""
    with tempfile.TemporaryDirectory() as folder:
        _seconds("-c", ROLL.replace("paper-robot", "tripod"), FLEXAPOD_CACHE=folder)
        return _seconds("-c", ROLL, FLEXAPOD_CACHE=folder)


def _commands() -> tuple[float, float]:
    """Seconds of `check` on one core, and of `run` on all."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.toml"
        file.write_text(preset_text("paper-robot"), encoding="utf-8")
        command = ("-m", "flexapod", "run", str(file), "--quiet")
        check = _median(lambda: _seconds("-m", "flexapod", "check", str(file)), 5)
        all_cores()
        _seconds(*command)
        ran = _median(lambda: _seconds(*command), 5)
        one_core()
    return check, ran


def _replicate() -> float:
    with tempfile.TemporaryDirectory() as folder:
        return _seconds("-m", "flexapod", "replicate", "--out", folder)


def _interpreted() -> float:
    """Seconds of a step without a compiler: the difference of two runs leaves out the start."""
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", NO_COMPILER],
        check=True, capture_output=True, text=True, env=os.environ | {"FLEXAPOD_COMPILER": "none"},
    )  # fmt: skip
    return float(run.stdout)
