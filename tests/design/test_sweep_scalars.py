"""Scalars of a sweep, which come from the record, against the Dataset and the summary of a run."""

import numpy as np
import pytest
from tests.helpers.sweeps import quick_text

import flexapod as fx
from flexapod.analysis import summary
from flexapod.analysis.scalars import ROBOT_SCALARS
from flexapod.design.sweeps.outputs import select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.design.sweeps.worker import compute_point
from flexapod.model import loads

pytestmark = pytest.mark.consistency

SERVO = ('drive = { type = "prescribed" }', 'drive = { type = "servo", stiffness = "20 N/um", damping = 1000 }')
TOOL = ("# tool = [0, 0,", "tool = [0, 0,")
BENDING = ('fidelity = "lumped"', 'fidelity = "assumed-modes"\nmodes = 2')
# The same formulas in another order: the largest terms are metres, the results micrometres, and the sums of a few.
ROUNDING = {"rel": 1e-12, "abs": 1e-15}


@pytest.mark.parametrize("changes", [(BENDING, TOOL), (BENDING, TOOL, SERVO), ()], ids=["bending", "servo", "lumped"])
def test_scalars_are_those_of_a_run(changes):
    study = loads(quick_text(*changes))
    plan = read_plan({"vary": [{"key": "payload.mass", "values": [100]}], "keep": {"scalars": list(ROBOT_SCALARS)}})
    points = Points(study, plan)
    result = compute_point(select_outputs(plan.keep, study, points.resolve()), points.study(0))
    assert result.failure == ""
    found, data = result.values, fx.run(study)
    com, tool = summary(data), summary(data, "tool")
    for name, point in (("com", com), ("tool", tool)):
        assert found[f"{name}_deviation_peak"] == pytest.approx(point.peak, **ROUNDING)
        assert found[f"{name}_deviation_rms"] == pytest.approx(point.rms, **ROUNDING)
        assert found[f"{name}_deviation_start"] == pytest.approx(point.start, **ROUNDING)
        assert found[f"{name}_deviation_peak_by_axis"] == pytest.approx([a.peak for a in point.axes], **ROUNDING)
        assert found[f"{name}_deviation_rms_by_axis"] == pytest.approx([a.rms for a in point.axes], **ROUNDING)
        first = data[f"{name}_deviation"].values[0]
        assert found[f"{name}_deviation_start_by_axis"] == pytest.approx(first, **ROUNDING)
    assert found["com_excursion_by_axis"] == pytest.approx([a.excursion for a in com.axes], **ROUNDING)
    # a share is a ratio of micrometres that are differences of metres: 1e-16 m over 1e-5 m
    assert found["cause_share"] == pytest.approx(list(com.causes.values()), abs=1e-9)
    turn = np.linalg.norm(data.rotation_deviation.values, axis=1).max()
    assert found["rotation_deviation_peak"] == pytest.approx(turn, **ROUNDING)
    force, tip = np.abs(data.actuator_force.values), np.linalg.norm(data.tip_deflection.values, axis=2)
    for name, values in (("actuator_force_peak", force), ("tip_deflection_peak", tip)):
        assert found[f"{name}_by_leg"] == pytest.approx(values.max(axis=0), **ROUNDING)
        assert found[name] == pytest.approx(values.max(), **ROUNDING)
    assert found["first_frequency"] == pytest.approx(float(fx.modes(study).frequency[0]), rel=1e-12)
    assert found["steps"] == data.attrs["steps"]
    # whether fixed steps follow what vibrates takes the modes, for which a sweep has no time
    said = [remark for remark in data.attrs["warnings"].splitlines() if "steps a period" not in remark]
    assert result.remarks.splitlines() == said


def test_stress_is_force_over_section_where_nothing_bends():
    study = loads(quick_text())
    plan = read_plan({"vary": [{"key": "payload.mass", "values": [100]}], "keep": {"scalars": ["stress_peak_by_leg"]}})
    points = Points(study, plan)
    stress = compute_point(select_outputs(plan.keep, study, points.resolve()), points.study(0)).values[
        "stress_peak_by_leg"
    ]
    data = fx.run(study)
    along = np.linalg.norm(data.joint_force.values, axis=2).max(axis=0)  # along the leg but for the leg's own weight
    area = np.pi * 0.027**2 / 4
    # 6 kg of leg against forces of some hundred newtons, a third of it across the leg
    assert stress == pytest.approx(along / area, rel=0.02)
