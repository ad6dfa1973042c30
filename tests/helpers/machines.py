"""A machine for tests of real parts: six electric cylinders under a platform of a ton, between joints that give way."""

from __future__ import annotations

import numpy as np
from tests.helpers.mechanisms import LOWER, UPPER, built, ring

from flexapod.model import MATERIALS, Bearing, Nut, Rotor, ScrewDrive, Study
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston
from flexapod.model.motion import AxisMotion
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
