"""The flexible robot, against Exudyn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Literal

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.proof.engines.engine import EXUDYN
from flexapod.proof.engines.exudyn_integration import Integration, extrapolated
from flexapod.proof.engines.exudyn_robot import MESHES, STEP
from flexapod.proof.engines.exudyn_robot import simulate_robot as exudyn_robot
from flexapod.study.simulation import simulate
from flexapod.typing import Array


def _compute(amplitude: float, travel: float, duration: float) -> list[Check]:
    motion = model.AxisMotion(type="roll", amplitude=np.deg2rad(amplitude), duration=travel)
    pair = _curve_pairs("paper-robot", motion, duration)
    theirs, ours = pair("com_deviation")
    start = [
        Check(what=f"sag at the start, {axis}", reference=theirs[0, i], ours=ours[0, i], tolerance=1e-5, unit="m")
        for i, axis in ((1, "y"), (2, "z"))
    ]
    forces, tips = pair("actuator_force"), pair("tip_deflection")
    return [
        *start,
        *_curves([f"deviation, {axis}" for axis in "xyz"], theirs, ours, 2e-3, 1e-2, "m"),
        *_curves(["drive force"], forces[0].reshape(-1, 1), forces[1].reshape(-1, 1), 5e-4, 2e-3, "N"),
        *_curves(["deflection of a tip"], tips[0].reshape(-1, 1), tips[1].reshape(-1, 1), 1e-2, 4e-2, "m"),
    ]


def _tripod() -> list[Check]:
    motion = model.CombinedMotion(amplitudes={"heave": 0.01, "roll": 0.06}, duration=0.2)
    pair = _curve_pairs("tripod", motion, 0.3)
    (theirs, ours), forces, tips = (pair(name) for name in ("com_deviation", "actuator_force", "tip_deflection"))
    return [
        Check(what="sag at the start, z", reference=theirs[0, 2], ours=ours[0, 2], tolerance=1e-4, unit="m"),
        *_curves(["deviation, y"], theirs[:, 1:2], ours[:, 1:2], 1e-2, 4e-2, "m"),
        *_curves(["drive force"], forces[0].reshape(-1, 1), forces[1].reshape(-1, 1), 5e-4, 2e-3, "N"),
        *_curves(["deflection of a tip"], tips[0].reshape(-1, 1), tips[1].reshape(-1, 1), 1e-2, 4e-2, "m"),
    ]


def _curve_pairs(
    preset: Literal["paper-robot", "tripod"], motion: model.Motion, duration: float
) -> Callable[[str], tuple[Array, Array]]:
    """Results of a preset's undamped robot by name: Exudyn's, extrapolated from two meshes, and ours."""
    study = model.preset(preset)
    robot = study.robot.replace(legs=tuple(leg.replace(damping=0.0) for leg in study.robot.legs))
    plan = Integration(duration=duration, step=STEP)
    coarse, fine = (exudyn_robot(robot, motion, plan, elements=n, guide=d, time_limit=900.0) for n, d in MESHES)
    data = simulate(robot, motion, modes=3, axial_modes=2, step=STEP, output_step=STEP, duration=duration)
    return lambda name: (extrapolated(getattr(coarse, name), getattr(fine, name)), data[name].values)


def _curves(
    names: list[str], theirs: Array, ours: Array, of_peak: float, of_curve: float, unit: str
) -> Iterator[Check]:
    """Checks of the largest value and of the largest difference of each column."""
    for name, x, y in zip(names, theirs.T, ours.T, strict=True):
        peak = float(np.abs(x).max())
        yield Check(what=f"{name}, largest", reference=peak, ours=float(np.abs(y).max()), tolerance=of_peak, unit=unit)
        yield Check(
            what=f"{name}, largest difference",
            reference=0.0,
            ours=float(np.abs(x - y).max()),
            tolerance=of_curve * peak,
            unit=unit,
            absolute=True,
        )


_SOURCE = "Exudyn, run on the spot: pistons of 30 and 60 cable elements slide through two rings; extrapolated"
_ARGUMENT = (
    "rings a distance d apart are softer than a clamp by about d/s, 0.8 % of the deflection of a tip at d = 5 mm, of "
    "first order, and let it vibrate more slowly; the deviation is stretch and hears of it by vibration only; the same "
    "step in both"
)

EXUDYN_ROBOT = Case(
    name="exudyn-robot",
    statement="Deviation, drive forces and deflections of the preset paper-robot, undamped, roll of 10 deg in 0.4 s",
    source=_SOURCE,
    argument=_ARGUMENT,
    compute=partial(_compute, 10.0, 0.4, 0.4),
    engine=EXUDYN,
)

EXUDYN_ROBOT_PAPER = Case(
    name="exudyn-robot-paper",
    statement="Deviation, drive forces and deflections of the preset paper-robot, undamped, on its own path of 2 s",
    source=_SOURCE,
    argument=_ARGUMENT,
    compute=partial(_compute, 26.6, 1.0, 2.0),
    engine=EXUDYN,
    slow=True,
)

EXUDYN_TRIPOD = Case(
    name="exudyn-tripod",
    statement="Deviation, drive forces and deflections of the preset tripod (3-RPS), undamped, heave of 10 mm and roll "
    "of 0.06 rad in 0.2 s: its pistons bend across their hinges, and the payload moves along at first order",
    source=_SOURCE,
    argument="rings a distance d apart are softer than a clamp by about d/s, of first order: 1 % of deflections on the "
    "finer mesh, a few parts in a thousand after extrapolation; here the deviation is bending; the same step in both",
    compute=_tripod,
    engine=EXUDYN,
)
