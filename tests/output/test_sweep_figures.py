"""Figures of sweeps: which form for what varies, failed points shown, refusals."""

import numpy as np
import pytest
from tests.helpers.sweeps import diameters, quick

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.output.figures.sweep import sweep as draw

pytestmark = pytest.mark.unit

PROFILES = {"key": "motion.profile", "values": ["quintic", "cycloidal"]}
DRAWS = {"count": 12, "tolerance": [{"key": "payload.mass", "normal": "1 %"}]}


def swept(sweep):
    return fx.sweep(quick(), sweep, workers=0)


def labels(fig):
    axes = fig.axes[0]
    return axes.get_xlabel(), axes.get_ylabel()


def test_curve_with_failed_points():
    values = ["-1 mm", "25 mm", "30 mm"]
    fig = draw(swept({"vary": [{"key": "leg.piston.diameter", "values": values}]}))
    assert labels(fig) == ("leg.piston.diameter [mm]", "largest deviation of the centre of mass [mm]")
    failed = [line for line in fig.axes[0].lines if line.get_label() == "failed"]
    assert failed[0].get_xdata().tolist() == [-1.0]


def test_curve_of_a_choice():
    fig = draw(swept({"vary": [PROFILES]}))
    assert [label.get_text() for label in fig.axes[0].get_xticklabels()] == ["quintic", "cycloidal"]


def test_band():
    fig = draw(swept({**diameters(3), "random": DRAWS}))
    assert [text.get_text() for text in fig.axes[0].get_legend().get_texts()] == ["5th to 95th percentile", "median"]


def test_map():
    data = swept(diameters(3, more=[{"key": "payload.mass", "values": [50, 100]}]))
    fig = draw(data, "com_deviation_peak")
    assert labels(fig) == ("leg.piston.diameter [mm]", "payload.mass [kg]")
    shown = fig.axes[0].collections[0].get_array()
    np.testing.assert_allclose(np.asarray(shown).T.ravel(), 1e3 * data.com_deviation_peak.values, rtol=1e-12)


def test_a_list_is_drawn_by_its_values_or_their_numbers():
    """A key that holds a list once ended the command after everything had been computed."""
    places = {"key": "payload.com", "values": [[0, 0, 0], [0, 0.1, 0]]}
    fig = draw(swept({"vary": [places]}))
    assert [label.get_text() for label in fig.axes[0].get_xticklabels()] == ["[0, 0, 0]", "[0, 0.1, 0]"]
    assert labels(fig)[0] == "payload.com [m]"
    inertia = [[9, 0, 0], [0, 9, 0], [0, 0, 9]], [[18, 0, 0], [0, 18, 0], [0, 0, 18]]
    tables = {"key": "payload.inertia", "values": list(inertia)}
    fig = draw(swept({"vary": [tables, places]}))
    assert labels(fig) == ("payload.inertia [kg m^2] (number of the value)", "payload.com [m]")
    assert [label.get_text() for label in fig.axes[0].get_xticklabels()] == ["1", "2"]


def test_keys_together_are_drawn_against_the_first_single_number():
    together = {"payload.com": [[0, 0, 0], [0, 0.1, 0]], "payload.mass": [50, 100]}
    assert labels(draw(swept({"vary": [{"together": together}]})))[0] == "payload.mass [kg]"


def test_histogram():
    fig = draw(swept({"random": DRAWS}))
    assert sum(bar.get_height() for bar in fig.axes[0].patches) == 12
    assert [text.get_text().split("\n")[0] for text in fig.axes[0].texts] == ["5 %", "median", "95 %"]


def test_panels():
    ranges = {"payload.mass": [50, 100], "leg.piston.diameter": ["20 mm", "30 mm"]}
    fig = draw(swept({"latin_hypercube": {"count": 5, "ranges": ranges}}))
    assert [axes.get_xlabel() for axes in fig.axes[:2]] == ["payload.mass [kg]", "leg.piston.diameter [mm]"]


def test_the_first_quantity_with_a_value_is_drawn():
    """Rigid legs on held strokes have no frequency: the figure of such a sweep was once refused."""
    made = fx.sweep(quick(), diameters(2, scalars=["first_frequency", "com_deviation_peak"]), workers=0)
    made["first_frequency"][:] = np.nan
    assert "centre of mass" in draw(made).axes[0].get_ylabel() + draw(made).axes[0].get_title()


def test_refusals():
    data = swept(diameters(2))
    with pytest.raises(InputError, match="is not a quantity of this sweep"):
        draw(data, "peak")
    data["com_deviation_peak"][:] = np.nan
    with pytest.raises(InputError, match="has no computed point"):
        draw(data)
