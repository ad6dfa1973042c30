"""``python -m tools.build_wheels FOLDER``: source distribution, and wheels with compiled time loops for each system.

The wheel for any machine has none: loops are compiled at first use there. Those of Linux (x86-64) are made by gcc, as a
checkout makes them, so that their numbers are the same to the bit; those of Windows (x86-64) and macOS (arm64) by
``ziglang``, on the same machine. Names of systems after the folder build these alone: ``linux windows macos``.
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from flexapod.mechanics.symbolic.compiler import COMMON, LOOPS, written_text
from flexapod.mechanics.symbolic.processor import BUILT, LEVELS, file_name, x86_target
from flexapod.solve.time.native import SOURCES

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"
LEAST_GLIBC = 17  # no tag of a wheel is older


@dataclass(frozen=True)
class System:
    """A system as Python names it, the tag of its wheel, and who compiles: with which words, for which targets."""

    name: str
    tag: str
    compiler: Sequence[str]
    targets: Sequence[str | None]


X86 = tuple(map(x86_target, LEVELS))
SYSTEMS = {
    "linux": System("linux-x86_64", "manylinux_2_{glibc}_x86_64", ("gcc",), X86),
    "windows": System("win32-amd64", "win_amd64", ("zig", "-target", "x86_64-windows-gnu"), X86),
    "macos": System("darwin-arm64", "macosx_11_0_arm64", ("zig", "-target", "aarch64-macos.11.0"), (None,)),
}


def told(command: Sequence[str | Path], folder: Path) -> str:
    """What a program says; it has to succeed."""
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, env=alone())
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def alone() -> dict[str, str]:
    """The environment without what would let a checkout in."""
    return {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "FLEXAPOD"))}


def packer(folder: Path, *packages: str) -> Path:
    """Python of an environment in `folder` with setuptools and these packages."""
    python = folder / "packer" / "bin" / "python"
    if not python.exists():
        told([sys.executable, "-m", "venv", folder / "packer"], folder)
    line = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-c", ROOT / "constraints.txt"]
    told([*line, "setuptools>=77", *packages], folder)
    return python


def distributions(folder: Path, work: Path) -> tuple[Path, Path]:
    """The source distribution, and the wheel for any machine that it gives."""
    make = "import setuptools.build_meta as b, sys; print(b.build_sdist(sys.argv[1]))"
    notes = SOURCE / "flexapod.egg-info"
    kept = notes.exists()
    sdist = folder / told([packer(work), "-c", make, folder], ROOT).splitlines()[-1]
    if not kept:
        shutil.rmtree(notes, ignore_errors=True)
    made = work / "pure"
    told([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", made, sdist], work)
    (wheel,) = made.glob("flexapod-*.whl")
    return sdist, Path(shutil.copy(wheel, folder))


def compiled_loops(system: System, work: Path) -> dict[str, bytes]:
    """Files of loops of a system, by name."""
    text, key = written_text(SOURCES)
    (work / "loops.c").write_text(text)
    command = list(system.compiler)
    zig = command[0] == "zig"
    if zig:
        command[:1] = [str(packer(work, "ziglang")), "-m", "ziglang", "cc"]
    found = {}
    for target in system.targets:
        words = [f"-march={target.replace('-', '_') if zig else target}"] if target else []
        told([*command, *COMMON, *LOOPS, *words, "-shared", "-s", "-o", "loops.so", "loops.c", "-lm"], work)
        content = (work / "loops.so").read_bytes()
        found[file_name(system.name, target, key, content)] = content
    return found


def glibc(files: Sequence[bytes]) -> int:
    """Release 2.x of the C library that libraries ask for."""
    return max([LEAST_GLIBC, *(int(x) for content in files for x in re.findall(rb"GLIBC_2\.(\d+)", content))])


def with_loops(wheel: Path, system: System, folder: Path, work: Path) -> Path:
    """A copy of the wheel for any machine for one system, with its loops."""
    loops = compiled_loops(system, work)
    tag = f"py3-none-{system.tag.format(glibc=glibc(list(loops.values())))}"
    made = folder / wheel.name.replace("py3-none-any", tag)
    place = BUILT.relative_to(SOURCE).as_posix()
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        content = {name: old.read(name) for name in old.namelist()}
        content |= {f"{place}/{name}": text for name, text in loops.items()}
        (record,) = (name for name in content if name.endswith(".dist-info/RECORD"))
        head = record.replace("RECORD", "WHEEL")
        content[head] = content[head].replace(b"Tag: py3-none-any", f"Tag: {tag}".encode())
        content[head] = content[head].replace(b"Root-Is-Purelib: true", b"Root-Is-Purelib: false")
        del content[record]
        for name, text in content.items():
            new.writestr(_readable(name), text)
        lines = [f"{name},sha256={_urlsafe(text)},{len(text)}" for name, text in content.items()]
        new.writestr(_readable(record), "\n".join([*lines, f"{record},,", ""]))
    return made


def _readable(name: str) -> zipfile.ZipInfo:
    """Entry of a wheel that everybody may read, with the same date always: equal contents make equal wheels."""
    entry = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
    entry.external_attr, entry.compress_type = 0o644 << 16, zipfile.ZIP_DEFLATED
    return entry


def _urlsafe(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def main() -> None:
    """Build all, or the systems that are named, and say what was made."""
    if len(sys.argv) < 2 or not set(sys.argv[2:]) <= set(SYSTEMS):
        raise SystemExit(f"python -m tools.build_wheels FOLDER [{' '.join(SYSTEMS)}]")
    folder = Path(sys.argv[1]).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        sdist, wheel = distributions(folder, Path(name))
        made = [sdist, wheel]
        for each in sys.argv[2:] or SYSTEMS:
            made.append(with_loops(wheel, SYSTEMS[each], folder, Path(name)))
    for path in made:
        print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
