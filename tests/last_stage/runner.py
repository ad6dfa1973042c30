"""Runs what a user of the last stage has: scripts, studies, commands; says what they found, as numbers and names.

It knows nothing of the package but what that stage documented, so that it runs under either of the two:

    python tests/last_stage/runner.py            # with the Python of the commit before: writes `expected` and `stored`
    python tests/last_stage/runner.py --compare  # with the Python of today: prints what differs, to the bit
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
EXPECTED = HERE / "expected"
#: What is another one at each run: seconds, versions, places.
VOLATILE = ("wall_time", "seconds", "version", "hash", "compiled", "file", "files", "cores", "memory")
LONGEST = 40  # letters of a text that is a name and no sentence
#: Kinds of items: folder, ending, and whether names that the package had before may answer with a remark.
KINDS = {"scripts": ".py", "studies": ".toml", "commands": ".sh"}


def items() -> list[str]:
    """Names of all thirty, as folder/name: those that begin with a number."""
    found = [path for kind, ending in KINDS.items() for path in (HERE / kind).glob(f"[0-9]*{ending}")]
    return [f"{path.parent.name}/{path.stem}" for path in sorted(found, key=lambda path: path.name)]


def expected(item: str) -> dict[str, Any]:
    """What the commit before found."""
    return json.loads((EXPECTED / f"{item.split('/')[1]}.json").read_text(encoding="utf-8"))


def run(item: str, folder: Path) -> dict[str, Any]:
    """What an item finds today in an empty folder, and the categories of what it was warned of."""
    kind, name = item.split("/")
    call: Callable[[str, Path], Any] = {"scripts": script, "studies": study, "commands": commands}[kind]
    shutil.copytree(HERE / "stored", folder / "stored")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = call(name, folder)
    texts = [f"{one.category.__name__}: {one.message}" for one in told]
    return {"found": json.loads(json.dumps(found, default=str)), "warnings": sorted({text for text in texts})}


@contextlib.contextmanager
def within(folder: Path) -> Iterator[None]:
    """A folder to work in, and the modules beside the scripts, as a user has them."""
    before, path, modules = Path.cwd(), list(sys.path), set(sys.modules)
    os.chdir(folder)
    sys.path[:0] = [str(HERE / "scripts"), str(HERE / "packages")]
    try:
        yield
    finally:
        os.chdir(before)
        sys.path[:] = path
        for name in set(sys.modules) - modules:
            if str(getattr(sys.modules[name], "__file__", None)).startswith(str(HERE)):
                del sys.modules[name]


def script(name: str, folder: Path) -> Any:
    """The JSON in the last line that a script prints."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    import flexapod as fx

    (folder / "robot.toml").write_text(fx.preset("machine-hexapod").source_text, encoding="utf-8")
    said = io.StringIO()
    with within(folder), contextlib.redirect_stdout(said):
        runpy.run_path(str(HERE / "scripts" / f"{name}.py"), run_name="__main__")
    plt.close("all")
    return json.loads(said.getvalue().splitlines()[-1])


def study(name: str, folder: Path) -> Any:
    """What `scripts/studies.py` asks of each study file that an item names."""
    shutil.copytree(HERE / "studies", folder, dirs_exist_ok=True)
    with within(folder):
        found = runpy.run_path(str(HERE / "scripts" / "studies.py"))["asked"](f"{name}.toml")
    return found


def commands(name: str, folder: Path) -> Any:
    """Exit codes, files and JSON that a shell script of commands leaves."""
    shutil.copytree(HERE / "studies", folder / "studies")
    bins = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    made = {"PATH": bins, "MPLBACKEND": "Agg", "COLUMNS": "100", "PYTHONPATH": str(HERE / "packages")}
    before = set(folder.rglob("*"))
    script = HERE / "commands" / f"{name}.sh"
    done = subprocess.run(
        ["sh", str(script)], cwd=folder, env=os.environ | made, capture_output=True, text=True, encoding="utf-8"
    )
    written = sorted(path for path in set(folder.rglob("*")) - before if path.is_file())
    found: dict[str, Any] = {"said": done.stdout.splitlines(), "files": [str(x.relative_to(folder)) for x in written]}
    for path in written:
        if path.suffix == ".json" and path.parent == folder:
            text = path.read_text(encoding="utf-8")
            found[path.stem] = reduced(json.loads(text)) if text.strip() else None
    return found


def reduced(value: Any, name: str = "") -> Any:
    """JSON without sentences and without what is another one at each run; of long lists of numbers some."""
    if isinstance(value, dict):
        kept = {key: reduced(x, key) for key, x in value.items() if not any(word in key for word in VOLATILE)}
        return {key: x for key, x in kept.items() if x != "..."}
    if isinstance(value, list):
        return [x for x in map(reduced, value[:3] if value and isinstance(value[0], dict) else value[:8]) if x != "..."]
    if isinstance(value, str) and name not in ("key", "value") and (len(value) > LONGEST or value.count(" ") > 2):
        return "..."
    return value


def flat(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Numbers of each list in one, all else by itself, by the path of its keys."""
    if isinstance(value, dict):
        for name, one in value.items():
            yield from flat(one, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and not numeric(value):
        yield f"{key}#", len(value)
        for number, one in enumerate(value):
            yield from flat(one, f"{key}[{number}]")
    else:
        yield key, value


def numeric(value: Any) -> bool:
    """A number, or lists of nothing else."""
    if isinstance(value, list):
        return bool(value) and all(map(numeric, value)) and len({shape(one) for one in value}) == 1
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def shape(value: Any) -> tuple[int, ...]:
    """Sizes of a list of lists of numbers; () of a number."""
    return (len(value), *shape(value[0])) if isinstance(value, list) and value else ()


def away(new: Any, old: Any) -> float:
    """Largest distance of numbers over the peak of the old ones; infinite where shapes or not-a-numbers differ."""
    import numpy as np

    try:
        a, b = np.asarray(new, dtype=float), np.asarray(old, dtype=float)
    except (TypeError, ValueError):
        return np.inf
    if a.shape != b.shape or not np.array_equal(np.isfinite(a), np.isfinite(b)):
        return np.inf
    there = np.isfinite(b)
    if not there.any():
        return 0.0
    peak = np.abs(b[there]).max()
    distance = np.abs(a[there] - b[there]).max()
    return float(distance / peak) if peak else float("inf") if distance else 0.0


def differences(new: Any, old: Any) -> Iterator[tuple[str, float, Any, Any]]:
    """By the path of its keys, what is not the same: how far away, new and old; infinitely far is what is no number."""
    ours, theirs = dict(flat(new)), dict(flat(old))
    for key in dict.fromkeys((*theirs, *ours)):
        a, b = ours.get(key, "missing"), theirs.get(key, "missing")
        far = away(a, b) if numeric(a) and numeric(b) else (0.0 if a == b else float("inf"))
        if far:
            yield key, far, a, b


def main(arguments: list[str]) -> None:
    """Write expectations, of all items or of those that are named, or compare with them."""
    comparing = "--compare" in arguments
    chosen = [x for x in arguments if not x.startswith("--")]
    for item in items():
        if chosen and not any(x in item for x in chosen):
            continue
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            found = run(item, Path(folder))
        print(f"{item}: {time.perf_counter() - began:.1f} s")
        if comparing:
            for key, far, new, old in differences(found, expected(item)):
                print(f"    {key}: {far:.1e}", *([] if far < 1e3 else [f"\n      now {new}\n      was {old}"]))
        else:
            EXPECTED.mkdir(exist_ok=True)
            text = json.dumps(found, indent=None, ensure_ascii=False, separators=(",", ":"))
            (EXPECTED / f"{item.split('/')[1]}.json").write_text(text.replace('},"', '},\n"') + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
