"""Small faults put into a copy of the code one by one: those that the tests near them do not see are listed.

By hand, it takes an hour or two (seeds give other faults; what is in the file of results is not tried again):

    .venv/bin/python -m tools.faults 100 [--seed 1] [--results build/faults]    try faults, list survivors
    .venv/bin/python -m tools.faults 100 --rooms control feedforward exchange   in these folders of the package alone
    .venv/bin/python -m tools.faults --list 100                                 show them, try none
    .venv/bin/python -m tools.faults --again                                    survivors of the results once more
    .venv/bin/python -m tools.faults --again kinematics/laws --tests tests/kinematics/test_laws.py   by these

A fault is one operator, number, index, function, default or sign. One that changes words alone is none: docstrings,
messages, annotations, figures. Each is tried in one process of low priority, on tests that are near (they call the
function, as far as that was seen before; else by names), the quickest first, until one fails. What fails without the
fault does not count.
"""

import argparse
import ast
import builtins
import contextlib
import dataclasses
import hashlib
import importlib
import json
import math
import os
import re
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from types import CodeType

import pytest

from tools.nearness import Nearness

ROOT = Path(__file__).parents[1]
#: Chances of a place in a folder's code, the innermost that has one; numbers and laws before pictures and words.
ROOMS = {"app": 0.1, "figures": 0.1, "report": 0.1, "verification": 0.05, "paper": 0.3, "exchange": 0.7, "scene": 0.7,
         "common": 0.5}  # fmt: skip
IN_A_FILE = 3
#: Files and functions that are about words, looks, files or speed.
WORDS = re.compile(
    r"words|text|label|title|legend|caption|colou?r|style|page|html|toml|format|describe_|remark|message|notes?$|"
    r"names?$|__repr__|__str__|progress|announce|sentence|_say|hint|advice|tick|table$|document|log"
)
FILES = re.compile(
    r"(^|/)(variables|quantities|\w*_words|page|field_help|citations|lazy_imports|resources|version|errors|compiler|cache|lock|html|"
    r"style|colours|c_source|failures|terminal|logs|access|server|network|client_limits|files|processes|write|toml|printed|"
    r"documents?|header|player|background|running|opening)\.py$"
)
SILENT = {"strict", "frozen", "kw_only", "repr", "exist_ok", "copy", "maxsize", "errors", "description", "mode", "eq",
          "optimize", "daemon", "parents", "missing_ok", "index", "stacklevel", "timeout", "next_step", "title",
          "allowed", "init", "check", "capture_output", "alias", "ignore_errors"}  # fmt: skip
TELLING = re.compile(r"Error$|^_log$|^warn|^log|^number$|^text$|^words|^TypeVar$|^lru_cache$|^round$|^Scalar$")
OPERATORS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
COMPARISONS = {ast.Lt: ast.GtE, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
SWAPS = {"sin": "cos", "cos": "sin", "max": "min", "min": "max", "maximum": "minimum", "minimum": "maximum",
         "argmax": "argmin", "argmin": "argmax", "floor": "ceil", "ceil": "floor", "abs": "float", "cosh": "sinh",
         "sinh": "cosh", "all": "any", "any": "all", "zeros": "ones", "hstack": "vstack", "cumsum": "asarray",
         "base_joint": "platform_joint", "platform_joint": "base_joint", "base_joints": "platform_joints",
         "platform_joints": "base_joints", "mouth": "begins", "rad2deg": "deg2rad", "deg2rad": "rad2deg"}  # fmt: skip
#: Their text is in the key of every kernel: all are compiled anew.
SYMBOLIC = tuple(f"src/flexapod/mechanics/{room}/" for room in ("elements", "leg", "symbolic"))
#: Seconds of a fault's tests, by what they took before; a fault that so many files have reached is left as it is.
ROUNDS = ((15.0, 0), (40.0, 3))
LONGEST = 20  # a run may take so many times as long: processors are shared
PRELOADED = ("numpy", "scipy.optimize", "scipy.integrate", "scipy.spatial.transform", "casadi", "pydantic", "xarray",
             "netCDF4", "tomlkit", "msgspec", "rich.console", "typer", "matplotlib")  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Fault:
    """A text in a file and what stands there in its place; ``count``: which of the equal ones in this function."""

    path: str
    function: str
    was: str
    now: str
    count: int
    line: int
    span: tuple[int, int, int, int] = dataclasses.field(compare=False)

    @property
    def name(self) -> str:
        return f"{self.path}:{self.function}: {self.was}  ->  {self.now}" + f" (#{self.count})" * (self.count > 1)

    @property
    def symbolic(self) -> bool:
        return self.path.startswith(SYMBOLIC)


# Faults of a file


class Places(ast.NodeVisitor):
    """All faults that a file may have."""

    def __init__(self, path: str, source: str) -> None:
        self.path, self.source, self.found = path, source, []
        self.inside, self.seen = [], Counter()
        self.visit(ast.parse(source))

    def put(self, node: ast.AST, now: ast.AST) -> None:
        was = ast.get_source_segment(self.source, node)
        text = ast.unparse(now)
        if was is None or "\n" in was or len(was) > 120 or not self.inside:
            return
        function = ".".join(self.inside)
        self.seen[function, was, text] += 1
        span = (node.lineno, node.col_offset, node.end_lineno, node.end_col_offset)
        self.found.append(Fault(self.path, function, was, text, self.seen[function, was, text], node.lineno, span))

    # What is left out

    def named(self, node):
        if WORDS.search(node.name) and not isinstance(node, ast.ClassDef):
            return
        self.inside.append(node.name)
        parts = [*node.decorator_list, *node.body] if not isinstance(node, ast.ClassDef) else node.body
        if not isinstance(node, ast.ClassDef):
            parts = [*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body]
        for part in parts:
            self.visit(part)
        self.inside.pop()

    visit_FunctionDef = visit_AsyncFunctionDef = visit_ClassDef = named

    def visit_AnnAssign(self, node):
        if node.value is not None:
            self.visit(node.value)

    def visit_Assign(self, node):
        names = [x.id for x in node.targets if isinstance(x, ast.Name)]
        if any(WORDS.search(name.lower()) or name == "__all__" for name in names):
            return
        outside = not self.inside
        self.inside += names[:1] if outside else []
        self.visit(node.value)
        if outside:
            self.inside.clear()

    def skip(self, node):
        return

    visit_Raise = visit_JoinedStr = visit_Assert = visit_Import = visit_ImportFrom = visit_Match = skip

    def visit_If(self, node):
        if "TYPE_CHECKING" not in ast.dump(node.test):
            # a check that ends in an error alone stays: its words are its purpose
            if not (all(isinstance(x, ast.Raise) for x in node.body) and not node.orelse):
                self.visit(node.test)
            for part in [*node.body, *node.orelse]:
                self.visit(part)

    def visit_Call(self, node):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        owner = getattr(getattr(node.func, "value", None), "id", "")
        if TELLING.search(name) or TELLING.search(owner):
            return
        if name in SWAPS and isinstance(node.func, ast.Attribute):
            self.put(node, ast.Call(ast.Attribute(node.func.value, SWAPS[name]), node.args, node.keywords))
        elif name in SWAPS:
            self.put(node, ast.Call(ast.Name(SWAPS[name]), node.args, node.keywords))
        self.visit(node.func)
        for part in node.args:
            self.visit(part)
        for keyword in node.keywords:
            if keyword.arg not in SILENT:
                self.visit(keyword.value)

    # What may be wrong

    def visit_BinOp(self, node):
        sides = (node.left, node.right)
        texts = any(isinstance(x, ast.JoinedStr | ast.List | ast.Tuple) or _is_text(x) for x in sides)
        if (to := OPERATORS.get(type(node.op))) and not texts:
            self.put(node, ast.BinOp(node.left, to(), node.right))
        self.generic_visit(node)

    def visit_AugAssign(self, node):
        texts = isinstance(node.value, ast.List | ast.JoinedStr | ast.ListComp)
        if isinstance(node.op, ast.Add | ast.Sub) and not texts:
            self.put(node.value, ast.UnaryOp(ast.USub(), node.value))
        self.visit(node.value)

    def visit_UnaryOp(self, node):
        if isinstance(node.op, ast.USub | ast.Not):
            self.put(node, node.operand)
        if not (isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant)):
            self.visit(node.operand)

    def visit_Compare(self, node):
        if len(node.ops) == 1 and (to := COMPARISONS.get(type(node.ops[0]))) and not _is_text(node.comparators[0]):
            self.put(node, ast.Compare(node.left, [to()], node.comparators))
        self.generic_visit(node)

    def visit_BoolOp(self, node):
        to = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        self.put(node, ast.BoolOp(to, node.values))
        self.generic_visit(node)

    def visit_Attribute(self, node):
        if node.attr in SWAPS and ("joint" in node.attr or node.attr == "mouth"):
            self.put(node, ast.Attribute(node.value, SWAPS[node.attr]))
        self.visit(node.value)

    def visit_Constant(self, node):
        x = node.value
        if isinstance(x, bool):
            self.put(node, ast.Constant(not x))
        elif isinstance(x, int):
            self.put(node, ast.Constant(x + 1 if x < 9 else 2 * x))
        elif isinstance(x, float) and abs(x) > 1e-6 and abs(x) < 1e9:  # beyond are guards against rounding
            self.put(node, ast.Constant(2.0 * x if x else 1.0))


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str | None)


def faults(count: int, seed: int, rooms: Sequence[str] = ()) -> list[Fault]:
    """Faults of a seed, one in a function and few in a file; what else changes in the code moves none of the others.

    With `rooms` from these folders of the package alone.
    """
    drawn = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        name = str(path.relative_to(ROOT))
        inside = name.split("/")[2:-1]
        if FILES.search(name) or name.endswith("__init__.py") or (rooms and not {*inside} & {*rooms}):
            continue
        weight = next((ROOMS[room] for room in reversed(inside) if room in ROOMS), 1.0)
        for fault in Places(name, path.read_text(encoding="utf-8")).found:
            chance = int(hashlib.sha256(f"{seed} {fault.name}".encode()).hexdigest()[:12], 16) / 16**12
            drawn.append((chance ** (1 / weight), fault))
    kept, functions, files = [], set(), Counter()
    for _, fault in sorted(drawn, key=lambda x: (-x[0], x[1].name)):
        place = (fault.path, fault.function)
        if place not in functions and files[fault.path] < IN_A_FILE:
            functions.add(place)
            files[fault.path] += 1
            kept.append(fault)
        if len(kept) == count:
            break
    return kept


def _rooms() -> list[str]:
    return sorted({x.name for x in (ROOT / "src" / "flexapod").rglob("*") if x.is_dir() and x.name[0] != "_"})


def faulty(source: str, fault: Fault) -> str:
    """The source with the fault, which tells when it is reached."""
    first, start, last, end = fault.span
    lines = source.splitlines(keepends=True)
    line = lines[first - 1].encode()
    if first != last or line[start:end].decode() != fault.was:
        raise ValueError(f"{fault.path}: {fault.was} is not there")
    lines[first - 1] = (line[:start] + f"fault_here({fault.now})".encode() + line[end:]).decode()
    return "".join(lines)


# Trying them


@dataclasses.dataclass
class Trial:
    """What tests say of a fault: which one failed, which files reached it, seconds that each file took."""

    failed: str | None = None
    why: str = ""
    reached: list[str] = dataclasses.field(default_factory=list)
    seconds: dict[str, float] = dataclasses.field(default_factory=dict)
    called: dict[str, list[str]] = dataclasses.field(default_factory=dict)


class Watch:
    """Of pytest: the first failure, times, and where the fault was reached."""

    def __init__(self, answer: Path) -> None:
        self.trial, self.file, self.answer = Trial(), "", answer

    def here(self, value):
        """Stands around the faulty expression."""
        if self.file not in self.trial.reached:
            self.trial.reached.append(self.file)
            self.tell()
        return value

    def tell(self):
        """Whole at each moment: its process may be ended."""
        new = self.answer.with_suffix(".new")
        new.write_text(json.dumps(dataclasses.asdict(self.trial)))
        new.replace(self.answer)

    def pytest_runtest_logstart(self, nodeid):
        self.file = nodeid.split("::")[0]

    def pytest_runtest_logreport(self, report):
        file = report.nodeid.split("::")[0]
        self.trial.seconds[file] = self.trial.seconds.get(file, 0.0) + report.duration
        if report.failed and not self.trial.failed:
            self.trial.failed, self.trial.why = report.nodeid, str(report.longrepr)[-300:]

    def pytest_collectreport(self, report):
        if report.failed and not self.trial.failed:
            self.trial.failed, self.trial.why = report.nodeid, str(report.longrepr)[-300:]


class Copy:
    """A copy of the project, in which one file at a time is faulty."""

    def __init__(self, folder: Path, kernels: Path) -> None:
        self.folder, self.kernels, self.times, self.mapped = folder, kernels, int(time.time()), set()
        listed = ["git", "ls-files", "-co", "--exclude-standard"]
        for name in subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines():
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, folder / name)
        (folder / "told").mkdir()  # for processes that tests start
        (folder / "told" / "sitecustomize.py").write_text("import builtins\nbuiltins.fault_here = lambda x: x\n")

    def tried(self, tests: list[str], seconds: float, fault: Fault | None = None) -> Trial:
        """Run `tests` until one fails, in a process of their own."""
        path = None if fault is None else self.folder / fault.path
        source = "" if path is None else path.read_text(encoding="utf-8")
        kernels = self.folder / "kernels" if fault and fault.symbolic else self.kernels
        try:
            if path is not None and fault is not None:
                self._write(path, faulty(source, fault))
            return self._run(tests, seconds, kernels)
        finally:
            if path is not None:
                self._write(path, source)
            shutil.rmtree(self.folder / "kernels", ignore_errors=True)

    def _name(self, code: CodeType) -> str | None:
        """What `Fault` calls a function of the code."""
        if not code.co_filename.startswith(str(self.folder / "src")):
            return None
        return f"{Path(code.co_filename).relative_to(self.folder)}:{code.co_qualname.replace('<locals>.', '')}"

    def _write(self, path: Path, source: str) -> None:
        """With a time of its own: compiled modules are known by time and size."""
        path.write_text(source, encoding="utf-8")
        self.times += 10
        os.utime(path, (self.times, self.times))

    def _run(self, tests, seconds, kernels) -> Trial:
        answer, done = self.folder / "answer.json", self.folder / "done"
        answer.unlink(missing_ok=True)
        done.unlink(missing_ok=True)
        child = os.fork()
        if not child:
            os.setpgid(0, 0)
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            try:
                self._child(tests, seconds, kernels, answer, done)
            except BaseException:
                (self.folder / "died.txt").write_text(traceback.format_exc())
            finally:
                os._exit(0)
        try:
            select.select([os.pidfd_open(child)], [], [], LONGEST * seconds)
        finally:  # what its tests have left, too
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
        trial = Trial(**json.loads(answer.read_text())) if answer.exists() else Trial()
        if done.exists():
            return trial
        died = self.folder / "died.txt"
        if died.exists():
            raise RuntimeError(died.read_text())
        trial.failed, trial.why = "time", f"no end within {4 * seconds:g} s of the processor, or the process died"
        return trial

    def _child(self, tests, seconds, kernels, answer, done):
        resource.setrlimit(resource.RLIMIT_CPU, (int(4 * seconds), int(4 * seconds) + 5))
        log = os.open(self.folder / "log.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(log, 1), os.dup2(log, 2)
        os.chdir(self.folder)
        for name in [name for name in sys.modules if name.split(".")[0] in ("tests", "tools", "flexapod")]:
            del sys.modules[name]
        ours = {str(ROOT), str(ROOT / "src"), ""}
        sys.path[:] = [str(self.folder / "src"), *(p for p in sys.path if p not in ours)]
        os.environ |= {"PYTHONPATH": f"{self.folder / 'src'}:{self.folder / 'told'}", "FLEXAPOD_CACHE": str(kernels),
                       "OPENBLAS_NUM_THREADS": "1"}  # fmt: skip
        kernels.mkdir(parents=True, exist_ok=True, mode=0o700)
        watch = Watch(answer)
        builtins.fault_here = watch.here
        for test in tests:  # what is not run is not read either
            codes = {}
            if test not in self.mapped:
                sys.setprofile(lambda frame, *_, codes=codes: codes.setdefault(id(frame.f_code), frame.f_code))
            pytest.main([test, "-x", "-q", "-p", "no:cacheprovider"], plugins=[watch])
            sys.setprofile(None)
            watch.trial.called[test] = sorted(filter(None, map(self._name, codes.values())))
            watch.tell()
            if watch.trial.failed:
                break
        done.touch()


class Results:
    """Lines of JSON, one for a fault, and the seconds that files of tests take."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.file, self.times, self.calls = (folder / x for x in ("results.jsonl", "seconds.json", "called.json"))
        self.called = json.loads(self.calls.read_text()) if self.calls.exists() else {}
        self.rows, self.passed = {}, set()
        for line in self.file.read_text(encoding="utf-8").splitlines() if self.file.exists() else ():
            row = json.loads(line)
            self.rows[row["fault"]] = row
            self.passed |= {row["failed"].split("::")[0]} if row["failed"] else set()
        self.seconds = json.loads(self.times.read_text()) if self.times.exists() else {}

    def add(self, fault: Fault, trial: Trial, nth: int, took: float) -> None:
        row = {
            "fault": fault.name, "line": fault.line, "failed": trial.failed, "why": trial.why, "reached": trial.reached,
            "tried": list(trial.seconds), "round": nth, "took": round(took, 1),
        }  # fmt: skip
        self.rows[fault.name] = row
        with self.file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")

    def learn(self, trial: Trial) -> None:
        whole = list(trial.seconds)[: -1 if trial.failed else None]
        for name in whole:  # the least: the first one to need a kernel waits for it
            self.seconds[name] = round(min(trial.seconds[name], self.seconds.get(name, math.inf)), 2)
            self.called.setdefault(name, trial.called.get(name, []))
        self.times.write_text(json.dumps(self.seconds, indent=1, sort_keys=True))
        self.calls.write_text(json.dumps(self.called))

    def sound(self, test: str, run: Callable[[], Trial]) -> bool:
        """Whether tests of this file pass without a fault; it is tried once."""
        file = test.split("::")[0]
        if test != "time" and file not in self.seconds and file not in self.passed and run().failed is None:
            self.passed.add(file)
        return test == "time" or file in self.seconds or file in self.passed

    def survivors(self) -> list[str]:
        return [name for name, row in self.rows.items() if row["failed"] is None]


def tried(
    copy: Copy, fault: Fault, near: Nearness, results: Results, seconds: float, tests: list[str], again: bool
) -> tuple[Trial, float]:
    """The tests near a fault, without those that did not see it before; and how long that took [s]."""
    begun, before = time.monotonic(), results.rows.get(fault.name, {"reached": [], "tried": []})
    chosen = tests or near.tests(fault.path, fault.function, seconds, results, set(() if again else before["tried"]))
    copy.mapped = set(results.called)
    trial = copy.tried(chosen, seconds, fault)
    results.learn(trial)
    if trial.failed == "time" and (not trial.reached or copy.tried(chosen, seconds).failed == "time"):
        print("    takes as long without the fault", flush=True)
        chosen, trial.failed, trial.why = [], None, "unsound: time"  # what has not ended is asked again
    if trial.failed and not results.sound(trial.failed, lambda: copy.tried([trial.failed], seconds)):
        print(f"    fails without the fault, too: {trial.failed}", flush=True)
        trial.failed, trial.why = None, f"unsound: {trial.failed}"
    trial.reached = [*before["reached"], *(file for file in trial.reached if file and file not in before["reached"])]
    trial.seconds = dict.fromkeys([*before["tried"], *chosen], 0.0) | trial.seconds
    return trial, time.monotonic() - begun


def main() -> int:
    """Try faults; the number of survivors is printed, the exit status 1 if there are some."""
    parser = argparse.ArgumentParser(prog="python -m tools.faults", description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="+", default=[], choices=_rooms(), metavar="ROOM", help="these alone")
    parser.add_argument("--list", action="store_true", help="show the faults, try none")
    parser.add_argument("--again", nargs="?", const="", help="survivors of the results once more, of this text")
    parser.add_argument("--seconds", type=float, default=120.0, help="of tests for each of those")
    parser.add_argument("--tests", nargs="+", default=[], help="by these tests")
    parser.add_argument("--results", type=Path, default=ROOT / "build" / "faults")
    given = parser.parse_args()
    results = Results(given.results)
    chosen = faults(given.count if given.again is None else 100_000, given.seed, given.rooms)
    if given.again is not None:
        chosen = [x for x in chosen if x.name in results.survivors() and given.again in x.name]
    if given.list:
        print("\n".join(f"{x.line:5d}  {x.name}" for x in chosen))
        return 0
    os.nice(5)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(130))
    for name in PRELOADED:
        importlib.import_module(name)
    os.environ.setdefault("FLEXAPOD_CACHE_MEGABYTES", "1000")
    near = Nearness(ROOT)
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        copy = Copy(Path(name), given.results.resolve() / "kernels")
        rounds = ROUNDS if given.again is None else ((given.seconds, math.inf),)
        for nth, (seconds, enough) in enumerate(rounds):
            for k, fault in sorted(enumerate(chosen), key=lambda x: x[1].symbolic):  # all kernels anew: last
                row = results.rows.get(fault.name)
                done = row and (row["failed"] or row["round"] >= nth or len(row["reached"]) >= enough)
                if done and given.again is None:
                    continue
                trial, took = tried(copy, fault, near, results, seconds, given.tests, given.again is not None)
                results.add(fault, trial, nth, took)
                said = f"seen by {trial.failed}" if trial.failed else f"NOT SEEN, reached in {len(trial.reached)} files"
                print(f"{k + 1:4d} {fault.name}\n         {said} ({took:.0f} s)", flush=True)
    names = {fault.name for fault in chosen}
    left = [name for name in results.survivors() if name in names]
    print(f"{len(left)} of {len(chosen)} faults were not seen:", *left, sep="\n")
    return int(bool(left))


if __name__ == "__main__":
    sys.exit(main())
