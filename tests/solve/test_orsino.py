"""Printed forces of planar robots (Orsino, Hess-Coelho & Malvezzi 2021), by the general equations in a plane."""

import numpy as np
import pytest
from tests.oracles.mechanism_cases import orsino_motion

from flexapod.kinematics import RigidPoses
from flexapod.kinematics.laws import Law
from flexapod.kinematics.trajectory import Poses, poses_from_coordinates
from flexapod.model import Home, Robot, Simulation
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Carriage
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston, Strut
from flexapod.model.study.payload import Payload
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.rigid_forces import joint_forces

pytestmark = pytest.mark.literature

STIFF = {"EA": 1e8, "EI": 1e4}


def robot(mixed):
    """Sliders on the line y = 0, each to the left of its rod; or an RPR about the origin in place of the first."""

    def rod(length, mass):
        carriage = Carriage(kind="slider", axis=[1, 0, 0], mass=1.0, side=-1)
        return Leg(chain="PRR", carriage=carriage, strut=Strut(length=length, rhoA=mass / length, **STIFF))

    legs = [rod(1.0, 0.5), rod(0.8, 0.4), rod(1.0, 0.5)]
    if mixed:
        cylinder = Cylinder(mass=1.0, com=0.0, inertia=1 / 48, mouth=0.5)
        legs[0] = Leg(chain="RPR", cylinder=cylinder, piston=Piston(length=1.0, rhoA=0.5, **STIFF))
    bar = 2 * 0.25 / 3
    return Robot(
        type="RPR+2-PRR" if mixed else "3-PRR", plane="xy", base_joints=np.zeros((3, 3)),
        platform_joints=[[-0.5, 0, 0], [0, 0, 0], [0.5, 0, 0]], home=Home(position=[2.0, 0.3, 0.0]),
        gravity=[0, -9.8, 0],
        payload=Payload(mass=2.0, inertia=[bar, bar, bar], com=[0, 0, 0]), legs=legs,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("mixed", "printed"),
    [(False, [-221.31533, 443.30184, -357.50533]), (True, [-184.96848, 423.29547, -351.61880])],
)
def test_printed_forces(mixed, printed):
    study = robot(mixed)
    law = [np.zeros((1, 6)) for _ in range(3)]
    for part, values in zip(law, orsino_motion(0.05), strict=True):
        part[0, [0, 1, 5]] = values
    path = poses_from_coordinates(Poses.at_rest(study.home_position, study.home_rotation), Law(*law), np.zeros(3))
    system = robot_system(study, Simulation(fidelity="rigid"), 0.0)
    held = joint_forces(system, *rigid_motion(system, RigidPoses(study, path)), np.zeros(6)).held[0]
    driven = [system.kernel.shapes.index("l" if leg.driven == "stroke" else "chi") for leg in study.legs]
    np.testing.assert_allclose(held[np.arange(3), driven], printed, rtol=0, atol=5.1e-6)  # five decimals
