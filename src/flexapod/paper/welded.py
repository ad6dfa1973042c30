"""The paper's robot with ball joints that carry moments: equilibria along the roll, legs welded to the platform."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from xarray import Dataset

from flexapod import model, rigid
from flexapod.paper.readings import robot_preset
from flexapod.paper.trials import opened
from flexapod.solve.equilibrium import equilibrium
from flexapod.solve.losses import per_loss
from flexapod.solve.rest import rest_commands, rest_load
from flexapod.solve.rigid_motion import rigid_rest, rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.system import State, System
from flexapod.study.attributes import attributes
from flexapod.study.record import Share
from flexapod.typing import Array

#: Robots of the map: preset and how many legs are welded to the platform.
READINGS = {
    "diameters": ("paper-robot", 6),
    "radii": ("paper-robot-radii", 6),
    "diameters-one": ("paper-robot", 1),
    "radii-one": ("paper-robot-radii", 1),
}
ROLLS = tuple(map(float, range(31)))  # deg; each equilibrium is sought from the one before
ARMS = (0.2, 0.3, 0.373, 0.45, 0.6)  # m, of the centre of mass from the platform's centre
SHAPES = 6  # per plane: the static shapes of a force and of a moment at the tip, and those of thrust
SHARE = 0.06  # of the travel: the third figure that the paper prints
SLOPE = 0.1  # of the tip: beyond, the bending of the legs is larger than the theory is made for
STATIONS = np.linspace(0.0, 1.0, 41)
COLUMNS = {
    "deviation": "m",
    "off_axis": "m",
    "slope": "rad",
    "shortening": "m",
    "leg_force": "N",
    "stress": "Pa",
}


def welded(study: model.Study, count: int = 6) -> model.Study:
    """The same robot with the first ``count`` legs fixed to the platform in place of their ball joints."""
    robot = study.robot
    legs = tuple(leg.replace(chain="UPF" if i < count else "UPS") for i, leg in enumerate(robot.legs))
    kind = "6-UPF" if count == 6 else f"{count}-UPF+{6 - count}-UPS"
    return study.replace(robot=robot.replace(type=kind, legs=legs))


@dataclass(frozen=True, kw_only=True)
class _Walk:
    """A robot on its way from home to the largest roll, at rest at each turn."""

    study: model.Study
    system: System

    def poses(self, rolls: Sequence[float]) -> Iterator[dict[str, object]]:
        """What the equilibrium at each roll [deg] is; ends where none continues the one before."""
        state: State | None = None
        robot = self.study.robot
        for roll in rolls:
            R = rigid.rotation_matrix(np.array([[np.deg2rad(roll), 0.0, 0.0]]))[0]
            path = rigid.Poses.at_rest(rigid.home_pose(robot).position[0], R)
            start = rigid_state(self.system, robot, path) if state is None else state
            acts = rest_load(self.system, robot, path, self.study.load)
            command = rest_commands(self.system, robot, rigid_rest(self.system, robot, path).q)
            found = equilibrium(self.system, start, command[0], acts.force[0], acts.wrench)
            if not found.found:
                return
            state = found.state
            yield self._values(path, state, command[0])

    def _values(self, path: rigid.Poses, x: State, command: Array) -> dict[str, object]:
        robot, shapes = self.study.robot, self.system.kernel.shapes
        com = path.point(robot.payload.com)[0][0]
        first = shapes.index("a")
        lateral = x.q[:, first : first + 2 * shapes.a.count].reshape(len(x.q), 2, -1)
        stroke = x.q[:, shapes.index("l")]
        free = stroke - np.array([leg.cylinder.mouth for leg in robot.legs])
        slope = lateral @ shapes.a.tip_slope / free[:, None]
        short = 0.5 * np.einsum("idk,kj,idj->i", lateral, shapes.a.slope_tip, lateral) / free
        thrust = np.abs(x.drive[:, 0])
        return {
            "deviation": np.abs(x.pose[:3] - com),
            "off_axis": np.linalg.norm(lateral @ shapes.a.tip, axis=1).max(),
            "slope": np.linalg.norm(slope, axis=1).max(),
            "shortening": short.max(),
            "leg_force": thrust.max(),
            "stress": self._stress(lateral, free, thrust),
        }

    def _stress(self, lateral: Array, free: Array, thrust: Array) -> float:
        """Largest stress [Pa] of round pistons: E d / 2 times the curvature, and the thrust over the section."""
        curvature = lateral @ self.system.kernel.shapes.a.values(STATIONS, 2) / free[:, None, None] ** 2
        bent = np.linalg.norm(curvature, axis=1).max(axis=1)
        pistons = [leg.piston for leg in self.study.robot.legs]
        stress = [
            0.5 * (p.E or np.nan) * (p.diameter or np.nan) * k + f * (p.E or np.nan) / p.EA
            for p, k, f in zip(pistons, bent, thrust, strict=True)
        ]
        return float(max(stress))


def welded_map(report: Share, arms: Sequence[float] = ARMS, rolls: Sequence[float] = ROLLS) -> Dataset:
    """Deviation of welded robots over the roll, the place of the centre of mass, and the readings of the circles.

    Returns
    -------
    xarray.Dataset
        Over `reading`, `arm` [m], `roll` [deg]: `deviation` (axis) [m] of the centre of mass at rest; `off_axis` [m],
        the farthest tip from its cylinder's axis, and its `slope`; `shortening` [m] of a leg by bending; `leg_force`
        [N]; `stress` [Pa] of a linear elastic piston. NaN beyond the last equilibrium.
    """
    shape = (len(READINGS), len(arms), len(rolls))
    values = {name: np.full((*shape, 3) if name == "deviation" else shape, np.nan) for name in COLUMNS}
    for i, (preset, count) in enumerate(READINGS.values()):
        for j, arm in enumerate(arms):
            study = welded(with_arm(opened(robot_preset(preset)), arm), count)
            simulation = study.simulation.replace(modes=SHAPES)
            walk = _Walk(study=study, system=robot_system(study.robot, simulation, per_loss(study.robot, simulation)))
            for k, row in enumerate(walk.poses(rolls)):
                for name, value in row.items():
                    values[name][i, j, k] = value
            report((i * len(arms) + j + 1) / (len(READINGS) * len(arms)))
    dims = ("reading", "arm", "roll")
    return Dataset(
        {
            name: ((*dims, "axis") if name == "deviation" else dims, values[name], {"units": unit})
            for name, unit in COLUMNS.items()
        },
        {
            "reading": list(READINGS),
            "arm": ("arm", list(arms), {"units": "m"}),
            "roll": ("roll", list(rolls), {"units": "deg"}),
            "axis": list("xyz"),
        },
        attributes(robot_preset("paper-robot")),
    )


def with_arm(study: model.Study, arm: float) -> model.Study:
    """The same robot with its centre of mass and tool ``arm`` [m] beside the platform's centre, where they are in y."""
    beside = [0.0, arm, 0.0]
    payload = study.robot.payload.replace(com=beside, tool=beside)
    return study.replace(robot=study.robot.replace(payload=payload))


def travel_share(found: Dataset) -> Array:
    """Deviation in z over the travel of the rigid centre of mass in z, (..., arm, roll); NaN at home."""
    travel = found.arm * np.sin(np.deg2rad(found["roll"]))
    z = found.deviation.sel(axis="z")
    return (z / travel.where(found["roll"] > 0)).transpose(*z.dims).values
