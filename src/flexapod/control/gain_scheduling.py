"""Controllers whose gains change with the pose: interpolated between those of a grid, (T21.43)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arguments import number, numbers
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.csv_tables import POSE
from flexapod.common.units import quantities
from flexapod.control.controllers import Controller
from flexapod.control.discretization import LATEST, period_of
from flexapod.control.feedback import law_of
from flexapod.control.function import Function
from flexapod.model import AXES

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["Scheduled"]


@dataclass(frozen=True, kw_only=True)
class Scheduled:
    """Controllers at the points of a grid of poses; between them matrices are interpolated straight, Eq. (T21.43).

    Parameters
    ----------
    axes : mapping
        Values of each coordinate of the grid, rising, by its name: ``{"heave": [-0.1, 0, 0.1]}`` [m, rad].
    controllers : sequence
        One for each point, in the order of the axes, the last changing fastest; all of one kind, so that states mean
        the same.
    """

    axes: Mapping[str, Sequence[float]]
    controllers: Sequence[Controller | StateSpace]

    def __post_init__(self) -> None:
        """Axes that rise, a controller for each point."""
        if not isinstance(self.axes, Mapping) or not self.axes:
            raise InputError("are none", key="axes", value=self.axes, allowed='as {"heave": [-0.1, 0, 0.1]} [m, rad]')
        for name, given in self.axes.items():
            given = quantities(given, _measures(name), key=f"axes.{name}")
            values = numbers(given, f"axes.{name}", "two values or more, rising")
            if len(values) < 2 or (np.diff(values) <= 0).any():
                raise InputError("does not rise", key=f"axes.{name}", value=given, allowed="two values or more")
        points, known = (
            int(np.prod([len(values) for values in self.axes.values()])),
            isinstance(self.controllers, Sequence),
        )
        if not known or len(self.controllers) != points:
            words = f"are {len(self.controllers)}" if known else "are no list of controllers"
            raise InputError(words, key="controllers", allowed=f"{points}, one for each point")

    def at(
        self, pose: Mapping[str, float], outputs: Sequence[str], inputs: Sequence[str], period: float | None = None
    ) -> StateSpace:
        """The controller at a pose, from `outputs` of a system to `inputs`, for samples of a `period` [s] if given.

        Raises
        ------
        InputError
            A pose outside of the grid, or controllers of several kinds.
        """
        T = None if period is None else period_of(period)
        each = [_law(one, outputs, inputs, T) for one in self.controllers]
        _check_alike(each)
        found = dict.fromkeys("ABCD", 0.0)
        for k, weight in _weights(self.axes, pose):
            found = {name: value + weight * getattr(each[k], name) for name, value in found.items()}
        return replace(each[0], **found)

    def following(
        self, pose: Callable[[float], Mapping[str, float]], period: float | str, outputs: Sequence[str],
        inputs: Sequence[str],
    ) -> Function:  # fmt: skip
        """For simulations: the controller along a path, `pose` of an instant [s], sampled with a `period` [s].

        States are remembered by their sample, so that samples that come again after a step that failed find their own.
        """
        T = period_of(period)
        each = [_law(one, outputs, inputs, T) for one in self.controllers]
        _check_alike(each)
        known: dict[int, Array] = {}

        def asked(t: float, y: Array) -> Array:
            k = round(t / T)
            x = known.get(k, np.zeros(len(each[0].A))) if k else np.zeros(len(each[0].A))
            shares = list(_weights(self.axes, pose(t)))
            A, B, C, D = (sum(w * getattr(each[i], name) for i, w in shares) for name in "ABCD")
            known[k + 1] = A @ x + B @ y
            known.pop(k - LATEST, None)
            return C @ x + D @ y

        return Function(function=asked, inputs=each[0].inputs, outputs=each[0].outputs)


def _law(
    one: Controller | StateSpace, outputs: Sequence[str], inputs: Sequence[str], period: float | None
) -> StateSpace:
    law = law_of(one, outputs, inputs, {})
    return law if period is None or law.sample is not None else law.sampled(period)


def _check_alike(each: Sequence[StateSpace]) -> None:
    kinds = {(one.inputs, one.outputs, one.states) for one in each}
    if len(kinds) > 1:
        raise InputError("are of several kinds", key="controllers", allowed="the same channels and states everywhere")


def _measures(name: str) -> str:
    """What a coordinate of a grid measures; one that is no coordinate of a pose is a number."""
    return POSE.get(name, "number")


def _weights(axes: Mapping[str, Sequence[float]], pose: Mapping[str, float]) -> list[tuple[int, float]]:
    """Points about a pose and their weights, which add up to 1."""
    if not isinstance(pose, Mapping) or set(pose) - {*axes, *AXES}:
        words = 'coordinates by name, as {"heave": 0.05} [m, rad]; of the grid: ' + ", ".join(axes)
        raise InputError("is no pose of this grid", key="pose", value=pose, allowed=words)
    sides = []
    for name, values in axes.items():
        kind = _measures(name)
        grid = np.asarray(quantities(values, kind, key=f"axes.{name}"), dtype=float)
        x = number(pose.get(name, 0.0), name, kind)
        if not grid[0] <= x <= grid[-1]:
            raise InputError("is outside of the grid", key=name, value=x, allowed=f"{grid[0]:g} to {grid[-1]:g}")
        k = min(int(np.searchsorted(grid, x, side="right")) - 1, len(grid) - 2)
        share = (x - grid[k]) / (grid[k + 1] - grid[k])
        sides.append([(k, 1 - share), (k + 1, share)])
    shape = tuple(len(values) for values in axes.values())
    return [
        (int(np.ravel_multi_index([k for k, _ in corner], shape)), float(np.prod([w for _, w in corner])))
        for corner in product(*sides)
        if all(w for _, w in corner)
    ]
