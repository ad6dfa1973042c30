"""A slider-crank with a flexible connecting rod, by the robot's time integration."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.symbolic.vocabulary import SX, bilinear, constant, cos, dot, quadratic, sin, vertcat, zeros
from flexapod.verification.case import Check, case
from flexapod.verification.mechanism import Mechanism, extrapolate_second_order, run_mechanism

CRANK, ROD, SIDE = 0.15, 0.30, 0.008  # m; the rod is square
DENSITY, E = 7870.0, 2e11
CRANK_INERTIA, ROD_MASS, ROD_INERTIA, SLIDER_MASS = 0.002727, 0.151104, 0.0045339259, 0.075552
SPEED, DURATION = 150.0, 0.1  # rad/s, s
START = (0.0, 0.0, 1.033398630e-5, 1.693279690e-5)  # two sines of bending; middle and end of axial displacement [m]
START_RATES = (4.448961125815990e-1, 4.634339319238670e-3, -1.785910760000550e-6, -2.689386719979040e-6)
END = (
    -0.3311734987910881, 0.1697373326718410,
    1.893192460247178e-4, 2.375751865617931e-5, -5.323907988763734e-6, -8.363283141616840e-6,
    60.25346682645789, -8.753116989887888,
)  # fmt: skip
NAMES = (
    "angle of the rod", "slider", "bending 1", "bending 2", "axial, middle", "axial, end",
    "rate of the rod", "rate of the slider",
)  # fmt: skip
UNITS = ("rad", "m", "m", "m", "m", "m", "rad/s", "m/s")
TOLERANCES = (1e-9, 2e-9, 5e-7, 5e-7, 5e-6, 5e-6, 1e-7, 1e-7)
STEPS = 160_000


def _integrals() -> dict[str, Array]:
    """Integrals over the rod of sines w and quadratics u, by quadrature, after Simeon; per length of the rod."""
    x, weight = np.polynomial.legendre.leggauss(40)
    x, weight = (x + 1) / 2, weight / 2
    zero = np.zeros_like(x)
    w = np.array([np.sin(np.pi * x), np.sin(2 * np.pi * x), zero, zero])
    u = np.array([zero, zero, 4 * x * (1 - x), x * (2 * x - 1)])
    bend = np.array([np.pi**2 * w[0], 4 * np.pi**2 * w[1], zero, zero])
    stretch = np.array([zero, zero, 4 - 8 * x, 4 * x - 1])
    lateral, axial = w * weight @ w.T, u * weight @ u.T
    return {
        # The test set has fifteen times the integral in the axial entries; its reference solution, too.
        "mass": ROD * (lateral + 15 * axial),
        "stiffness": (SIDE**2 / 12 / ROD**3) * (bend * weight @ bend.T) + (stretch * weight @ stretch.T) / ROD,
        "turn": ROD * (u * weight @ w.T - w * weight @ u.T),
        "u": ROD * u @ weight,
        "w": ROD * w @ weight,
        "xu": ROD**2 * u @ (weight * x),
        "xw": ROD**2 * w @ (weight * x),
    }


def _branch(q: SX, v: SX, p: SX) -> tuple[SX, SX, SX]:
    """Crank, rod and slider in (angle of the rod, slider, angle of the crank, four of the rod)."""
    del p
    k, area = _integrals(), SIDE**2
    rod, x, crank, z = q[0], q[1], q[2], q[3:]
    rod_dot, x_dot, crank_dot, z_dot = v[0], v[1], v[2], v[3:]
    c, s = cos(crank - rod), sin(crank - rod)
    m = DENSITY * area
    along, across = constant(m * k["u"][:, None]), constant(m * k["w"][:, None])
    twist = dot(constant(m * k["xw"][:, None]), z_dot) + bilinear(z, m * k["turn"], z_dot)
    kinetic = 0.5 * (
        (CRANK_INERTIA + ROD_MASS * CRANK**2) * crank_dot**2
        + ROD_INERTIA * rod_dot**2
        + SLIDER_MASS * x_dot**2
        + CRANK * ROD * ROD_MASS * c * crank_dot * rod_dot
        + rod_dot**2 * (quadratic(z, m * k["mass"]) + 2 * dot(constant(m * k["xu"][:, None]), z))
        + quadratic(z_dot, m * k["mass"])
    )
    kinetic += CRANK * crank_dot * rod_dot * (c * dot(along, z) + s * dot(across, z))
    kinetic += CRANK * crank_dot * (c * dot(across, z_dot) - s * dot(along, z_dot)) + rod_dot * twist
    reach = ROD + z[3]
    pin = vertcat(CRANK * sin(crank) + reach * sin(rod), x - CRANK * cos(crank) - reach * cos(rod), crank)
    return kinetic, 0.5 * quadratic(z, E * area * k["stiffness"]), pin


def _shaft(x: SX, u: SX) -> tuple[SX, SX, SX]:
    """A shaft that turns with all cranks; the pins stay on the sliders' line."""
    point = vertcat(zeros(2), x[0])
    return 0.5 * dot(u, u), zeros(1), vertcat(*[point] * 6)


def end_state(steps: int) -> Array:
    """Positions and rates after 0.1 s with so many steps, (6, 8): six cranks on the shaft, the first one driven."""
    mechanism = Mechanism(
        branch=_branch,
        hub=_shaft,
        drive=lambda t: (SPEED * t, np.full_like(t, SPEED), np.zeros_like(t)),
        shapes=2,
        parameters=np.zeros((6, 1)),
        file=__file__,
    )
    reach = ROD + START[3]
    q = np.tile([0.0, CRANK + reach, 0.0, *START], (6, 1))
    v = np.tile([-SPEED * CRANK / reach, START_RATES[3], SPEED, *START_RATES], (6, 1))
    final = run_mechanism(mechanism, q, np.zeros(3), v, np.array([SPEED, 0.0, 0.0]), DURATION, steps)[-1]
    place, rate = final.q[-1], final.v[-1, :42].reshape(6, 7)
    return np.concatenate([place[:, [0, 1, 3, 4, 5, 6]], rate[:, :2]], axis=1)


@case(
    "Six slider-cranks with flexible rods on one shaft after 0.1 s, in the compiled time integration of the "
    "robot; two step sizes extrapolated",
    source="Simeon 1996, test set for IVP solvers (Bari), problem crank: data, and solution at 0.1 s",
    argument="the solutions in two releases of the test set differ by 1e-10 in the angle of the rod, 1e-9 in the "
    "slider, 3e-7 in bending, 4e-6 in the axial displacements, 8e-8 in the rates; its start is 2e-10 m off the "
    "closure, ours is not",
)
def _slider_crank() -> list[Check]:
    ours = extrapolate_second_order(end_state(STEPS), end_state(2 * STEPS))[-1].tolist()
    return [Check(*row) for row in zip(NAMES, END, ours, TOLERANCES, UNITS, strict=True)]
