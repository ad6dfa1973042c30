"""Damaged studies, tables and sweep files, each from a seed: refused in words, or computed in finite numbers.

By hand, more of them than the suite has time for (the first seed may be given too):

    .venv/bin/python -m tools.damaged 100000 [1]
"""

import dataclasses
import functools
import math
import random
import re
import signal
import sys
import tempfile
import tomllib
import traceback
import warnings
from collections import Counter
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from flexapod.analysis import simulate, simulate_actuator
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.tables.base import Frozen
from flexapod.design.sweeps.outputs import columns, select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.model import Study, load, loads, to_toml

SAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"
MECHANISMS = {path.stem: {"study.toml": path.read_text(encoding="utf-8")} for path in sorted(SAMPLES.glob("*.toml"))}
WHOLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")) | MECHANISMS
SWEEPS = [name for name, files in WHOLE.items() if "sweep.toml" in files]
BASES = [name for name in WHOLE if name not in (*SWEEPS, *MECHANISMS)]
SECONDS = 60  # for one file; the slowest take one, and some more where the first of a kind compiles its kernel
MARCHED = 100  # one in so many is simulated too
FEW_POINTS = 30  # of a sweep that is read point by point
# Kernels of other shapes would have to be compiled first: seconds each.
COMPILED = {("rigid", 0), ("lumped", 0), ("assumed-modes", 1), ("assumed-modes", 3)}
AXIAL_MODES = 2

ODD = [
    "0", "-1", "1", "-0.0", "nan", "inf", "-inf", "1e-300", "1e-30", "1e-12", "1e12", "1e160", "1e308", "1e400",
    '"-3 mm"', "5e-324", "9" * 400, "-" + "9" * 30, "0x10", "1_000", "true", "false", '""', "''", '" "', '"x"',
    '"0 mm"', '"nan mm"', '"inf m"', '"1e160 m"', '"1e-300 kg"', '"1e400 m"', '"27 parsec"', '"27 mm mm"',
    '"27 kg"', '"3 deg"', '"3 m/s"', '"27mm"', '"27,5 mm"', '"1 N m^2"', '"5 %"', '"5 m^1e9"', '"5 m**9999999"',
    '"1 (((m)))"', '"1 degC"', '"1 m + 1"', '"1 \\u0000"', '"\\U0001F600"', '"1 µm"', '"../x.csv"', '"/dev/null"',
    '"."', '"path.csv\\u0000"', "[]", "[[]]", "[1]", "[1, 2]", "[1, 2, 3]", "[0, 0, 0]", "[1, 2, 3, 4, 5, 6]",
    '["1 m", 2, "3 mm"]', "[nan, 0, 0]", "[1e160, 0, 0]", "[1e-300, 0, 0]", "[[1, 2, 3]]",
    "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]", "[true, false, true]", "{}", "{ a = 1 }", "{ type = 1 }", "{ rate = 1 }",
    "[{}]", "[{ time = 0 }, { time = 1 }]", "1979-05-27", "1979-05-27T07:32:00Z", "07:32:00", '"quintic"',
    '"linear"', '"smooth"', '"trapezoid"', '"csv"', '"rigid"', '"lumped"', '"force"', '"servo"', '"roll"',
    '"heave"', '"steel"', '"straight"', '"moving"', '"tip-load"', '"clamped-free"', '"constant"', '"sine"',
    '"step"', '"spin-up"', "2", "3", "12", "24", "25", "4", "5", "1e-3", "1e-9", "1e9", "0.05",
]  # fmt: skip
CELLS = [
    "", " ", "nan", "NaN", "inf", "-inf", "x", "1e160", "1e-300", "1e400", "-1", "0", "0", "1", "1e9", "1,5", "1;5",
    '"', '"1"', "1 mm", "true", "0x1", "1_0", "\x00", "#", "٣", "9" * 400,
]  # fmt: skip
HEADERS = [
    "time", "time [s]", "time [ms]", "time [m]", "t [s]", "roll [deg]", "roll [m]", "roll []", "surge [mm]", "[s]",
    "surge [um", "value [N]", "value [rad]", "leg 1 [N]", "leg 7 [N]", "Fz [kN]", "Fx [N m]", "", "é [s]", "time [0 s]",
]  # fmt: skip

ASSIGNED = re.compile(
    r'([\w".-]+)(\s*=\s*)("[^"\n]*"|\[[^\n]*?\](?=[\s,}]|$)|\{[^{}\n]*\}|[^\s,{}\[\]"]+)', re.MULTILINE
)
TABLE = re.compile(r"^\[+([\w.]+)\]+", re.MULTILINE)


# Damages of a text: (random, text) -> text


def value(r, text):
    return _replaced(r, text, lambda m: m[1] + m[2] + r.choice(ODD))


def scaled(r, text):
    """A number times a power of ten or another factor."""
    found = list(re.finditer(r"(?<![\w.\"])-?\d+\.?\d*(?:e-?\d+)?|(?<=\")-?\d+\.?\d*", text))
    if not found:
        return text
    m = r.choice(found)
    factor = r.choice([-1, 0, 0.1, 0.5, 0.9, 1.1, 2, 10, 1e3, 1e6, 1e-3, 1e-6, 1e-9, 1e9])
    return text[: m.start()] + f"{float(m[0]) * factor:.9g}" + text[m.end() :]


def wrong_name(r, text):
    def rename(m):
        name = m[1]
        i = r.randrange(len(name))
        others = [name[:i] + name[i + 1 :], name + "s", name.upper(), "x", "", '""', f"{name}.x", f'"{name}"',
                  f"é{name}", name[:i] + name[i : i + 1] * 2 + name[i + 1 :]]  # fmt: skip
        return r.choice([*others, r.choice(ASSIGNED.findall(text))[0]]) + m[2] + m[3]

    return _replaced(r, text, rename)


def removed(r, text):
    return _replaced(r, text, lambda m: "")


def removed_neatly(r, text):
    found = list(re.finditer(r'(?<![\w".-])[\w."-]+\s*=\s*("[^"\n]*"|[\d.e-]+)\s*(,\s*|\n|(?=\}))', text))
    if not found:
        return text
    m = r.choice(found)
    return re.sub(r",\s*\}", " }", text[: m.start()] + text[m.end() :])


def doubled(r, text):
    lines = text.splitlines(keepends=True)
    i = r.randrange(len(lines))
    return "".join([*lines[: i + 1], *lines[i:]])


def moved(r, text):
    lines = text.splitlines(keepends=True)
    line = lines.pop(r.randrange(len(lines)))
    lines.insert(r.randrange(len(lines) + 1), line)
    return "".join(lines)


def added(r, text):
    """A line of another study, anywhere."""
    lines = text.splitlines(keepends=True)
    other = WHOLE[r.choice(BASES)]["study.toml"].splitlines(keepends=True)
    lines.insert(r.randrange(len(lines) + 1), r.choice(other))
    return "".join(lines)


def retabled(r, text):
    found = list(TABLE.finditer(text))
    if not found:
        return text
    m = r.choice(found)
    name = r.choice([m[1] + "s", "leg", "motion", "load", "initial", "actuator", "simulation", "robot", "a.b", ""])
    words = r.choice([f"[{name}]", f"[[{m[1]}]]", f"[[{name}]]", f"[{m[1]}.{name}]", "", "[", f"{m[1]} = 1"])
    return text[: m.start()] + words + text[m.end() :]


def nested(r, text):
    depth = r.choice([3, 31, 33, 200, 3000])
    deep = r.choice(["[" * depth + "]" * depth, "{ a = " * depth + "1" + " }" * depth, "[" * depth])
    if r.random() < 0.3:
        return text + "\n" + ".".join("a" * depth) + " = 1\n"
    return _replaced(r, text, lambda m: m[1] + m[2] + deep)


def long_line(r, text):
    size = r.choice([1000, 20_000])
    long = r.choice([f'"{"x" * size}"', "1" * size, f"[{'1, ' * (size // 3)}1]", f"1 # {'x' * size}"])
    return _replaced(r, text, lambda m: m[1] + m[2] + long)


def _replaced(r, text, change):
    found = list(ASSIGNED.finditer(text))
    if not found:
        return text
    m = r.choice(found)
    return text[: m.start()] + change(m) + text[m.end() :]


# Damages of bytes: (random, bytes) -> bytes


def cut(r, data):
    return data[: r.randrange(len(data) + 1)]


def flipped(r, data):
    out = bytearray(data)
    for _ in range(r.choice([1, 1, 2, 10]) if out else 0):
        out[r.randrange(len(out))] = r.choice([r.randrange(256), r.randrange(32, 127)])
    return bytes(out)


def encoded(r, data):
    text = data.decode("utf-8", "replace")
    return r.choice([
        b"\xef\xbb\xbf" + data, b"\xff\xfe" + data, data.replace(b"\n", b"\r\n"), data.replace(b"\n", b"\r"),
        text.encode("utf-16"), text.encode("latin-1", "replace") + b"\xe9", data + b"\x00", b"\x00" + data, b"", b"\n",
        b"\xef\xbb\xbf" * 2 + data, data * 2, data.replace(b" ", "\u00a0".encode()), b"\x1a" + data,
    ])  # fmt: skip


# Damages of a table: (random, text) -> text


def cell(r, text):
    rows = [line.split(",") for line in text.splitlines()]
    row = r.choice(rows)
    row[r.randrange(len(row))] = r.choice(HEADERS if row is rows[0] else CELLS)
    return _csv(rows)


def ragged(r, text):
    rows = [line.split(",") for line in text.splitlines()]
    row = r.choice(rows)
    row.append(r.choice(CELLS)) if r.random() < 0.5 else row.pop()
    return _csv(rows)


def reordered(r, text):
    head, *rows = text.splitlines()
    r.choice([r.shuffle, list.reverse, lambda x: x.append(x[-1]), list.clear, lambda x: x.insert(0, head)])(rows)
    return "\n".join([head, *rows]) + "\n"


def columns_apart(r, text):
    rows = [line.split(",") for line in text.splitlines()]
    i, j = r.randrange(len(rows[0])), r.randrange(len(rows[0]))
    for row in rows:
        row[i] = row[j]
    return _csv(rows) if r.random() < 0.5 else text.replace(",", r.choice([";", "\t", ",,", " "]))


def stretched(r, text):
    head, *rows = text.splitlines()
    factor = r.choice([0, 1e-9, 1e-3, 10, 1e3, 1e9, 1e150])
    cells = [[f"{float(c) * factor:.17g}" for c in row.split(",")] for row in rows]
    return "\n".join([head, *(",".join(row) for row in cells)]) + "\n"


def _csv(rows):
    return "\n".join(",".join(row) for row in rows) + "\n"


TEXTS = [value] * 8 + [scaled] * 12 + [wrong_name, wrong_name, removed, removed_neatly, removed_neatly, doubled, moved,
         added, added, retabled, nested, long_line]  # fmt: skip
BYTES = [cut, flipped, encoded]
ROWS = [cell, cell, cell, ragged, reordered, columns_apart, stretched]


@dataclasses.dataclass(frozen=True)
class Damaged:
    """Files by name, which of them was damaged and how."""

    name: str
    files: dict[str, bytes]
    how: tuple[str, ...]

    @property
    def sweep(self):
        return "sweep.toml" in self.files


def damaged(seed: int) -> Damaged:
    """The damaged files of a seed."""
    r = random.Random(seed)
    share = r.random()
    name = r.choice(SWEEPS if share < 0.2 else list(MECHANISMS) if share < 0.25 else BASES)
    files = dict(WHOLE[name])
    tables = [file for file in files if file.endswith(".csv")]
    target = (
        r.choice(tables) if tables and r.random() < 0.4 else "sweep.toml" if "sweep.toml" in files else "study.toml"
    )
    kinds = ROWS if target.endswith(".csv") else TEXTS
    chosen = [r.choice(kinds) for _ in range(r.choice([1, 1, 1, 2, 3]))]
    chosen = sorted(set(chosen), key=lambda damage: (damage is long_line, kinds.index(damage)))  # the longest one last
    for damage in chosen:
        with_text = files[target]
        try:
            files[target] = damage(r, with_text)
        except (IndexError, ValueError):  # an earlier damage left nothing to damage
            files[target] = with_text
    data = {file: text.encode("utf-8", "surrogatepass") for file, text in files.items()}
    how = [damage.__name__ for damage in chosen]
    if r.random() < 0.15:
        broken = r.choice(BYTES)
        data[target] = broken(r, data[target])
        how.append(broken.__name__)
    return Damaged(name, data, (target, *how))


# What becomes of it


def outcome(case: Damaged, folder: Path, *, march: bool = False) -> str:
    """``refused``, ``failed`` in words or ``accepted``; anything else is raised.

    Raises
    ------
    AssertionError
        A number that is not finite, or a study that is another one when it is written and read again.
    Exception
        Whatever is not an error of flexapod's own, warnings of NumPy among them.
    """
    for file, data in case.files.items():
        (folder / file).write_bytes(data)
    try:
        with time_limit(SECONDS):
            _use(case, folder, march)
    except InputError as error:
        assert str(error).isprintable() or "\n" not in str(error)
        return "refused"
    except ComputationError:
        return "failed"
    return "accepted"


def _use(case, folder, march):
    study = load(folder / "study.toml")
    assert_finite(study, "study")
    assert study.warnings is not None
    again = loads(to_toml(study), path=folder / "study.toml")
    assert bare(again) == bare(study)
    if case.sweep:
        _sweep(study, folder)
        return
    simulation = study.simulation
    stretch = {leg.axial_modes for leg in study.robot.legs} if isinstance(study, Study) else {AXIAL_MODES}
    if (simulation.fidelity, simulation.lateral_shapes) not in COMPILED or stretch != {AXIAL_MODES}:
        return
    if isinstance(study, Study) and joints(study) not in known_joints():
        return
    assert_finite(describe(study).as_dict(), "description")
    if march and study.duration / simulation.stored_step < 1000 and study.duration < 10:
        run = simulate if isinstance(study, Study) else simulate_actuator
        data = run(study, tolerance=1e-2, duration=min(study.duration, 0.01), output_step=0.002)
        for name in ("com_position", "tip_deflection", "actuator_force"):
            assert name not in data or np.isfinite(data[name]).all(), name


def joints(study):
    """What a robot's kernel is made for, besides shapes."""
    ends = [joint for leg in study.robot.legs for joint in (leg.base_joint, leg.platform_joint)]
    free = tuple((joint.bending is None, joint.torsion is None, joint.stiffness is None) for joint in ends)
    return study.robot.type, study.robot.plane, free


@functools.cache
def known_joints():
    return {joints(loads(files["study.toml"])) for files in MECHANISMS.values()}


def bare(study):
    """The study without its text."""
    return study.replace(source_text="-", path=None, notes=())


def _sweep(study, folder):
    points = Points(study, read_plan(folder / "sweep.toml"))
    if len(points) > FEW_POINTS:
        return
    resolved = points.resolve()
    keep = select_outputs(points.plan.keep, points.nominal, resolved)
    columns(points, keep, resolved)
    for i in set(resolved.first.tolist()) - set(resolved.refused):
        assert_finite(points.study(i), f"point {i}")


MAY_BE_INFINITE = {"settling"}  # without damping it never falls below the band


def assert_finite(found, path):
    if isinstance(found, Frozen):
        found = {name: getattr(found, name) for name in type(found).model_fields}
    if isinstance(found, dict):
        for name, inner in found.items():
            if name not in MAY_BE_INFINITE:
                assert_finite(inner, f"{path}.{name}")
    elif isinstance(found, list | tuple):
        for i, inner in enumerate(found):
            assert_finite(inner, f"{path}[{i}]")
    elif isinstance(found, np.ndarray):
        assert np.isfinite(found).all(), path
    elif isinstance(found, float):
        assert math.isfinite(found), f"{path} = {found}"


@contextmanager
def time_limit(seconds):
    def late(number, frame):
        raise AssertionError(f"takes more than {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def main(count: int, first: int = 0) -> int:
    """Try `count` seeds from `first` on; print every finding with its seed. Returns the number of findings."""
    warnings.simplefilter("error")
    found, counts = Counter(), Counter()
    with tempfile.TemporaryDirectory() as name:
        for seed in range(first, first + count):
            case, folder = damaged(seed), Path(name) / str(seed)
            folder.mkdir()
            try:
                counts[outcome(case, folder, march=seed % MARCHED == 0)] += 1
            except Exception as error:
                counts["wrong"] += 1
                last = traceback.extract_tb(error.__traceback__)[-1]
                where = f"{type(error).__name__} {str(error)[:80]} at {Path(last.filename).name}:{last.lineno}"
                if not found[where]:
                    print(f"seed {seed}: {case.name}, {', '.join(case.how)}: {where}", flush=True)
                found[where] += 1
            for file in folder.iterdir():
                file.unlink()
            folder.rmdir()
    print(dict(counts))
    return sum(found.values())


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])) > 0)
