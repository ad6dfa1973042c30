"""Results that elements of the legs have, by name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.variables import VARIABLES, Variable
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.registry import kinds_of, slots_of
from flexapod.mechanics.elements.trial import wrap_hook_errors
from flexapod.mechanics.leg.layout import leg_parameters
from flexapod.model import Robot
from flexapod.solve.system import System

if TYPE_CHECKING:
    from xarray import Dataset


def element_forms(robot: Robot) -> dict[str, Variable]:
    """Results of the elements of a robot: dimensions, unit, meaning."""
    found = {}
    for kind in kinds_of(robot.legs):
        for slot in slots_of(kind, robot.legs) if kind.outputs else ():
            for output in kind.outputs:
                found[f"{slot.prefix}{output.name}"] = Variable(("time", "leg"), output.units, output.long_name)
    return found


def element_results(robot: Robot, system: System, q: Array) -> dict[str, Array]:
    """Results of the elements from recorded coordinates (T, legs, n), each (T, legs); NaN in legs without one."""
    shapes, found = system.kernel.shapes, {}
    if not any(slot.kind.outputs for slot in shapes.elements):
        return found
    p, coordinates = columns_by_name(system.leg_p, leg_parameters(shapes)), columns_by_name(q, shapes.layout)
    for slot in shapes.elements:
        has = np.array([slot.of(leg) is not None for leg in robot.legs])
        for output in slot.kind.outputs:
            with wrap_hook_errors(slot.kind, f"outputs.{output.name}"):
                values = np.broadcast_to(output.of(slot.strip_prefix(p), slot.strip_prefix(coordinates)), q.shape[:-1])
            found[f"{slot.prefix}{output.name}"] = np.where(has, values, np.nan)
    return found


def element_names(data: Dataset) -> tuple[str, ...]:
    """Names of the results that elements of the legs have, see `flexapod.Element`."""
    return tuple(str(name) for name in data.data_vars if name not in VARIABLES and data[name].dims == ("time", "leg"))


def columns_by_name(rows: Array, layout: tuple[tuple[str, int], ...]) -> SimpleNamespace:
    """Columns of rows by name; of more than one number the first axis counts them."""
    found, start = {}, 0
    for name, size in layout:
        part = rows[..., start : start + size]
        found[name], start = part[..., 0] if size == 1 else part.transpose(-1, *range(part.ndim - 1)), start + size
    return SimpleNamespace(**found)
