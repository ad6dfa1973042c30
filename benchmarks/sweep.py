"""`python -m benchmarks.sweep`: what a sweep costs beside its simulations, and how well two workers share them.

Points are the preset `paper-robot` (2 s roll) with a scatter of its parts. Options: number of points, and the step or
tolerance of the integration. Two cores that do nothing else are assumed; times alternate and medians are printed.
"""

import argparse
import multiprocessing
import os
import statistics
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.report import goal
from flexapod import sweep
from flexapod.analysis.simulation import run_simulation
from flexapod.design.sweeps import executors
from flexapod.design.sweeps.outputs import select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.design.sweeps.worker import compute_point
from flexapod.model import override, preset

GOAL = 0.05 * 0.05  # overhead: 5 % of a simulation of 50 ms [s]
REPEATS = 3


def study(settings):
    return override(preset("paper-robot"), **settings)


def plan(count):
    """Random tolerances: diameters of the six pistons, places of the joints, payload."""
    laws = {
        "leg.piston.diameter": {"normal": "0.02 mm"},
        "robot.base.joints": {"uniform": "0.1 mm"},
        "payload.mass": {"normal": "1 %"},
    }
    return {"random": {"count": count, "seed": 1, "tolerance": [{"key": key, **law} for key, law in laws.items()]}}


def bare(one):
    """The part of `flexapod.simulate` that nobody can do without: checks, integration, remarks."""
    run_simulation(one).warnings()


def measured(action):
    begin = time.process_time()
    action()
    return time.process_time() - begin


def in_one_process(points, keep, count):
    """Processor seconds of a point: the bare simulation, and what a sweep adds to it in the worker."""
    bare_times, kept_too = [], []
    for number in range(count):
        one = points.study(number)
        bare_times.append(measured(lambda one=one: bare(one)))
        kept_too.append(measured(lambda one=one: compute_point(keep, one)))
    added = statistics.median(b - a for a, b in zip(bare_times, kept_too, strict=True))
    return statistics.median(bare_times), added


def swept(settings, count, workers, store):
    """A sweep: seconds from the first results to the end, points in them, client's processor seconds a point."""
    seen = []

    def progress(words, share):
        if " points, " in words:
            seen.append((time.perf_counter(), time.process_time(), int(words.split()[0])))

    sweep(study(settings), plan(count), store=store, workers=workers, progress=progress)
    begin = next(i for i, entry in enumerate(seen) if entry[2] > 2 * workers)  # all have compiled and imported
    (t0, c0, n0), (t1, c1, n1) = seen[begin], seen[-1]
    return (n1 - n0) / (t1 - t0), (c1 - c0) / (n1 - n0)


def plain(settings, numbers, ready, go, rates):
    """A process of its own that computes points one after the other."""
    points = Points(study(settings), read_plan(plan(10_000)))
    keep = select_outputs(points.plan.keep, points.nominal, Points(points.nominal, read_plan(plan(2))).resolve())
    compute_point(keep, points.study(0))
    ready.wait()
    go.wait()
    begin = time.perf_counter()
    for number in numbers:
        compute_point(keep, points.study(number))
    rates.put(len(numbers) / (time.perf_counter() - begin))


def plain_rate(settings, count, processes):
    """Points a second of plain processes that start together."""
    context = multiprocessing.get_context("spawn")
    ready, go, rates = context.Barrier(processes + 1), context.Event(), context.Queue()
    started = [
        context.Process(target=plain, args=(settings, range(i, count, processes), ready, go, rates))
        for i in range(processes)
    ]
    for process in started:
        process.start()
    ready.wait()
    go.set()
    found = [rates.get() for _ in started]
    for process in started:
        process.join()
    return sum(found)


def resident():
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=400)
    parser.add_argument("--step", type=float, default=None)
    parser.add_argument("--tolerance", type=float, default=1e-2)
    given = parser.parse_args()
    settings = {"step": given.step} if given.step else {"tolerance": given.tolerance}
    points = Points(study(settings), read_plan(plan(given.points)))
    keep = select_outputs(points.plan.keep, points.nominal, points.resolve())
    read = measured(Points(points.nominal, points.plan).resolve) / given.points  # as a sweep does, all in a row
    compute_point(keep, points.study(0))
    bare_time, added = in_one_process(points, keep, 30)
    print(f"a simulation, without a Dataset {1e3 * bare_time:26.1f} ms of one core")
    print(f"reading its study               {1e3 * read:26.2f} ms")
    print(f"scalars from its record         {1e3 * added:26.2f} ms")
    ratios, client, rates = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for repeat in range(REPEATS):
            two = plain_rate(settings, given.points, 2)
            before = resident()
            rate, cost = swept(settings, given.points, 2, Path(folder) / f"{repeat}.sqlite")
            rates.append(rate)
            ratios.append(rate / two)
            client.append(cost)
            print(f"two plain processes {two:8.2f}/s, two workers {rate:.2f}/s, memory {resident() - before:+.0f} MB")
    cost = statistics.median(client)
    overhead = cost + read
    print(f"client: Dask, storing           {1e3 * cost:26.2f} ms a point")
    ratio, minutes = statistics.median(ratios), 10_000 / statistics.median(rates) / 60
    print(f"overhead: client and reading    {1e3 * overhead:26.2f} ms a point, {goal(overhead, GOAL, '2.5 ms')}")
    print(f"two workers / two processes     {ratio:26.3f}, {goal(ratio, 0.93, '0.93', at_least=True)}")
    print(f"10,000 points                   {minutes:26.1f} minutes, {goal(minutes, 10, '10 minutes')}")
    print(f"(tasks of {executors.TASK} s, {given.points} points, {settings})")


if __name__ == "__main__":
    main()
