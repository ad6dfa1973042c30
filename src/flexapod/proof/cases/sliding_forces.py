"""Torque and force that a stiff beam asks of hub and feed while it turns and slides."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.study.actuator import simulate_actuator
from flexapod.typing import Array

LENGTH, FREE, RHOA, TIP, HUB, GRAVITY, ANGLE = 3.66, 1.5, 4.02, 1.3, 0.7, 9.81, 0.3
TURN, FEED, DURATION = 1.2, 0.8, 1.0
INSTANTS = (0.1, 0.3, 0.5, 0.7, 0.9)


def _law(stroke: float) -> model.ProfileLaw:
    return model.ProfileLaw(law="quintic", amplitude=stroke, duration=DURATION)


def _quintic(t: Array, stroke: float) -> tuple[Array, Array, Array]:
    """10 t^3 - 15 t^4 + 6 t^5 times the stroke, with its rates."""
    s = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6]) * stroke
    return s(t), s.deriv(1)(t), s.deriv(2)(t)


def expected(t: Array) -> tuple[Array, Array]:
    """Torque [N m] and force [N] of the rigid beam."""
    turned, rate, push = _quintic(t, TURN)
    fed, speed, pull = _quintic(t, FEED)
    angle, length = ANGLE + turned, FREE + fed
    inertia = HUB + RHOA * (length**3 - (length - LENGTH) ** 3) / 3 + TIP * length**2
    first = RHOA * (2 * length * LENGTH - LENGTH**2) / 2 + TIP * length
    mass = RHOA * LENGTH + TIP
    torque = inertia * push + 2 * first * speed * rate + GRAVITY * np.cos(angle) * first
    return torque, mass * pull - first * rate**2 + mass * GRAVITY * np.sin(angle)


def _compute() -> list[Check]:
    beam = model.Actuator(
        length=LENGTH,
        free_length=FREE,
        rhoA=RHOA,
        EI=756.65,
        tip_mass=TIP,
        hub_inertia=HUB,
        gravity=GRAVITY,
        angle=ANGLE,
    )
    motion = model.ActuatorMotion(rotation=_law(TURN), extension=_law(FEED))
    data = simulate_actuator(beam, motion, fidelity="rigid", step=0.01, output_step=0.1, duration=DURATION)
    at = data.sel(time=list(INSTANTS), method="nearest")
    torque, force = expected(np.array(INSTANTS))
    rows = (("torque", torque, at.torque.values, "N m"), ("force", force, at.force.values, "N"))
    return [
        Check(what=f"{what} at {t:g} s", reference=float(a), ours=float(b), tolerance=1e-10, unit=unit)
        for what, theirs, ours, unit in rows
        for t, a, b in zip(INSTANTS, theirs, ours, strict=True)
    ]


SLIDING_FORCES = Case(
    name="sliding-forces",
    statement="Torque and force of a rigid beam with a tip mass, turning by 1.2 rad and sliding by 0.8 m",
    source="equations of motion of the sliding link without bending, written by hand",
    argument="both are closed forms of the same instant: rounding",
    compute=_compute,
)
