"""Spectral radius, numerical damping and period of the time integration, measured on a vibrating beam."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.proof.cases.cantilever import ROOTS
from flexapod.solve.actuator_march import prepare_actuator
from flexapod.study.record import collect

RADIUS = ((0.0, 0.906563), (0.5, 0.989313), (0.8, 0.999475), (0.9, 0.999942))  # rho_inf, spectral radius at omega h = 1
SMALL = 0.05  # omega h
NEXT = 5 * SMALL**2  # what the next terms are of the leading ones, at most
STEPS = 60


def roots(rho: float, turn: float) -> NDArray[np.complex128]:
    """The three eigenvalues of a step with omega h = `turn`, from the marched amplitudes of one mode.

    The amplitude follows a recurrence of three terms; its coefficients by least squares.
    """
    step = turn / ROOTS[0] ** 2
    beam = model.Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0)
    settings = model.Simulation(
        basis="clamped-free", modes=1, step=step, output_step=step, duration=STEPS * step, rho_inf=rho
    )
    march = prepare_actuator(model.ActuatorStudy(actuator=beam, simulation=settings), np.array([1e-3]), np.zeros(1))
    a = 1e3 * collect(march.chunks, march.system.kernel.shapes.l_index, STEPS * step, None).q[:, 0, 2]
    past = np.stack([a[2:-1], a[1:-2], a[:-3]], axis=1)
    coefficients = np.linalg.lstsq(past, a[3:], rcond=None)[0]
    return np.roots([1.0, *-coefficients]).astype(np.complex128)


def _compute() -> list[Check]:
    found: list[Check] = []
    for rho, radius in RADIUS:
        ours = float(np.abs(roots(rho, 1.0)).max())
        found.append(Check(what=f"spectral radius, rho = {rho:g}", reference=radius, ours=ours, tolerance=1e-6))
    for rho, _ in RADIUS:
        values = roots(rho, SMALL)
        log = np.log(values[np.argmax(values.imag)])
        chi = (1 - rho) / (1 + rho)
        found += [
            Check(
                what=f"damping ratio, rho = {rho:g}, omega h = {SMALL:g}",
                reference=0.5 * chi**3 * SMALL**3,
                ours=float(-log.real / abs(log)),
                tolerance=NEXT,
            ),
            Check(
                what=f"longer period, rho = {rho:g}, omega h = {SMALL:g}",
                reference=SMALL**2 * (1 / 12 + 3 * chi**2 / 8),
                ours=float(SMALL / log.imag - 1),
                tolerance=NEXT,
            ),
        ]
    return found


GENERALIZED_ALPHA = Case(
    name="generalized-alpha",
    statement="Spectral radius at omega h = 1, damping ratio and longer period at 0.05 of a marched mode of a beam",
    source="Chung & Hulbert 1993; leading errors chi^3 (omega h)^3 / 2 and (omega h)^2 (1/12 + 3 chi^2 / 8)",
    argument="six printed digits; the next terms are some (omega h)^2 of the leading ones",
    compute=_compute,
)
