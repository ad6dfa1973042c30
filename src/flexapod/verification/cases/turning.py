"""Beams that turn, steadily or up to speed, and a leg between its joints."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.model import Actuator, Simulation
from flexapod.solve.modal.actuator_modes import actuator_modes, stretching_lag
from flexapod.verification.case import Check, case, checks
from flexapod.verification.robots import heavy_robot

# Speed, hub radius, tip mass (dimensionless), flap frequencies from the first on
FLAP = (
    (1, 0.0, 0.0, (3.681647, 22.181011, 61.841763)),
    (2, 0.0, 0.0, (4.137320, 22.614922, 62.273184)),
    (3, 0.0, 0.0, (4.797279, 23.320264, 62.984967)),
    (4, 0.0, 0.0, (5.585001, 24.273349, 63.966760)),
    (5, 0.0, 0.0, (6.449545, 25.446080, 65.205041)),
    (6, 0.0, 0.0, (7.360373, 26.809082, 66.683914)),
    (8, 0.0, 0.0, (9.256838, 29.995382, 70.292962)),
    (10, 0.0, 0.0, (11.202328, 33.640366, 74.649295)),
    (12, 0.0, 0.0, (13.170150, 37.603112, 79.614478)),
    (1, 0.0, 1.0, (1.90168, 16.75702)),
    (2, 0.0, 1.0, (2.66964, 18.19097)),
    (4, 0.0, 1.0, (4.54291, 23.02287)),
    (8, 0.0, 1.0, (8.49447, 36.21329)),
    (2, 1.0, 0.0, (4.8337,)),
    (10, 1.0, 0.0, (16.6064,)),
    (2, 5.0, 0.0, (6.9415,)),
    (10, 5.0, 0.0, (29.4745,)),
    (5, 0.5, 1.0, (6.719405, 30.01018, 69.458755)),
)
LAG = (
    (1, 0.0, 0.0, (3.5432,)), (2, 0.0, 0.0, (3.6218,)), (5, 0.0, 0.0, (4.0739,)), (10, 0.0, 0.0, (5.0490,)),
    (5, 0.5, 1.0, (4.48892, 29.590723)),
)  # fmt: skip
SHAPES = 8
FAULT = (
    "It is the Ritz value of 16 polynomials, not the limit: 24, 30 and 40 polynomials give 144.381755, 144.381721 and "
    "144.381720, and so does a boundary-value solver."
)
# The boundary layer at the root, L / (speed sqrt(hub + 1/2)), is thin
FAST = ((50, 1, 79.3305, ""), (50, 5, 144.3906, FAULT))


@cache
def _lag(g: float, hub: float, mass: float) -> Array:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, hub_radius=hub, tip_mass=mass)
    return 2 * np.pi * actuator_modes(beam, Simulation(basis="tip-load", modes=SHAPES), rate=g).frequency


@case(
    "Flap and lag frequencies of a turning clamped beam; eight shapes; flap^2 = lag^2 + speed^2",
    source="Wright et al. 1982, Hodges & Rutkowski 1981; recomputed with 30 spectral shapes",
    argument="half a unit of the last printed digit is 1.5e-5 of the smallest entry; eight shapes are right to 1e-5",
)
def _rotating_beam() -> Iterator[Check]:
    for kind, table in (("flap", FLAP), ("lag", LAG)):
        for g, hub, mass, row in table:
            ours = np.hypot(_lag(g, hub, mass), g) if kind == "flap" else _lag(g, hub, mass)
            names = [f"{kind}, speed {g:g}, hub {hub:g}, tip mass {mass:g}, mode {i + 1}" for i in range(len(row))]
            yield from checks(names, row, ours[: len(row)], 2e-5)
    for g, hub, wave, fault in FAST:
        ours = float(np.hypot(_lag(g, hub, 0.0)[0], g))
        yield Check(f"flap, speed {g}, hub {hub}, tip mass 0, mode 1", wave, ours, 2e-5, fault=fault)


INCH, PSI = 0.0254, 6894.757293
BLADE, ROOT, WIDTH, DEPTH = 37.5 * INCH, 2.5 * INCH, 1.0 * INCH, 0.117 * INCH
E, DENSITY = 2.059e7 * PSI, 1.44e-4 * PSI / INCH**2  # lb s^2 / in^4
# Speed [rpm], first three flap frequencies [Hz]
MEASURED = (
    (0, (5.237, 33.0, 90.4)), (250, (7.424, 34.6, 91.1)), (500, (11.018, 40.2, 97.7)), (750, (15.820, 47.0, 105.6)),
)  # fmt: skip


@case(
    "Flap frequencies of a straight composite blade at up to 750 rpm, as an Euler-Bernoulli beam",
    source="Epps & Chandra 1996, measured; section and moduli as in the examples of AeroBeams.jl",
    argument="an experiment: no shear, no coupling of the laminate, moduli of the material: 10 %, as others take",
)
def _rotor() -> Iterator[Check]:
    blade = Actuator(
        length=BLADE, free_length=BLADE, hub_radius=ROOT, rhoA=DENSITY * WIDTH * DEPTH, EI=E * WIDTH * DEPTH**3 / 12
    )
    for rpm, row in MEASURED:
        lag = actuator_modes(blade, Simulation(basis="tip-load", modes=8), rate=rpm * np.pi / 30).frequency[:3]
        flap = np.hypot(lag, rpm / 60)
        yield from checks([f"{rpm} rpm, mode {i}" for i in (1, 2, 3)], row, flap, 0.1, "Hz")


# Cylinder's length [m] and mass [kg], free length [m], frequencies [Hz]
LEGS = (
    (0.3, 3.0, 0.6, (67.976401, 321.006353, 844.644953)),
    (0.4, 5.0, 0.6, (54.579565, 291.10741, 810.989844)),
    (0.5, 8.0, 0.6, (43.768985, 271.284004, 790.6379)),
    (0.4, 5.0, 0.34, (113.893634, 823.028156)),
    (0.4, 5.0, 0.47, (75.104984, 452.327661)),
)
TOLERANCES = (1e-6, 1e-6, 2e-4)  # of modes 1 to 3


@case(
    "Frequencies of a leg, rigid cylinder with a clamped piston, between ideal joints; six shapes",
    source="closed form: beam clamped in a rigid bar that is pinned, tip pinned",
    argument="basis tip-load reaches 1e-11, 2e-7 and 2e-4 in modes 1 to 3; the platform of 1e12 kg gives way by less",
)
def _pinned_leg() -> Iterator[Check]:
    for mouth, mass, free, row in LEGS:
        robot = heavy_robot(mouth=mouth, mass=mass, free=free)
        frequency = modes(robot, modes=6, axial_modes=1).frequency.values[6:]  # six of them: the heavy platform's
        n, what = len(row), f"cylinder {mouth:g} m, {mass:g} kg, piston {free:g} m, mode"
        yield from checks([f"{what} {i + 1}" for i in range(n)], row, frequency[: 12 * n : 12], TOLERANCES[:n], "Hz")


DURATION = 15.0
_AREA, _E, _SECOND, _DENSITY = 7.2968e-5, 6.8952e10, 8.2189e-9, 2766.7  # of Wu & Haug's beam
_WU_HAUG = (8.0, _E * _SECOND, _E * _AREA, _DENSITY * _AREA)
# Name; length [m], EI [N m^2], EA [N], mass per length [kg/m]; final rate [rad/s]; peak [m] and its instant [s], linear
# with stiffening; peak by nonlinear elements [m]; largest lag after the spin-up [m]
TABLE = (
    ("Simo & Vu-Quoc, 6 rad/s", (10.0, 1.4e4, 2.8e7, 1.2), 6.0, -0.57437, 6.762, -0.57384, 3.7e-3),
    ("Wu & Haug, 4 rad/s", _WU_HAUG, 4.0, -0.53440, 6.766, -0.53370, 8.4e-3),
    ("Wu & Haug, 6 rad/s", _WU_HAUG, 6.0, -0.75262, 6.541, -0.75069, 7.7e-3),
)


@case(
    "Peak lag of the tip of a beam spun up in 15 s, its instant, and what is left after it; three shapes",
    source="Simo & Vu-Quoc 1986, Wu & Haug 1988; recomputed by Ritz's method and by nonlinear finite elements",
    argument="three shapes are within 1.5e-4 of Ritz's six; what second order leaves out is 0.1 to 0.3 %; instants "
    "are stored each 2 ms; the lag that is left is printed with two digits",
)
def _spin_up() -> Iterator[Check]:
    for name, (length, EI, _, rhoA), rate, linear, instant, nonlinear, rest in TABLE:
        beam = model.Actuator(length=length, free_length=length, rhoA=rhoA, EI=EI)
        law = model.SpinUpLaw(rate=rate, duration=DURATION)
        motion = model.ActuatorMotion(rotation=law, extension=model.RateLaw(rate=0.0))
        data = simulate_actuator(beam, motion, modes=3, step=2e-3, output_step=2e-3, duration=DURATION + 5)
        lag, time = data.tip_deflection.values, data.time.values
        peak, when = float(lag.min()), float(time[lag.argmin()])
        left = float(np.abs(lag[time > DURATION]).max())
        yield from [
            Check(f"{name}, peak lag", linear, peak, 5e-4, "m"),
            Check(f"{name}, peak lag, nonlinear", nonlinear, peak, 5e-3, "m"),
            Check(f"{name}, instant", instant, when, 3e-3, "s", absolute=True),
            Check(f"{name}, largest lag after it", rest, left, 0.03, "m"),
        ]


SLENDERNESS = 70.0  # of the printed table: EA L^2 / EI is its square
STRETCHING_LAG = ((2.0, 3.6196), (10.0, 4.9700))  # speed, first frequency


@case(
    "Lag of a turning beam with Coriolis forces between stretch and bending; its steady stretch when spun up",
    source="Yoo & Shin 1998, recomputed with two fields of 12 polynomials; L (tan a / a - 1) of a linear rod",
    argument="half a unit of the last printed digit is 1e-5, so is what six axial shapes leave; the lag left, 4 mm, "
    "pulls by less than 1e-3 of the load",
)
def _stretching_rotor() -> list[Check]:
    beam = Actuator(length=1.0, free_length=1.0, rhoA=1.0, EI=1.0, EA=SLENDERNESS**2, axial_modes=6, space=True)
    settings = Simulation(basis="tip-load", modes=SHAPES)
    found = [
        Check(f"lag, speed {g:g}", wave, float(stretching_lag(beam, settings, g)[0]), 2e-5)
        for g, wave in STRETCHING_LAG
    ]
    _, (length, EI, EA, rhoA), rate, *_ = TABLE[0]
    spun = Actuator(length=length, free_length=length, rhoA=rhoA, EI=EI, EA=EA, space=True)
    motion = model.ActuatorMotion(rotation=model.SpinUpLaw(rate=rate, duration=DURATION))
    data = simulate_actuator(spun, motion, modes=3, step=5e-3, output_step=5e-3, duration=DURATION + 1)
    a, last = rate * length * np.sqrt(rhoA / EA), data.tip_stretch.values[data.time.values > DURATION]
    return [*found, Check("stretch after the spin-up", length * (np.tan(a) / a - 1), float(last.mean()), 1e-3, "m")]
