"""Weight of cranks: its moment on the drives by hand, and the energy that it takes."""

from types import SimpleNamespace

import numpy as np
import pytest
from casadi import DM
from scipy.spatial.transform import Rotation
from tests.helpers.mechanisms import six_rus
from tests.helpers.moving import moving
from tests.helpers.runs import balance, collect

import flexapod as fx
from flexapod.mechanics.elements.frames import Frame
from flexapod.mechanics.leg.joints import carriage
from flexapod.model.leg.joint import Carriage
from flexapod.solve.statics.ideal_robot import rigid_forces
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.consistency

MASS, COM = 4.0, 0.05


def heavy(robot, mass=MASS):
    legs = tuple(leg.replace(carriage=leg.carriage.replace(mass=mass, com=COM)) for leg in robot.legs)
    return robot.replace(legs=legs)


def test_the_drives_carry_it():
    """Torque about the shaft: m g times the horizontal distance of the centre of mass, across the shaft."""
    path = [fx.kinematics.poses_from_home(six_rus(), np.array([[0, 0, z, 0, 0, 0]])) for z in (0.0, 0.03)]
    for pose in path:
        robots = six_rus(), heavy(six_rus())
        none, with_mass = (
            rigid_forces(fx.kinematics.RigidPoses(robot, pose), np.zeros(6)).drive_force[0] for robot in robots
        )
        chi = fx.kinematics.inverse_kinematics(six_rus(), pose).coordinate("chi")[0][0] + six_rus().home_carriages
        for i, leg in enumerate(six_rus().legs):
            arm = Rotation.from_rotvec(chi[i] * leg.carriage.unit).apply(np.array(leg.carriage.arm))
            centre = COM * arm / np.linalg.norm(arm)
            lifts = leg.carriage.unit @ np.cross(centre, [0, 0, MASS * 9.81])
            assert with_mass[i] - none[i] == pytest.approx(lifts, abs=1e-9)


def test_its_energy_is_in_the_balance():
    """Second order: the balance of flexible legs on heavy cranks closes four times as well with half the step."""
    errors = []
    for h in (1e-3, 5e-4):
        study = moving("6-RUS", step=h)
        run = collect(prepare(study.replace(robot=heavy(study.robot))).chunks)
        errors.append(np.ptp(balance(run)) / np.ptp(run["energy"][:, 1]))
    assert errors[1] < 2e-3
    assert errors[1] < 0.35 * errors[0]


def test_a_crank_of_point_masses_on_a_base_that_moves():
    """Half of the masses times the squares of their velocities, the base moving along all axes and about the shaft."""
    rng = np.random.default_rng(8)
    masses, out, shaft, arm = np.array([1.0, 2.5]), np.array([0.04, 0.11]), np.array([0.3, -0.1, 0.2]), 0.12
    axis, along = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    com = masses @ out / masses.sum()
    p = {"R0": np.eye(3), "base": shaft + arm * along, "carriage_axis": axis, "carriage_arm": arm * along,
         "carriage_com": com * along, "carriage_mass": masses.sum(), "carriage_inertia": masses @ out**2,
         "gravity": np.array([0, 0, -9.81])}  # fmt: skip
    chi, rate, spin, velocity = 0.7, 3.0, -2.0, rng.normal(size=3)
    base = Frame(origin=DM(np.zeros(3)), axes=DM.eye(3), velocity=DM(velocity), omega=DM(spin * axis))
    numbers = SimpleNamespace(**{name: DM(np.ravel(x)) for name, x in p.items()})
    _, found = carriage("crank", numbers, SimpleNamespace(chi=DM(chi)), SimpleNamespace(chi=DM(rate)), base)
    places = shaft + Rotation.from_rotvec(chi * axis).apply(out[:, None] * along)
    rates = velocity + np.cross(spin * axis, places) + np.cross(rate * axis, places - shaft)
    assert float(found.kinetic) == pytest.approx(0.5 * masses @ (rates**2).sum(axis=1), rel=1e-14)
    assert float(found.gravity) == pytest.approx(9.81 * masses @ places[:, 2], rel=1e-14)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"kind": "slider", "com": 0.1}, "belongs to a crank"),
        ({"kind": "crank", "arm": [0.1, 0, 0], "mass": 2.0, "com": 0.1, "inertia": 0.01}, "is less than that of the"),
    ],
)
def test_what_no_crank_has_is_refused(parts, message):
    with pytest.raises(fx.InputError, match=message):
        Carriage(axis=[0, 0, 1], **parts)
