"""Beams and robots against Exudyn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Literal

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.verification.case import Case, Check, case, checks, curve_checks
from flexapod.verification.cases.turning import DURATION, TABLE
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_actuator import simulate_actuator as exudyn_actuator
from flexapod.verification.engines.exudyn_integration import Integration, extrapolate_first_order
from flexapod.verification.engines.exudyn_robot import MESHES, STEP, simulate_robot
from flexapod.verification.robots import with_legs

SPIN_UP_STEP, ELEMENTS = 5e-3, 16


@case(
    "Lag of the tip of a beam spun up in 15 s, three shapes, against 16 nonlinear cable elements",
    source="Exudyn, run on the spot; the beams of Simo & Vu-Quoc 1986, Wu & Haug 1988",
    argument="ours is of second order in a lag of a tenth of the length: wrong by 0.1 to 0.3 %; mesh and step: 0.02 %",
    engine=EXUDYN,
)
def _exudyn_spin_up() -> Iterator[Check]:
    for name, (length, EI, EA, rhoA), rate, *_ in TABLE:
        study = model.ActuatorStudy(
            actuator=model.Actuator(length=length, free_length=length, rhoA=rhoA, EI=EI),
            motion=model.ActuatorMotion(rotation=model.SpinUpLaw(rate=rate, duration=DURATION)),
            simulation=model.Simulation(basis="clamped-free", duration=DURATION),
        )
        theirs = exudyn_actuator(
            study, Integration(duration=DURATION, step=SPIN_UP_STEP), elements=ELEMENTS, axial_stiffness=EA
        ).tip_deflection
        ours = simulate_actuator(study, modes=3, step=SPIN_UP_STEP, output_step=SPIN_UP_STEP).tip_deflection.values
        peak = float(theirs.min())
        worst = float(np.abs(ours - theirs).max())
        yield from [
            Check(f"{name}, peak lag", peak, float(ours.min()), 5e-3, "m"),
            Check(f"{name}, largest difference of the lag in 15 s", 0.0, worst, 5e-3 * abs(peak), "m", absolute=True),
        ]


SLIDING_STEP = 1e-3


def _sliding_beam(duration: float, elements: int) -> list[Check]:
    study = model.override(model.preset("paper-actuator"), duration=duration)
    plan = Integration(duration=duration, step=SLIDING_STEP, tolerance=1e-5)
    coarse, fine = (exudyn_actuator(study, plan, elements=n).tip_deflection for n in (elements, 2 * elements))
    theirs = extrapolate_first_order(coarse, fine)
    ours = simulate_actuator(study, modes=3, step=SLIDING_STEP, output_step=SLIDING_STEP).tip_deflection.values
    peak, half = float(np.abs(theirs).max()), float(np.abs(fine - coarse).max()) / 2
    worst = float(np.abs(ours - theirs).max())
    return [
        Check(f"largest difference of the tip in {duration:g} s", 0.0, worst, half, "m", absolute=True),
        Check("largest deflection of the tip", peak, float(np.abs(ours).max()), half / peak, "m"),
    ]


SLIDING = [
    Case(
        name=name,
        statement=f"Tip of the beam of the paper's Table 2, {time}, against {elements} and {2 * elements} cable "
        "elements, extrapolated",
        source="Exudyn, run on the spot: cables that slide through a clamp",
        argument="a clamp that slides through elements is of first order in their length: the meshes differ by what "
        "the finer one is wrong, and half of it is allowed after extrapolation; the same step in both",
        compute=partial(_sliding_beam, duration, elements),
        engine=EXUDYN,
        slow=name.endswith("long"),
    )
    for name, time, duration, elements in (
        ("exudyn-sliding-beam", "the first 3 s", 3.0, 36),
        ("exudyn-sliding-beam-long", "10 s", 10.0, 72),
    )
]

MOTION = model.CombinedMotion(
    amplitudes={"surge": 0.02, "sway": -0.015, "heave": 0.03, "roll": 0.1, "pitch": -0.08, "yaw": 0.15},
    duration=0.4,
    profile="smooth",
    pivot=np.array([0.02, 0.05, 0.1]),
)


@case(
    "Drive forces and path of the preset paper-robot, rigid, moved and turned in all six directions in 0.4 s",
    source="Exudyn, run on the spot: kinematic trees, spherical joints, prescribed strokes",
    argument="Exudyn's step of 0.25 ms: 0.04 N of 3,100 N, falling with its square; constraints to Newton's tolerance",
    engine=EXUDYN,
)
def _exudyn_rigid_robot() -> list[Check]:
    study = model.preset("paper-robot")
    theirs = simulate_robot(study.robot, MOTION, Integration(duration=0.5, tolerance=1e-8), elements=0)
    ours = kinematics.inverse_dynamics(study.robot, kinematics.poses(study.robot, MOTION, theirs.time)).actuator_force
    peak, worst = np.abs(theirs.actuator_force), float(np.abs(ours - theirs.actuator_force).max())
    off, names = float(np.abs(theirs.com_deviation).max()), [f"largest drive force of leg {i}" for i in range(1, 7)]
    return [
        *checks(names, peak.max(axis=0), np.abs(ours).max(axis=0), 1e-4, "N"),
        Check("largest difference of a drive force", 0.0, worst, 1e-4 * float(peak.max()), "N", absolute=True),
        Check("largest deviation from the path", 0.0, off, 1e-10, "m", absolute=True),
    ]


_SOURCE = "Exudyn, run on the spot: pistons of 30 and 60 cable elements slide through two rings; extrapolated"


def _robot(amplitude: float, travel: float, duration: float) -> Iterator[Check]:
    motion = model.AxisMotion(type="roll", amplitude=np.deg2rad(amplitude), duration=travel)
    pair = _curve_pairs("paper-robot", motion, duration)
    theirs, ours = pair("com_deviation")
    yield from checks(["sag at the start, y", "sag at the start, z"], theirs[0, 1:], ours[0, 1:], 1e-5, "m")
    for i, axis in enumerate("xyz"):
        yield from curve_checks(f"deviation, {axis}", theirs[:, i], ours[:, i], 2e-3, 1e-2, "m")
    yield from _forces_and_tips(pair)


def _curve_pairs(
    preset: Literal["paper-robot", "tripod"], motion: model.Motion, duration: float
) -> Callable[[str], tuple[Array, Array]]:
    """Results of a preset's undamped robot by name: Exudyn's, extrapolated from two meshes, and ours."""
    robot = with_legs(model.preset(preset).robot, damping=0.0)
    plan = Integration(duration=duration, step=STEP)
    coarse, fine = (simulate_robot(robot, motion, plan, elements=n, guide=d, time_limit=900.0) for n, d in MESHES)
    data = simulate(robot, motion, modes=3, axial_modes=2, step=STEP, output_step=STEP, duration=duration)
    return lambda name: (extrapolate_first_order(getattr(coarse, name), getattr(fine, name)), data[name].values)


def _forces_and_tips(pair: Callable[[str], tuple[Array, Array]]) -> Iterator[Check]:
    yield from curve_checks("drive force", *pair("actuator_force"), 5e-4, 2e-3, "N")
    yield from curve_checks("deflection of a tip", *pair("tip_deflection"), 1e-2, 4e-2, "m")


FLEXIBLE = [
    Case(
        name=name,
        statement=f"Deviation, drive forces and deflections of the preset paper-robot, undamped, {path}",
        source=_SOURCE,
        argument="rings a distance d apart are softer than a clamp by about d/s, 0.8 % of the deflection of a tip at "
        "d = 5 mm, of first order, and let it vibrate more slowly; the deviation is stretch and hears of it by "
        "vibration only; the same step in both",
        compute=partial(_robot, *numbers),
        engine=EXUDYN,
        slow=name.endswith("paper"),
    )
    for name, path, numbers in (
        ("exudyn-robot", "roll of 10 deg in 0.4 s", (10.0, 0.4, 0.4)),
        ("exudyn-robot-paper", "on its own path of 2 s", (26.6, 1.0, 2.0)),
    )
]


@case(
    "Deviation, drive forces and deflections of the preset tripod (3-RPS), undamped, heave of 10 mm and "
    "roll of 0.06 rad in 0.2 s: its pistons bend across their hinges, and the payload moves along at first order",
    source=_SOURCE,
    argument="rings a distance d apart are softer than a clamp by about d/s, of first order: 1 % of deflections on "
    "the finer mesh, a few parts in a thousand after extrapolation; here the deviation is bending; the same step in "
    "both",
    engine=EXUDYN,
)
def _exudyn_tripod() -> Iterator[Check]:
    motion = model.CombinedMotion(amplitudes={"heave": 0.01, "roll": 0.06}, duration=0.2)
    pair = _curve_pairs("tripod", motion, 0.3)
    theirs, ours = pair("com_deviation")
    yield Check("sag at the start, z", theirs[0, 2], ours[0, 2], 1e-4, "m")
    yield from curve_checks("deviation, y", theirs[:, 1], ours[:, 1], 1e-2, 4e-2, "m")
    yield from _forces_and_tips(pair)
