"""`python -m benchmarks [names] [--write]`: measured speed, printed; all of it, or the sections named.

With `--write` figures are stored beside the page `RESULTS.md`, and without names the page is rewritten.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from datetime import date
from pathlib import Path
from time import perf_counter

from benchmarks.machine import machine, one_core, peak
from benchmarks.report import Section
from flexapod.common.resources import one_thread

PAGE = Path(__file__).with_name("RESULTS.md")


def sections() -> dict[str, Callable[[], list[Section]]]:
    """The sections by name, in the order of the page."""
    from benchmarks.linear_models import linear_models
    from benchmarks.many_poses import many_poses
    from benchmarks.many_robots import many_robots
    from benchmarks.mechanisms import mechanisms
    from benchmarks.one_actuator import one_actuator
    from benchmarks.one_robot import one_robot
    from benchmarks.real_parts import real_parts
    from benchmarks.sampled_loops import sampled_loops
    from benchmarks.scaling import scaling
    from benchmarks.side_by_side import side_by_side
    from benchmarks.startup import startup
    from benchmarks.tolerances import tolerances

    return {
        "tolerances": tolerances,
        "one-robot": one_robot,
        "scaling": scaling,
        "side-by-side": side_by_side,
        "one-actuator": one_actuator,
        "mechanisms": mechanisms,
        "real-parts": real_parts,
        "many-poses": many_poses,
        "linear-models": linear_models,
        "sampled-loops": sampled_loops,
        "many-robots": many_robots,
        "start-up": startup,
    }


def main(arguments: list[str]) -> int:
    """Measure what is named, or everything."""
    known = sections()
    names = [a for a in arguments if a != "--write"]
    if unknown := [name for name in names if name not in known]:
        print(f"no such section: {', '.join(unknown)}; there are {', '.join(known)}", file=sys.stderr)
        return 2
    one_core()
    rates = ", ".join(f"{rate / 1e9:.0f} GFLOP/s {width} wide" for width, rate in peak().items())
    about = [*machine().lines(), f"Peak of one core, measured: {rates or 'no compiler'}"]
    print("\n".join(about), end="\n\n", flush=True)
    measured = []
    for name in names or known:
        begin, before = perf_counter(), _processor()
        with one_thread():  # as in all calls: threads of BLAS that spin would count, and take turns on this core
            found = known[name]()
        for section in found:
            measured.append(section)
            print(section.text(), end="\n\n", flush=True)
        wall, processor = perf_counter() - begin, _processor() - before
        print(f"  {name}: {wall:.0f} s, {processor:.0f} s of the processor", file=sys.stderr, flush=True)
    if "--write" in arguments:
        from flexapod.output.figures.style import save

        for section in measured:
            for name, picture in section.pictures.items():
                save(picture, PAGE.with_name(name), formats=("svg",))
    if "--write" in arguments and not names:
        PAGE.write_text(page(about, measured), encoding="utf-8")
    return 0


def _processor() -> float:
    """Seconds of the processor, of this process and of those that it waited for."""
    return sum(os.times()[:4])


def page(about: list[str], measured: list[Section]) -> str:
    """The page of results."""
    head = (
        "# Measured speed\n\n"
        f"Measured on {date.today().isoformat()} by `make bench`, everything in one run on one core. "
        "`python -m benchmarks --write` writes this page.\n\n"
    )
    return head + "\n".join(f"- {line}" for line in about) + "\n\n" + "\n\n".join(s.markdown() for s in measured) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
