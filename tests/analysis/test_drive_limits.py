"""What a path uses of the limits of screws and their motors, by Newton's law and the catalogue's formulas by hand."""

import numpy as np
import pytest
from tests.helpers.machines import SCREW, study, symmetric

from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.commissioning.feedforward.loaded_path import drive_limits
from flexapod.model import Limits, Rotor

pytestmark = pytest.mark.unit

LEAD, RATIO, ROTOR, EFFICIENCY, G, MASS = 0.01, 3.0, 2e-3, 0.9, 9.81, 1000.0


def test_shares_of_a_heavy_platform_that_rises_and_falls():
    """A ton on six screws alike, legs without mass: thrust, turns, inertia of rod and geared rotor, efficiency."""
    limits = Limits(force=5e3, speed=200.0, torque=12.0)
    screw = SCREW.replace(rotor=Rotor(inertia=ROTOR, ratio=RATIO), efficiency=EFFICIENCY, limits=limits)
    robot = symmetric(drive=screw).replace(gravity=[0, 0, -G])
    legs = tuple(
        leg.replace(piston=leg.piston.replace(rhoA=0.0, axial_inertia=0.0),
                    cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0, axial_inertia=0.0, com=0.0))
        for leg in robot.legs
    )  # fmt: skip
    given = study(robot.replace(legs=legs))
    motion = given.motion
    t = np.linspace(0.012, 0.088, 9)
    path = RigidPath(given, t)
    fast, strong = drive_limits(given, None, None, None).shares(path)

    # heave, its rate and acceleration from the path alone; legs stretch from one circle to the other
    z, rate, bend = path.poses.position[:, 2], path.poses.velocity[:, 2], path.poses.acceleration[:, 2]
    feet, tips = robot.base_joints, robot.platform_joints
    flat = np.linalg.norm((tips - feet)[0, :2])
    high = z + tips[0, 2] - feet[0, 2]
    length = np.hypot(flat, high)
    v = high / length * rate
    a = (rate**2 + high * bend - v**2) / length
    force = MASS * (G + bend) / (6 * high / length)
    turn = 2 * np.pi / LEAD
    polar = np.pi / 32 * screw.root_diameter**4
    inertia = screw.material.density * screw.length * polar + RATIO**2 * ROTOR
    # what pushes as it goes loses by friction, what is pushed back gains: of a rod that lifts T = F lead / 2 pi eta
    back = np.where(force * v > 0, 1 / EFFICIENCY, 2 - 1 / EFFICIENCY)
    torque = (force / turn * back + inertia * a * turn) / RATIO
    shares = {"speed": v * turn * RATIO / 200.0, "force": force / 5e3, "torque": torque / 12.0}
    assert fast[:, 1:] == pytest.approx(np.repeat(shares["speed"][:, None], 6, axis=1), rel=1e-6)
    for leg in range(6):
        assert strong[:, 1 + 2 * leg] == pytest.approx(shares["force"], rel=1e-6)
        assert strong[:, 2 + 2 * leg] == pytest.approx(shares["torque"], rel=1e-6)
    assert (torque > 0).any() and np.ptp(inertia * a * turn) > 1.0 and motion.type == "heave"
