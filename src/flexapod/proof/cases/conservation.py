"""What motion without losses must keep, and the balance of motion with them."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.study.actuator import simulate_actuator
from flexapod.study.simulation import simulate

STEPS = (1e-3, 5e-4)
LIGHT = 1e-9  # kg/m, of pistons


def _robot() -> model.Study:
    study = model.preset("paper-robot")
    return study.replace(motion=study.motion.replace(profile="smooth"))


def _balance() -> list[Check]:
    """Drift of the energy balance of the preset, which drives do work on, damping takes from, a wrench shakes."""
    shake = model.SineWrench(amplitude=np.array([60.0, -40, 30, 5, 4, -3]), frequency=3.0, phase=0.4)
    drift, work = [], 0.0
    for step in STEPS:
        data = simulate(_robot(), load=shake, step=step, output_step=2e-3, duration=1.2)
        stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        drift.append(float(np.ptp((stored - data.work_drive - data.work_external).values)))
        work = float(np.ptp(data.work_drive.values))
    return [
        Check(what="paper-robot, order of the balance", reference=2, ours=float(np.log2(drift[0] / drift[1])),
              tolerance=0.1, absolute=True),
        Check(what="paper-robot, drift of the balance over the work done", reference=0, ours=drift[1] / work,
              tolerance=1e-4, absolute=True),
    ]  # fmt: skip


def _beam() -> list[Check]:
    """Energy of an undamped beam let go from 5 mm, in a hub that is free to turn."""
    beam = model.Actuator(length=1.83, free_length=1.83, rhoA=4.02, EI=756.65, hub_inertia=2.0)
    motion = model.ActuatorMotion(rotation=None, extension=model.RateLaw(rate=0.0))
    data = simulate_actuator(
        beam,
        motion,
        load=model.ActuatorLoad(torque=model.ConstantLaw(value=0.0)),
        initial=model.ActuatorInitial(tip_displacement=5e-3),
        modes=1,
        step=STEPS[1],
        output_step=2e-3,
        duration=2.0,
    )
    energy = (data.energy_kinetic + data.energy_strain).values
    drift = float(np.ptp(energy) / energy[0])
    return [Check(what="free beam, drift of the energy", reference=0, ours=drift, tolerance=1e-5, absolute=True)]


def _payload() -> list[Check]:
    """A payload on legs of next to no mass, without weight and drive forces: nothing can change its momentum."""
    study = _robot()
    free = model.ForceDrive(law="csv", file="none", time=np.array([0.0, 1.0]), force=np.zeros(2))
    legs = [
        leg.replace(
            drive=free,
            damping=0.0,
            cylinder=leg.cylinder.replace(mass=0.0, com=0.0, inertia=0.0),
            piston=leg.piston.replace(rhoA=LIGHT, E=None, density=None, diameter=None),
        )
        for leg in study.robot.legs
    ]
    robot = study.robot.replace(legs=legs, gravity=[0, 0, 0])
    motion = model.CombinedMotion(amplitudes={"surge": 0.3, "heave": 0.1, "yaw": 0.2}, duration=1.0, profile="linear")
    study = study.replace(robot=robot, motion=motion, initial=model.Initial(start="moving"))
    data = simulate(study, fidelity="rigid", step=5e-4, output_step=5e-3, duration=0.1)
    t, com = data.time.values, data.com_position.values
    straight = com[0] + np.outer(t, com[1] - com[0]) / t[1]
    off = float(np.abs(com - straight).max() / np.abs(com[-1] - com[0]).max())
    kinetic = data.energy_kinetic.values
    return [
        Check(what="free payload, path off a straight line", reference=0, ours=off, tolerance=1e-9, absolute=True),
        Check(what="free payload, drift of the energy", reference=0, ours=float(np.ptp(kinetic) / kinetic[0]),
              tolerance=1e-9, absolute=True),
    ]  # fmt: skip


def _compute() -> list[Check]:
    return [*_balance(), *_beam(), *_payload()]


CONSERVATION = Case(
    name="conservation",
    statement="Energy balance of the driven and damped robot; energy of a free beam; momentum and energy of a "
    "free payload",
    source="laws of conservation",
    argument="the balance closes to the order of the method, two, and to a share of 1e-4; the energy of a vibration "
    "wavers by (omega h)^2 / 12; legs of 1e-9 kg/m are 1e-11 of the payload",
    compute=_compute,
)
