"""Accuracy of the time integration: numerical damping, residual amplitudes, balances of energy and momentum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.results.time_history import Record, collect
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.bending import ROOTS

PERIODS, A_PERIOD = 10, 200
BEAM = model.Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0)


def _marched(study: model.ActuatorStudy, *amplitudes: Array) -> Record:
    march = prepare_actuator(study, *amplitudes)
    return collect(march.chunks, (), study.duration, None)


def _released(**settings: float) -> Record:
    """Record of one mode released at rest from an amplitude of 1e-3."""
    study = model.ActuatorStudy(actuator=BEAM, simulation=model.Simulation(basis="clamped-free", modes=1, **settings))  # type: ignore[arg-type]
    return _marched(study, np.array([1e-3]), np.zeros(1))


@case(
    "Free vibration of a beam, rho_inf = 0.9, 200 steps a period",
    source="Chung & Hulbert 1993: damping ratio chi^3 (omega h)^3 / 2, chi = (1 - rho) / (1 + rho)",
    argument="leading term of the loss; the next ones are of relative size (omega h)^2 and the phase of the start",
)
def _energy_loss() -> list[Check]:
    period = 2 * np.pi / ROOTS[0] ** 2
    chi, turn = (1 - 0.9) / (1 + 0.9), 2 * np.pi / A_PERIOD
    predicted = 1 - np.exp(-2 * np.pi * PERIODS * chi**3 * turn**3)
    record = _released(rho_inf=0.9, step=period / A_PERIOD, output_step=period, duration=PERIODS * period)
    energy = record.energy.sum(axis=1)
    lost = float(1 - energy[-1] / energy[0])
    return [Check("share of the energy lost in 10 periods", float(predicted), lost, 0.2)]


RADIUS = ((0.0, 0.906563), (0.5, 0.989313), (0.8, 0.999475), (0.9, 0.999942))  # rho_inf, spectral radius at omega h = 1
SMALL = 0.05  # omega h
NEXT = 5 * SMALL**2  # what the next terms are of the leading ones, at most
MARCHED = 60


def roots(rho: float, turn: float) -> NDArray[np.complex128]:
    """The three eigenvalues of a step with omega h = `turn`, from the marched amplitudes of one mode.

    The amplitude follows a recurrence of three terms; its coefficients by least squares.
    """
    step = turn / ROOTS[0] ** 2
    a = 1e3 * _released(rho_inf=rho, step=step, output_step=step, duration=MARCHED * step).q[:, 0, 2]
    past = np.stack([a[2:-1], a[1:-2], a[:-3]], axis=1)
    coefficients = np.linalg.lstsq(past, a[3:], rcond=None)[0]
    return np.roots([1.0, *-coefficients]).astype(np.complex128)


@case(
    "Spectral radius at omega h = 1, damping ratio and longer period at 0.05 of a marched mode of a beam",
    source="Chung & Hulbert 1993; leading errors chi^3 (omega h)^3 / 2 and (omega h)^2 (1/12 + 3 chi^2 / 8)",
    argument="six printed digits; the next terms are some (omega h)^2 of the leading ones",
)
def _generalized_alpha() -> list[Check]:
    found = [
        Check(f"spectral radius, rho = {rho:g}", radius, float(np.abs(roots(rho, 1.0)).max()), 1e-6)
        for rho, radius in RADIUS
    ]
    for rho, _ in RADIUS:
        values = roots(rho, SMALL)
        log = np.log(values[np.argmax(values.imag)])
        chi = (1 - rho) / (1 + rho)
        names = [f"{what}, rho = {rho:g}, omega h = {SMALL:g}" for what in ("damping ratio", "longer period")]
        exact = 0.5 * chi**3 * SMALL**3, SMALL**2 * (1 / 12 + 3 * chi**2 / 8)
        found += checks(names, exact, [-log.real / abs(log), SMALL / log.imag - 1], NEXT)
    return found


TURN = 1e-4  # rad: centrifugal terms are 1e-9 of the others
A_TURN = 20000
FIRST = 0.56882574  # int x phi_1 of the first eigenfunction with unit norm
TABLE = (("cycloidal", 10.0, 0.12510186), ("quintic", 10.0, 0.08083873))  # profile, omega T, residual over stroke


def residual_share(profile: str, s: float) -> float:
    """Amplitude that a turn or way of this profile leaves of an oscillator, over its size; s = omega T."""
    if profile == "cycloidal":
        return float(8 * np.pi**2 * abs(np.sin(s / 2)) / (s * abs(s**2 - 4 * np.pi**2)))
    return float(120 / s**5 * abs((12 - s**2) * np.sin(s / 2) - 6 * s * np.cos(s / 2)))


def residual_amplitude(profile: str, s: float) -> float:
    """Amplitude of the first mode after the turn, over that of the base it stands on; s = omega T."""
    omega = ROOTS[0] ** 2
    duration = s / omega
    step = duration / A_TURN
    study = model.ActuatorStudy(
        actuator=BEAM,
        motion=model.ActuatorMotion(rotation=model.ProfileLaw(law=profile, amplitude=TURN, duration=duration)),  # type: ignore[arg-type]
        simulation=model.Simulation(
            basis="clamped-free", modes=1, duration=1.1 * duration, step=step, output_step=step
        ),
    )
    a = _marched(study).q[A_TURN:, 0, 2]
    t = omega * step * np.arange(len(a))
    waves = np.linalg.lstsq(np.stack([np.cos(t), np.sin(t)], axis=1), a, rcond=None)[0]
    return float(np.hypot(*waves) / (FIRST * TURN))


@case(
    "Residual amplitude over stroke of a one-mode beam on a hub that turns from rest to rest",
    source="closed forms: 8 pi^2 |sin(s/2)| / (s |s^2 - 4 pi^2|), (120 / s^5) |(12 - s^2) sin(s/2) - 6 s cos(s/2)|",
    argument="the integrator shifts s by s (omega h)^2 / 12: 3e-8, 2e-7, 3e-6 at 5, 10, 25, where the slopes are "
    "below 0.2, 0.1, 0.01; the integral of the shape is printed with eight digits",
)
def _residual_vibration() -> list[Check]:
    rows = [*TABLE, *((profile, s, residual_share(profile, s)) for profile, _, _ in TABLE for s in (5.0, 25.0))]
    return [
        Check(f"{profile}, omega T = {s:g}", value, residual_amplitude(profile, s), 5e-8, absolute=True)
        for profile, s, value in rows
    ]


HALVED = (1e-3, 5e-4)
LIGHT = 1e-9  # kg/m, of pistons


def _robot() -> model.Study:
    study = model.preset("paper-robot")
    return study.replace(motion=study.motion.replace(profile="smooth"))


def _balance() -> list[Check]:
    """Order and drift of the preset's energy balance, with drives, damping and an oscillating wrench."""
    shake = model.SineWrench(amplitude=np.array([60.0, -40, 30, 5, 4, -3]), frequency=3.0, phase=0.4)
    runs = [simulate(_robot(), load=shake, step=step, output_step=2e-3, duration=1.2) for step in HALVED]
    return balance_checks("paper-robot, ", runs, 1e-4)


def balance_checks(of: str, runs: Sequence[xr.Dataset], drifting: float) -> list[Check]:
    """Order of the energy balance of two runs, the second with half the steps, and how far it drifts."""
    drift = []
    for data in runs:
        stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        drift.append(float(np.ptp((stored - data.work_drive - data.work_external).values)))
    share = drift[1] / float(np.ptp(runs[1].work_drive.values))
    return [
        Check(f"{of}order of the balance", 2, float(np.log2(drift[0] / drift[1])), 0.1, absolute=True),
        Check(f"{of}drift of the balance over the work done", 0, share, drifting, absolute=True),
    ]


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
        step=HALVED[1],
        output_step=2e-3,
        duration=2.0,
    )
    energy = (data.energy_kinetic + data.energy_strain).values
    drift = float(np.ptp(energy) / energy[0])
    return [Check("free beam, drift of the energy", 0, drift, 1e-5, absolute=True)]


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
        Check("free payload, path off a straight line", 0, off, 1e-9, absolute=True),
        Check("free payload, drift of the energy", 0, float(np.ptp(kinetic) / kinetic[0]), 1e-9, absolute=True),
    ]


@case(
    "Energy balance of the driven and damped robot; energy of a free beam; momentum and energy of a free payload",
    source="laws of conservation",
    argument="the balance closes to the order of the method, two, and to a share of 1e-4; the energy of a vibration "
    "wavers by (omega h)^2 / 12; legs of 1e-9 kg/m are 1e-11 of the payload",
)
def _conservation() -> list[Check]:
    return [*_balance(), *_beam(), *_payload()]
