"""Files for other programs, read and run by these."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.kinematics import inverse_dynamics
from flexapod.analysis.static import stiffness
from flexapod.output.exchange.mjcf import mjcf
from flexapod.verification.case import Check, case
from flexapod.verification.engines import mujoco_forces
from flexapod.verification.engines.engine import MUJOCO
from flexapod.verification.engines.mujoco_rest import AtRest

ROBOTS = ("paper-robot", "machine-hexapod", "tripod", "flight-simulator", "nano-hexapod")
AMPLITUDES = {"heave": 0.02, "roll": 0.1, "pitch": -0.08}


def _study(name: str) -> model.Study:
    return model.preset(name)  # type: ignore[return-value]


@case(
    "Stiffness at the tool of robots written as MJCF, with legs that stretch and bend: largest difference of an entry "
    "over the mean of its diagonal ones",
    source="MuJoCo, differences of its equilibria, loops held by its soft constraints",
    argument="loops are two steps fast and 1e-4 of a force is lost in them: parts in 1e5 of a leg; springs stand at "
    "home, micrometres from the equilibrium",
    engine=MUJOCO,
)
def _export_mjcf_stiffness() -> Iterator[Check]:
    for name in ROBOTS:
        study = _study(name)
        ours = stiffness(study, load=np.zeros(6)).stiffness.values
        theirs = np.linalg.inv(AtRest(str(mjcf(study).files[""])).compliance(np.diag(np.linalg.inv(ours))))
        scale = np.sqrt(np.diag(ours))
        gap = float(np.abs((theirs - ours) / np.outer(scale, scale)).max())
        yield Check(f"{name}", 0.0, gap, 1e-3, absolute=True)


@case(
    "Drive forces of rigid robots written as MJCF, in motion: largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the trees in the file",
    argument="exact but for what turns between pistons and platform without mass, which is given a millionth of the "
    "payload's inertia",
    engine=MUJOCO,
)
def _export_mjcf_forces() -> Iterator[Check]:
    motion = model.CombinedMotion(amplitudes=AMPLITUDES, duration=0.4)  # type: ignore[arg-type]
    for name in ("paper-robot", "tripod", "flight-simulator"):
        study = _study(name)
        ours = inverse_dynamics(study.robot, motion, output_step=0.02)
        path = kinematics.poses(study.robot, motion, ours.time.values)
        text = str(mjcf(study, fidelity="rigid").files[""])
        theirs = mujoco_forces.inverse_dynamics(study.robot, path, text=text).actuator_force
        largest = float(np.abs(theirs).max())
        gap = float(np.abs(ours.drive_force_rigid.values - theirs).max()) / largest
        yield Check(f"{name}", 0.0, gap, 1e-6, absolute=True)
