"""Variables of a map: dimensions after the grid's, unit, meaning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.study.names import Variable

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["BUDGET_VARIABLES", "GRID_VARIABLES", "SCALARS", "SIDES", "forms", "scalars"]

#: Variables by name; their dimensions follow those of the grid.
GRID_VARIABLES = {
    "reason": Variable((), "1", "why a pose is not reached: a code, 0 where it is"),
    "frequency": Variable(("mode",), "Hz", "undamped natural frequency, commands of the drives held"),
    "stiffness": Variable((), "N m-1", "stiffness at the tool against a force in the chosen direction"),
    "stiffness_least": Variable((), "N m-1", "stiffness at the tool against a force in the weakest direction"),
    "softest_direction": Variable(("axis",), "1", "weakest direction at the tool, world axes"),
    "condition": Variable((), "1", "condition of the scaled Jacobian of the rigid robot"),
    "smallest_singular_value": Variable((), "1", "smallest singular value of the scaled Jacobian of the rigid robot"),
    "static_deviation": Variable(("axis",), "m", "sag of the tool under gravity and load, flexible minus rigid"),
    "static_deviation_size": Variable((), "m", "sag of the tool under gravity and load"),
    "dynamic_deviation": Variable((), "m", "quasi-static deviation of the tool in an acceleration"),
    "actuator_force": Variable(("leg",), "N", "force of the drive on the piston at rest, positive pushes out"),
    "largest_force": Variable((), "N", "largest drive force of a leg at rest"),
    "stroke_margin": Variable((), "m", "least distance of a leg from the ends of its stroke"),
    "guided_length": Variable((), "m", "least length of a piston in its cylinder"),
    "base_joint_angle": Variable((), "rad", "largest turn of a leg at its base joint from home"),
    "platform_joint_angle": Variable((), "rad", "largest turn of a leg at its platform joint from home"),
    "euler_share": Variable((), "1", "largest axial thrust of a leg at rest over its Euler load"),
}

#: Those that are computed only where error budgets are asked for.
BUDGET_VARIABLES = {
    "error_worst": Variable((), "m", "worst case of the tool's place at rest, all parts"),
    "error_by_part": Variable(("part",), "m", "size of the worst that a part does to the tool's place at rest"),
}

#: Scalars of which maps are drawn, in the order of the figures, and which end is the bad one.
SCALARS = {
    "frequency": "least",
    "stiffness": "least",
    "stiffness_least": "least",
    "condition": "largest",
    "static_deviation_size": "largest",
    "dynamic_deviation": "largest",
    "largest_force": "largest",
    "stroke_margin": "least",
    "guided_length": "least",
    "base_joint_angle": "largest",
    "platform_joint_angle": "largest",
    "euler_share": "largest",
}
#: The same with those that a map has if they are asked for.
SIDES = SCALARS | {"error_worst": "largest"}


def forms(names: tuple[str, ...]) -> dict[str, Variable]:
    """The variables on a grid with these dimensions."""
    table = GRID_VARIABLES | BUDGET_VARIABLES
    return {key: Variable((*names, *dims), units, words) for key, (dims, units, words) in table.items()}


def scalars(data: Dataset) -> list[str]:
    """Scalars of a map of which maps are drawn."""
    return [name for name in SIDES if name in SCALARS or name in data]
