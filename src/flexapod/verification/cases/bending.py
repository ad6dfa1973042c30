"""Beams and pistons that bend and stretch: closed forms, a body at the tip, finite elements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.model import Actuator, Simulation
from flexapod.solve.modal.actuator_modes import actuator_modes
from flexapod.verification.case import Check, case, checks
from flexapod.verification.robots import STEEL, heavy_robot, round_piston

ROOTS = (1.875104068712, 4.694091132974, 7.854757438238, 10.99554073488, 14.13716839105)  # cos x cosh x = -1
MODES = [f"mode {i}, omega / sqrt(EI / rhoA L^4)" for i in range(1, 6)]


@case(
    "Frequencies of a clamped-free beam, in its own eigenfunctions",
    source="roots of cos x cosh x = -1, any text on vibrations",
    argument="the shapes are the exact ones; the printed roots carry 12 to 13 digits",
)
def _cantilever() -> list[Check]:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0)
    found = actuator_modes(beam, Simulation(basis="clamped-free", modes=5))
    return checks(MODES, np.square(ROOTS), 2 * np.pi * found.frequency, 1e-11)


# Tip mass over beam mass, rotary inertia over rhoA L^3, first three omega / sqrt(EI / rhoA L^4)
BODIES = (
    (0.1, 0.0, (2.9678383, 19.355801, 55.5182455)),
    (0.5, 0.0, (2.016299, 16.9014177, 51.7009209)),
    (1.0, 0.0, (1.5572979, 16.2500852, 50.8958428)),
    (2.0, 0.0, (1.1581971, 15.86089, 50.4476397)),
    (5.0, 0.0, (0.7569373, 15.6023459, 50.1623389)),
    (10.0, 0.0, (0.541375, 15.5115131, 50.064347)),
    (1.0, 0.01, (1.5436768, 13.2395886, 32.0695808)),
    (1.0, 0.1, (1.4296263, 6.2753257, 24.7516045)),
    (1.0, 1.0, (0.8678998, 3.3905722, 24.0185577)),
    (1.0, 10.0, (0.3115388, 2.9978154, 23.9471132)),
)


@case(
    "Frequencies of a clamped beam with mass and rotary inertia at its tip, basis tip-mass",
    source="1 + cos x cosh x + mu x (cos x sinh x - sin x cosh x) = 0 and its form with rotary inertia, in closed form",
    argument="the shapes are the exact ones; the table carries seven to nine digits, at least half a unit of 0.3115388",
)
def _tip_body() -> Iterator[Check]:
    for mass, inertia, row in BODIES:
        beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, tip_mass=mass, tip_inertia=inertia)
        waves = 2 * np.pi * actuator_modes(beam, Simulation(basis="tip-mass", modes=3)).frequency
        names = [f"m = {mass:g}, J = {inertia:g}, mode {i}" for i in (1, 2, 3)]
        yield from checks(names, row, waves, 2e-7)


ELEMENTS, SEGMENTS = 8, 12


def _waves(fidelity: str, shapes: int, mass: float = 0.0, inertia: float = 0.0) -> Array:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, tip_mass=mass, tip_inertia=inertia)
    return 2 * np.pi * actuator_modes(beam, Simulation(fidelity=fidelity, modes=shapes)).frequency[:3]


def _cubic(wave: Array) -> Array:
    """Relative error of a frequency, lambda^2 = `wave`: (lambda / n)^4 / 1440, and a tenth of it for the next term."""
    return 1.1 * wave**2 / ELEMENTS**4 / 1440 + 2e-7


@case(
    "Frequencies of a clamped beam with mass and rotary inertia at its tip: eight cubic elements; twelve "
    "hinged segments without a body",
    source="closed forms, as for cantilever and tip-body",
    argument="leading error of cubic elements, (lambda / n)^4 / 1440 (that of a sine; a clamped or free end takes "
    "some of it), a tenth for the next term, seven digits of the table; of segments, the chord of a sine, (lambda / "
    "n)^2 / 24, and as much for the half segment at the clamp",
)
def _beam_elements() -> list[Check]:
    found, bare = [], np.square(ROOTS[:3])
    for mass, inertia, row in ((0.0, 0.0, bare), *BODIES):
        names = [f"elements, m = {mass:g}, J = {inertia:g}, mode {i}" for i in (1, 2, 3)]
        found += checks(names, row, _waves("beam-fem", 2 * ELEMENTS, mass, inertia), _cubic(np.asarray(row)))
    segments = [f"segments, mode {i}" for i in (1, 2, 3)]
    return found + checks(segments, bare, _waves("finite-segment", SEGMENTS), bare / SEGMENTS**2 / 12)


FREE = 0.6
PINNED = (149.138, 596.553)  # Hz, pinned at both ends
CLAMPED = (232.982, 755.012)  # Hz, clamped at one
EULER = 143.0e3  # N
HEAVY = 1e9  # kg: a cylinder that holds its piston clamped
# Thrust [N] and the factor it puts on the first frequency, sqrt(1 - P / P_cr)
THRUST = 1e3
FACTOR = 0.996498


def _section() -> list[Check]:
    rod = round_piston(FREE)
    return [
        Check("EI", 5217.4, rod.EI, 1e-5, "N m^2"),
        Check("EA", 1.1451e8, rod.EA, 5e-5, "N"),
        Check("mass per length", 4.466, rod.rhoA, 1.2e-4, "kg/m"),
        Check("Euler load", EULER, float(np.pi**2 * rod.EI / FREE**2), 4e-4, "N"),
    ]


@case(
    "A 27 mm steel piston of 600 mm: section, bending between ideal ends, first frequency under a thrust of 1 kN",
    source="closed forms: sin x = 0, tan x = tanh x, sqrt(1 - P / P_cr)",
    argument="printed digits; what eight polynomials lack of a sine with lambda = 7.07 is at most 4e-6",
)
def _piston() -> list[Check]:
    found = _section()
    light = heavy_robot(mouth=0.0, mass=0.0, free=FREE)
    held = heavy_robot(mouth=0.3, mass=HEAVY, free=FREE)
    for name, robot, first, table in (("pinned", light, 6, PINNED), ("clamped", held, 18, CLAMPED)):
        ours = modes(robot, modes=8, axial_modes=1).frequency.values[first::12]
        found += checks([f"{name} and pinned, mode {i}" for i in (1, 2)], table, ours[:2], 1e-5, "Hz")
    across = light.home_height / light.home_lengths[0]
    weight = np.array([0.0, 0.0, -6 * THRUST * across, 0.0, 0.0, 0.0])
    free, loaded = (
        modes(light, load=load, modes=8, axial_modes=1).frequency.values[6] for load in (np.zeros(6), weight)
    )
    return [*found, Check("factor of a thrust of 1 kN", FACTOR, float(loaded / free), 1e-6)]


@case(
    "Axial vibration and stiffness of a 27 mm steel piston of 600 mm",
    source="c / 2 L of a uniform bar held at both ends; EA / L",
    argument="the sine shapes are the exact modes of such a bar; EA / L is printed with five digits",
)
def _bar() -> list[Check]:
    # A platform that cannot move holds the tips: clamped-clamped bar, n c / 2 L.
    speed = np.sqrt(STEEL.E / STEEL.density)
    robot = heavy_robot(mouth=0.0, mass=0.0, free=FREE)
    found = modes(robot, modes=1, axial_modes=4)
    first = float(found.frequency.values[[kind.endswith("axial") for kind in found.kind.values]].min())
    return [
        Check("first axial mode", speed / (2 * FREE), first, 1e-12, "Hz"),
        Check("EA / L of the piston", 1.9085e8, round_piston(FREE).EA / FREE, 5e-5, "N/m"),
    ]
