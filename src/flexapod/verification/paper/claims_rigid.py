"""Claims of the paper's section 3 on the rigid robot: slenderness, roll, travel, forces, path."""

from __future__ import annotations

import math

import numpy as np
from xarray import Dataset

from flexapod import kinematics
from flexapod.analysis.results.attributes import robot_study
from flexapod.common.quantities import number, text
from flexapod.verification.paper.claim import (
    AWAY,
    ELASTIC_LENGTH,
    FIGURE,
    HERE,
    IN_PART,
    OPEN,
    Claim,
    axis_motion,
    choose_verdict,
    force_gaps,
    is_unspecified,
    roll_and_arm,
    transverse_words,
)
from flexapod.verification.paper.computing_time import FORMULATIONS
from flexapod.verification.paper.rows import row
from flexapod.verification.paper.variants import TRAVELS

TRAVEL, TRAVEL_ROUNDED = 0.26, 0.005  # of a piston, Fig. 7; printed to 10 mm [m]
SHEAR = 2.6 / 0.9  # E / kappa G of a round steel section: 2 (1 + 0.3), kappa = 0.9
ROUNDING = 1e-9  # of a path computed in double precision, relative


@row("Section 3", "Diameter below a tenth of the length: Euler-Bernoulli theory is valid", "robot")
def _slender(robot: Dataset) -> Claim:
    diameter = robot_study(robot).robot.legs[0].piston.width
    ratio = diameter / ELASTIC_LENGTH
    lower = _lowered(ratio)
    verdict = choose_verdict(ratio < 0.1 and lower < 0.01, ratio < 0.1)
    return Claim(
        ours=f"{100 * ratio:.2g} % of the elastic length",
        verdict=verdict,
        reason=f"Shear and rotary inertia lower the first frequency of such a pinned piston by {100 * lower:.2g} %.",
    )


def _lowered(ratio: float) -> float:
    """Share by which Timoshenko's theory lowers the first frequency of a round pinned beam; diameter over length.

    Smaller root of r^2 s^2 W^4 - [1 + pi^2 (r^2 + s^2)] W^2 + pi^4 = 0 against W = pi^2, with the radius of gyration
    r = d / 4 L and s^2 = r^2 E / (kappa G): Han, Benaroya & Wei (1999), J. Sound Vib. 225(5), 935-988.
    """
    r2 = ratio**2 / 16
    s2 = SHEAR * r2
    half = 0.5 * (1 + np.pi**2 * (r2 + s2))
    squared = np.pi**4 / (half + np.sqrt(half**2 - r2 * s2 * np.pi**4))
    return 1 - float(np.sqrt(squared)) / np.pi**2


@row("Fig. 6", "Roll about X; no amplitude, time or law in the text", "robot", expected=OPEN)
def _figure6(robot: Dataset) -> Claim:
    motion = axis_motion(robot_study(robot))
    open_here = is_unspecified("paper-robot", "motion.amplitude", "motion.duration", "motion.profile")
    return Claim(
        ours=f"{motion.profile.capitalize()} law, 0 to {np.rad2deg(motion.target[3]):.1f} deg in {motion.duration:g} s",
        verdict=OPEN if open_here else choose_verdict(motion.type == "roll"),
        reason="The amplitude is backed out of Eqs. 11-12 and the printed 5 mm, 10 mm and 6 %; law and time are ours. "
        "The figure, which may have them, was not at hand.",
    )


@row("Fig. 7", "Pistons reach a maximum travel of 260 mm at the end of the roll", "readings")
def _figure7(readings: Dataset) -> Claim:
    found = {name: readings.sel(reading=name) for name in TRAVELS}
    travel, apart = ({name: float(row[key]) for name, row in found.items()} for key in ("travel", "apart"))
    travels = [name for name in TRAVELS if _is_260(travel[name])]
    differs = [name for name in TRAVELS if name not in travels and _is_260(apart[name])]
    first = next(iter(TRAVELS))
    ways = [f"the longest leg less the shortest ({_named(name)})" for name in differs]
    off = {name: transverse_words(found[name].deviation_peak.values) for name in travels}
    ways += [f"a piston's travel ({_named(name)}; deviations {words})" for name, words in off.items()]
    can_be = f" 260 mm can be {', '.join(ways)}; the text does not say which." if ways else ""
    return Claim(
        ours=". ".join(f"{_named(name).capitalize()}: {1e3 * travel[name]:.0f} mm" for name in TRAVELS),
        verdict=choose_verdict(first in travels, bool(ways)),
        reason=f"The printed diameters and the roll that is backed out give {1e3 * travel[first]:.0f} mm.{can_be}"
        f"{FIGURE}",
    )


def _is_260(length: float) -> bool:
    return abs(length - TRAVEL) <= TRAVEL_ROUNDED


def _named(reading: str) -> str:
    """Reading of Fig. 7 as text."""
    preset, turn, both_sides = TRAVELS[reading]
    circles = "radii" if preset.endswith("radii") else "diameters"
    return f"{circles}, {-turn if both_sides else 0:g} to {turn:g} deg"


@row(
    "Section 3.1",
    "Newton-Euler is more efficient than Lagrange, which differentiates, for the inverse dynamics",
    "cost",
)
def _cost(cost: Dataset) -> Claim:
    newton_euler, lagrange = (int(cost.operations.sel(formulation=name)) for name in FORMULATIONS)
    return Claim(
        ours=f"A rigid leg in one pose takes {newton_euler} operations by Newton-Euler, {lagrange} by Lagrange",
        verdict=choose_verdict(newton_euler < 0.9 * lagrange, newton_euler < lagrange, best=HERE),
        reason=f"Lagrange's equations take {number(lagrange / newton_euler, 2)} times as many, even differentiated "
        "symbolically with common terms computed once. That is one leg in one formulation each: other coordinates or "
        "another order of the terms count otherwise. Balances of the payload and the solution for six forces are the "
        "same for both, and so are the results.",
    )


@row("Fig. 8", "Actuator forces of the rigid robot: Newton-Euler and finite elements agree strongly", "robot-rigid")
def _figure8(rigid_legs: Dataset) -> Claim:
    largest = float(np.abs(rigid_legs.actuator_force_rigid).max())
    apart, anywhere = (gap / largest for gap in force_gaps(rigid_legs))
    at_most = 2 * 10 ** math.ceil(math.log10(apart / 2))  # of a difference the digits are those of the processor: 1e-5
    return Claim(
        ours=f"Newton-Euler and our multibody model differ by at most {at_most:.0e} of the largest force, "
        f"{largest:.0f} N",
        verdict=choose_verdict(apart < 0.01, apart < 0.1),
        reason=f"Closer than {1e3 * AWAY:.0f} ms to the ends of the quintic, where its jerk jumps, by "
        f"{100 * anywhere:.1g} % at a step of {1e3 * rigid_legs.attrs['step']:g} ms; this falls "
        f"with the step.{FIGURE}",
    )


@row("Eqs. 11-12", "Rigid path of the centre of mass: Y = d cos(theta), Z = d sin(theta)", "robot", expected=IN_PART)
def _equations_11_12(robot: Dataset) -> Claim:
    study, (_, arm) = robot_study(robot), roll_and_arm(robot)
    R = kinematics.poses(study.robot, study.motion, robot.time.values).rotation
    roll = np.arctan2(R[:, 2, 1], R[:, 2, 2])
    rest = robot.com_position_rigid.values[:, 1:] - arm * np.stack([np.cos(roll), np.sin(roll)], axis=1)
    printed, off = (float(np.abs(rest - [0.0, height]).max()) for height in (0.0, study.robot.home_height))
    so = "So it is" if off < ROUNDING * arm else f"Off by {text(off, 'm')}"
    return Claim(
        ours=f"{so}, with d = {1e3 * arm:.0f} mm along the platform's y and its height added",
        verdict=choose_verdict(printed < ROUNDING * arm, off < ROUNDING * arm),
        reason="A payload on top of the platform would have Y = -d sin(theta), Z = d cos(theta) (T2.13); no height is "
        f"given, ours is {study.robot.home_height:g} m.",
    )
