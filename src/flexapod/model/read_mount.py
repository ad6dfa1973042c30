"""From the keys base_mount, platform_mount and base_motion of a study file to the model."""

from __future__ import annotations

import numpy as np

from flexapod.model.mount import BaseMotion, Mount
from flexapod.schema.csv_tables import POSE
from flexapod.schema.section import Section

__all__ = ["BASE_ACCELERATION", "read_mounts"]

BASE_ACCELERATION = {
    axis: "acceleration" if dimension == "length" else "angular acceleration" for axis, dimension in POSE.items()
}
_UNITS = {
    "stiffness": ("stiffness", "force", "rotational stiffness"),
    "damping": ("damping", "impulse", "rotational damping"),
}
_INERTIAS = ("inertia",) * 3


def read_mounts(robot: Section) -> dict[str, object]:
    """Mounts of base and platform, and motion of the base, as the table [robot] has them; None where it has none."""
    base, platform, moved = (robot.section(name) for name in ("base_mount", "platform_mount", "base_motion"))
    return {
        "base_mount": base and base.read(Mount, then=_mount),
        "platform_mount": platform and platform.read(Mount, then=_mount),
        "base_motion": moved and moved.read(BaseMotion, then=_table),
    }


def _mount(section: Section) -> dict[str, object]:
    section.need("stiffness")
    found: dict[str, object] = {name: _matrix(section, name) for name in _UNITS if name in section}
    if not _has_rows(section, "inertia"):
        return found | {"inertia": np.diag(section.vector("inertia", *_INERTIAS) or (0.0,) * 3)}
    return found | {"inertia": section.rows("inertia", *(_INERTIAS,) * 3)}


def _has_rows(section: Section, name: str) -> bool:
    value = section.data.get(name)
    return isinstance(value, list) and any(isinstance(row, list) for row in value)


def _matrix(section: Section, name: str) -> object:
    """Six numbers, or six rows."""
    along, mixed, about = _UNITS[name]
    if _has_rows(section, name):
        upper, lower = (along,) * 3 + (mixed,) * 3, (mixed,) * 3 + (about,) * 3
        return section.rows(name, *(upper,) * 3, *(lower,) * 3)
    return np.diag(section.vector(name, *(along,) * 3, *(about,) * 3) or ())


def _table(section: Section) -> dict[str, object]:
    of = section.text("of", ("acceleration", "displacement")) or "acceleration"
    found = section.table(BASE_ACCELERATION if of == "acceleration" else POSE, jumps=of == "acceleration")
    none = np.zeros(len(found["time"]))
    return {"of": of, "time": found["time"], "values": np.stack([found.get(axis, none) for axis in POSE], axis=1)}
