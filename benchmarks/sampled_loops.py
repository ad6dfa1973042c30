"""Sampled controllers in the march: samples at each fixed step, and as ends of steps within a tolerance."""

from __future__ import annotations

import time
from collections.abc import Callable

from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod.analysis.controller_settings import sampled_controller
from flexapod.control import IFF
from flexapod.model import ServoDrive, Study, override, preset
from flexapod.solve.time.robot_march import prepare

__all__ = ["sampled_loops"]

COMMAND = "python -m benchmarks sampled-loops"
REPEATS, SPAN, STEP = 7, 2.0, 2e-4
LAW = IFF(20.0, high_pass=5.0)


def sampled_loops() -> list[Section]:
    """One section, processor time of the march alone."""
    actions: dict[str, Callable[[], float]] = {}
    for name in ("paper-robot", "nano-hexapod"):
        for words, steps in (("steps of 0.2 ms", {"step": STEP}), ("within 1e-4", {"tolerance": 1e-4})):
            study = override(_with_servos(preset(name)), duration=SPAN, output_step=0.01, **steps)
            actions[f"{name}, {words}, alone"] = lambda study=study: _seconds(study, False)
            actions[f"{name}, {words}, 5 kHz"] = lambda study=study: _seconds(study, True)
    for action in actions.values():  # compiles
        action()
    times = interleaved(actions, REPEATS)
    rows = []
    for what, spread in times.items():
        limit = ""
        if what.endswith("5 kHz"):
            alone = times[what.replace("5 kHz", "alone")].median
            fixed = "steps of" in what
            limit = goal(spread.median, 1.3 * alone, "1.3 times") if fixed else goal(spread.median, 0.5, "0.5 s")
        rows.append([what, spread.text(), limit])
    remark = f"Medians of {REPEATS} interleaved runs of {SPAN:g} s, six force sensors and integrators, 10,000 samples."
    header = ["what", "cost", "goal"]
    return [Section(title="Sampled loops", command=COMMAND, header=header, rows=rows, remarks=[remark])]


def _with_servos(study: Study) -> Study:
    if not study.robot.legs[0].drive.holds:
        return study
    drive = ServoDrive(stiffness=5e7, damping=2e4)
    legs = tuple(leg.replace(drive=drive) for leg in study.robot.legs)
    return study.replace(robot=study.robot.replace(legs=legs))


def _seconds(study: Study, controlled: bool) -> float:
    sampled = sampled_controller(study, LAW, "5 kHz") if controlled else None
    chunks = prepare(study, sampled=sampled).chunks
    begin = time.process_time()
    for _ in chunks:
        pass
    return time.process_time() - begin
