"""Quantities of a map as text: where each is least and largest, how much is reached, and why not the rest."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.reachability import REACHED, REASONS
from flexapod.analysis.pose_variables import FURTHER_VARIABLES, GRID_VARIABLES
from flexapod.analysis.results.attributes import robot_study
from flexapod.analysis.results.poses import coordinate_text, coordinate_words, pose_coordinates
from flexapod.analysis.results.variables import Variable
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.ranking import first_largest, first_least
from flexapod.model import AXES

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

#: Scalars of which maps are drawn, in the order of the figures: which end is the bad one, and what they are called.
TOLD = {
    "frequency": ("least", "first natural frequency"),
    "stiffness": ("least", "stiffness at the tool along {}"),
    "stiffness_least": ("least", "stiffness at the tool in its weakest direction"),
    "condition": ("largest", "condition of the scaled Jacobian"),
    "static_deviation_size": ("largest", "deviation of the tool at rest"),
    "dynamic_deviation": ("largest", "deviation of the tool at {}"),
    "largest_force": ("largest", "largest drive force at rest"),
    "stroke_margin": ("least", "least stroke left"),
    "guided_length": ("least", "least length of piston in its cylinder"),
    "base_joint_angle": ("largest", "largest turn of a base joint from home"),
    "platform_joint_angle": ("largest", "largest turn of a platform joint from home"),
    "leg_clearance": ("least", "least distance between two legs"),
    "euler_share": ("largest", "largest thrust over the Euler load"),
    "loop_growth": ("largest", "growth of deviations by unstable loops"),
    "error_worst": ("largest", "worst case of the tool's place at rest, all parts"),
    "joint_margin": ("least", "least angle left at a joint"),
}
SIDES = {name: side for name, (side, _) in TOLD.items()}
SCALARS = [name for name in TOLD if name in GRID_VARIABLES]  # the others only some maps have


def grid_variables(names: tuple[str, ...]) -> dict[str, Variable]:
    """The variables on a grid with these dimensions."""
    table = GRID_VARIABLES | FURTHER_VARIABLES
    return {key: Variable((*names, *dims), units, words) for key, (dims, units, words) in table.items()}


def scalars(data: Dataset) -> list[str]:
    """Scalars of a map of which maps are drawn."""
    return [name for name in SIDES if name in SCALARS or name in data]


POINTS = 400


def motion_path(data: Dataset) -> Array | None:
    """Surge ... yaw along the commanded motion, (T, 6) [m, rad]; None where it stays, or its tables are gone."""
    try:
        study = robot_study(data)
    except InputError:
        return None
    t = np.linspace(0.0, study.motion.end_time, POINTS)
    path = pose_coordinates(study.robot, kinematics.poses(study.robot, study.motion, t))
    return path if np.ptp(path, axis=0).max() > 1e-9 else None


_UNIT_WORDS = {"N m-1": "N/m", "s-1": "1/s", "1": ""}


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Least and largest value of a quantity over the reached poses, where they are, and the value at home.

    SI units; `home` is None where home is not a point of the grid, or not reached.
    """

    name: str
    words: str
    unit: str
    least: float
    least_at: dict[str, float]
    largest: float
    largest_at: dict[str, float]
    home: float | None


@dataclass(frozen=True, kw_only=True)
class MapFindings:
    """Counts of poses, of all and of those reached; why the others are not, by words; findings by quantity."""

    poses: int
    reached: int
    reasons: dict[str, int]
    quantities: tuple[Finding, ...]

    def as_dict(self) -> dict[str, object]:
        """Everything as plain data."""
        return asdict(self)


def map_findings(data: Dataset, mode: int = 1) -> MapFindings:
    """Find out what a map says.

    Parameters
    ----------
    data : Dataset
        Result of `flexapod.workspace_map`.
    mode : int
        Which frequency.
    """
    codes, counts = np.unique(data.reason.values, return_counts=True)
    reasons = {REASONS[code].words: int(n) for code, n in zip(codes, counts, strict=True) if code != REACHED}
    found = [_finding(data, name, scalar(data, name, mode), mode) for name in scalars(data)]
    return MapFindings(
        poses=int(data.reason.size),
        reached=int((data.reason.values == REACHED).sum()),
        reasons=reasons,
        quantities=tuple(finding for finding in found if finding is not None),
    )


def scalar(data: Dataset, name: str, mode: int = 1) -> DataArray:
    """A quantity of one number per pose; of the frequencies, that of a mode."""
    return data[name].sel(mode=mode) if "mode" in data[name].dims else data[name]


def quantity_name(data: Dataset, name: str, mode: int = 1) -> str:
    """Name of a quantity for readers, with its mode, direction or acceleration."""
    if name == "frequency" and mode > 1:
        return f"natural frequency of mode {mode}"
    words = {"stiffness": ("stiffness_direction", _vector), "dynamic_deviation": ("acceleration", _acceleration)}
    given = [told(data.attrs[key]) for key, told in [words[name]]] if name in words else []
    return TOLD[name][1].format(*given)


def quantity_unit(values: DataArray) -> str:
    """Unit as people write it; empty for numbers without one."""
    unit = str(values.attrs.get("units", ""))
    return _UNIT_WORDS.get(unit, unit)


def axis_words(data: Dataset) -> str:
    """The grid: "surge -120 to 120 mm (41), heave ... at roll 5 deg"."""
    parts = []
    for name in data.attrs["axes"].split():
        values = data[name].values
        ends = " to ".join(coordinate_text(name, end) for end in dict.fromkeys(values[[0, -1]].tolist()))
        parts.append(f"{name} {ends} ({len(values)})")
    fixed = {name: float(data.attrs[f"at_{name}"]) for name in AXES if data.attrs.get(f"at_{name}", 0.0)}
    return ", ".join(parts) + (f", at {coordinate_words(fixed)}" if fixed else "")


def scalars_with_values(data: Dataset) -> list[str]:
    """Quantities that have a value anywhere; the first one in any case."""
    return [name for name in scalars(data) if name == "frequency" or np.isfinite(data[name].values).any()]


def _finding(data: Dataset, name: str, values: DataArray, mode: int) -> Finding | None:
    flat = values.values.ravel()
    if not np.isfinite(flat).any():
        return None
    least, largest = first_least(flat), first_largest(flat)
    home = _home(data, values)
    return Finding(
        name=name,
        words=quantity_name(data, name, mode),
        unit=quantity_unit(values),
        least=float(flat[least]),
        least_at=_place(values, least),
        largest=float(flat[largest]),
        largest_at=_place(values, largest),
        home=home,
    )


def _place(values: DataArray, flat: int) -> dict[str, float]:
    index = np.unravel_index(flat, values.shape)
    return {str(dim): float(values[dim].values[i]) for dim, i in zip(values.dims, index, strict=True)}


def _home(data: Dataset, values: DataArray) -> float | None:
    """Value at home, where the grid has that point."""
    if any(data.attrs.get(f"at_{name}", 0.0) for name in AXES):
        return None
    index = []
    for dim in values.dims:
        axis = values[dim].values
        k = int(np.abs(axis).argmin())
        if abs(axis[k]) > 1e-9 * max(1.0, float(np.ptp(axis))):
            return None
        index.append(k)
    found = float(values.values[tuple(index)])
    return found if np.isfinite(found) else None


def _vector(vector: Array) -> str:
    whole = np.asarray(vector, dtype=float)
    for axis, unit in zip("xyz", np.eye(3), strict=True):
        if np.array_equal(whole, unit):
            return axis
    return f"[{', '.join(f'{part:.3g}' for part in whole)}]"


def _acceleration(given: str | Array) -> str:
    if isinstance(given, str):
        return "1 m/s² in the worst direction"
    return f"an acceleration of [{', '.join(f'{part:.3g}' for part in np.asarray(given, dtype=float))}] m/s²"
