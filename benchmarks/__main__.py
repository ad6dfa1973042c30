"""`python -m benchmarks`: medians of repeated runs on one core, against the figures this project promises."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

from flexapod.model import override, preset
from flexapod.solve.actuator_march import prepare_actuator
from flexapod.solve.robot_march import prepare

REPEATS = 7


def one_core() -> None:
    """Pin this process and its children to one core, where the system can."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


def median(action: Callable[[], float], repeats: int = REPEATS) -> float:
    return statistics.median(action() for _ in range(repeats))


def roll(fidelity: str, **settings: object) -> tuple[float, int]:
    """Seconds and steps of the 2 s roll of `paper-robot` at step 0.5 ms, kernel compiled, start included."""
    study = override(preset("paper-robot"), fidelity=fidelity, step=5e-4, **settings)
    begin = time.perf_counter()
    run = prepare(study)
    for _ in run.chunks:
        pass
    return time.perf_counter() - begin, run.counters.steps


def actuator() -> float:
    """Seconds for 10 s of `paper-actuator`, three shapes, tolerance 1e-4."""
    begin = time.perf_counter()
    for _ in prepare_actuator(preset("paper-actuator")).chunks:
        pass
    return time.perf_counter() - begin


def command(*arguments: str, **environment: str) -> float:
    """Seconds of a whole command as a user types it."""
    begin = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "flexapod", *arguments],
        check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=os.environ | environment,
    )  # fmt: skip
    return time.perf_counter() - begin


def cold() -> float:
    """Seconds from nothing to a finished roll in a new process, its kernel compiled for the first time."""
    code = (
        "from flexapod.model import override, preset\n"
        "from flexapod.solve.robot_march import prepare\n"
        "list(prepare(override(preset('paper-robot'), step=5e-4)).chunks)\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env=os.environ | {"FLEXAPOD_CACHE": folder})
        return time.perf_counter() - begin


def interpreted() -> float:
    """Microseconds of a step, k = 3, without a compiler: the difference of two runs leaves out the start."""
    code = (
        "import time\n"
        "from flexapod.model import override, preset\n"
        "from flexapod.solve.robot_march import prepare\n"
        "def seconds(duration):\n"
        "    run = prepare(override(preset('paper-robot'), step=5e-4, duration=duration))\n"
        "    begin = time.perf_counter()\n"
        "    list(run.chunks)\n"
        "    return time.perf_counter() - begin\n"
        "short, long = seconds(0.02), seconds(0.12)\n"
        "print(1e6 * (long - short) / 200)\n"
    )
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        check=True, capture_output=True, text=True, env=os.environ | {"FLEXAPOD_COMPILER": "none"},
    )  # fmt: skip
    return float(run.stdout)


def main() -> None:
    """Print the table."""
    one_core()
    for settings in ({"fidelity": "assumed-modes", "modes": 3}, {"fidelity": "lumped"}, {"fidelity": "rigid"}):
        roll(**settings)  # warm
        times = [roll(**settings) for _ in range(REPEATS)]
        seconds, steps = statistics.median(t for t, _ in times), times[0][1]
        name = settings["fidelity"] + (f", k = {settings['modes']}" if "modes" in settings else "")
        goal = "at most 0.2 s, 50 us a step" if "modes" in settings else ""
        line(f"2 s roll at 0.5 ms, {name}", seconds, goal, f"{1e6 * seconds / steps:7.1f} us a step")
    actuator()
    line("10 s actuator, k = 3, tolerance 1e-4", median(actuator), "")
    line("cold start to finished roll (compiles)", median(cold, 3), "at most 15 s")
    step = interpreted()
    line("without a C compiler, k = 3", 1e-6 * step, "", f"{step:7.1f} us a step")
    line("flexapod --help", median(lambda: command("--help")), "at most 0.5 s")
    line("flexapod replicate", replicate(), "at most 90 s")


def replicate() -> float:
    """Seconds of the paper's whole study."""
    with tempfile.TemporaryDirectory() as folder:
        return command("replicate", "--out", folder)


def line(name: str, seconds: float, goal: str, more: str = "") -> None:
    print(f"{name:44s}{seconds:8.3f} s   {more:20s}{goal}")


if __name__ == "__main__":
    main()
