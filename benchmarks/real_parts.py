"""What real parts cost: a step beside that of paper-robot, the first run, memory; operations of robots without them."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.mechanisms import count, first_run, least_step, with_step
from benchmarks.report import Section, goal
from benchmarks.timing import interleaved
from flexapod.model import loads, preset, preset_text
from flexapod.solve.time.robot_march import prepare

__all__ = ["EVERYTHING", "real_parts", "tapered"]

COMMAND = "python -m benchmarks real-parts"
REPEATS = 9
#: Operations of a leg of paper-robot before there were real parts: residual, matrices.
BEFORE = {"leg_residual": 3887, "leg_matrices": 1977}
EVERYTHING = Path(__file__).with_name("everything.toml")
#: Pistons as everything.toml has them, and in two parts of which one tapers.
UNIFORM = '{ diameter = "60 mm", inner_diameter = "40 mm", length = "600 mm", material = "steel" }'
TAPERED = """{ sections = [
  { length = "400 mm", diameter = "60 mm", tip_diameter = "50 mm", material = "steel" },
  { length = "200 mm", diameter = "60 mm", material = "steel" },
] }"""
MOST_SHAPES = 6


def real_parts() -> list[Section]:
    """One section: a row a robot, and what those without such parts pay."""
    texts = {"machine-hexapod": preset_text("machine-hexapod"), "everything on": EVERYTHING.read_text("utf-8")}
    plain = with_step(preset("paper-robot"))
    studies = {"paper-robot": plain, **{name: with_step(loads(text)) for name, text in texts.items()}}  # type: ignore[arg-type]
    for study in studies.values():
        least_step(study)
    steps = interleaved({name: (lambda s=study: least_step(s)) for name, study in studies.items()}, REPEATS)
    base = steps["paper-robot"].median
    rows = [["paper-robot", steps["paper-robot"].text("us", 1e6), "1", *_first(preset_text("paper-robot"))]]
    for (name, text), most in zip(texts.items(), (2.0, 4.0), strict=True):
        ratio = steps[name].median / base
        of_plain = f"{ratio:.2f}, {goal(ratio, most, f'at most {most:g}')}"
        rows.append([name, steps[name].text("us", 1e6), of_plain, *_first(text)])
    kernel = prepare(plain).system.kernel
    now = {name: count(kernel, name) for name in BEFORE}
    worst = max(now[name] / before for name, before in BEFORE.items())
    numbers = ", ".join(f"{value:.0f} for {BEFORE[name]}" for name, value in now.items())
    remarks = [
        f"Operations of a leg of paper-robot, residual and matrices, over those without real parts: {numbers}: "
        + goal(worst, 1.03, "at most 3 % more"),
        f"First run ever with pistons that taper and {MOST_SHAPES} shapes a plane, within a tolerance: "
        + _first_tapered(),
        "everything on: its cylinder bends with a kink at the piston's head: 21,700 operations of a residual and "
        "51 coordinates of a leg; polynomials alone, 13,300 and 45, met the goal with a first frequency 1.7 % off.",
        "everything on: benchmarks/everything.toml. Budgets at a pose and in maps: python -m benchmarks many-poses.",
    ]
    header = ["Robot", "Step in C", "Of paper-robot", "First run ever", "Memory, of the compiler or the run"]
    return [Section(title="Real parts", command=COMMAND, header=header, rows=rows, remarks=remarks)]


def tapered() -> str:
    """Everything on, with guided pistons of two sections, one a taper: the longest compilation."""
    return EVERYTHING.read_text("utf-8").replace(UNIFORM, TAPERED)


def _first_tapered() -> str:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text(tapered(), encoding="utf-8")
        seconds, memory = first_run(file, "tolerance", "1e-4", modes=MOST_SHAPES)
    return f"{seconds:.1f} s, {goal(seconds, 30.0, 'at most 30')}; {memory:.0f} MB"


def _first(text: str) -> list[str]:
    """Time and memory of the first run with a fixed step, and within a tolerance, whose library has a method more."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text(text, encoding="utf-8")
        runs = [first_run(file, *how) for how in (("step", "1e-3"), ("tolerance", "1e-4"))]
    (seconds, memory), (longer, more) = runs
    return [
        f"{seconds:.1f} s, within a tolerance {longer:.1f} s, {goal(max(seconds, longer), 30.0, 'at most 30')}",
        f"{memory:.0f} MB, {more:.0f} MB, {goal(max(memory, more), 500.0, 'at most 500')}",
    ]
