"""Results over rows by compiled loops and in NumPy: one answer for legs, drives, frames and joints of every kind."""

import numpy as np
import pytest
from tests.helpers import machines, mechanisms
from tests.helpers.machines import BASE, EVERYTHING, OIL, SCREW, TOP
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import model
from flexapod.analysis.results import bodies
from flexapod.analysis.results.causes import cause_names, deviation_by_cause, errors_of, shares_and_sums
from flexapod.analysis.results.leg_results import flexible_lengths
from flexapod.analysis.simulation import run_simulation
from flexapod.common.errors import ComputationError
from flexapod.kinematics import Poses, RigidPoses, poses_from_home
from flexapod.kinematics.dynamics import inverse_dynamics
from flexapod.kinematics.robot import home_frames, leg_bodies, payload_body
from flexapod.model import Encoder, Expansion, Geometry, Heat, Load, Loop, ServoDrive, SineWrench
from flexapod.model.study.mount import BaseMotion
from flexapod.solve.result_rows import balances
from flexapod.solve.statics.ideal_robot import is_hexapod

pytestmark = pytest.mark.consistency

RNG = np.random.default_rng(11)
GEOMETRY = Geometry(
    base_joints=1e-4 * RNG.normal(size=(6, 3)), platform_joints=1e-4 * RNG.normal(size=(6, 3)),
    leg_offset=5e-5 * RNG.normal(size=6), lead=1e-4 * RNG.normal(size=6),
)  # fmt: skip
ROUNDING, LEAST = 5e-11, 1e-15  # of the largest share; m: lengths of a metre are rounded at 1e-16
SHAKEN = {
    "of": "displacement",
    "time": [0.0, 0.05, 0.1, 0.15, 0.2],
    "values": 1e-3 * np.outer([0, 1, 3, 2, 1], RNG.normal(size=6)),
}


def machine(**more):
    """Machine whose legs have springs of every kind, in a short run."""
    return machines.study(machines.machine(**{"drive": SCREW, **EVERYTHING, **more}), fidelity="lumped", step=1e-3)


def measured(place):
    """Screw in a loop that gives way."""
    loop = Loop(stiffness=5e3, damping=60.0, integral=2e4)
    return SCREW.replace(encoder=Encoder(at=place), command="servo", loop=loop)


def with_robot(study, **more):
    return study.replace(robot=study.robot.replace(**more))


def warm(study):
    """Temperatures over time of legs and plates, and others that stay."""
    heat = Heat(piston=30.0, platform=24.0, expansion=Expansion(piston=2e-5), time=[0.0, 0.1, 0.2],
                columns=("base", "screw"), table=[[20, 20], [24, 25], [27, 22]])  # fmt: skip
    return with_robot(study, heat=heat, geometry=GEOMETRY)


def rolling(**more):
    return model.override(paper_robot(), duration=0.2, step=1e-3, output_step=5e-3, **more)


def loaded(study):
    wrench = SineWrench(amplitude=[1e3, -2e3, 25e3, 100, 200, -300], frequency=8.0)
    return study.replace(load=Load(wrench=wrench))


STUDIES = {
    "plain legs": rolling,
    "servo drives": lambda: with_legs(rolling(), lambda leg: leg.replace(drive=ServoDrive(stiffness=2e7, damping=2e4))),
    "friction, heat and plates": lambda: model.override(model.preset("machine-hexapod"), duration=0.3, tolerance=1e-3),
    "errors of geometry, temperatures over time": lambda: warm(machine()),
    "a loop about the stroke": lambda: machine(drive=measured("stroke")),
    "a loop about the joints": lambda: machine(drive=measured("joint-to-joint")),
    "gaps": lambda: machines.study(
        machines.machine(drive=SCREW.replace(nut=SCREW.nut.replace(backlash=1e-5, damping=1e6)), damping=0.02),
        fidelity="lumped",
        play="gap",
        step=5e-4,
    ),
    "oil": lambda: machines.study(machines.machine(**EVERYTHING, drive=OIL), fidelity="lumped", step=1e-3),
    "frames on mounts": lambda: with_robot(machine(), base_mount=BASE, platform_mount=TOP),
    "a base that moves": lambda: with_robot(machine(), base_motion=BaseMotion(at=[0.1, 0.0, -0.2], **SHAKEN)),
    "eight legs": lambda: machines.study(mechanisms.ROBOTS["8-UPS"](), fidelity="lumped", step=1e-3),
    "carriages": lambda: machines.study(mechanisms.ROBOTS["6-PUS"](), fidelity="lumped", step=1e-3),
}


def shares_in_numpy(found):
    path, system = found.recorded_path, found.march.system
    shares = deviation_by_cause(path, errors_of(system, path, found.record))
    return shares if path.base is None else np.einsum("txy,tcly->tclx", path.base.rotation, shares)


@pytest.mark.parametrize("kind", STUDIES)
def test_loops_and_numpy_agree(kind):
    found = run_simulation(loaded(STUDIES[kind]()))
    path, system, record, robot = found.recorded_path, found.march.system, found.record, found.study.robot
    assert system.kernel.library is not None
    expected, (shares, sums) = shares_in_numpy(found), shares_and_sums(system, path, record)
    assert shares.shape[1] == len(cause_names(robot))
    near = max(ROUNDING * np.abs(expected).max(), LEAST)
    np.testing.assert_allclose(shares, expected, rtol=0, atol=near)
    np.testing.assert_allclose(sums, expected.sum(axis=(1, 2)), rtol=0, atol=4 * near)
    drawn = bodies.draw(robot, system, record)
    turns = bodies.joint_angles(robot, drawn.axes(robot), drawn.rotation)
    np.testing.assert_allclose(bodies.drawn_turns(robot, system.kernel, drawn), turns, rtol=0, atol=1e-15)
    if bodies.pairs_of_legs(robot):
        length = flexible_lengths(robot, system, record, drawn)
        near = bodies.clearance(robot, drawn.tips(robot), drawn.axes(robot), length)
        made = bodies.drawn_clearance(robot, system.kernel, drawn, length)
        np.testing.assert_allclose(made.gap, near.gap, rtol=0, atol=2e-15)
        np.testing.assert_array_equal(made.legs, near.legs)
    if is_hexapod(robot):
        forces, expected = balances(system.kernel, path, path.wrench), path.forces
        for name, values in forces.items():
            other = getattr(expected, name)
            np.testing.assert_allclose(values, other, rtol=0, atol=1e-13 * np.abs(other).max())


@pytest.fixture(scope="module")
def compiled():
    return run_simulation(model.override(rolling(), duration=0.02)).march.system.kernel


def test_forces_of_fast_poses_under_any_load_agree(compiled):
    # Rates, accelerations and loads far from those of a path: every term of the balances counts.
    robot, count = model.preset("machine-hexapod").robot, 37  # the last vector is not full
    still = poses_from_home(robot, 0.05 * RNG.normal(size=(count, 6)))
    rates = {name: RNG.normal(size=(count, 3)) * size for name, size in
             (("velocity", 2.0), ("omega", 3.0), ("acceleration", 20.0), ("alpha", 30.0))}  # fmt: skip
    moving = RigidPoses(robot, Poses(position=still.position, rotation=still.rotation, **rates))
    wrench = 1e4 * RNG.normal(size=(count, 6))
    expected = inverse_dynamics(
        home_frames(robot), robot.platform_joints, leg_bodies(robot), payload_body(robot), robot.gravity, moving.poses,
        moving.legs, wrench,
    )  # fmt: skip
    made = balances(compiled, moving, wrench)
    np.testing.assert_allclose(made["drive_force"], expected.actuator_force, rtol=0, atol=1e-8)  # of some 1e5 N
    np.testing.assert_allclose(made["joint_force"], expected.joint_force, rtol=0, atol=1e-8)


def test_a_singular_pose_is_refused_in_the_same_words(compiled):
    robot = paper_robot().robot
    joints = robot.home_bases.copy()
    joints[1] = joints[0]
    twice = robot.platform_joints.copy()
    twice[1] = twice[0]
    same = robot.replace(base_joints=joints, platform_joints=twice)
    with pytest.raises(ComputationError, match="a pose of the path is singular"):
        balances(compiled, RigidPoses(same, poses_from_home(same, np.zeros((1, 6)))), np.zeros((1, 6)))


def test_without_a_compiler_results_are_the_same(monkeypatch):
    compiled = fx.simulate(rolling(fidelity="rigid"), duration=0.02)
    found = run_simulation(model.override(rolling(fidelity="rigid"), duration=0.02))
    kernel = found.march.system.kernel
    monkeypatch.setitem(vars(kernel), "library", None)
    values = found.values()
    for name in ("deviation_by_cause", "deviation_residual", "joint_turn", "leg_clearance", "leg_length",
                 "drive_command", "drive_force_rigid", "joint_force_rigid"):  # fmt: skip
        own = compiled[name].values
        np.testing.assert_allclose(values[name], own, rtol=0, atol=1e-12 * max(np.abs(own).max(), 1.0), err_msg=name)
