"""Limits of a run: times that must fit each other, and room in memory and on disk for the stored instants."""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path

from flexapod.analysis.results.remarks import remark
from flexapod.common.errors import InputError
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.statics.lost_motion import places_with_friction


def check_outputs(study: Study | ActuatorStudy) -> list[str]:
    """Refuse a study whose results could not be stored even once after the start; remark on omitted results.

    Raises
    ------
    InputError
        The duration is shorter than the time between stored results, or so long that the memory does not hold them.
    """
    simulation, duration = study.simulation, study.duration
    stored = simulation.stored_step
    name = "output_step" if stored == simulation.output_step else "step"
    remarks = check_memory(study)
    outputs = simulation.outputs(duration)
    if not outputs:
        raise InputError(
            "is longer than the simulation",
            key=f"simulation.{name}",
            value=stored,
            allowed=f"at most the duration of {duration:g} s",
            next_step=f"Give simulation.{name} a value below it, or a longer simulation.duration",
        )
    if name == "step":
        remarks.append(remark("long step", step=stored, output_step=simulation.output_step))
    end = outputs * stored
    if duration - end > 1e-6 * stored:
        remarks.append(remark("cut duration", duration=duration, name=name, step=stored, end=end))
    return remarks


REMARKED = 1e9  # byte of results from which on their size is worth a remark
MANY = 100_000  # instants from which on it is worth one how many they are: some seconds to compute, a minute to write
FEW = 5000  # instants that show what there is to see
SMALL = 1e8  # byte that every machine has free: below it nothing is asked
PEAK = 3  # times the results is what they take while they are made: the record, the Dataset, what is written
CSV = 3  # times the results is what NetCDF and CSV take together: a number in letters is twice its 8 bytes
POSE = 28  # numbers of a pose of a map beside its frequencies
# Of a control group: most memory, memory in use, and the part of it that files left behind and the kernel gives back.
_CGROUPS = (
    (Path("/sys/fs/cgroup"), "memory.max", "memory.current", "inactive_file"),
    (Path("/sys/fs/cgroup/memory"), "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
)


def stored_instants(study: Study | ActuatorStudy) -> float:
    """Number of instants that a simulation stores; not a whole number where they are too many to be counted."""
    return study.duration / study.simulation.stored_step + 1


def result_bytes(study: Study | ActuatorStudy) -> float:
    """Size of the variables over time: so many floats of 8 bytes an instant, and one for every shape of every leg."""
    s = study.simulation
    if isinstance(study, ActuatorStudy):
        return 8 * stored_instants(study) * (17 + s.lateral_shapes)
    shapes = 2 * s.lateral_shapes + s.axial_shapes(study.robot.legs[0].axial_modes)
    joints = (joint for leg in study.robot.legs for joint in (leg.base_joint, leg.platform_joint))
    margins = 2 * any(joint.max_angle is not None for joint in joints)
    rubs = 3 * len(places_with_friction(study.robot))
    robot = study.robot
    frames = 13 * (robot.base_motion is not None) + 12 * (robot.base_mount is not None)
    frames += 6 * (robot.platform_mount is not None)
    return 8 * stored_instants(study) * (64 + frames + robot.count * (30 + shapes + margins + rubs))


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
    count, takes = stored_instants(study), {"size": gigabytes(size), "times": PEAK}
    if count > MANY:
        return [remark("many instants", count=count, **takes, step=study.duration / FEW, few=FEW)]
    return [remark("large results", **takes)] if size > REMARKED else []


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


def check_room(size: float, folder: Path | None, *, key: str, next_step: str, file: str | None = None) -> None:
    """Refuse what the disk of a folder, or without one the memory, does not hold.

    Parameters
    ----------
    size : float
        What is asked for [byte].
    folder : Path, optional
        Where it is to be written.
    key, next_step, file : str
        What asks for it, what would do instead, and where it stands.

    Raises
    ------
    InputError
        Naming how many gigabytes.
    """
    free = available_memory() if folder is None else free_disk(folder)
    if size > SMALL and size > free:
        place = "of memory" if folder is None else "on the disk"
        raise InputError(
            f"asks for {gigabytes(size)} {place}, where {gigabytes(free)} is free",
            file=file,
            key=key,
            next_step=next_step,
        )


def check_map(poses: int, frequencies: int, folder: Path | None = None) -> None:
    """Refuse a map that the memory, or the disk of its folder, does not hold.

    Raises
    ------
    InputError
    """
    size = 8.0 * poses * (POSE + frequencies)
    next_step = "Give the axes fewer points, or compute the map in parts"
    check_room(size if folder else PEAK * size, folder, key="axes", next_step=next_step)


def gigabytes(size: float) -> str:
    """Size as text in GB or MB."""
    return f"{size / 1e9:.3g} GB" if size >= 1e8 else f"{size / 1e6:.3g} MB"


def free_disk(folder: Path) -> float:
    """Free space [byte] where a folder is or will be; inf where unknown."""
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    with suppress(OSError):
        return float(shutil.disk_usage(existing).free)
    return float("inf")


def available_memory() -> float:
    """Memory [byte] available to this process: of the machine, of its control group; inf where unknown."""
    found = [float("inf")]
    with suppress(OSError, ValueError, IndexError, StopIteration):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        found.append(1024.0 * int(next(line.split()[1] for line in lines if line.startswith("MemAvailable"))))
    if len(found) == 1 and hasattr(os, "sysconf"):
        with suppress(OSError, ValueError):
            found.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    for folder, *names in _CGROUPS:
        with suppress(OSError, ValueError):
            found.append(_free_of_group(folder, *names))
    return min(found)


def _free_of_group(folder: Path, most: str, used: str, cached: str) -> float:
    """Memory [byte] that a control group may still take."""
    limit, now = (int((folder / name).read_text(encoding="ascii")) for name in (most, used))
    lines = (folder / "memory.stat").read_text(encoding="ascii").splitlines()
    return float(max(limit - now + sum(int(n) for name, n in map(str.split, lines) if name == cached), 0))
