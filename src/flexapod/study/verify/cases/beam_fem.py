"""The paper's sliding beam by elements on its free length and by assumed modes."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.study.actuator import simulate_actuator
from flexapod.study.verify.case import Case, Check
from flexapod.typing import Array

ELEMENTS, STEP, OUTPUT_STEP = 12, 5e-5, 5e-3
FIRST_HALF = 5.0  # s


def _tip(study: model.ActuatorStudy, **settings: object) -> Array:
    return np.asarray(simulate_actuator(study, step=STEP, output_step=OUTPUT_STEP, **settings).tip_deflection.values)  # pyright: ignore


def _compute() -> list[Check]:
    study = model.preset("paper-actuator")
    elements = _tip(study, fidelity="beam-fem", modes=2 * ELEMENTS)
    modes = _tip(study, fidelity="assumed-modes", basis="clamped-free", modes=6)
    peak, gap = float(np.abs(modes).max()), np.abs(elements - modes)
    early = np.arange(len(gap)) * OUTPUT_STEP <= FIRST_HALF
    return [
        Check(what=what, reference=0.0, ours=float(of.max()) / peak, tolerance=1e-3, unit="of the peak", absolute=True)
        for what, of in (("largest difference in 5 s", gap[early]), ("largest difference in 10 s", gap))
    ] + [
        Check(what="largest deflection", reference=peak, ours=float(np.abs(elements).max()), tolerance=1e-3, unit="m"),
    ]


BEAM_FEM = Case(
    name="beam-fem",
    statement="Tip of the beam of the paper's Table 2 over 10 s, every 5 ms: twelve cubic elements on the free length "
    "against six clamped-free shapes",
    source="assumed modes of this software, themselves checked in sliding-beam",
    argument="one thousandth of the peak: mode i of n elements runs ahead by (lambda / n)^4 / 1440 of its angle over "
    "10 s "
    "and has a share of lambda^-4 in the start: 0.33 % of 5 mm together, of the peak 0.12 % if all met at one instant; "
    "the "
    "same steps in both",
    compute=_compute,
)
