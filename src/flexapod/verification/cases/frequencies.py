"""Frequencies of robots with their drives locked, against the exact dynamic stiffness of their legs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from flexapod import model
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.model import Robot
from flexapod.verification import dynamic_stiffness
from flexapod.verification.case import Case, Check, case, checks
from flexapod.verification.dynamic_stiffness import (
    legs_and_body,
    polynomial_truncation,
    sine_truncation,
    twist_truncation,
    wave_number,
)
from flexapod.verification.robots import (
    eight_legs,
    hexapod,
    planar,
    table,
    tricept,
    tripod,
    with_unequal_legs,
    without_cylinders,
    without_gravity,
)

HOME = (0.0,) * 6
ROLLED = (0.01, -0.02, 0.03, np.deg2rad(20.0), 0.05, 0.1)
AXIAL = 2  # axial shapes
ROUNDING = 1e-10  # of the eigenproblem: eps times the spread of the squared frequencies
SHOWN = {1: "payload", 7: "first bending", 18: "second bending"}  # of the frequencies, in ascending order
ASSUMED = ("assumed-modes", (1, 2, 3, 6))
LADDER = (ASSUMED, ("beam-fem", (4, 8)), ("finite-segment", (4, 8)))  # shapes a plane: two an element, one a segment
FEWEST = {"assumed-modes": 2, "beam-fem": 8, "finite-segment": 8}  # shapes that can follow the second bending mode


def _bound(legs: list[dynamic_stiffness.UniformLeg], frequency: Array, fidelity: str, shapes: int) -> Array:
    """Bound on the relative error of frequencies [Hz] by the shapes that are left out."""
    rest = sine_truncation(legs, frequency, AXIAL) + ROUNDING
    if fidelity == "beam-fem":
        return 1.2 * (wave_number(legs, frequency) / (shapes / 2)) ** 4 / 1440 + rest
    if fidelity == "finite-segment":
        return (wave_number(legs, frequency) / shapes) ** 2 / 24 + rest
    return polynomial_truncation(legs, frequency, shapes) + rest


@case(
    "Frequencies of the 6-UPS robot about the undeformed pose, drives locked: with and without cylinders, "
    "with six different legs, up the ladder of shapes",
    source="exact dynamic stiffness of uniform pinned legs, transcendental in the frequency; roots counted after "
    "Wittrick & Williams 1971, none missed",
    argument="what the shapes leave out: polynomials of degree k of a sine; cubic elements (lambda / n)^4 / 1440 and "
    "a fifth of it for the next term; straight segments (lambda / n)^2 / 24; sines of the bars beyond the second "
    "shape",
)
def _locked_robot() -> list[Check]:
    layout = model.preset("paper-robot")
    robot, found = without_gravity(layout.robot), []
    for name, body, pose, ladder in (
        ("preset", robot, HOME, LADDER),
        ("no cylinders", without_cylinders(robot), HOME, LADDER),
        ("unlike legs, rolled", with_unequal_legs(robot), ROLLED, (ASSUMED,)),
    ):
        legs, payload = legs_and_body(body, pose)
        exact = dynamic_stiffness.robot_frequencies(legs, payload, max(SHOWN))
        for fidelity, rungs in ladder:
            for shapes in rungs:
                ours = modes(body, pose, fidelity=fidelity, modes=shapes, axial_modes=AXIAL).frequency.values
                bound = _bound(legs, exact, fidelity, shapes)
                shown = [i for i, kind in SHOWN.items() if kind != "second bending" or shapes >= FEWEST[fidelity]]
                names, at = [f"{name}, {fidelity}, {shapes} shapes, {SHOWN[i]}" for i in shown], np.array(shown) - 1
                found += checks(names, exact[at], ours[at], bound[at], "Hz")
    return found


COUNT, LATERAL = 5, 6
SPREAD = 1e-9  # of the eigenproblem: the softest motion's squared frequency is 1e-7 of the stiffest


def _lowest(make: Callable[[], Robot]) -> list[Check]:
    robot = without_gravity(make())
    legs, body = legs_and_body(robot, HOME)
    exact = dynamic_stiffness.robot_frequencies(legs, body, COUNT)
    ours = modes(robot, modes=LATERAL, axial_modes=AXIAL).frequency.values
    bound = polynomial_truncation(legs, exact, LATERAL) + sine_truncation(legs, exact, AXIAL)
    bound += twist_truncation(legs, exact) + SPREAD
    return checks([f"frequency {i + 1}" for i in range(COUNT)], exact, ours[:COUNT], bound, "Hz")


LOWEST = [
    Case(
        name=f"frequencies-{name}",
        statement=f"Lowest frequencies of {robot}, drives locked; six shapes a plane",
        source="exact dynamic stiffness, transcendental in the frequency, joints as axes about which ends turn; roots "
        "counted after Wittrick & Williams 1971, none missed",
        argument="what the shapes leave out: polynomials of degree 5 of a sine, sines of bars beyond the second "
        "shape and of shafts beyond the first; rounding where bars are 1e7 times as stiff as what bends",
        compute=partial(_lowest, make),
    )
    for name, robot, make in (
        ("tripod", "a tripod 3-RPS, hinged at the base", tripod),
        ("tricept", "a Tricept 3-UPS+UP, its passive leg welded to the platform", tricept),
        ("eight-legs", "an 8-UPS, two drives more than motions", eight_legs),
        ("planar", "a planar 3-PRR with slender rods", planar),
        ("welded", "a hexapod 6-UPF, legs welded to the platform", partial(hexapod, "UPF")),
        ("table", "a table on four upright legs welded at both ends", partial(table, "FPF", mass=500.0, inertia=50.0)),
    )
]
