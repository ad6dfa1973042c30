"""What is rounding beside the largest axis is shown as nothing; what `run` remarks on, `modes` remarks on as well."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import plot
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.results.summary import summary
from flexapod.app.browser.charts import Chart, _readout, charts
from flexapod.common.quantities import length, rounded_up

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def data():
    """A run of which x is nothing but rounding."""
    found = fx.simulate(paper_robot(fidelity="lumped"), duration=0.02, step=1e-3)
    for name in ("com_deviation", "tool_deviation", "deviation_by_cause"):
        found[name].loc[{"axis": "x"}] = 1e-9 * found[name].sel(axis="y").values
    return found


def test_rounding_is_zero_in_words(data):
    """Once "x 4.45e-07 nm"."""
    assert "(x 0, y " in summary(data).sentence


def test_panels_of_nothing_are_flat_on_the_scale_of_the_others(data):
    shown = plot.com_path(data, ("x", "y", "z")).axes[3:6]
    assert not any(np.any(line.get_ydata()) for line in shown[0].lines if len(line.get_xdata()) > 2)
    assert shown[0].get_ylim() in [other.get_ylim() for other in shown[1:]]


def test_causes_that_are_nothing_are_flat(data):
    """Panels of noise once had `1e-9` over their title, and the instant of their bars was that of the largest noise."""
    shown = plot.deviation_by_cause(data).axes
    panel = shown[0]
    assert not any(np.any(line.get_ydata()) for line in panel.lines if len(line.get_xdata()) > 2)
    assert panel.get_ylim() in [other.get_ylim() for other in (shown[2], shown[4])]
    assert f"at {summary(data).time:.2f} s" in shown[1].get_title(loc="left")


def test_tables_have_no_instant_of_nothing(data):
    x, y, _ = summary(data).shown_axes
    assert (x.peak, x.time, x.rms) == (0.0, None, 0.0)
    assert y == summary(data).axes[1]
    assert summary(data).axes[0].peak > 0  # as it was computed


def test_tables_have_no_travel_of_nothing(data):
    """A robot that did not leave a plane once travelled `1.632e-08 nm` across it."""
    told = summary(data)
    across = replace(told, axes=(replace(told.axes[0], excursion=1.6e-17), *told.axes[1:]))
    assert across.shown_axes[0].excursion == 0.0
    assert [a.excursion for a in across.shown_axes[1:]] == [a.excursion for a in told.axes[1:]]


def test_no_leg_is_named_where_legs_are_alike(data):
    """A symmetric heave once owed most to leg 1: the leg of the largest rounding."""
    alike = data.copy(deep=True)
    alike["deviation_by_cause"][:] = alike.deviation_by_cause.mean("leg")
    assert summary(data).worst_leg is not None
    assert summary(alike).worst_leg is None
    assert "most of it" not in summary(alike).sentence


def test_charts_of_the_page_hold_no_rounding(data):
    chart = charts(data)["deviation"]
    assert not chart.values[0].any()
    assert chart.values[1].any()


def test_shapes_that_hardly_move_are_flat():
    found = fx.simulate_actuator(fx.preset("paper-actuator"), duration=0.02, step=1e-3)
    found["mode_amplitude"][:, 1] = 1e-9 * found.mode_amplitude[:, 0].values
    first, second, *_ = plot.actuator_modes(found).axes
    assert not np.any(second.lines[0].get_ydata())
    assert second.get_ylim() == first.get_ylim()
    assert second.get_ylabel() == first.get_ylabel()


def test_a_sag_of_rounding_is_zero():
    assert length(3e-16) == "0 m"
    assert length(-3e-6) == "-3 µm"


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


def test_values_at_the_cursor_hold_no_rounding():
    """A robot at rest was off by `2.28e-12` of a micrometre, beside 29 later."""
    lines = np.array([[-2.28e-12, 29.0], [-0.606, -0.99], [np.nan, 1.0]])
    chart = Chart(title="", unit="um", time=np.arange(2.0), values=lines, names=tuple("xyz"), colors=("#000",) * 3)
    words = _readout(chart, 0.0)
    assert "x <b>0</b>" in words and "y <b>-0.606</b>" in words and "z <b>0</b>" not in words


@pytest.mark.parametrize(("value", "most"), [(0.0123, 0.02), (0.02, 0.02), (3.1, 5.0), (7.0, 10.0), (0.0, 0.0)])
def test_a_number_whose_digits_are_rounding_is_said_by_what_it_is_at_most(value, most):
    assert rounded_up(value) == pytest.approx(most, rel=1e-15)
