"""Remarks on drives that a simulation loads beyond their limits, in the words of the checks before it."""

from __future__ import annotations

import numpy as np

from flexapod.analysis.description.hydraulic_description import describe_hydraulic, hydraulic_remarks
from flexapod.analysis.description.screw_description import describe_screw, screw_remarks
from flexapod.analysis.results.leg_results import drive_forces
from flexapod.analysis.results.time_history import Record
from flexapod.model import Robot
from flexapod.solve.system import System

FEWEST = 3  # instants of which a rate and an acceleration are told


def drive_warnings(robot: Robot, system: System, record: Record) -> list[str]:
    """Thrust, speed, torque, pressure, flow beyond limits, of the flexible robot; of friction what checks estimate."""
    t, shapes = record.time, system.kernel.shapes
    if len(t) < FEWEST or not any(leg.screw or leg.cylinder_of_oil for leg in robot.legs):
        return []
    force, screws, cylinders = drive_forces(robot, system, record), [], []
    for i, leg in enumerate(robot.legs):
        length = record.q[:, i, shapes.l_index]
        if leg.cylinder_of_oil is not None:
            cylinders.append(describe_hydraulic(i, leg, t, length, force[:, i], np.gradient(length, t)))
        if leg.screw is not None:
            rate = np.gradient(record.q[:, i, shapes.index("r")], t, edge_order=2)
            accel = np.gradient(rate, t, edge_order=2)
            screws.append(describe_screw(i, leg, t, length, force[:, i], rate, accel))
    return [*screw_remarks(robot, tuple(screws)), *hydraulic_remarks(robot, tuple(cylinders))]
