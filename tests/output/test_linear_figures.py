"""Figures of linear systems: what they show is in the data, channels by name, units in labels."""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod import plot
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit

HZ = np.geomspace(0.1, 100, 200)


def mode(c=3.0):
    return fc.StateSpace(
        A=[[0, 1], [-900.0, -c]], B=[[0, 0], [0.5, -1]], C=[[1, 0], [-1800.0, 0]], D=[[0, 0], [1, 0]],
        inputs=("drive:1", "floor:z"), outputs=("tool:z", "force-sensor:base:1"), states=("z", "v"),
        units={"drive:1": "N", "floor:z": "m/s^2", "tool:z": "m", "force-sensor:base:1": "N"},
    )  # fmt: skip


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_bode_shows_named_channels_of_several_results():
    fig = plot.bode(mode().frequency_response(HZ), inputs="drive")
    size, phase = fig.axes
    assert labels(size) == ["tool:z by drive:1", "force-sensor:base:1 by drive:1"]
    assert "SI units" in size.get_ylabel() and phase.get_ylabel() == "phase [deg]"
    np.testing.assert_allclose(size.lines[0].get_ydata(), np.abs(mode().at(HZ)[0, 0]))
    both = {"open": mode().frequency_response(HZ), "damped": mode(30.0).frequency_response(HZ)}
    size, _ = plot.bode(both, "drive", "tool").axes
    assert labels(size) == ["open", "damped"] and size.get_title(loc="left") == "tool:z by drive:1"
    assert size.get_ylabel() == "size [m/N]"
    assert plot.bode(both["open"], "floor", "tool").axes[0].get_ylabel() == "size [m/(m/s^2)]"


def test_what_symmetry_makes_zero_is_not_drawn_as_noise():
    C = [[1.0, 0], [1e-12, 0], [3e-9, 0], [1e-7, 0]]  # rounding, in metres and radians, and a stroke that is small
    names = ("tool:z", "tool:x", "tool:ry", "stroke:1")
    units = dict(zip(names, ("m", "m", "rad", "m"), strict=True)) | {"u": "N"}
    one = fc.StateSpace(
        A=[[0, 1], [-900.0, -3.0]], B=[[0], [1.0]], C=C, D=np.zeros((4, 1)), inputs=("u",), outputs=names,
        states=("z", "v"), units=units,
    )  # fmt: skip
    size, phase = plot.bode(one.frequency_response(HZ)).axes
    assert labels(size) == ["tool:z by u", "stroke:1 by u"] and len(phase.lines) == 2
    assert "without 2 that are zero" in size.get_title(loc="left")
    size, _ = plot.bode(one.frequency_response(HZ), outputs="tool:x").axes  # who asks for it alone sees it
    np.testing.assert_allclose(size.lines[0].get_ydata(), 1e-12 * np.abs(one.at(HZ)[0, 0]))


@pytest.mark.parametrize("factor", [0.0, np.nan])
def test_responses_without_a_size_are_refused(factor):
    # Matplotlib has no axis of logarithms for them, and says so only when the figure is saved
    data = mode().frequency_response(HZ)
    data["frequency_response"] = data.frequency_response * factor
    with pytest.raises(InputError, match="are 0 at all frequencies"):
        plot.bode(data)


def test_phases_jump_without_a_line():
    data = mode().frequency_response(HZ)
    y = plot.bode(data, "floor", "tool").axes[1].lines[0].get_ydata()
    steps = np.abs(np.diff(y))
    assert np.nanmax(steps) <= 180


def test_too_many_or_unknown_channels_are_refused():
    with pytest.raises(InputError, match="Did you mean 'tool'"):
        plot.bode(mode().frequency_response(HZ), outputs="tol")
    many = fc.StateSpace(
        A=np.zeros((0, 0)), B=np.zeros((0, 5)), C=np.zeros((4, 0)), D=np.ones((4, 5)),
        inputs=tuple(f"u:{i}" for i in range(5)), outputs=tuple(f"y:{i}" for i in range(4)), states=(), units={},
    )  # fmt: skip
    with pytest.raises(InputError, match="20 pairs of channels"):
        plot.bode(many.frequency_response(HZ))
    with pytest.raises(InputError, match="has no 'frequency_response'"):
        plot.bode(mode().damp())


def test_poles_stand_in_their_plane_with_lines_of_damping():
    axes = plot.pole_map({"open": mode().damp(), "damped": mode(30.0).damp()}).axes[0]
    assert labels(axes) == ["open", "damped"]
    pole = mode().poles()[1] / (2 * np.pi)
    np.testing.assert_allclose([axes.lines[0].get_xdata()[0], axes.lines[0].get_ydata()[0]], [pole.real, pole.imag])
    assert "Hz" in axes.get_xlabel()


def test_poles_of_systems_themselves():
    open_, damped = mode(), mode(30.0)
    told = plot.pole_map({"1": open_.damp(), "2": damped.damp()}).axes[0]
    for given in ([open_, damped], {"1": open_, "2": damped.damp()}):
        found = plot.pole_map(given).axes[0]
        assert labels(found) == ["1", "2"]
        for line, other in zip(found.lines, told.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), other.get_xydata())
    pole = damped.poles()[1] / (2 * np.pi)
    np.testing.assert_allclose(plot.pole_map(damped).axes[0].lines[0].get_xydata()[0], [pole.real, pole.imag])
    for none in ([], "damp", [3]):
        with pytest.raises(InputError, match="pole_map: cannot be drawn"):
            plot.pole_map(none)


def test_a_root_locus_shows_branches_and_damping():
    data = fc.root_locus(mode(0.0), fc.IFF(1.0, sensor="force-sensor:base"), np.geomspace(0.01, 100, 50))
    fig = plot.root_locus(data)
    assert fig.axes[1].get_xlabel() == "factor on the controller"
    shown = np.nanmax([np.nanmax(line.get_ydata()) for line in fig.axes[1].lines[:1]])
    # m z'' + k z = f, sensor m z'': s^2 + g s + w^2, a ratio of g / 2 w below 1.
    gains = data.gain.values[data.gain.values < 2 * 30.0]
    assert shown == pytest.approx(100 * gains.max() / (2 * 30.0), rel=1e-9)


def test_cumulative_spectra_have_a_panel_for_each_unit():
    data = mode().psd({"drive": (np.array([0.1, 100.0]), np.array([1e-2, 1e-2]))})
    fig = plot.cumulative(data)
    assert [axes.get_ylabel().split("[")[1] for axes in fig.axes] == ["µm]", "N]"] or len(fig.axes) == 2
    first = fig.axes[0].lines[0].get_ydata()
    assert first[0] == max(first) and (np.diff(first) <= 0).all()
