"""The flexible robot, against Exudyn."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

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
    study = model.preset("paper-robot")
    robot = study.robot.replace(legs=tuple(leg.replace(damping=0.0) for leg in study.robot.legs))
    motion = model.AxisMotion(type="roll", amplitude=np.deg2rad(amplitude), duration=travel)
    plan = Integration(duration=duration, step=STEP)
    coarse, fine = (exudyn_robot(robot, motion, plan, elements=n, guide=d, time_limit=900.0) for n, d in MESHES)
    data = simulate(robot, motion, modes=3, axial_modes=2, step=STEP, output_step=STEP, duration=duration)

    def pair(name: str) -> tuple[Array, Array]:
        return extrapolated(getattr(coarse, name), getattr(fine, name)), data[name].values

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
