"""What is rounding beside the largest axis is shown as nothing; what `run` remarks on, `modes` remarks on as well."""

import numpy as np
import pytest
from tests.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import plot
from flexapod.study.estimates import buckling_load
from flexapod.study.summary import summary


@pytest.fixture(scope="module")
def data():
    """A run of which x is nothing but rounding."""
    found = fx.simulate(paper_robot(fidelity="lumped"), duration=0.02, step=1e-3)
    for name in ("com_deviation", "tool_deviation", "deviation_by_cause"):
        found[name].loc[{"axis": "x"}] = 1e-9 * found[name].sel(axis="y").values
    return found


def test_rounding_is_zero_in_words(data):
    """Once "x 4.45e-07 nm"."""
    assert "(x 0 m, y " in summary(data).sentence


def test_panels_of_nothing_are_flat_on_the_scale_of_the_others(data):
    shown = plot.com_path(data, ("x", "y", "z")).axes[3:6]
    assert not any(np.any(line.get_ydata()) for line in shown[0].lines if len(line.get_xdata()) > 2)
    assert shown[0].get_ylim() in [other.get_ylim() for other in shown[1:]]


def test_modes_and_stiffness_remark_on_buckling():
    """At 95 % of the Euler load `run` and `check` had words and `modes` had none."""
    study = paper_robot(modes=3)
    calm = fx.modes(study)
    assert "Euler" not in calm.attrs["warnings"]
    start = fx.simulate(study, duration=1e-3, step=1e-3).isel(time=0)
    thrust = float(np.linalg.norm(start.joint_force, axis=1).max())
    free = study.robot.home_lengths[0] - study.robot.legs[0].cylinder.mouth
    soft = thrust / 0.8 / buckling_load(study.robot.legs[0], np.array([free]))[0]
    near = with_legs(study, lambda leg: leg.replace(
        piston=leg.piston.replace(EI=leg.piston.EI * soft, diameter=None, E=None, density=None)))  # fmt: skip
    for found in (fx.modes(near), fx.stiffness(near)):
        assert "of the Euler load" in found.attrs["warnings"]
        assert "at t =" not in found.attrs["warnings"]
