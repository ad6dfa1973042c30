"""Frequencies of the whole robot with its drives locked, against the exact dynamic stiffness of its legs."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof import dynamic_stiffness
from flexapod.proof.case import Case, Check
from flexapod.proof.locked_robot import legs_and_body, missing_polynomials, missing_sines, wave_number
from flexapod.proof.unlike import unlike_legs, without_cylinders, without_gravity
from flexapod.study.static import modes
from flexapod.typing import Array

HOME = (0.0,) * 6
ROLLED = (0.01, -0.02, 0.03, np.deg2rad(20.0), 0.05, 0.1)
AXIAL = 2  # axial shapes
ROUNDING = 1e-10  # of the eigenproblem: eps times the spread of the squared frequencies
SHOWN = {1: "payload", 7: "first bending", 18: "second bending"}  # of the frequencies, in ascending order
ASSUMED = ("assumed-modes", (1, 2, 3, 6))
LADDER = (ASSUMED, ("beam-fem", (4, 8)), ("finite-segment", (4, 8)))  # shapes a plane: two an element, one a segment
FEWEST = {"assumed-modes": 2, "beam-fem": 8, "finite-segment": 8}  # shapes that can follow the second bending mode


def _bound(legs: list[dynamic_stiffness.Leg], frequency: Array, fidelity: str, shapes: int) -> Array:
    """What the shapes leave out of the frequencies, relative."""
    rest = missing_sines(legs, frequency, AXIAL) + ROUNDING
    if fidelity == "beam-fem":
        return 1.2 * (wave_number(legs, frequency) / (shapes / 2)) ** 4 / 1440 + rest
    if fidelity == "finite-segment":
        return (wave_number(legs, frequency) / shapes) ** 2 / 24 + rest
    return missing_polynomials(legs, frequency, shapes) + rest


def _compute() -> list[Check]:
    layout = model.preset("paper-robot")
    robot, found = without_gravity(layout.robot), []
    for name, body, pose, ladder in (
        ("preset", robot, HOME, LADDER),
        ("no cylinders", without_cylinders(robot), HOME, LADDER),
        ("unlike legs, rolled", unlike_legs(robot), ROLLED, (ASSUMED,)),
    ):
        legs, payload = legs_and_body(body, pose)
        exact = dynamic_stiffness.robot_frequencies(legs, payload, max(SHOWN))
        for fidelity, rungs in ladder:
            for shapes in rungs:
                ours = modes(body, pose, fidelity=fidelity, modes=shapes, axial_modes=AXIAL).frequency.values
                bound = _bound(legs, exact, fidelity, shapes)
                found += [
                    Check(
                        what=f"{name}, {fidelity}, {shapes} shapes, {kind}",
                        reference=float(exact[i - 1]),
                        ours=float(ours[i - 1]),
                        tolerance=float(bound[i - 1]),
                        unit="Hz",
                    )
                    for i, kind in SHOWN.items()
                    if kind != "second bending" or shapes >= FEWEST[fidelity]
                ]
    return found


LOCKED_ROBOT = Case(
    name="locked-robot",
    statement="Frequencies of the 6-UPS robot about the undeformed pose, drives locked: with and without cylinders, "
    "with six different legs, up the ladder of shapes",
    source="exact dynamic stiffness of uniform pinned legs, transcendental in the frequency; roots counted after "
    "Wittrick & Williams 1971, none missed",
    argument="what the shapes leave out: polynomials of degree k of a sine; cubic elements (lambda / n)^4 / 1440 and a "
    "fifth of it for the next term; straight segments (lambda / n)^2 / 24; sines of the bars beyond the second shape",
    compute=_compute,
)
