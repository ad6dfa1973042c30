"""The paper's beam that slides out of a turning hub, against Exudyn."""

from __future__ import annotations

from functools import partial

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.proof.engines.engine import EXUDYN
from flexapod.proof.engines.exudyn_actuator import simulate_actuator as exudyn_actuator
from flexapod.proof.engines.exudyn_integration import Integration, extrapolated
from flexapod.study.actuator import simulate_actuator

STEP = 1e-3


def _compute(duration: float, elements: int) -> list[Check]:
    study = model.override(model.preset("paper-actuator"), duration=duration)
    plan = Integration(duration=duration, step=STEP, tolerance=1e-5)
    coarse, fine = (exudyn_actuator(study, plan, elements=n).tip_deflection for n in (elements, 2 * elements))
    theirs = extrapolated(coarse, fine)
    ours = simulate_actuator(study, modes=3, step=STEP, output_step=STEP).tip_deflection.values
    between = float(np.abs(fine - coarse).max())
    return [
        Check(
            what=f"largest difference of the tip in {duration:g} s",
            reference=0.0,
            ours=float(np.abs(ours - theirs).max()),
            tolerance=between / 2,
            unit="m",
            absolute=True,
        ),
        Check(
            what="largest deflection of the tip",
            reference=float(np.abs(theirs).max()),
            ours=float(np.abs(ours).max()),
            tolerance=between / 2 / float(np.abs(theirs).max()),
            unit="m",
        ),
    ]


_ARGUMENT = (
    "a clamp that slides through elements is of first order in their length: the meshes differ by what the finer one "
    "is wrong, and half of it is allowed after extrapolation; the same step in both"
)

EXUDYN_SLIDING_BEAM = Case(
    name="exudyn-sliding-beam",
    statement="Tip of the beam of the paper's Table 2, the first 3 s, against 36 and 72 cable elements, extrapolated",
    source="Exudyn, run on the spot: cables that slide through a clamp",
    argument=_ARGUMENT,
    compute=partial(_compute, 3.0, 36),
    engine=EXUDYN,
)

EXUDYN_SLIDING_BEAM_LONG = Case(
    name="exudyn-sliding-beam-long",
    statement="Tip of the beam of the paper's Table 2, 10 s, against 72 and 144 cable elements, extrapolated",
    source="Exudyn, run on the spot: cables that slide through a clamp",
    argument=_ARGUMENT,
    compute=partial(_compute, 10.0, 72),
    engine=EXUDYN,
    slow=True,
)
