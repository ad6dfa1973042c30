"""Robots that the paper might mean: how far each deviates, and whether that can be trusted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from xarray import Dataset

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.results.attributes import attributes, robot_study
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.analysis.results.time_history import Share
from flexapod.analysis.simulation import simulate
from flexapod.common.errors import ComputationError, InputError
from flexapod.solve.modal.structural_damping import per_loss
from flexapod.solve.rigid_motion import rigid_rest, rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.equilibrium import Equilibrium, equilibrium
from flexapod.solve.statics.static_loads import rest_commands, rest_load
from flexapod.solve.system import State, System
from flexapod.verification.paper.claim import largest_deviation

TRIAL_STEP = 5e-4  # s; peaks change by less than 1 % from 1 ms to 0.25 ms


def extend_strokes(study: model.Study) -> model.Study:
    """Study with mouths and strokes moved just so far that no piston leaves its cylinder on the path."""
    robot = study.robot
    path = kinematics.poses(robot, study.motion, path_instants(study))
    lengths = kinematics.leg_lengths(robot.base_joints, robot.platform_joints, path.position, path.rotation)
    legs = tuple(_opened(leg, float(lengths.max())) for leg in robot.legs)
    return study.replace(robot=robot.replace(legs=legs))


def _opened(leg: model.Leg, longest: float) -> model.Leg:
    mouth = max(leg.cylinder.mouth, longest - leg.piston.length)
    stroke = model.Stroke(min=mouth, max=mouth + leg.piston.length)
    return leg.replace(stroke=stroke, cylinder=leg.cylinder.replace(mouth=mouth))


def load_share(data: Dataset) -> float:
    """Largest thrust of a drive over the Euler load of its leg at that length."""
    robot = robot_study(data).robot
    free = data.leg_length.values - np.array([leg.cylinder.mouth for leg in robot.legs])
    shares = (data.actuator_force.values[:, i] / buckling_load(leg, free[:, i]) for i, leg in enumerate(robot.legs))
    return max(float(share.max()) for share in shares)


def _spread(data: Dataset, dim: str) -> float:
    """Largest less smallest commanded length along a dimension [m], where it is largest."""
    command = data.leg_length_command
    return float((command.max(dim) - command.min(dim)).max())


def _stretch_stiffness(data: Dataset) -> float:
    piston = robot_study(data).robot.legs[0].piston
    return piston.EA / piston.length


#: Numbers of a trial by name: unit, and what each is of a result.
NUMBERS: dict[str, tuple[str, Callable[[Dataset], Any]]] = {
    "deviation_peak": ("m", largest_deviation),
    "tip_peak": ("m", lambda data: float(np.abs(data.tip_deflection).max())),
    "force_peak": ("N", lambda data: float(np.abs(data.actuator_force).max())),
    "load_share": ("1", load_share),
    "travel": ("m", partial(_spread, dim="time")),
    "apart": ("m", partial(_spread, dim="leg")),
    "stretch_stiffness": ("N m-1", _stretch_stiffness),
}


def system_of(study: model.Study) -> System:
    """The equations of a study's robot."""
    return robot_system(study.robot, study.simulation, per_loss(study.robot, study.simulation))


def locked_equilibrium(study: model.Study, system: System, path: kinematics.Poses, state: State | None) -> Equilibrium:
    """Equilibrium with the drives locked at a rigid pose, sought from a state; None: from the rigid pose."""
    at = kinematics.RigidPoses(study.robot, path)
    start = rigid_state(system, at) if state is None else state
    acts = rest_load(system, at, study.load)
    command = rest_commands(system, study.robot, rigid_rest(system, at).q)
    return equilibrium(system, start, command[0], acts.force[0], acts.wrench)


def trial(study: model.Study) -> dict[str, object]:
    """Largest values of a simulation by name, as in `NUMBERS`; `verdict` states why they are not to be trusted.

    The verdict is empty where they are. Where nothing could be computed all values are NaN.
    """
    try:
        data = simulate(study, step=TRIAL_STEP)
    except (InputError, ComputationError) as error:
        nothing = {**dict.fromkeys(NUMBERS, np.nan), "deviation_peak": np.full(3, np.nan)}
        return {**nothing, "verdict": error.what.split(":")[0]}
    found, verdict = {name: number(data) for name, (_, number) in NUMBERS.items()}, ""
    if data.attrs["partial"]:
        verdict = str(data.attrs["failure"])
    elif found["load_share"] >= 1:
        verdict = f"collapse: a leg bears {100 * found['load_share']:.0f} % of its Euler load"
    return {**found, "verdict": verdict}


def trials(studies: Mapping[str, model.Study], report: Share) -> Dataset:
    """Trials of several studies by name.

    Returns
    -------
    xarray.Dataset
        Over `reading`: `deviation_peak` (reading, axis) and `tip_peak` [m], `force_peak` [N], `load_share` (largest
        thrust over the Euler load), `travel` (largest of a piston) and `apart` (longest less shortest leg at one
        instant) [m], `stretch_stiffness` of a piston [N/m], `verdict`.
    """
    rows = []
    for i, study in enumerate(studies.values()):
        rows.append(trial(study))
        report((i + 1) / len(studies))
    first = next(iter(studies.values()))
    columns = {name: unit for name, (unit, _) in NUMBERS.items()}
    return table(rows, ("reading", list(studies), {}), columns, attributes(first) | {"step": TRIAL_STEP})


def table(
    rows: list[dict[str, object]],
    along: tuple[str, list[str] | list[float], dict[str, str]],
    columns: Mapping[str, str],
    attrs: Mapping[str, object],
) -> Dataset:
    """Rows as a Dataset along a dimension (name, labels, attributes), units by column, axes and, if any, `verdict`."""
    dim, labels, about = along
    data: dict[str, object] = {name: (dim, [row[name] for row in rows]) for name in ("verdict",) if name in rows[0]}
    for name, unit in columns.items():
        values = np.array([row[name] for row in rows])
        data[name] = ((dim, "axis") if values.ndim == 2 else dim, values, {"units": unit})
    return Dataset(data, {dim: (dim, labels, about), "axis": list("xyz")}, dict(attrs))
