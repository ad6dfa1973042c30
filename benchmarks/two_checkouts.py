"""`python -m benchmarks.two_checkouts OTHER [runs]`: a step of `paper-robot` here and in another checkout.

Each checkout runs in its own process with its own sources, the processes take turns, A B A B: whatever disturbs the
machine disturbs both. Printed: medians, ranges, and the median of the ratios of neighbours.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
from pathlib import Path

from benchmarks.timing import Spread

HERE = Path(__file__).parents[1]
RUNS = 15
# Only public calls, so that old and new checkouts both know them. The least of some calls is the step without what
# the machine does beside it; a short and a long call differ by steps only, without start and storage.
PROGRAM = """
import sys, time
import flexapod as fx
study = fx.preset("paper-robot")

def seconds(duration):
    begin = time.process_time()
    fx.simulate(study, step=2.5e-4, output_step=2e-2, duration=duration)
    return time.process_time() - begin

def step():
    long, short = (min(seconds(duration) for _ in range(3)) for duration in (2.0, 0.2))
    return (long - short) / (1.8 / 2.5e-4)

step()
print("ready", flush=True)
for _ in sys.stdin:
    print(step(), flush=True)
"""


class Checkout:
    """A process that runs a program with the sources of one checkout, and answers a line by seconds."""

    def __init__(self, root: Path, program: str = PROGRAM) -> None:
        paths = os.pathsep.join([str(root / "src"), str(root)])
        environment = os.environ | {"PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(
            [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )
        self._answer()

    def _answer(self) -> str:
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the process of a checkout ended; its message stands above")
        return line.strip()

    def ask(self, line: str = "") -> float:
        """Seconds of the processor that what the line names takes now; of `PROGRAM` a step."""
        self._process.stdin.write(f"{line}\n")
        self._process.stdin.flush()
        return float(self._answer())

    def close(self) -> None:
        """End the process."""
        self._process.communicate()


def compared(here: Path, other: Path, runs: int = RUNS) -> tuple[Spread, Spread, float]:
    """Spreads of the seconds a step takes in both checkouts, and the median ratio, `here` over `other`."""
    checkouts = [Checkout(root) for root in (here, other)]
    try:
        pairs = [[checkout.ask() for checkout in checkouts] for _ in range(runs)]
    finally:
        for checkout in checkouts:
            checkout.close()
    ours, theirs = zip(*pairs, strict=True)
    return Spread(ours), Spread(theirs), statistics.median(a / b for a, b in pairs)


def main(arguments: list[str]) -> int:
    """Print the comparison."""
    if not 1 <= len(arguments) <= 2 or not (Path(arguments[0]) / "src" / "flexapod").is_dir():
        print(
            "usage: python -m benchmarks.two_checkouts OTHER [runs]; OTHER is the folder of a checkout", file=sys.stderr
        )
        return 2
    ours, theirs, ratio = compared(HERE, Path(arguments[0]).resolve(), *(int(n) for n in arguments[1:]))
    least = min(ours.values) / min(theirs.values)  # what a busy machine disturbs least
    print(f"here   {ours.text('us', 1e6)}\nother  {theirs.text('us', 1e6)}")
    print(f"ratio  {ratio:.3f}, of the least {least:.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
