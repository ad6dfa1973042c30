"""A machine for tests of real parts: six electric cylinders under a platform of a ton, between joints that give way."""

from __future__ import annotations

import numpy as np
from tests.helpers.mechanisms import LOWER, UPPER, built, ring

from flexapod.mechanics.elements.springs import series_stiffness, springs_along
from flexapod.model import (
    MATERIALS,
    AxialSpring,
    Bearing,
    Feedback,
    HydraulicDrive,
    JointFriction,
    Loop,
    Motor,
    Nut,
    Rotor,
    ScrewDrive,
    ScrewFriction,
    Study,
    Tube,
)
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston
from flexapod.model.motion import AxisMotion
from flexapod.model.study.mount import BaseMotion, Mount
from flexapod.model.study.payload import Payload
from flexapod.model.study.simulation import Simulation

TON = Payload(mass=1000.0, inertia=np.diag([120.0, 120.0, 180.0]), com=[0.02, 0.01, 0.15])
BODY = Cylinder(mass=28.0, com=0.3, inertia=2.1, axial_inertia=0.05, mouth=0.6)
TUBE = Piston(length=0.75, EA=3.3e8, EI=1.07e5, rhoA=12.3, axial_inertia=0.004)
SOFT = Joint(stiffness=np.diag([150e6, 150e6, 200e6, 0, 0, 0]), leg_axes=True)
STIFF = Joint()


def leg(**more):
    """A leg with ideal parts but for what is given."""
    return Leg(**{"cylinder": BODY, "piston": TUBE, "damping": 0.005, **more})


def machine(*, payload=TON, lower=LOWER, upper=UPPER, **more):
    """6-UPS on circles of 0.7 and 0.4 m, 1.0 m high; `more`: parts of its legs."""
    return built("6-UPS", ring(0.7, lower), ring(0.4, upper), 1.0, [leg(**more)] * 6, payload=payload)


def symmetric(**more):
    """The same with a payload that keeps its threefold symmetry."""
    payload = Payload(mass=1000.0, inertia=np.diag([120.0, 120.0, 180.0]), com=[0.0, 0.0, 0.15])
    return machine(payload=payload, **more)


def study(robot, *, duration=0.2, **simulation):
    """A quick heave of 20 mm, and as long at rest."""
    motion = AxisMotion(type="heave", amplitude=0.02, duration=0.1, hold=0.1)
    return Study(robot=robot, motion=motion, simulation=Simulation(**{"duration": duration, **simulation}))


BEARING = Bearing(stiffness=780e6, position=0.06)
NUT = Nut(stiffness=850e6)
SCREW = ScrewDrive(
    lead=0.01, root_diameter=0.02874, length=0.9, material=MATERIALS["steel"], bearing=BEARING, nut=NUT,
    rotor=Rotor(inertia=2e-3),
)  # fmt: skip


def light(robot, **more):
    """The robot without gravity and without masses in its legs."""
    legs = tuple(
        leg.replace(piston=leg.piston.replace(rhoA=0.0, axial_inertia=0.0),
                    cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0, axial_inertia=0.0, com=0.0))
        for leg in robot.legs
    )  # fmt: skip
    return robot.replace(legs=legs, **more)


STILL = {"gravity": [0, 0, 0]}
EVERYTHING = {"base_joint": SOFT, "platform_joint": SOFT, "springs": (AxialSpring(name="bracket", stiffness=5e8),)}


def stiffness(robot, place="nut"):
    """Of the springs at a place of the first leg, at home [N/m]."""
    springs = [spring for spring in springs_along(robot.legs[0]) if spring.at == place]
    return series_stiffness(springs, robot.home_lengths[0], 0.0)[0]


OIL = HydraulicDrive(
    bore=0.08, rod=0.056, stroke=0.5, bottom=0.05, dead_volume=[1e-4, 3e-4], bulk_modulus=1.2e9, leakage=1e-12
)

#: A frame below the machine and a plate below its payload, on springs.
K = np.diag([3e8, 2e8, 5e8, 3e7, 2e7, 4e7]) + 0.0
K[0, 4] = K[4, 0] = 2e7
K[1, 2] = K[2, 1] = -5e7
BASE = Mount(at=[0.05, -0.02, -0.1], stiffness=K, mass=150.0, inertia=np.diag([6.0, 7.0, 10.0]))
TOP = Mount(at=[0.01, 0.03, 0.04], stiffness=0.6 * K, mass=30.0, inertia=np.diag([1.0, 1.5, 2.0]))

#: Coordinates without mass, and some with.
MOUNT = Mount(stiffness=np.diag([3e8, 3e8, 5e8, 1e8, 1e8, 1e8]))
HEAVY = MOUNT.replace(mass=400.0, inertia=np.diag([40.0, 40.0, 70.0]))
PLATE = Mount(stiffness=np.diag([8e8, 8e8, 9e8, 3e7, 3e7, 3e7]))
LIGHT = TUBE.replace(rhoA=0.0, axial_inertia=0.0)
SERVO = SCREW.replace(command="servo", loop=Feedback(stiffness=5e3, damping=20.0))

#: Parts of which each brings numbers or coordinates of its own.
RUBS = SOFT.replace(friction=JointFriction(moment=2.0))
SPRUNG = Mount(stiffness=np.diag([3e8, 2e8, 5e8, 3e7, 2e7, 4e7]))
MOVED = BaseMotion(of="acceleration", time=np.array([0.0, 1.0]), values=np.zeros((2, 6)))
LAGGING = SCREW.replace(
    command="servo", loop=Loop(stiffness=50.0, damping=0.5, integral=9.0), motor=Motor(bandwidth=150.0),
    friction=ScrewFriction(torque=0.5), nut=NUT.replace(backlash=1e-5),
)  # fmt: skip
THICK = Piston.round(length=0.75, section=Tube(diameter=0.1), material=MATERIALS["steel"], shear=True)
