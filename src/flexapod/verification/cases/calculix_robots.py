"""Whole locked robots by CalculiX, from the deck that `flexapod export` writes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod import model
from flexapod.analysis.results.arguments import as_pose
from flexapod.analysis.static import modes
from flexapod.output.exchange.export import abaqus_deck
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.calculix_corrections import ONE_ELEMENT, robot_thick
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX
from flexapod.verification.robots import unlike_legs, without_cylinders, without_gravity

ROLLED = (0.01, -0.02, 0.03, np.deg2rad(20.0), 0.05, 0.1)
COUNT = 17  # the platform's six frequencies and first bending of the pistons
BENDING = slice(3, 13)  # of these the ones of the pistons, of the preset at home
SHAPES = model.Simulation(modes=6)  # to 1e-11 of the exact frequencies in first bending
MESHES = (16, 32)  # elements along a free piston
REST = 1e-5  # the spring for a locked stroke takes 5e-6; seven digits of a squared frequency
WEIGHT = 1.5e-4  # m g d / (2 omega^2 I) of a cylinder with what is inside, its joint below: 6 N m, 0.14 kg m^2, 63 Hz
TURNING = 1e-4  # of the sag: what turning joint forces add, m g times a platform's arm, over the stiffness about y


def _preset(name: str = "paper-robot") -> model.Robot:
    return model.preset(name).robot  # type: ignore[union-attr]


def _robot_frequencies(name: str, robot: model.Robot, pose: tuple[float, ...] | None) -> list[Check]:
    """CalculiX's frequencies in the limit of two meshes against ours with first-order shear and rotary inertia."""
    coarse, fine = (
        calculix.run(abaqus_deck(robot, pose, elements=n, modes=COUNT + 3)).frequencies()[:COUNT] for n in MESHES
    )
    limit = fine + (fine - coarse) / 15  # half the edges, a sixteenth of the error
    robot = robot.replace(legs=[leg.replace(axial_modes=4) for leg in robot.legs])
    found = robot_modes(robot, SHAPES, as_pose(robot, pose))
    ours = robot_thick(robot, found, ONE_ELEMENT)[:COUNT]
    correction = 1 - ours / found.frequency[:COUNT]
    tolerance = REST + correction**2 + 0.5 * np.abs(limit / fine - 1)
    return checks([f"{name}, mode {i}" for i in range(1, COUNT + 1)], limit, ours, tolerance, "Hz")


@case(
    "Frequencies of the whole locked robot without gravity: the preset, pistons without cylinders, six "
    "different legs at a rolled pose",
    source="CalculiX on the deck of `flexapod export`, pistons of 16 and 32 elements C3D20 and their limit",
    argument="ours with first-order shear and rotary inertia, 1e-4 to 1e-2; its square, half of what the limit of the "
    "meshes adds, and 1e-5 for the spring that locks a stroke",
    engine=CALCULIX,
)
def _calculix_robot() -> list[Check]:
    robot = without_gravity(_preset())
    return [
        *_robot_frequencies("preset", robot, None),
        *_robot_frequencies("no cylinders", without_cylinders(robot), None),
        *_robot_frequencies("unlike legs, rolled", unlike_legs(robot), ROLLED),
    ]


@case(
    "The locked robot under gravity, which shifts bending frequencies by -0.6 to 0.4 %: frequencies about "
    "the sagged state, and the sag",
    source="CalculiX, *STATIC with NLGEOM, then *FREQUENCY, on the deck of `flexapod export`",
    argument="as calculix-robot, and 1.5e-4 for the weight of a turning cylinder, which linear equations leave out, m "
    "g d / (2 omega^2 I); the sag 1e-4 for the turning payload, likewise: 390 N m over 5.7e6 N m",
    engine=CALCULIX,
)
def _calculix_prestress() -> list[Check]:
    robot = _preset()
    found = [replace(check, tolerance=check.tolerance + WEIGHT) for check in _robot_frequencies("preset", robot, None)]
    _, moved = calculix.run(abaqus_deck(robot)).displacements("PAYLOAD")
    theirs = 1e6 * moved[0].mean(axis=0)  # six equal masses about the centre
    ours = 1e6 * modes(robot).com_sag.values
    sag = checks(["sag y", "sag z"], theirs[1:], ours[1:], TURNING, "um")
    return [*found[BENDING], *sag]


@case(
    "Frequencies of the presets tripod (3-RPS), flight-simulator (6-UCU) and machine-hexapod (as drawn: "
    "joints and plates that give way, screws) under gravity, drives locked",
    source="CalculiX, *STATIC with NLGEOM, then *FREQUENCY, on the deck of `flexapod export`, 20 elements a piston",
    argument="shear and rotary inertia, which beams have not: ten times (thickness / length)^2 in stiffness, at most "
    "1e-2; and the weight of what turns, which the deck's linear equations leave out",
    engine=CALCULIX,
)
def _calculix_mechanisms() -> list[Check]:
    found = []
    for name in ("tripod", "flight-simulator", "machine-hexapod"):
        robot = _preset(name).replace(heat=None)
        theirs = calculix.run(abaqus_deck(robot, elements=20, modes=8)).frequencies()[:6]
        ours = modes(robot).frequency.values[:6]
        found += checks([f"{name}, mode {i}" for i in range(1, 7)], theirs, ours, 5e-3, "Hz")
    return found
