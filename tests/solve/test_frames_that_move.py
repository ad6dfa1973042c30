"""A base that is moved: against gravity changed, against a turned world, energy, reactions, small shakes in modes."""

import numpy as np
import pytest
from scipy.integrate import quad
from tests.helpers.machines import machine, study
from tests.helpers.runs import run_robot

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.kinematics import base_law, base_placed
from flexapod.model import Initial, ServoDrive, loads, preset_text
from flexapod.model.study.mount import BaseMotion, Mount

pytestmark = pytest.mark.consistency

A = np.array([0.7, -0.4, 1.1])
MOUNT = Mount(at=[0, 0, -0.1], stiffness=np.diag([3e8, 2e8, 5e8, 3e7, 2e7, 4e7]), mass=150.0, inertia=np.eye(3) * 8,
              loss=0.05)  # fmt: skip


def moved(of="acceleration", time=(0.0, 1.0), **axes):
    """A base moved along some of x, y, z, rx, ry, rz by rows over time."""
    values = np.zeros((len(time), 6))
    for name, rows in axes.items():
        values[:, ["x", "y", "z", "rx", "ry", "rz"].index(name)] = rows
    return BaseMotion(of=of, time=np.array(time), values=values, at=[0.1, 0.0, -0.2])


def given(robot, *, duration=0.1, step=5e-4, start="equilibrium", fidelity="lumped"):
    ours = study(robot, duration=duration, step=step, fidelity=fidelity)
    return ours.replace(initial=Initial(start=start))


@pytest.mark.parametrize("mount", [None, MOUNT], ids=["rigid", "mount"])
def test_a_base_that_is_moved_is_a_base_at_rest_in_other_gravity(mount):
    # In axes that move with the base, without turning, only gravity changes; the integrator is exact for the motion of
    # the base, a polynomial of second degree. What is left is rounding of index 3.
    damped = mount and mount.replace(
        loss=None, damping=1e-4 * MOUNT.stiffness
    )  # a loss factor asks for modes in gravity
    robot = machine().replace(base_mount=damped)
    accelerated = moved(**{name: [a, a] for name, a in zip("xyz", A, strict=True)})
    ours = run_robot(given(robot.replace(base_motion=accelerated), start="straight"))
    theirs = run_robot(given(robot.replace(gravity=robot.gravity - A), start="straight"))
    shift = 0.5 * A * ours["time"][:, None] ** 2
    np.testing.assert_allclose(ours["pose"][:, :3] - shift, theirs["pose"][:, :3], atol=1e-10)
    np.testing.assert_allclose(ours["pose"][:, 3:], theirs["pose"][:, 3:], atol=1e-10)
    np.testing.assert_allclose(ours["lam"], theirs["lam"], atol=1e-5)  # N, of 4 kN: index 3 magnifies


def test_a_base_turned_for_good_is_a_robot_in_turned_gravity():
    # Slowly to 20 deg of roll about a point beside the base, then at rest: the sag there in platform axes.
    angle, robot = np.deg2rad(20.0), machine(drive=ServoDrive(stiffness=1e8, damping=2e5))
    turned = moved("displacement", time=(0.0, 0.3), rx=[0.0, angle])
    ours = given(robot.replace(base_motion=turned), duration=0.7, step=1e-3)
    data = fx.run(ours.replace(motion=ours.motion.replace(amplitude=0.0)))
    R = base_placed(ours.robot.replace(base_motion=turned), np.array([0.5])).rotation[0]
    still = fx.modes(robot.replace(gravity=R.T @ robot.gravity), fidelity="lumped").com_sag.values
    # 0.4 s after the turn its vibration, 20 um at most, is down by exp(-0.17 x 203 x 0.4): 1e-6.
    np.testing.assert_allclose(R.T @ data.com_deviation.values[-1], still, atol=1e-9)
    assert np.abs(data.deviation_residual).max() < 1e-3 * np.abs(data.com_deviation).max()


@pytest.fixture(scope="module")
def shaken():
    """Runs on a base that moves along and about all axes, by step; its mount with losses."""
    shake = moved(time=(0.0, 0.02, 0.04, 0.1), x=[0, 8, -8, 0], z=[3, 0, -5, 0], rx=[0, 5, -5, 0], rz=[2, -4, 2, 0])
    robot = machine().replace(base_mount=MOUNT, base_motion=shake)
    return {h: fx.run(given(robot, step=h)) for h in (1e-3, 5e-4, 2.5e-4)}


def test_the_work_on_the_base_closes_the_balance_to_the_second_order(shaken):
    misses = []
    for data in shaken.values():
        kept = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        kept = kept - data.work_drive - data.work_external - data.work_base
        misses.append(float(np.abs(kept - kept[0]).max()))
    assert misses[0] / misses[1] > 3
    assert misses[1] / misses[2] > 3
    assert misses[2] < 1e-3 * float(np.abs(shaken[2.5e-4].work_base).max())


def test_the_force_on_the_base_is_the_weight_and_what_all_masses_take(shaken):
    # On its mount nothing has moved yet at the start; a rigid robot moves with its base.
    legs = 6 * (28.0 + 12.3 * 0.75)
    start = shaken[1e-3].base_motion_force.values[0]
    np.testing.assert_allclose(start, [0, 0, 9.81 * (1150.0 + legs)], rtol=1e-9, atol=1e-6)
    ours = given(machine().replace(base_motion=moved(z=[3.0, 3.0], x=[1.0, 1.0])), step=1e-3, fidelity="rigid")
    data = fx.run(ours.replace(motion=ours.motion.replace(amplitude=0.0)))
    expected = (1000.0 + legs) * np.array([1.0, 0.0, 12.81])
    np.testing.assert_allclose(
        data.base_motion_force.values[1:], np.tile(expected, (len(data.time) - 1, 1)), rtol=1e-6, atol=1e-2
    )


def test_a_small_shake_in_modes():
    # Linear model about rest, forced by the base's acceleration (T18.4), against the march. A step of 0.25 ms at 60 Hz
    # turns phases by (omega h)^2 / 12 of a period's angle: 1e-3; shapes are of the first order in the sag.
    from flexapod.kinematics import home_pose
    from flexapod.solve.linear.random_vibration import linear_robot
    from flexapod.solve.modal.at_poses import locked_poses

    robot, duration, h = machine().replace(base_mount=MOUNT), 0.12, 2.5e-4
    shake = moved(time=(0.0, 0.01, 0.02, 0.03, 1.0), x=[0, 0.02, -0.02, 0, 0])
    ours = given(robot.replace(base_motion=shake), duration=duration, step=h)
    ours = ours.replace(motion=ours.motion.replace(amplitude=0.0))
    data = fx.run(ours)
    found = (data.com_deviation - data.com_deviation[0]).values
    model = linear_robot(locked_poses(robot, ours.simulation, home_pose(robot)))
    real = np.isfinite(model.omega)
    w, D, tool = model.omega[real], model.damping[np.ix_(real, real)], model.tool[:, real]
    f = model.inputs["floor"][real][:, 0]
    # x'' / w^2 + D x' + x = f a in modes of unit stiffness, integrated finely by the exact exponential of each step
    from scipy.linalg import expm

    n, a = len(w), base_law(ours.robot, data.time.values).acceleration[:, 0]
    S = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w**2), -(w**2)[:, None] * D]])
    B = np.concatenate([np.zeros(n), w**2 * f])
    big = np.zeros((2 * n + 2, 2 * n + 2))
    dt = float(data.time[1] - data.time[0])
    big[: 2 * n, : 2 * n], big[: 2 * n, 2 * n], big[2 * n, 2 * n + 1] = S * dt, B * dt, 1.0
    step, y, path = expm(big), np.zeros(2 * n), [np.zeros(3)]
    for k in range(len(a) - 1):
        y = (step @ np.concatenate([y, [a[k], a[k + 1] - a[k]]]))[: 2 * n]
        path.append(tool[:3] @ y[:n])
    expected = np.array(path)
    np.testing.assert_allclose(found, expected, atol=5e-3 * np.abs(expected).max())


def test_accelerations_are_integrated_from_rest():
    robot = machine().replace(base_motion=moved(time=(0.0, 0.2, 0.2, 0.5), x=[1.0, 3.0, -2.0, 0.5]))
    t = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.8])
    law = base_law(robot, t)

    def a(s):
        return 1 + 10 * s if s < 0.2 else -2 + (s - 0.2) * 2.5 / 0.3 if s < 0.5 else 0.0

    for k, s in enumerate(t):
        v = quad(a, 0, s, points=[0.2, 0.5])[0]
        x = quad(lambda u, s=s: (s - u) * a(u), 0, s, points=[0.2, 0.5])[0]
        np.testing.assert_allclose([law.rate[k, 0], law.position[k, 0]], [v, x], atol=1e-12)


def test_a_table_of_the_base_is_read_and_refused(tmp_path):
    text = preset_text("paper-robot").replace("[robot]", '[robot]\nbase_motion = { file = "shake.csv" }', 1)
    table = tmp_path / "shake.csv"
    table.write_text("time [s], heave [m/s^2], roll [deg/s^2]\n0, 0, 0\n0.1, 1, 90\n", encoding="utf-8")
    read = loads(text, path=tmp_path / "study.toml").robot.base_motion
    np.testing.assert_allclose(read.values[1], [0, 0, 1, np.pi / 2, 0, 0])
    table.write_text("time [s], heave [mm]\n0, 0\n0.1, 1\n", encoding="utf-8")
    with pytest.raises(InputError, match="mm"):
        loads(text, path=tmp_path / "study.toml")
    shifted = text.replace('"shake.csv"', '"shake.csv", of = "displacement"')
    table.write_text("time [s], heave [mm]\n0, 2\n0.1, 1\n", encoding="utf-8")
    with pytest.raises(InputError, match="does not start where the base is drawn"):
        loads(shifted, path=tmp_path / "study.toml")
