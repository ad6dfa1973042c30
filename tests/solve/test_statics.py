"""One equilibrium: with every drive, load and fidelity all that is static agrees with the start of a run."""

from itertools import cycle

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.analysis.description.residual_vibration import RestingRobot
from flexapod.analysis.description.robot_description import describe_pose
from flexapod.analysis.scalars import ROBOT_SCALARS, RobotRun
from flexapod.model import (
    ConstantWrench,
    CsvWrench,
    Feedback,
    ForceDrive,
    Load,
    PrescribedDrive,
    ServoDrive,
    SineWrench,
    StepWrench,
    Waypoint,
    WaypointMotion,
)
from flexapod.solve.modal.elastic_robot import ElasticRobot

pytestmark = pytest.mark.contract

WRENCH = np.array([50.0, -30.0, -200.0, 5.0, 4.0, -3.0])
POSE = {"sway": 0.03, "heave": 0.02, "roll": 0.1}
SPRING = Feedback(stiffness=3e6, damping=1e3)
TABLE = ForceDrive(law="csv", file="f.csv", time=[0.0, 1.0], force=[170.0, 400.0], feedback=SPRING)
DRIVES = {
    "prescribed": [PrescribedDrive()],
    "servo": [ServoDrive(stiffness=4e6, damping=1e3)],
    "force, rigid": [ForceDrive(feedback=SPRING)],
    "force, csv": [TABLE],
    "mixed": [ForceDrive(feedback=SPRING), PrescribedDrive(), TABLE, ServoDrive(stiffness=4e6)],
}
LOADS = {
    "none": None,
    "constant": ConstantWrench(value=WRENCH),
    "sine": SineWrench(amplitude=WRENCH, frequency=3.0, phase=1.0),
    "step at once": StepWrench(amplitude=WRENCH),
    "step later": StepWrench(amplitude=WRENCH, time=0.01),
    "table": CsvWrench(time=[0.0, 0.5], wrench=[WRENCH, -WRENCH]),
}
FIDELITIES = {"rigid": 0, "lumped": 0, "finite-segment": 8, "assumed-modes": 3, "beam-fem": 6, "solid-fem": 3}


def held_at(pose):
    points = [Waypoint(time=float(t), **pose) for t in (0, 1)]
    return WaypointMotion(points=points)


def robot_study(drive, load, fidelity):
    study = paper_robot(fidelity=fidelity, **({"modes": FIDELITIES[fidelity]} if FIDELITIES[fidelity] else {}))
    drives = cycle(DRIVES[drive])
    legs = tuple(leg.replace(drive=next(drives)) for leg in study.robot.legs)
    payload = study.robot.payload.replace(tool=[0.1, 0.2, 0.3])
    robot = study.robot.replace(legs=legs, payload=payload)
    return study.replace(robot=robot, motion=held_at(POSE), load=Load(wrench=LOADS[load]))


def agree(found, expected, size=None):
    """To 1e-9 of the size, and to 1e-14 m: deviations are differences of positions of a metre."""
    size = np.abs(expected).max() if size is None else size
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * size + 1e-14)


# Every drive with every load; every fidelity with given forces, loads in turn; constraints and springs once each.
loads = cycle(LOADS)
CASES = [(drive, load, "lumped") for drive in DRIVES for load in LOADS]
CASES += [("force, rigid", next(loads), fidelity) for fidelity in FIDELITIES]
CASES += [("mixed", "sine", "assumed-modes"), ("servo", "table", "rigid")]


@pytest.mark.parametrize(("drive", "load", "fidelity"), sorted(set(CASES)))
def test_statics_are_the_first_instant_of_a_run(drive, load, fidelity):
    """The force of force drives once counted in `run` alone: 17.74 um of sag there, 926 um everywhere else."""
    study = robot_study(drive, load, fidelity)
    start = fx.simulate(study, duration=1e-3, step=1e-3).isel(time=0)
    modes, many = fx.modes(study, POSE), fx.modes(study, np.tile([0, 0.03, 0.02, 0.1, 0, 0], (2, 1)))
    at = {"heave": [POSE["heave"]]}
    map_ = fx.workspace_map(study, at, at={"sway": POSE["sway"], "roll": POSE["roll"]}).isel(heave=0)
    elastic = ElasticRobot(study.robot, study.simulation, study.load)
    checked = describe_pose("start", RestingRobot(study, elastic, 0.0))
    sag = start.com_deviation.values
    agree(modes.com_sag, sag)
    agree(many.com_sag[1], sag)
    agree(checked.sag, np.linalg.norm(sag))
    agree(map_.static_deviation, start.tool_deviation)
    agree(modes.platform_position, start.com_position - _turned(start, study.robot.payload.com), size=1.0)
    if load != "step at once":  # which acts on the robot at rest: the drives then push as in the equilibrium
        agree(map_.actuator_force, start.actuator_force, size=max(np.abs(start.actuator_force.values).max(), 1e3))
    frequency = modes.frequency.values
    for other in (many.frequency[1].values, map_.frequency.values, [line.frequency for line in checked.modes]):
        np.testing.assert_allclose(other, frequency[: len(other)], rtol=1e-9)
    compliance = np.linalg.inv(fx.stiffness(study, POSE).stiffness.values)[:3, :3]
    lowest = 1 / np.linalg.eigvalsh(0.5 * (compliance + compliance.T))[-1]  # a moment that does not turn along: skew
    np.testing.assert_allclose([map_.stiffness_least, checked.stiffness.least], lowest, rtol=1e-9)


def _turned(start, vector):
    return fx.kinematics.rotations.matrix(start.platform_quaternion.values) @ vector


@pytest.mark.parametrize("drive", ["force, rigid", "force, csv"])
def test_energy_and_sweeps_start_from_that_equilibrium(drive):
    """Gravity, wrench and drives lift the payload and load the springs by as much as the sag says."""
    study = robot_study(drive, "constant", "lumped")
    start = fx.simulate(study, duration=1e-3, step=1e-3).isel(time=0)
    strokes = start.leg_length_command - start.leg_stroke
    stretch = start.axial_amplitude.values[:, 0]
    piston = study.robot.legs[0].piston
    springs = 0.5 * SPRING.stiffness * (strokes.values**2).sum()
    springs += 0.5 * piston.EA / piston.length * (stretch**2).sum()
    assert start.energy_strain.item() == pytest.approx(springs, rel=1e-9)
    run = RobotRun(study=study.replace(motion=held_at({})), system=None, record=None, counters=None, path=None)
    value = ROBOT_SCALARS["first_frequency"].value(run)
    assert value == pytest.approx(fx.modes(study).frequency[0].item(), rel=1e-12)


def test_a_table_counts_at_the_instant_of_the_pose():
    """At the end of the motion the drives push with what their table says there, in `check` as in a long rest."""
    study = robot_study("force, csv", "none", "lumped")
    later = ForceDrive(law="csv", file="f.csv", time=[0.0, 1.0], force=[400.0, 400.0], feedback=SPRING)
    legs = tuple(leg.replace(drive=later) for leg in study.robot.legs)
    expected = fx.modes(study.replace(robot=study.robot.replace(legs=legs)), POSE).com_sag.values
    elastic = ElasticRobot(study.robot, study.simulation, study.load)
    agree(describe_pose("end of the motion", RestingRobot(study, elastic, 1.0)).sag, np.linalg.norm(expected))
