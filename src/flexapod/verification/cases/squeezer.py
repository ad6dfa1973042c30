"""Andrews' squeezing mechanism, by the robot's time integration."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.symbolic.vocabulary import SX, cos, dot, sin, sqrt, time_derivative, vertcat, zeros
from flexapod.solve.time.recording import Recording
from flexapod.verification.case import Check, case, checks
from flexapod.verification.mechanism import Mechanism, extrapolate_second_order, run_mechanism

MASS = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)  # kg, bodies 1 to 7
INERTIA = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)  # kg m^2
A, B, C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)  # fixed points [m]
D, DA, E, EA, RR, RA = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
SS, SA, SB, SC, SD = 0.035, 0.01874, 0.01043, 0.018, 0.02
TA, TB, U, UA, UB, ZF, ZT, FA = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
SPRING, LENGTH, TORQUE = 4530.0, 0.07785, 0.033  # N/m, m, N m
DURATION, STEPS = 0.03, 20_000
# Angles beta, Theta, gamma, Phi, delta, Omega, epsilon [rad]
START = (
    -0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885,
    0.487364979543842550, -0.222668390165885885, 1.23054744454982119,
)  # fmt: skip
END = (
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
    0.5244099658805304, 0.5347301163226948, 1.048080741042263,
)  # fmt: skip
NAMES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")


def _body(i: int, place: SX, angle: SX, q: SX, v: SX) -> SX:
    """Kinetic energy of body i with its centre of mass at a place (2,) and its angle."""
    speed, turn = time_derivative(place, (q, v)), time_derivative(angle, (q, v))
    return 0.5 * (MASS[i - 1] * dot(speed, speed) + INERTIA[i - 1] * turn**2)


def _branch(q: SX, v: SX, p: SX) -> tuple[SX, SX, SX]:
    """The branch that p picks: body 3 with the spring, bodies 5 and 4, or bodies 7 and 6.

    Each has a third coordinate that rests: the length of body 3, which is given, or the way out of the plane.
    """
    a, b = q[0], q[1]
    ca, sa, cab, sab = cos(a), sin(a), cos(a + b), sin(a + b)
    arm = vertcat(B[0] + SA * sa + SB * ca, B[1] - SA * ca + SB * sa)
    hook = vertcat(B[0] + SC * sa + SD * ca - C[0], B[1] - SC * ca + SD * sa - C[1])
    fourth = vertcat(ZT * ca + (E - EA) * sab, ZT * sa - (E - EA) * cab)
    fifth = vertcat(TA * ca - TB * sa, TA * sa + TB * ca)
    sixth = vertcat(U * sa + (ZF - FA) * cab, -U * ca + (ZF - FA) * sab)
    seventh = vertcat(UA * sa - UB * ca, -UA * ca - UB * sa)
    out = 0.5 * v[2] ** 2
    kinetic = (
        _body(3, arm, a, q, v) + 0.5 * v[1] ** 2 + out,
        _body(5, fifth, a, q, v) + _body(4, fourth, a + b, q, v) + out,
        _body(7, seventh, a, q, v) + _body(6, sixth, a + b, q, v) + out,
    )
    point = (
        vertcat(B[0] + q[2] * sa, B[1] - q[2] * ca, b),
        vertcat(A[0] + E * sab + ZT * ca, A[1] - E * cab + ZT * sa, q[2]),
        vertcat(A[0] + ZF * cab + U * sa, A[1] + ZF * sab - U * ca, q[2]),
    )
    stored = p[0] * 0.5 * SPRING * (sqrt(dot(hook, hook)) - LENGTH) ** 2
    total, place = zeros(1), zeros(3)
    for i in range(3):
        total, place = total + p[i] * kinetic[i], place + p[i] * point[i]
    return total, stored, place


def _hub(x: SX, u: SX) -> tuple[SX, SX, SX]:
    """Bodies 1 and 2 in (beta, Theta), driven; the end of body 2 holds three branches."""
    beta, both = x[0], x[0] + x[1]
    first = vertcat(RA * cos(beta), RA * sin(beta))
    second = vertcat(RR * cos(beta) - DA * cos(both), RR * sin(beta) - DA * sin(both))
    point = vertcat(RR * cos(beta) - D * cos(both), RR * sin(beta) - D * sin(both), zeros(1))
    kinetic = _body(1, first, beta, x, u) + _body(2, second, both, x, u) + 0.5 * u[2] ** 2
    return kinetic, -TORQUE * beta, vertcat(point, point, point)


def run(steps: int) -> list[Recording]:
    """The mechanism from rest over 0.03 s in so many steps: the start, and what follows."""
    squeezer = Mechanism(
        branch=_branch,
        hub=_hub,
        drive=lambda t: (np.full_like(t, SS), np.zeros_like(t), np.zeros_like(t)),
        shapes=0,
        parameters=np.eye(3),
        file=__file__,
    )
    beta, theta, gamma, phi, delta, omega, epsilon = START
    q = np.array([[gamma, 0.0, SS], [delta, phi, 0.0], [epsilon, omega, 0.0]])
    return run_mechanism(squeezer, q, np.array([beta, theta, 0.0]), np.zeros((3, 3)), np.zeros(3), DURATION, steps)


def end_state(steps: int) -> Array:
    """The seven angles after 0.03 s."""
    final = run(steps)[-1]
    (gamma, *_), (delta, phi, _), (epsilon, omega, _) = final.q[-1, :3]
    return np.array([*final.pose[-1, :2], gamma, phi, delta, omega, epsilon])


@case(
    "Andrews' squeezing mechanism, seven bodies and six closures, after 0.03 s, in the compiled time "
    "integration of the robot; two step sizes extrapolated",
    source="Schiehlen 1990; Hairer & Wanner 1996, VII.7; test set for IVP solvers (Bari), problem andrews: data, and "
    "solution at 0.03 s",
    argument="of two steps of a method of order two the error of order four is left, 1e-10; each step is solved to "
    "1e-10 N m beside the torque of 0.033 N m, which over as many steps adds up to 1e-9",
)
def _squeezer() -> list[Check]:
    return checks(NAMES, END, extrapolate_second_order(end_state(STEPS), end_state(2 * STEPS)), 5e-9, "rad")
