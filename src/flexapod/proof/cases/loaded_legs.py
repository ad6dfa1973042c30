"""Legs under thrust, to near their buckling: frequencies, and the sideways stiffness of a table."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import root_scalar
from scipy.special import spherical_jn

from flexapod.model import Robot
from flexapod.model.payload import Payload
from flexapod.model.piston import Cylinder, Piston
from flexapod.proof.case import Case, Check
from flexapod.proof.parallel_robots import hexapod, table
from flexapod.study.static import modes, stiffness

EI, RHOA, SPAN = 5e3, 4.5, 0.8  # of `table`
IMMOVABLE = 1e12  # kg, and kg m^2
STIFF = 1e11  # N: next to nothing is lost by squeezing
Root = Callable[[float, float], float]


def _fixed(a: float, b: float) -> float:
    return 2 * a * b * (1 / np.cosh(a) - np.cos(b)) + (a**2 - b**2) * np.tanh(a) * np.sin(b)


ENDS: dict[str, tuple[str, float, Root]] = {  # chain, buckling load in EI / L^2, what vanishes at a frequency
    "both ends turn": ("UPS", np.pi**2, lambda a, b: np.sin(b)),
    "welded to the platform": ("UPF", 20.190728556427, lambda a, b: a * np.sin(b) - b * np.cos(b) * np.tanh(a)),
    "both ends welded": ("FPF", 4 * np.pi**2, _fixed),
}
SHARES = (0.0, 0.5, 0.99)  # of the buckling load


def _frequency(root: Root, thrust: float) -> float:
    """First frequency [Hz] of a beam under a thrust in EI / L^2: waves cosh a x and cos b x."""

    def value(square: float) -> float:  # rhoA omega^2 L^4 / EI
        middle = np.sqrt(thrust**2 / 4 + square)
        return root(np.sqrt(max(middle - thrust / 2, 0.0)), np.sqrt(middle + thrust / 2))

    grid = np.linspace(1e-3, 30.0, 3000) ** 2
    values = np.array([value(x) for x in grid])
    i = int(np.flatnonzero(values[1:] * values[:-1] < 0)[0])
    square = root_scalar(value, bracket=(grid[i], grid[i + 1]), xtol=1e-14 * grid[i]).root
    return float(np.sqrt(square * EI / RHOA) / SPAN**2 / (2 * np.pi))


def _spread(chain: str) -> Robot:
    """Six legs all of which is piston, which share a vertical load, under an immovable platform."""
    load = Payload(mass=IMMOVABLE, inertia=[IMMOVABLE] * 3, com=[0, 0, 0])
    found = hexapod(chain)
    span = float(found.home_lengths[0])
    piston = Piston(length=SPAN, EA=STIFF, EI=EI, rhoA=RHOA)
    bare = found.legs[0].replace(cylinder=Cylinder(mass=0.0, mouth=0.0), piston=piston)
    joints = {name: getattr(found, name) * SPAN / span for name in ("base_joints", "platform_joints")}
    height = found.home_height * SPAN / span
    return found.replace(**joints, home_height=height, legs=(bare,) * 6, payload=load, gravity=[0, 0, 0])


def _bound(wave: float, thrust: float, left: float) -> float:
    """Relative error of a frequency of which a share `left` of the stiffness remains; of the stiffness it is twice.

    What six polynomials, curvature of degree 5, lack of a sine of this wave (radians along the leg), doubled for what
    a fixed end adds to the sine; and the leg's squeezing, by which its square of length is less.
    """
    n = np.arange(6, 30)
    lacking = float(np.sum((2 * n + 1) * spherical_jn(n, wave / 2) ** 2))
    return 2 * (lacking + thrust / STIFF) / left + 1e-9


def _frequencies() -> list[Check]:
    found: list[Check] = []
    for ends, (chain, buckling, root) in ENDS.items():
        robot = _spread(chain)
        rise = (robot.home_vectors / robot.home_lengths[:, None])[0, 2]
        for share in SHARES:
            thrust = share * buckling
            load = [0, 0, -6 * rise * thrust * EI / SPAN**2, 0, 0, 0]
            ours = modes(robot, load=load, modes=6, axial_modes=2).frequency.values[6:]
            exact = _frequency(root, thrust)
            square = (2 * np.pi * exact) ** 2 * RHOA * SPAN**4 / EI
            wave = np.sqrt(thrust / 2 + np.sqrt(thrust**2 / 4 + square))
            what, bound = f"{ends}, {share:g} of the buckling load", _bound(wave, thrust * EI / SPAN**2, 1 - share)
            found.append(Check(what=what, reference=exact, ours=float(ours[0]), tolerance=bound, unit="Hz"))
    return found


THRUST_ON_LEGS = Case(
    name="thrust-on-legs",
    statement="First frequency of a leg between a fixed base and an immovable platform, free to turn or welded there, "
    "to 0.99 of its buckling load, pi^2, 20.19 and 4 pi^2 EI / L^2",
    source="characteristic equations of a beam under thrust in closed form; Timoshenko & Gere, sec. 2.1",
    argument="what six polynomials lack of a sine, twice for ends that are fixed, and the squeezing of the leg, P / "
    "EA; a hundred times that where a hundredth of the stiffness is left",
    compute=_frequencies,
)


def _sway() -> list[Check]:
    found: list[Check] = []
    for ends, chain, base in (("welded", "FPF", 2), ("hinged", "UPF", 1)):
        robot = table(chain, mass=1.0, inertia=1.0, EA=STIFF).replace(gravity=[0, 0, 0])
        for share in (0.01, 0.5, 0.99):
            x = share * np.pi / 2  # of the wave, from where the leg does not turn to where it bears no moment
            thrust = EI * (base * x / SPAN) ** 2
            reference = 4 * thrust / SPAN / (np.tan(x) / x - 1)
            load = [0, 0, -4 * thrust, 0, 0, 0]
            ours = stiffness(robot, load=load, modes=6, axial_modes=2).stiffness.values[0, 0]
            what, bound = f"{ends} at the base, {share:g} of the wave", 2 * _bound(base * x, thrust, 1 - share**2)
            found.append(Check(what=what, reference=reference, ours=float(ours), tolerance=bound, unit="N/m"))
    return found


TABLE_SWAY = Case(
    name="table-sway",
    statement="Sideways stiffness of a table that does not tilt, four upright legs welded to it, under load: 48 EI / "
    "L^3 or 12 EI / L^3 at none, nothing where the legs buckle",
    source="beam-column in closed form, P / L / (tan x / x - 1) a leg, x = L sqrt(P / EI), welded at the base half of "
    "that",
    argument="as for thrust-on-legs, where a fiftieth of the stiffness is left",
    compute=_sway,
)
