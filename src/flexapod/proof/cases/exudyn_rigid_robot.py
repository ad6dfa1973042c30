"""The rigid robot in all six directions at once, against Exudyn."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.proof.case import Case, Check, checks
from flexapod.proof.engines.engine import EXUDYN
from flexapod.proof.engines.exudyn_integration import Integration
from flexapod.proof.engines.exudyn_robot import simulate_robot

MOTION = model.CombinedMotion(
    amplitudes={"surge": 0.02, "sway": -0.015, "heave": 0.03, "roll": 0.1, "pitch": -0.08, "yaw": 0.15},
    duration=0.4,
    profile="smooth",
    pivot=np.array([0.02, 0.05, 0.1]),
)


def _compute() -> list[Check]:
    study = model.preset("paper-robot")
    theirs = simulate_robot(study.robot, MOTION, Integration(duration=0.5, tolerance=1e-8), elements=0)
    ours = rigid.inverse_dynamics(study.robot, rigid.poses(study.robot, MOTION, theirs.time)).actuator_force
    peak, worst = np.abs(theirs.actuator_force), float(np.abs(ours - theirs.actuator_force).max())
    return [
        *checks(
            [f"largest drive force of leg {i}" for i in range(1, 7)],
            peak.max(axis=0),
            np.abs(ours).max(axis=0),
            1e-4,
            "N",
        ),
        Check(
            what="largest difference of a drive force",
            reference=0.0,
            ours=worst,
            tolerance=1e-4 * float(peak.max()),
            unit="N",
            absolute=True,
        ),
        Check(
            what="largest deviation from the path",
            reference=0.0,
            ours=float(np.abs(theirs.com_deviation).max()),
            tolerance=1e-10,
            unit="m",
            absolute=True,
        ),
    ]


EXUDYN_RIGID_ROBOT = Case(
    name="exudyn-rigid-robot",
    statement="Drive forces and path of the preset paper-robot, rigid, moved and turned in all six directions in 0.4 s",
    source="Exudyn, run on the spot: kinematic trees, spherical joints, prescribed strokes",
    argument="Exudyn's step of 0.25 ms: 0.04 N of 3,100 N, falling with its square; constraints to Newton's tolerance",
    compute=_compute,
    engine=EXUDYN,
)
