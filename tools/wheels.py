"""``python -m tools.wheels``: the source distribution builds a wheel; installed in clean environments, it runs.

Each of Python 3.11 to 3.14 that is found on this machine (``python3.12``, or of pyenv) gets an environment of its own
with the wheel and nothing else of ours; `flexapod new`, `check` and `run` and a call from Python are made there. So it
is with the wheel of Linux that brings its time loops compiled (`python -m tools.build_wheels` makes all). With
``--check`` the source distribution, by itself in a folder, also passes `make check`.
"""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

from tools.build_wheels import SYSTEMS, distributions, told, with_loops

ROOT = Path(__file__).parents[1]
VERSIONS = ("3.11", "3.12", "3.13", "3.14")
CALL = """
import flexapod as fx
data = fx.simulate(fx.preset("paper-robot"))
peak = 1e6 * float(abs(data.com_deviation.sel(axis="z")).max())
assert 19.2 < peak < 19.4, peak  # um; an independent program gives 19.33
"""
#: The same, by loops that the wheel brings.
LOOPS = f"""{CALL}
from flexapod.mechanics.symbolic.processor import built_loops
assert built_loops() and built_loops().path.name in open("/proc/self/maps").read(), "loops were compiled"
"""


def found(version: str) -> Path | None:
    """The program of a version of Python, if there is one that starts."""
    pyenv = sorted((Path.home() / ".pyenv" / "versions").glob(f"{version}.*/bin/python"))
    for path in [*map(Path, filter(None, [shutil.which(f"python{version}")])), *pyenv]:
        said = subprocess.run([path, "-c", "import sys; print(sys.version)"], capture_output=True, text=True)
        if said.returncode == 0 and said.stdout.startswith(f"{version}."):
            return path
    return None


def built(folder: Path) -> tuple[Path, Path]:
    """The source distribution and the wheel that it gives; what has to be in both is, licence and all."""
    sdist, wheel = distributions(folder, folder)
    with tarfile.open(sdist) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    for name in ("Makefile", "constraints.txt", "tests/conftest.py", "docs/index.md", "LICENSE", "README.md"):
        if name not in names:
            raise SystemExit(f"{name} is not in the source distribution")
    with zipfile.ZipFile(wheel) as archive:
        inside = set(archive.namelist())
    package = {path.relative_to(ROOT / "src").as_posix() for path in (ROOT / "src" / "flexapod").rglob("*.*")}
    missing = {name for name in package if "__pycache__" not in name and (ROOT / "src" / name).is_file()} - inside
    missing |= {"LICENSE"} - {Path(name).name for name in inside if ".dist-info/licenses/" in name}
    if missing:
        raise SystemExit(f"not in the wheel: {', '.join(sorted(missing))}")
    return sdist, wheel


def checked(sdist: Path, folder: Path) -> None:
    """The source distribution by itself, as somebody gets it: `make check`."""
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    told(["make", "check"], next(folder.iterdir()))


def tried(python: Path, wheel: Path, folder: Path, call: str = CALL) -> None:
    """Install the wheel by itself, and use it as on the first day."""
    folder.mkdir()
    told([python, "-m", "venv", folder / "venv"], folder)
    programs = folder / "venv" / "bin"
    told([programs / "pip", "install", "--quiet", "--disable-pip-version-check", wheel], folder)
    told([programs / "python", "-W", "error::SyntaxWarning", "-c", call], folder)
    told([programs / "flexapod", "new", "robot.toml"], folder)
    told([programs / "flexapod", "check", "robot.toml"], folder)
    told([programs / "flexapod", "run", "robot.toml", "--no-figures", "--quiet"], folder)
    told([programs / "flexapod", "new", "--example", "sag_by_hand"], folder)
    told([programs / "python", "sag_by_hand.py"], folder)


def main() -> None:
    """Build, then try on all versions that there are; say which there are not."""
    needed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["requires-python"]
    print(f"flexapod needs Python {needed}")
    with tempfile.TemporaryDirectory() as name:
        sdist, wheel = built(Path(name))
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, built of the source distribution")
        loops = None
        if sys.platform == "linux" and platform.machine() == "x86_64" and shutil.which("gcc"):
            loops = with_loops(wheel, SYSTEMS["linux"], Path(name), Path(name))
            print(f"{loops.name}: {loops.stat().st_size / 1e6:.1f} MB, with compiled loops")
        for version in VERSIONS:
            python = found(version)
            if python is None:
                print(f"{version}: not on this machine")
                continue
            tried(python, wheel, Path(name) / version)
            print(f"{version}: installed by itself, runs")
            if loops is not None:
                tried(python, loops, Path(name) / f"{version}-loops", LOOPS)
                print(f"{version}: with the loops of the wheel, runs")
        if "--check" in sys.argv[1:]:
            checked(sdist, Path(name) / "source")
            print("the source distribution passes `make check`")


if __name__ == "__main__":
    main()
