"""Room for results: what a simulation keeps of each instant, and the memory and disk that are there for it."""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path

from flexapod.errors import InputError
from flexapod.model import ActuatorStudy, Study

__all__ = ["available_memory", "check_disk", "check_memory", "check_room", "free_disk", "gigabytes", "result_bytes"]

REMARKED = 1e9  # byte of results from which on their size is worth a remark
SMALL = 1e8  # byte that every machine has free: below it nothing is asked
PEAK = 3  # times the results is what they take while they are made: the record, the Dataset, what is written
CSV = 3  # times the results is what NetCDF and CSV take together: a number in letters is twice its 8 bytes
_CGROUPS = (("memory.max", "memory.current"), ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes"))


def stored_instants(study: Study | ActuatorStudy) -> float:
    """How many instants a simulation keeps; not a whole number where they are too many to be counted."""
    return study.duration / study.simulation.stored_step + 1


def result_bytes(study: Study | ActuatorStudy) -> float:
    """Size of the variables over time: so many floats of 8 bytes an instant, and one for every shape of every leg."""
    s = study.simulation
    if isinstance(study, ActuatorStudy):
        return 8 * stored_instants(study) * (17 + s.lateral_shapes)
    shapes = 2 * s.lateral_shapes + s.axial_shapes(study.robot.legs[0].axial_modes)
    return 8 * stored_instants(study) * (205 + 6 * shapes)


def check_memory(study: Study | ActuatorStudy, runs: int = 1) -> list[str]:
    """Refuse a study whose results the memory does not hold; remark on results of gigabytes.

    Parameters
    ----------
    study : Study or ActuatorStudy
    runs : int
        How many such simulations there are at the same time.

    Raises
    ------
    InputError
        Naming how many gigabytes, and the output step that would do.
    """
    size = result_bytes(study)
    needed = PEAK * runs * size
    if needed > SMALL and needed > (free := available_memory()):
        at_once = f", {runs} of them at a time" if runs > 1 else ""
        raise _too_much(study, f"{gigabytes(needed)} of memory{at_once}", "is free", free, needed)
    return [f"the results take {gigabytes(size)}, and {PEAK} times as much while they are made"] * (size > REMARKED)


def check_disk(study: Study | ActuatorStudy, folder: Path) -> None:
    """Refuse a study whose results, as NetCDF and as CSV, the disk of a folder does not hold.

    Raises
    ------
    InputError
    """
    needed, free = CSV * result_bytes(study), free_disk(folder)
    if needed > free:
        raise _too_much(study, f"{gigabytes(needed)} on the disk", f"is free at {folder}", free, needed)


def _too_much(study: Study | ActuatorStudy, what: str, where: str, free: float, needed: float) -> InputError:
    step = study.simulation.stored_step
    name = "output_step" if step == study.simulation.output_step else "step"
    return InputError(
        f"asks for more results than can be kept: {stored_instants(study):.3g} instants, {what}, where "
        f"{gigabytes(free)} {where}",
        file=study.path,
        key=f"simulation.{name}",
        value=step,
        next_step=f"Give output_step = {step * max(1.0, needed / max(free, 1.0)) * 2:.1g} (s), or a shorter duration",
    )


def check_room(size: float, path: Path | None, file: str | None) -> None:
    """Refuse a sweep whose records neither memory nor the disk of its store (`path`) holds.

    Raises
    ------
    InputError
    """
    free = available_memory() if path is None else free_disk(path.parent)
    if size > SMALL and size > free:
        place = "of memory" if path is None else "on the disk"
        raise InputError(
            f"asks for {gigabytes(size)} {place}, where {gigabytes(free)} is free",
            file=file,
            key="keep",
            next_step="Keep fewer records, or give [keep] a longer record_step",
        )


def gigabytes(size: float) -> str:
    """A size in words."""
    return f"{size / 1e9:.3g} GB" if size >= 1e8 else f"{size / 1e6:.3g} MB"


def free_disk(folder: Path) -> float:
    """Free space [byte] where a folder is or will be; inf where that cannot be told."""
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    with suppress(OSError):
        return float(shutil.disk_usage(existing).free)
    return float("inf")


def available_memory() -> float:
    """Memory [byte] that this process may still take: of the machine, of its control group; inf if not to be told."""
    found = [float("inf")]
    with suppress(OSError, ValueError, IndexError, StopIteration):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        found.append(1024.0 * int(next(line.split()[1] for line in lines if line.startswith("MemAvailable"))))
    if len(found) == 1 and hasattr(os, "sysconf"):
        with suppress(OSError, ValueError):
            found.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    for most, used in _CGROUPS:
        with suppress(OSError, ValueError):
            limit, now = (int((Path("/sys/fs/cgroup") / name).read_text(encoding="ascii")) for name in (most, used))
            found.append(float(max(limit - now, 0)))
    return min(found)
