"""Drives whose motor lags or whose loop is closed elsewhere than at the rotor, and a payload on six of them by hand."""

import numpy as np
from tests.helpers.machines import EVERYTHING, NUT, SCREW, light, machine, stiffness, symmetric

from flexapod.model import Encoder, Loop, Motor, Rotor

LOOP = Loop(stiffness=50.0, damping=0.5)
STEEL = SCREW.material.replace(E=1e15, density=1e-3)
#: A screw whose nut alone gives way, and a rotor: two masses on a spring.
PLAIN = SCREW.replace(
    command="servo", loop=LOOP, material=STEEL, rotor=Rotor(inertia=4e-3),
    bearing=SCREW.bearing.replace(stiffness=1e17), nut=NUT.replace(stiffness=2e7),
)  # fmt: skip
LAGS = Motor(bandwidth=150.0)
ROTOR, STROKE, BOTH = Encoder(), Encoder(at="stroke"), Encoder(at="stroke", rate="rotor")
JOINTS = Encoder(at="joint-to-joint", rate="rotor")


class Hand:
    """Six such drives whose legs have no mass lift a payload straight up: z, r, their rates, force, summed error."""

    def __init__(self, drive, **more):
        self.drive, self.robot = drive, light(symmetric(drive=drive), **more)
        self.reach = np.linalg.norm((self.robot.platform_joints - self.robot.base_joints)[0, :2])
        self.z0, self.M, self.ks = self.robot.home_position[2], self.robot.payload.mass, stiffness(self.robot)
        loop = drive.loop
        self.m, self.k, self.c, self.g = (
            x / drive.per_turn**2 for x in (drive.inertia, loop.stiffness, loop.damping, loop.integral)
        )
        self.tau = 1 / (2 * np.pi * drive.motor.bandwidth) if drive.motor.bandwidth else 0.0

    def length(self, z):
        return np.sqrt(z**2 + self.reach**2)

    def slope(self, z):
        return z / self.length(z)

    def asked(self, z, v, r, rate, total, command=0.0, command_rate=0.0):
        at_stroke, same = self.drive.encoder.at == "stroke", self.drive.encoder.rate == "same"
        measured = self.length(z) if at_stroke else r
        measured_rate = self.slope(z) * v if at_stroke and same else rate
        return self.k * (command - measured) + self.c * (command_rate - measured_rate) + self.g * total, measured

    def rates(self, x, command=0.0, command_rate=0.0, torque=0.0, weight=0.0):
        z, r, v, rate, P, total = x
        asked, measured = self.asked(z, v, r, rate, total, command, command_rate)
        asked += torque
        push = self.ks * (r - self.length(z))
        motor = P if self.tau else asked
        late = (asked - P) / self.tau if self.tau else 0.0
        acceleration = 6 * self.slope(z) * push / self.M - weight
        return np.array([v, rate, acceleration, (motor - push) / self.m, late, command - measured])

    def matrix(self):
        """Jacobian about home without weight, where no force is; by complex steps."""
        rest = np.array([self.z0, self.length(self.z0), 0.0, 0.0, 0.0, 0.0], dtype=complex)
        columns = [self.rates(rest + 1e-30j * e, command=self.length(self.z0)).imag / 1e-30 for e in np.eye(6)]
        return np.array(columns).T


def with_loop(motor=LAGS, encoder=BOTH, **loop):
    return PLAIN.replace(motor=motor, encoder=encoder, loop=LOOP.replace(**loop))


#: Loops of a machine whose every part gives way, inside of them or not.
GAINS = Loop(stiffness=500.0, damping=6.0, integral=2e3)


def real(encoder, motor=LAGS, **loop):
    drive = SCREW.replace(command="servo", loop=GAINS.replace(**loop), encoder=encoder, motor=motor)
    return machine(drive=drive, **EVERYTHING)


def mixed():
    """Legs about the stroke (summed), the rotor, the joints; at once about the stroke, the rotor, and that summed."""
    kinds = [real(BOTH), real(ROTOR, integral=0.0), real(JOINTS, integral=0.0),
             real(STROKE, Motor(), integral=0.0), real(ROTOR, Motor(), integral=0.0), real(ROTOR, Motor())]  # fmt: skip
    return kinds[0].replace(legs=tuple(x.legs[0] for x in kinds))
