"""Figures that a page can zoom: the curves of the figure, at its places, thinned without losing its peaks."""

import base64
import json

import numpy as np
import pytest
from matplotlib.figure import Figure

from flexapod.output.report.plotly_export import plotly_figure
from flexapod.output.report.replay import MOST_POINTS, plotly_array
from flexapod.output.scene.geometry import decimation_indices

pytestmark = pytest.mark.unit


def unpacked(value):
    return np.frombuffer(base64.b64decode(value["bdata"]), dtype="<f4")


def drawn(*, log=False):
    figure = Figure(figsize=(6, 4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot([0, 1, 2], [1, 4, 2], color="#0072B2", linewidth=1.5, linestyle="--", label="a < b")
    above.axhline(3, color="#555555")
    above.axvspan(0.5, 1, facecolor="#E4E4E4")
    above.set_title("Above", loc="left")
    above.set_ylabel("force [kN]")
    above.annotate("peak", (1, 4), xytext=(6, -6), textcoords="offset points", va="top")
    above.legend()
    below.plot([0, 1, 2], [1, 10, 100], "s", color="#D55E00", label="not in the legend")
    below.set_xlabel("time [s]")
    if log:
        below.set_yscale("log")
    figure.draw_without_rendering()
    return figure


def test_curves_keep_values_colours_and_names():
    made = plotly_figure(drawn())
    first, second = made["data"]
    np.testing.assert_array_equal(unpacked(first["y"]), [1, 4, 2])
    assert first["line"]["color"] == "#0072b2" and first["line"]["dash"] != "solid"
    assert first["name"] == "a &lt; b" and first["showlegend"]
    assert not second["showlegend"]
    assert second["mode"] == "markers" and second["marker"]["symbol"] == "square"
    assert first["hovertemplate"] == "%{y:.5g} kN"


def test_panels_have_the_places_limits_and_words_of_the_figure():
    figure = drawn()
    layout = plotly_figure(figure)["layout"]
    box = figure.axes[1].get_position()
    assert layout["yaxis2"]["domain"] == [pytest.approx(box.y0, abs=1e-4), pytest.approx(box.y1, abs=1e-4)]
    assert layout["xaxis2"]["range"] == list(figure.axes[1].get_xlim())
    assert layout["xaxis2"]["matches"] == "x"  # the panels share it
    assert layout["xaxis2"]["title"]["text"] == "time [s]"
    texts = {note["text"]: note for note in layout["annotations"]}
    assert set(texts) == {"<b>Above</b>", "peak"}
    assert (texts["peak"]["x"], texts["peak"]["y"], texts["peak"]["yanchor"]) == (1.0, 4.0, "top")
    rule, band = layout["shapes"]
    assert (rule["yref"], rule["y0"], rule["xref"], rule["x1"]) == ("y", 3.0, "x domain", 1.0)
    assert (band["xref"], band["x0"], band["x1"], band["yref"]) == ("x", 0.5, 1.0, "y domain")


def test_logarithmic_axes_are_given_in_powers():
    figure = drawn(log=True)
    axis = plotly_figure(figure)["layout"]["yaxis2"]
    assert axis["type"] == "log"
    np.testing.assert_allclose(axis["range"], np.log10(figure.axes[1].get_ylim()))


def test_bars_and_areas():
    figure = Figure()
    axes = figure.subplots()
    axes.bar([1, 2], [3, -4], bottom=[0, 1], width=0.5)
    axes.fill_between([0, 1], [0, 0], [1, 2], color="#B8B8B8", alpha=0.5)
    area, bars = plotly_figure(figure)["data"]
    assert bars["x"] == [0.75, 1.75] and bars["y"] == [3, -4] and bars["base"] == [0, 1]
    assert area["fill"] == "toself" and area["fillcolor"] == "rgba(184, 184, 184, 0.5)"


def test_what_lies_above_in_the_figure_lies_above_on_the_page():
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], zorder=3, label="thin, above")
    axes.plot([0, 1], [0, 1], linewidth=5, label="wide, below")
    axes.legend()
    assert [trace["name"] for trace in plotly_figure(figure)["data"]] == ["wide, below", "thin, above"]


def test_what_has_no_counterpart_stays_a_picture():
    space, coloured = Figure(), Figure()
    space.add_subplot(projection="3d")
    coloured.subplots().pcolormesh(np.eye(3))
    assert plotly_figure(space) is None and plotly_figure(coloured) is None and plotly_figure(Figure()) is None


def test_thinning_keeps_ends_and_extremes():
    x = np.linspace(0, 10, 10_001)
    y = np.sin(40 * x)
    y[3333], y[7777] = 5.0, -5.0  # spikes of a single sample
    kept = decimation_indices(y[None], MOST_POINTS)
    short_x, short_y = x[kept], y[kept]
    assert len(short_x) <= MOST_POINTS + 2
    assert {x[0], x[-1], x[3333], x[7777]} <= set(short_x)
    assert (short_y.max(), short_y.min()) == (5.0, -5.0)
    np.testing.assert_array_equal(np.interp(short_x, x, y), short_y)
    assert len(decimation_indices(y[None, :100], MOST_POINTS)) == 100


def test_thinning_bears_gaps():
    y = np.full(4000, np.nan)
    y[100] = 1.0
    assert 100 in decimation_indices(y[None], MOST_POINTS)


def test_numbers_are_packed_with_their_shape():
    values = np.arange(6.0).reshape(2, 3)
    made = plotly_array(values)
    assert made["shape"] == "2, 3"
    np.testing.assert_array_equal(unpacked(made).reshape(2, 3), values)


@pytest.mark.parametrize("log", [False, True])
def test_plotly_knows_every_word_of_it(log):
    """plotly's own validators refuse unknown names and wrong values."""
    graph_objects = pytest.importorskip("plotly.graph_objects")
    made = plotly_figure(drawn(log=log))
    layout = {key: value for key, value in made["layout"].items() if key != "size"}
    figure = graph_objects.Figure(data=made["data"], layout=layout)
    assert len(figure.data) == 2
    json.dumps(made, allow_nan=False)


def test_areas_lie_below_curves():
    """The band of the printed deviation hid both paths in the report."""
    figure = Figure(figsize=(6, 4), layout="constrained")
    panel = figure.subplots()
    panel.plot([0, 1], [1, 2], label="path")
    panel.fill_between([0, 1], [0, 1], [2, 3])
    figure.draw_without_rendering()
    area, curve = plotly_figure(figure)["data"]
    assert area["fill"] == "toself" and curve["name"] == "path"
