"""What vibrates after a rest-to-rest turn."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.proof.cases.cantilever import ROOTS
from flexapod.solve.actuator_march import prepare_actuator
from flexapod.study.record import collect

TURN = 1e-4  # rad: centrifugal terms are 1e-9 of the others
STEPS = 20000
FIRST = 0.56882574  # int x phi_1 of the first eigenfunction with unit norm
TABLE = (("cycloidal", 10.0, 0.12510186), ("quintic", 10.0, 0.08083873))  # profile, omega T, residual over stroke


def _closed(profile: str, s: float) -> float:
    if profile == "cycloidal":
        return float(8 * np.pi**2 * abs(np.sin(s / 2)) / (s * abs(s**2 - 4 * np.pi**2)))
    return float(120 / s**5 * abs((12 - s**2) * np.sin(s / 2) - 6 * s * np.cos(s / 2)))


def residual(profile: str, s: float) -> float:
    """Amplitude of the first mode after the turn, over that of the base it stands on; s = omega T."""
    omega = ROOTS[0] ** 2
    duration = s / omega
    study = model.ActuatorStudy(
        actuator=model.Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0),
        motion=model.ActuatorMotion(rotation=model.ProfileLaw(law=profile, amplitude=TURN, duration=duration)),  # type: ignore[arg-type]
        simulation=model.Simulation(
            basis="clamped-free", modes=1, duration=1.1 * duration, step=duration / STEPS, output_step=duration / STEPS
        ),
    )
    march = prepare_actuator(study)
    a = collect(march.chunks, march.system.kernel.shapes.l_index, 1.1 * duration, None).q[STEPS:, 0, 2]
    t = omega * duration / STEPS * np.arange(len(a))
    waves = np.linalg.lstsq(np.stack([np.cos(t), np.sin(t)], axis=1), a, rcond=None)[0]
    return float(np.hypot(*waves) / (FIRST * TURN))


def _compute() -> list[Check]:
    rows = [*TABLE, *((profile, s, _closed(profile, s)) for profile, _, _ in TABLE for s in (5.0, 25.0))]
    return [
        Check(
            what=f"{profile}, omega T = {s:g}",
            reference=value,
            ours=residual(profile, s),
            tolerance=5e-8,
            absolute=True,
        )
        for profile, s, value in rows
    ]


RESIDUAL_VIBRATION = Case(
    name="residual-vibration",
    statement="Residual amplitude over stroke of a one-mode beam on a hub that turns from rest to rest",
    source="closed forms: 8 pi^2 |sin(s/2)| / (s |s^2 - 4 pi^2|), (120 / s^5) |(12 - s^2) sin(s/2) - 6 s cos(s/2)|",
    argument="the integrator shifts s by s (omega h)^2 / 12: 3e-8, 2e-7, 3e-6 at 5, 10, 25, where the slopes are below "
    "0.2, 0.1, 0.01; the integral of the shape is printed with eight digits",
    compute=_compute,
)
