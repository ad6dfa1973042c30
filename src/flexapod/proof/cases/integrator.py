"""What the time integration loses by itself."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.solve.actuator_march import prepare_actuator
from flexapod.study.record import collect

PERIODS, STEPS = 10, 200


def _compute() -> list[Check]:
    beam = model.Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0)
    omega = 1.875104068712**2
    period = 2 * np.pi / omega
    chi, turn = (1 - 0.9) / (1 + 0.9), 2 * np.pi / STEPS
    predicted = 1 - np.exp(-2 * np.pi * PERIODS * chi**3 * turn**3)
    simulation = model.Simulation(
        basis="clamped-free", modes=1, step=period / STEPS, output_step=period, duration=PERIODS * period, rho_inf=0.9
    )
    march = prepare_actuator(model.ActuatorStudy(actuator=beam, simulation=simulation), np.array([1e-3]), np.zeros(1))
    record = collect(march.chunks, march.system.kernel.shapes.l_index, PERIODS * period, None)
    energy = record.energy.sum(axis=1)
    lost = float(1 - energy[-1] / energy[0])
    return [Check(what="share of the energy lost in 10 periods", reference=float(predicted), ours=lost, tolerance=0.2)]


ENERGY_LOSS = Case(
    name="energy-loss",
    statement="Free vibration of a beam, rho_inf = 0.9, 200 steps a period",
    source="Chung & Hulbert 1993: damping ratio chi^3 (omega h)^3 / 2, chi = (1 - rho) / (1 + rho)",
    argument="leading term of the loss; the next ones are of relative size (omega h)^2 and the phase of the start",
    compute=_compute,
)
