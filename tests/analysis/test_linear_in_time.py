"""Histories of the linear model by the matrix exponential against the march of the whole equations, small inputs."""

import numpy as np
import pytest
from scipy.linalg import expm
from tests.helpers import motor_loops as motors
from tests.helpers.machines import study
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod import kinematics, model
from flexapod.model.study.mount import BaseMotion

pytestmark = pytest.mark.consistency

ROW, END = 5e-6, 0.02  # rows of all tables [s]; steps are as long, or twice
TIME = np.arange(round(END / ROW) + 1) * ROW
SHOWN = 40  # rows between those that are compared
STILL = model.AxisMotion(type="heave", amplitude=0.0, duration=END)


def sine(hz=180.0):
    return np.sin(2 * np.pi * hz * TIME)


def chirp(low=20.0, high=600.0):
    return np.sin(2 * np.pi * (low * TIME + 0.5 * (high - low) / END * TIME**2))


def at_rest(name):
    """The preset as it stands, what rubs stuck."""
    given = fx.preset(name).replace(motion=STILL)
    return given.replace(simulation=given.simulation.replace(friction="stuck"))


def on_drives(*drives):
    """The paper's robot at rest on other drives."""
    given = fx.preset("paper-robot").replace(motion=STILL)
    legs = tuple(leg.replace(drive=drive) for leg, drive in zip(given.robot.legs, drives, strict=True))
    return given.replace(robot=given.robot.replace(legs=legs))


def marched(given, step):
    """Displacement and turn of the tool off its commanded path, forces on pistons and joints, from rest, (rows, 30)."""
    data = fx.simulate(model.override(given, step=step, output_step=SHOWN * ROW, duration=END))
    joints = data.joint_force.values.reshape(len(data.time), -1)
    turned = data.rotation_deviation.values
    more = turned - turned[0]
    more -= 0.5 * np.cross(more, turned[0])  # rotation vectors do not add up: by a turn about the world's axes at rest
    drives = data.get("actuator_force", data.drive_force)
    found = np.concatenate([data.tool_deviation, more, drives, joints], axis=1)
    found[:, :3] -= found[0, :3]
    found[:, 6:] -= found[0, 6:]
    return found


def extrapolated(of, *given):
    """Of steps of 5 and 10 us, whose error is of the second order."""
    return (4 * of(*given, ROW) - of(*given, 2 * ROW)) / 3


def by_exponential(lin, u, step):
    """Outputs at the rows that are shown, of inputs (rows, m) that are straight from step to step, from rest."""
    n, m = lin.B.shape
    every, whole = round(step / ROW), np.zeros((n + 2 * m, n + 2 * m))
    whole[:n, :n], whole[:n, n : n + m], whole[n : n + m, n + m :] = lin.A, lin.B, np.eye(m) / step
    over, u = expm(whole * step)[:n], u[::every]
    x, found = np.zeros(n), []
    for k in range(len(u)):
        if k % (SHOWN // every) == 0:
            found.append(lin.C @ x + lin.D @ u[k])
        if k + 1 < len(u):
            x = over @ np.concatenate([x, u[k], u[k + 1] - u[k]])
    return np.array(found)


#: Of the largest of each unit: displacements and turns as promised. Forces have accelerations of modes of kilohertz in
#: them that hardly any damper takes, which steps see coarsely, and the march solves its equations to some 1e-10 of
#: thousands of newtons; a screw's is that at the nut, 1e-4 beside that on the piston, as it softens.
CLOSE = (1e-5, 1e-5, 3e-4, 1e-3)


def assert_same(ours, theirs, close=CLOSE):
    """Displacements, turns, forces of drives and of joints."""
    groups = (slice(0, 3), slice(3, 6), slice(6, 12), slice(12, None))
    apart = [np.abs(ours[:, g] - theirs[:, g]).max() / np.abs(theirs[:, g]).max() for g in groups]
    assert (np.array(apart) < close).all()


OUTPUTS = ["tool", "force-sensor:drive", "joint-force"]
WRENCH = np.array([0.3, -0.2, 0.5, 0.05, 0.03, -0.04])


@pytest.mark.parametrize("signal", [sine, chirp])
@pytest.mark.parametrize("name", ["paper-robot", "machine-hexapod"])
def test_wrench(name, signal):
    given = at_rest(name)
    w = 10.0 * signal()[:, None] * WRENCH
    ours = extrapolated(by_exponential, fx.linearize(given, inputs="wrench", outputs=OUTPUTS), w)
    theirs = extrapolated(marched, given.replace(load=model.Load(wrench=model.CsvWrench(time=TIME, wrench=w))))
    assert_same(ours, theirs)


@pytest.mark.parametrize("signal", [sine, chirp])
def test_forces_of_drives(signal):
    feedback, f = model.Feedback(stiffness=2e7, damping=4e3), signal()
    share = np.array([1.0, -0.5, 0.3, 0.8, -1.0, 0.2])
    drives = [model.ForceDrive(law="csv", time=TIME, force=10.0 * f * x, feedback=feedback) for x in share]
    given = on_drives(*drives)
    ours = extrapolated(by_exponential, fx.linearize(given, inputs="drive", outputs=OUTPUTS), 10.0 * f[:, None] * share)
    assert_same(ours, extrapolated(marched, given))


@pytest.mark.parametrize("signal", [sine, chirp])
@pytest.mark.parametrize("kind", ["held", "servo"])
def test_commands(kind, signal):
    drive = model.PrescribedDrive() if kind == "held" else model.ServoDrive(stiffness=2e7, damping=4e3)
    given = on_drives(*[drive] * 6)
    rises = np.sin(np.pi * TIME / END) ** 4  # from rest to rest, with its rates
    way = 1e-6 * rises * signal()
    pose = way[:, None] * np.array([1.0, 0.0, 0.5, 0.0, 1.0, 0.3])
    given = given.replace(motion=model.CsvMotion(time=TIME, pose=pose))
    lin = fx.linearize(given, inputs="command", outputs=OUTPUTS)
    path = kinematics.poses(given.robot, given.motion, TIME)
    u = kinematics.inverse_kinematics(given.robot, path).accel
    ours, off = extrapolated(by_exponential, lin, u), path.part(slice(None, None, SHOWN))
    told = off.position + off.rotation @ given.robot.tool
    ours[:, :3] -= told - told[0]
    sag = fx.simulate(model.override(given, step=1e-4, output_step=1e-3, duration=1e-3)).isel(time=0)
    turned = pose[::SHOWN, 3:]
    ours[:, 3:6] += np.cross(turned, sag.rotation_deviation.values) - turned
    assert_same(ours, extrapolated(marched, given))


@pytest.mark.parametrize("signal", [sine, chirp])
@pytest.mark.parametrize("name", ["paper-robot", "machine-hexapod"])
def test_floor(name, signal):
    """Under a load that stands in the world, as weight does, while the floor turns below."""
    load = model.Load(wrench=model.ConstantWrench(value=[2e3, -1e3, 500.0, 100.0, -200.0, 150.0]))
    given = at_rest(name).replace(load=load)
    a = 0.1 * signal()[:, None] * np.array([1.0, 0.5, -0.7, 2.0, -1.0, 1.5])
    shaken = BaseMotion(time=TIME, values=a, at=[0.1, -0.2, 0.3])
    moved = given.replace(robot=given.robot.replace(base_motion=shaken))
    lin = fx.linearize(moved, inputs="floor", outputs=OUTPUTS)
    ours = extrapolated(by_exponential, lin, a)
    # ours turn with the base, as one that stands on it sees them; a march's turn with the world: sag and forces at rest
    rest = fx.simulate(model.override(given, step=1e-4, output_step=1e-3, duration=1e-3)).isel(time=0)
    turned = kinematics.base_law(moved.robot, TIME[::SHOWN]).position[:, 3:]
    ours[:, :3] += np.cross(turned, rest.tool_deviation.values)
    ours[:, 3:6] += np.cross(turned, rest.rotation_deviation.values)
    for k in range(6):
        ours[:, 12 + 3 * k : 15 + 3 * k] += np.cross(turned, rest.joint_force.values[k])
    assert_same(ours[:-1], extrapolated(marched, moved)[:-1])  # at its last row a table has ended


@pytest.mark.parametrize("signal", [sine, chirp])
def test_commands_of_carriages(signal):
    given = sample_study("hexaglide")
    way = 1e-7 * np.sin(np.pi * TIME / END) ** 4 * signal()
    given = given.replace(motion=model.CsvMotion(time=TIME, pose=way[:, None] * np.array([1.0, 0, 0.5, 0, 1.0, 0.3])))
    path = kinematics.poses(given.robot, given.motion, TIME)
    lin = fx.linearize(given, inputs="command", outputs=OUTPUTS)
    ours = extrapolated(by_exponential, lin, kinematics.inverse_kinematics(given.robot, path).chi_ddot)
    off = path.part(slice(None, None, SHOWN))
    told = off.position + off.rotation @ given.robot.tool
    theirs = extrapolated(marched, given)[:, :3]
    assert ours[:, :3] - told + told[0] == pytest.approx(theirs, abs=1e-5 * np.abs(theirs).max())


def test_drives_that_are_forces_alone():
    # pure forces start "moving", straight legs that fall into their sag: small forces more show in the difference of
    # two such marches. They are 16 um from the equilibrium about which the plant is linear: 1e-4 of what is seen,
    # and forces have more of the modes of kilohertz in them that are excited so
    share, hold = np.array([1.0, -0.5, 0.3, 0.8, -1.0, 0.2]), fx.preset("paper-robot").replace(motion=STILL)
    weight = fx.simulate(model.override(hold, step=1e-4, output_step=1e-3, duration=1e-3)).drive_force.values[0]

    def pushed(signal):
        force = [model.ForceDrive(law="csv", time=TIME, force=w + 10.0 * signal * x)
                 for w, x in zip(weight, share, strict=True)]  # fmt: skip
        return on_drives(*force).replace(initial=model.Initial(start="moving"))

    theirs = extrapolated(marched, pushed(sine())) - extrapolated(marched, pushed(0 * sine()))
    lin = fx.linearize(pushed(sine()), inputs="drive", outputs=OUTPUTS, drives="force")
    ours = extrapolated(by_exponential, lin, 10.0 * sine()[:, None] * share)
    assert_same(ours, theirs, (1e-4, 1e-4, 1e-9, 3e-3))


def test_what_is_left_is_of_the_second_order():
    # across its planes a tripod gives way to first order, and z follows by what that shortens, to second
    given, left = at_rest("tripod"), []
    for newton in (0.8, 0.4, 0.2):
        w = newton * sine(60.0)[:, None] * np.eye(6)[0]
        ours = extrapolated(by_exponential, fx.linearize(given, inputs="wrench", outputs=OUTPUTS), w)
        theirs = extrapolated(marched, given.replace(load=model.Load(wrench=model.CsvWrench(time=TIME, wrench=w))))
        left.append(np.abs(ours[:, 2] - theirs[:, 2]).max())
    assert left[0] / left[1] == pytest.approx(4, rel=0.1) and left[1] / left[2] == pytest.approx(4, rel=0.2)


def test_commands_of_loops_that_lag_about_the_stroke():
    loop = motors.with_loop(motors.LAGS, motors.BOTH, stiffness=500.0, damping=6.0, integral=2e3)
    robot = motors.Hand(loop).robot
    way = 1e-6 * np.sin(np.pi * TIME / END) ** 4 * sine(60.0)
    given = study(robot, fidelity="rigid").replace(motion=model.CsvMotion(time=TIME, pose=way[:, None] * np.eye(6)[2]))
    path = kinematics.poses(robot, given.motion, TIME)
    lin = fx.linearize(given, inputs="command", outputs=OUTPUTS)
    ours = extrapolated(by_exponential, lin, kinematics.inverse_kinematics(robot, path).accel)
    theirs = extrapolated(marched, given)[:, 2]
    assert ours[:, 2] - way[::SHOWN] == pytest.approx(theirs, abs=1e-5 * np.abs(theirs).max())
