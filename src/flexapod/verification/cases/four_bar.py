"""Two four-bar windows side by side, which pass through singular positions, by the robot's time integration."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.symbolic.vocabulary import SX, cos, dot, sin, time_derivative, vertcat, zeros
from flexapod.solve.time.recording import Recording
from flexapod.verification.case import Check, case
from flexapod.verification.mechanism import Mechanism, extrapolate_second_order, rest_motion, run_mechanism

LENGTH, MASS, GRAVITY, SPEED = 1.0, 1.0, 9.81, 1.0  # m, kg, m/s^2, m/s
DURATION, STEPS = 10.0, 40_000
END = (0.328458111533, 0.944518538181, 1.423051470, -0.494868845)
NAMES = ("x of B0", "y of B0", "rate of x", "rate of y")
UNITS = ("m", "m", "m/s", "m/s")


def _rod(centre: SX, turn: SX, q: SX, v: SX) -> tuple[SX, SX]:
    """Kinetic and potential energy of a uniform rod with its centre at a place (2,)."""
    speed = time_derivative(centre, (q, v))
    kinetic = 0.5 * MASS * (dot(speed, speed) + LENGTH**2 / 12 * turn**2)
    return kinetic, MASS * GRAVITY * centre[1]


def _branch(q: SX, v: SX, p: SX) -> tuple[SX, SX, SX]:
    """Upright and bar at x = -1 (p = -1) or +1 (p = 1) that end at the middle upright.

    Angles: of the upright from the vertical, of the bar from the horizontal; the third coordinate rests.
    """
    side, a, b = p[0], q[0], q[1]
    up, along = LENGTH * vertcat(sin(a), cos(a)), LENGTH * vertcat(cos(b), sin(b))
    foot = vertcat(side * LENGTH, 0)
    upright = _rod(foot + 0.5 * up, v[0], q, v)
    bar = _rod(foot + up - 0.5 * side * along, v[1], q, v)
    point = vertcat(foot + up - side * along, q[2])
    return upright[0] + bar[0] + 0.5 * v[2] ** 2, upright[1] + bar[1], point


def _hub(x: SX, u: SX) -> tuple[SX, SX, SX]:
    """The middle upright by its angle; the second coordinate goes with the first branch's third, the last rests."""
    up = LENGTH * vertcat(sin(x[0]), cos(x[0]))
    kinetic, potential = _rod(0.5 * up, u[0], x, u)
    points = vertcat(up, x[1], up, zeros(1))
    return kinetic + 0.5 * (u[1] ** 2 + u[2] ** 2), potential, points


def run(steps: int) -> list[Recording]:
    """The mechanism over 10 s in so many steps, from upright and B0 at 1 m/s: the start, and what follows."""
    windows = Mechanism(
        branch=_branch,
        hub=_hub,
        drive=rest_motion,
        shapes=0,
        parameters=np.array([[-1.0], [1.0]]),
        file=__file__,
    )
    u = np.array([SPEED / LENGTH, 0.0, 0.0])
    return run_mechanism(windows, np.zeros((2, 3)), np.zeros(3), np.stack([u, u]), u, DURATION, steps)


def end_state(steps: int) -> Array:
    """Place and velocity of B0, the top of the first upright, after 10 s."""
    final = run(steps)[-1]
    angle, rate = final.q[-1, 0, 0], final.v[-1, 0]
    c, s = np.cos(angle), np.sin(angle)
    return LENGTH * np.array([s, c, c * rate, -s * rate])


@case(
    "Two four-bar windows of rods of 1 m, five turns in 10 s and through a singular position twice a turn, "
    "in the compiled time integration of the robot; two step sizes extrapolated",
    source="IFToMM library of computational benchmark problems, A02, N = 2 (Gonzalez et al. 2006); B0 after 10 s by "
    "the one degree of freedom that unit links leave, 3 phi'' = 3.5 g sin phi",
    argument="nine printed decimals of the rates, 1e-9 of the smaller one; of two steps of a method of order two the "
    "error of order four, 1e-10",
)
def _four_bar() -> list[Check]:
    ours = extrapolate_second_order(end_state(STEPS), end_state(2 * STEPS)).tolist()
    return [Check(name, a, b, 2e-9, unit) for name, a, b, unit in zip(NAMES, END, ours, UNITS, strict=True)]
