"""A Tricept: what its passive leg bears, and the energy of its motion."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.model import AxisMotion, ServoDrive, Study
from flexapod.proof.case import Case, Check
from flexapod.proof.parallel_robots import tricept
from flexapod.solve.released import rigid_forces
from flexapod.study.simulation import simulate

WRENCH = np.array([30.0, -20, -100, 5, 4, 3])
STEPS = (5e-4, 2.5e-4)
SOFT = ServoDrive(stiffness=1e6, damping=2e3)  # some 40 Hz with the platform


def _passive() -> list[Check]:
    robot = tricept()
    guide = robot.legs[3]
    bare = guide.replace(
        cylinder=guide.cylinder.replace(mass=0.0, com=0.0, inertia=0.0), piston=guide.piston.replace(rhoA=0.0)
    )
    robot = robot.replace(legs=(*robot.legs[:3], bare))
    motion = model.CombinedMotion(amplitudes={"heave": 0.03, "roll": 0.2, "pitch": -0.1}, duration=0.5)
    path = rigid.poses(robot, motion, np.array([0.0, 0.1, 0.2, 0.4]))
    forces = rigid_forces(robot, path, WRENCH)
    axes = rigid.leg_axes(robot, path, rigid.inverse_kinematics(robot, path))[:, 3]
    force = forces.joint_force[:, 3]
    size = float(np.abs(forces.joint_force).max())
    along = float(np.abs((force * axes).sum(axis=-1)).max()) / size
    return [
        Check(what="force along the passive leg", reference=0, ours=along, tolerance=1e-11, absolute=True),
        Check(what="its drive's force", reference=0, ours=float(np.abs(forces.drive_force[:, 3]).max()) / size,
              tolerance=1e-11, absolute=True),
    ]  # fmt: skip


TRICEPT_GUIDE = Case(
    name="tricept-guide",
    statement="Force along the passive leg of a moving, loaded Tricept whose guide weighs nothing, over the largest "
    "joint force",
    source="it slides freely: nothing pushes along it",
    argument="rounding times the condition of the closures, some ten to a hundred",
    compute=_passive,
)


def _energy() -> list[Check]:
    robot = tricept()
    legs = tuple(
        leg.replace(damping=0.01, axial_modes=0, **({} if leg.passive else {"drive": SOFT})) for leg in robot.legs
    )
    motion = AxisMotion(type="heave", amplitude=0.03, duration=0.1, profile="smooth")
    study = Study(
        robot=robot.replace(legs=legs), motion=motion, simulation=model.preset("paper-robot").simulation,
        initial=model.Initial(start="straight"),
    )  # fmt: skip
    drift, work = [], 0.0
    for step in STEPS:
        data = simulate(study, modes=1, step=step, output_step=2e-3, duration=0.12)
        stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        drift.append(float(np.ptp((stored - data.work_drive - data.work_external).values)))
        work = float(np.ptp(data.work_drive.values))
    return [
        Check(what="order of the balance", reference=2, ours=float(np.log2(drift[0] / drift[1])), tolerance=0.1,
              absolute=True),
        Check(what="drift of the balance over the work done", reference=0, ours=drift[1] / work, tolerance=2e-4,
              absolute=True),
    ]  # fmt: skip


TRICEPT_ENERGY = Case(
    name="tricept-energy",
    statement="Energy balance of a flexible, damped Tricept on soft drives that rises by 30 mm in 0.1 s",
    source="conservation of energy",
    argument="the order of the method, two, and (omega h)^2 / 12 at 40 to 100 Hz of what vibrates",
    compute=_energy,
)
