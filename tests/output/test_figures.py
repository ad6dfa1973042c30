"""Figures: labelled with units, true to the data, drawn in any state of the user's matplotlib."""

import re
from itertools import pairwise

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.legend import Legend
from matplotlib.text import Text
from tests.helpers.samples import sample_study

from flexapod import plot
from flexapod.analysis import modes, simulate, simulate_actuator
from flexapod.analysis.results.attributes import motion_end, robot_study
from flexapod.app.browser.charts import charts
from flexapod.common.errors import InputError
from flexapod.design.maps import workspace_map
from flexapod.model import preset
from flexapod.output.figures.column_width import resize_figure
from flexapod.output.figures.style import NOTE, house_settings, readable_color
from flexapod.output.figures.style import figure as page_figure
from flexapod.output.report.figures import draw_figures
from flexapod.output.report.plotly_export import plotly_figure
from flexapod.output.report.report import write_report
from flexapod.output.scene.robot_scene import mode_scene, scene
from flexapod.output.scene.style import ENERGIES

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def robot():
    return simulate(preset("paper-robot"), step=1e-3, output_step=5e-3)


@pytest.fixture(scope="module")
def rigid():
    return simulate(preset("paper-robot"), fidelity="rigid", step=1e-3, output_step=5e-3)


@pytest.fixture(scope="module")
def actuator():
    return {k: simulate_actuator(preset("paper-actuator"), modes=k, step=1e-3, duration=1.0) for k in (1, 2, 3)}


@pytest.fixture(scope="module")
def shapes():
    study = preset("paper-robot")
    return modes(study, study.motion.target)


ROBOT = (
    "com_path",
    "deviation_by_cause",
    "energies",
    "actuator_forces",
    "forces_overlaid",
    "leg_lengths",
    "tip_deflections",
    "motion_law",
)


def left_labels(figure):
    return [axes.get_ylabel() for axes in figure.axes if axes.get_ylabel()]


@pytest.mark.parametrize("name", ROBOT)
@pytest.mark.parametrize("which", ["robot", "rigid"])
def test_axes_name_quantity_and_unit(name, which, request):
    figure = getattr(plot, name)(request.getfixturevalue(which))
    assert isinstance(figure, Figure)
    assert left_labels(figure) and all("[" in label and "]" in label for label in left_labels(figure))
    assert any("time [s]" in axes.get_xlabel() for axes in figure.axes)
    assert all(axes.get_title(loc="left") or not axes.get_subplotspec().is_first_row() for axes in figure.axes)


def test_path_shows_the_deviation_of_the_data(robot):
    figure = plot.com_path(robot, ("z",))
    below = next(axes for axes in figure.axes if "minus" in axes.get_title(loc="left"))
    np.testing.assert_allclose(below.lines[0].get_ydata(), 1e6 * robot.com_deviation.sel(axis="z"))
    largest = 1e6 * float(np.abs(robot.com_deviation.sel(axis="z")).max())
    assert below.texts[0].get_text() == f"peak \N{MINUS SIGN}{largest:.3g} µm"


def test_bars_of_the_legs_add_up_and_fit_their_axes(robot):
    figure = plot.deviation_by_cause(robot)
    bars = next(axes for axes in figure.axes if axes.get_title(loc="left").startswith("Z, by leg"))
    heights = [patch.get_height() for patch in bars.patches]
    whole = 1e6 * float(np.abs(robot.com_deviation.sel(axis="z")).max())
    assert sum(heights) == pytest.approx(-whole, rel=1e-3)  # causes add up to second order in the deviation
    low, high = bars.get_ylim()
    assert low < min(heights) and high > max(heights)


def test_many_causes_have_colours_of_their_own_and_keep_their_sum(robot):
    names = [f"spring{k}" for k in range(15)]
    share = xr.DataArray(np.arange(1, 16) / 120, {"cause": names})
    many = share * robot.deviation_by_cause.sum("cause")
    data = robot.drop_dims("cause").assign(deviation_by_cause=many.transpose("time", "cause", "leg", "axis"))
    figure = plot.deviation_by_cause(data)
    lines = [line for line in figure.axes[4].lines if not str(line.get_label()).startswith("_")]
    labels, colours = [line.get_label() for line in lines], [line.get_color() for line in lines]
    assert labels[1:] == [*(f"give of spring{k}" for k in range(7, 15)), "7 smaller ones together"]
    assert len(set(colours)) == len(lines) == 10
    whole = 1e6 * many.sel(axis="z").sum(("cause", "leg"))
    np.testing.assert_allclose(sum(line.get_ydata() for line in lines[1:]), whole, atol=1e-9)


def test_nothing_moves_across_gives_no_drama(robot):
    figure = plot.com_path(robot, ("x",))
    low, high = figure.axes[0].get_ylim()
    assert high - low == pytest.approx(2.0)  # mm: x rests on this path


def test_actuator_response_shows_convergence(actuator):
    figure = plot.actuator_response(actuator)
    assert len(figure.axes) == 3
    gap = 1e6 * float(np.abs(actuator[2].tip_deflection - actuator[3].tip_deflection).max())
    shown = [text.get_text() for text in figure.axes[1].texts]
    assert f"2: {gap:.2g} µm" in shown
    assert len(plot.actuator_response(actuator[3]).axes) == 2
    assert len(plot.actuator_modes(actuator[3]).axes) == 3


def test_robot_in_space_stands_where_the_data_say(robot):
    end = motion_end(robot)
    assert end == pytest.approx(1.0, abs=0.01)
    at = scene(robot, end)
    np.testing.assert_allclose(at.com, robot.com_position.sel(time=end, method="nearest"))
    np.testing.assert_allclose(at.piston[:, -1], at.platform, atol=1e-12)
    length = np.linalg.norm(at.platform - at.base, axis=1)
    np.testing.assert_allclose(length, robot.leg_length.sel(time=end, method="nearest"), atol=1e-9)
    assert plot.robot_3d(robot).axes[0].get_title().startswith("At t = 1.00 s")


def test_the_robot_in_space_says_that_nothing_is_magnified(robot):
    right = plot.robot_3d(robot).axes[1]
    assert "deflections to scale" in right.get_title()
    assert to_rgba(right.get_facecolor())[3] == 0  # nothing of the left picture is behind it


def test_energies_have_the_same_words_and_colours_and_values_on_the_page(robot):
    lines = plot.energies(robot).axes[0].lines[: sum(name in robot for name in ENERGIES)]
    chart = charts(robot)["energies"]
    shown = [(line.get_label(), line.get_color()) for line in lines]
    there = [words for name, words in ENERGIES.items() if name in robot]
    assert shown == list(zip(chart.names, chart.colors, strict=True)) == there
    assert chart.unit in plot.energies(robot).axes[0].get_ylabel()
    for line, values in zip(lines, chart.values, strict=True):
        np.testing.assert_allclose(line.get_ydata(), values, rtol=1e-12, atol=1e-12 * np.abs(chart.values).max())


def test_mode_moves_a_tip_with_its_platform(shapes):
    moved, rest = mode_scene(shapes, 1, 0.05), mode_scene(shapes, 1, 0.05, phase=0.0)
    largest = np.linalg.norm(np.vstack([moved.platform - rest.platform, moved.com - rest.com]), axis=1).max()
    assert largest == pytest.approx(0.05, rel=0.05)  # drawn as a finite rotation, scaled as a small one
    np.testing.assert_allclose(moved.piston[:, -1], moved.platform, atol=1e-12)
    assert len(plot.modes_3d(shapes, [2, 3]).axes) == 2


def test_study_of_an_actuator_is_refused_where_a_robot_is_needed(actuator):
    with pytest.raises(InputError, match="single actuator"):
        robot_study(actuator[1])


def test_users_settings_neither_count_nor_change(robot):
    with matplotlib.rc_context({"axes.grid": False, "font.size": 30}):
        before = dict(matplotlib.rcParams)
        figure = plot.com_path(robot)
        assert dict(matplotlib.rcParams) == before
        ticks = figure.axes[0].get_yticklabels()
    assert figure.axes[0].title.get_fontsize() < 15
    assert len(ticks) > 1 and {tick.get_fontsize() for tick in ticks} == {NOTE}


def test_files_are_replaced_whole(robot, tmp_path):
    figure = plot.com_path(robot)
    png, svg = plot.save(figure, tmp_path / "new" / "path", formats=("png", "svg"))
    assert png.read_bytes().startswith(b"\x89PNG") and "<svg" in svg.read_text(encoding="utf-8")
    first = png.read_bytes(), svg.read_bytes()
    plot.save(plot.com_path(robot), tmp_path / "new" / "path", formats=("png", "svg"))
    assert (png.read_bytes(), svg.read_bytes()) == first  # the same picture is the same file
    assert sorted(p.name for p in (tmp_path / "new").iterdir()) == ["path.png", "path.svg"]


@pytest.mark.parametrize("name", ["actuator_forces", "deviation_by_cause", "robot_3d"])
def test_files_are_what_the_figure_saves_itself(robot, tmp_path, name):
    """The other side is matplotlib's own layout, anew for each file."""
    (png, *_) = plot.save(getattr(plot, name)(robot), tmp_path / "ours", formats=("png", "svg"))
    with house_settings():
        getattr(plot, name)(robot).savefig(tmp_path / "theirs.png", dpi=200)
    assert np.array_equal(imread(png), imread(tmp_path / "theirs.png"))


def test_formats_and_their_refusal(robot, tmp_path):
    figure = plot.com_path(robot, ("z",))
    written = plot.save(figure, tmp_path / "z", formats=("pdf", "png", "svg"))
    assert [path.name for path in written] == ["z.pdf", "z.png", "z.svg"]
    first = written[0].read_bytes()
    assert first.startswith(b"%PDF")
    plot.save(plot.com_path(robot, ("z",)), tmp_path / "z", formats=("pdf",))
    assert written[0].read_bytes() == first  # the same picture is the same file
    with pytest.raises(InputError, match="not a format"):
        plot.save(figure, tmp_path / "z", formats=("jpg",))
    with pytest.raises(InputError, match="not a format"):
        plot.save(figure, tmp_path / "z", formats=())
    with pytest.raises(InputError, match="not a width"):
        plot.save(figure, tmp_path / "z", width=0.0)


@pytest.mark.parametrize("name", [*ROBOT, "robot_3d"])
def test_figures_are_as_wide_as_a_page_and_legible(robot, name):
    """At 170 mm nothing need be scaled: 7 points are the least that journals ask for."""
    figure = getattr(plot, name)(robot)
    assert figure.get_figwidth() <= 0.1705 / 0.0254
    figure.draw_without_rendering()
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    assert min(text.get_fontsize() for text in texts) >= 7.0
    assert all(
        readable_color(to_hex(text.get_color())) == to_hex(text.get_color()) for text in texts
    )  # contrast on white


def test_legs_of_equal_commands_are_alike(robot):
    # Joints to six digits in a file leave 1e-9 of a length between legs, which is nobody's travel
    for spread, words in ((1e-10, "all legs alike"), (1e-5, "legs differ by up to")):
        shares = 1 + spread * robot.leg / 6
        same = robot.assign(
            leg_length_command=(robot.leg_length_command.isel(leg=0) * shares).transpose(*robot.leg_length_command.dims)
        )
        assert words in plot.leg_lengths(same).axes[0].get_title(loc="left")


@pytest.mark.parametrize("name", ["com_path", "actuator_forces", "leg_lengths", "energies", "deviation_by_cause"])
def test_results_without_instants_are_refused(robot, name):
    with pytest.raises(InputError, match="time: has no instant"):
        getattr(plot, name)(robot.isel(time=slice(0, 0)))
    getattr(plot, name)(robot.isel(time=slice(0, 1))).draw_without_rendering()


def test_a_figure_for_a_column_stays_as_it_was(robot, tmp_path):
    figure = plot.leg_lengths(robot)
    size, legend = tuple(figure.get_size_inches()), figure.legends[0]
    (path,) = plot.save(figure, tmp_path / "lengths", formats=("png",), width=0.085, dpi=254)
    assert imread(path).shape[1] == 850  # 85 mm at 10 dots a millimetre
    assert tuple(figure.get_size_inches()) == size and figure.legends == [legend]
    (path,) = plot.save(figure, tmp_path / "lengths", formats=("png",), dpi=100)
    assert imread(path).shape[1] == 670


def first_bending(shapes):
    return next(
        int(m) for m, kind in zip(shapes.mode.values, shapes.kind.values, strict=True) if "bending" in str(kind)
    )


def test_piston_alone_is_bent_as_its_mode_says(shapes):
    mode = first_bending(shapes)
    axes = plot.piston_mode(shapes, mode).axes[0]
    x, drawn = axes.lines[2].get_data()
    leg = int(axes.get_title(loc="left").split()[1])
    shape = shapes.leg_shape.sel(mode=mode, leg=leg).values
    assert np.abs(shape).max() == np.abs(shapes.leg_shape.sel(mode=mode)).max()
    across = np.linalg.svd(shape.T, full_matrices=False)[2][0] @ shape
    np.testing.assert_allclose(drawn / np.abs(drawn).max(), across / np.abs(across).max(), atol=1e-12)
    place = mode_scene(shapes, mode, 1.0, phase=0.0)
    assert x[-1] == pytest.approx(1e3 * np.linalg.norm(place.platform[leg - 1] - place.base[leg - 1]), rel=1e-9)


def test_bands_are_the_printed_deviation_to_scale(robot):
    figure = plot.path_bands(robot, {"y": 5e-3, "z": 10e-3})
    below = figure.axes[2]
    np.testing.assert_allclose(below.lines[0].get_ydata(), 1e3 * robot.com_deviation.sel(axis="y"))
    assert below.get_ylim() == pytest.approx((-6.25, 6.25))
    assert below.texts[0].get_text() == "largest 9.38 µm:\nthe print is 530 times that"


def test_a_drawing_stays_a_picture_on_the_page(robot, tmp_path):
    drawing, curves = plot.actuator_symbols(), plot.forces_overlaid(robot)
    for figure in (drawing, curves):
        plot.save(figure, tmp_path / "x", formats=("png",))
    assert plotly_figure(drawing) is None and plotly_figure(curves) is not None


def panels(figure):
    return [axes for axes in figure.axes if axes.get_visible()]


OTHERS = ("com_path of all axes", "actuator_path", "actuator_response", "modes_3d", "actuator_free",
          "path_bands", "piston_mode", "actuator_symbols")  # fmt: skip


@pytest.mark.parametrize("name", [*ROBOT, *OTHERS])
def test_at_the_width_of_a_column_nothing_overlaps_or_is_cut(robot, actuator, shapes, name):
    draws = {
        "com_path of all axes": lambda: plot.com_path(robot, ("x", "y", "z")),
        "actuator_path": lambda: plot.actuator_path(actuator[3], magnify=20.0),
        "actuator_response": lambda: plot.actuator_response(actuator),
        "modes_3d": lambda: plot.modes_3d(shapes),
        "actuator_free": lambda: plot.actuator_free({"held": actuator[3], "given at the start": actuator[2]}),
        "path_bands": lambda: plot.path_bands(robot, {"y": 5e-3, "z": 10e-3}),
        "piston_mode": lambda: plot.piston_mode(shapes, first_bending(shapes)),
        "actuator_symbols": plot.actuator_symbols,
    }
    figure = draws.get(name, lambda: getattr(plot, name)(robot))()
    made = resize_figure(figure, 0.085 / 0.0254)
    made.draw_without_rendering()
    assert made.get_figwidth() == pytest.approx(0.085 / 0.0254) and made.get_figheight() < 0.24 / 0.0254
    assert len({round(axes.get_position().x0, 2) for axes in panels(made)}) <= 2
    assert len(panels(made)) == len(panels(figure))
    assert min(text.get_fontsize() for text in texts(made)) >= 7.0
    if name == "modes_3d":  # pictures in space reach beyond what is seen of them
        boxes = [title.get_window_extent() for axes in panels(made) for title in (axes.title,)]
    else:
        boxes = [part.get_window_extent() for part in (*panels(made), *made.findobj(Legend))]
        inside = made.bbox.padded(1.5)  # half a point: rounding of letters
        for text in texts(made):
            box = text.get_window_extent()
            assert inside.x0 <= box.x0 and box.x1 <= inside.x1, text.get_text()
    for i, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[i + 1 :])


def test_titles_in_space_stay_clear_of_the_labels_above_them(robot):
    made = resize_figure(plot.robot_3d(robot), 0.085 / 0.0254)
    made.draw_without_rendering()
    above, below = panels(made)
    title = below.title.get_window_extent()
    for label in (above.xaxis.label, above.yaxis.label):
        assert label.get_window_extent().y0 > title.y1
    tops = [axes.title.get_window_extent().y1 for axes in (above, below)]
    assert max(tops) <= made.bbox.y1 and made.get_figheight() < 9.2


def test_a_label_longer_than_its_panel_is_broken():
    figure = page_figure(height=3.0)
    for axes in figure.subplots(3, 1):
        axes.set_ylabel("largest difference of the two [µm]")
    made = resize_figure(figure, 0.085 / 0.0254)
    made.draw_without_rendering()
    labels = [axes.yaxis.label.get_window_extent() for axes in panels(made)]
    assert not any(one.overlaps(other) for one, other in pairwise(labels))


def test_slices_of_a_volume_fit_into_a_column():
    """Seven slices leave two places of the wide figure empty: that once ended the narrow one in an IndexError."""
    poses = {"surge": np.linspace(-0.2, 0.2, 5), "sway": np.linspace(-0.2, 0.2, 5), "heave": np.linspace(-0.15, 0.1, 7)}
    made = resize_figure(plot.workspace_map(workspace_map(preset("paper-robot"), poses, frequencies=1)), 0.085 / 0.0254)
    made.draw_without_rendering()
    *slices, bar = panels(made)
    assert len(slices) == 7 and made.get_figheight() < 9.2
    for axes in slices:
        title = axes.title.get_window_extent()
        assert title.x1 < bar.get_window_extent().x0
        low, high = axes.get_position(original=True).height, axes.get_position().height
        assert low == pytest.approx(high, rel=0.1)  # no empty stripes above and below equal scales
    assert {to_hex(label.get_color()) for axes in slices for label in axes.texts} == {"#222222", "#ffffff"}


def texts(figure):
    ticks = {label for axes in figure.axes for label in (*axes.get_xticklabels(), *axes.get_yticklabels())}
    return [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip() and t not in ticks]


def test_panels_in_a_column_keep_their_labels(robot):
    made = resize_figure(plot.com_path(robot), 0.085 / 0.0254)
    by_height = sorted(panels(made), key=lambda axes: -axes.get_position().y0)
    assert [axes.get_title(loc="left")[-1] for axes in by_height] == ["Y", "Y", "Z", "Z"]
    assert all("mm" in axes.get_ylabel() or "µm" in axes.get_ylabel() for axes in by_height)
    assert [bool(axes.get_xlabel()) for axes in by_height] == [False, False, False, True]  # they share time
    forces = resize_figure(plot.actuator_forces(robot), 0.085 / 0.0254)
    lowest = [axes for axes in panels(forces) if axes.get_xlabel()]
    assert len(lowest) == 2 and lowest[0].get_position().y0 == pytest.approx(lowest[1].get_position().y0)


@pytest.mark.parametrize("color", ["#E69F00", "#56B4E9", "#009E73", "#333333"])
def test_words_in_colour_have_contrast(color):
    """4.5 to 1 on white (WCAG 2.2, 1.4.3); what is dark enough stays as it is."""
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in to_rgb(readable_color(color))]
    assert 1.05 / (np.dot([0.2126, 0.7152, 0.0722], linear) + 0.05) >= 4.5
    assert (readable_color(color) == color) == (color == "#333333")


def test_path_of_a_beam_is_that_of_its_tip(actuator):
    data = actuator[3]
    figure = plot.actuator_path(data, hub_radius=0.1, magnify=20.0)
    flexible = next(line for line in figure.axes[0].lines if "20 times larger" in str(line.get_label()))
    x, y = flexible.get_data()
    # Pythagoras: along the straight beam, and across it.
    np.testing.assert_allclose(np.hypot(x, y) ** 2, (0.1 + data.length) ** 2 + (20 * data.tip_deflection) ** 2)
    turned = np.arctan2(20 * data.tip_deflection, 0.1 + data.length)
    np.testing.assert_allclose(np.unwrap(np.arctan2(y, x)), data.angle + turned, atol=1e-12)


def test_folder_that_is_a_file_is_refused(robot, tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError):
        plot.save(plot.com_path(robot), tmp_path / "file" / "path")


def test_report_of_a_run_has_its_figures_and_its_answer(actuator, tmp_path):
    figures = draw_figures(actuator[3], tmp_path)
    text = write_report(actuator[3], tmp_path, lambda: figures).read_text(encoding="utf-8")
    assert text.count("<figure") == len(figures) == 3  # one of them stands for the replay on paper
    assert "The tip leaves the hub" in text.split("</h1>")[0]
    assert "[motion]" in text and "Newton iterations" in text and "flexapod run study.toml" in text


def test_report_of_a_robot_gives_per_cent_by_axis(robot, tmp_path):
    text = write_report(robot, tmp_path).read_text(encoding="utf-8")
    assert "largest cause is stretch of the pistons" in text.split("</h1>")[0]
    # x does not move on a roll about x: no percentage of nothing.
    row = re.search(r"<td[^>]*>X</td>.*?</tr>", text, re.S)
    assert row is not None and "n/a" in row[0]


def test_report_of_a_partial_run_says_so(robot, tmp_path):
    part = robot.isel(time=slice(0, 101)).assign_attrs(partial=1, failure="leg 2 left the range of the model.")
    text = write_report(part, tmp_path).read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert "Incomplete: computed to t = 0.5 s. leg 2 left the range of the model." in text
    assert plot.com_path(part) is not None


def test_text_in_a_report_is_text(robot, tmp_path):
    odd = robot.assign_attrs(warnings="leg 1: <b>1 < 2</b> & more")
    assert "&lt;b&gt;1 &lt; 2&lt;/b&gt; &amp; more" in write_report(odd, tmp_path).read_text(encoding="utf-8")


@pytest.mark.parametrize("width", [None, 0.085])
@pytest.mark.parametrize("name", ["flight-simulator", "nano-hexapod"])
def test_words_of_a_wide_robot_stay_in_its_picture(name, width):
    made = plot.robot_3d(simulate(preset(name), fidelity="lumped", duration=0.002, step=1e-3))
    drawn = made if width is None else resize_figure(made, width / 0.0254)
    drawn.canvas.draw()
    names = []
    for axes in drawn.axes:
        names.append([axis.label for axis in (axes.xaxis, axes.yaxis, axes.zaxis) if axis.label.get_text()])
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            low, high = axis.get_view_interval()
            ticks = [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            for text in (part for part in (axis.label, *ticks) if part.get_text()):
                box = text.get_window_extent()
                assert drawn.bbox.x0 <= box.x0 and box.x1 <= drawn.bbox.x1, text.get_text()
    left, right = ([label.get_window_extent() for label in labels] for labels in names)
    assert not any(one.overlaps(other) for one in left for other in right)


def test_words_and_numbers_of_a_robot_along_one_axis_stand_apart():
    # One actuator along x: of the other two directions there is no room for numbers.
    data = simulate(sample_study("strut"), fidelity="lumped", duration=0.002, step=1e-3)
    drawn = plot.robot_3d(data)
    drawn.canvas.draw()
    for axes in drawn.axes:
        assert [axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()] == ["x [mm]", "", ""]
        texts = [axes.xaxis.label, *(label for label in axes.xaxis.get_ticklabels() if label.get_text())]
        boxes = [text.get_window_extent() for text in texts]
        assert len(boxes) > 3
        assert not any(boxes[0].overlaps(box) for box in boxes[1:])


@pytest.mark.parametrize(("turning", "drawn"), [(1e-36, False), (1e-12, True)])
def test_what_symmetry_makes_zero_is_no_vibration(turning, drawn):
    """An upright shake of a symmetric robot was drawn as a rotation of 1e-15 urad, with the name of a mode at it."""
    component = ["x", "y", "z", "rx", "ry", "rz"]
    variance = xr.DataArray([0, 0, 1e-14, 0, 0, 1.0], {"component": component})
    variance[-1] = turning
    f = np.geomspace(0.01, 2e4, 30)
    falls = xr.DataArray(np.where(f < 459, 1.0, 0.0), {"spectrum_frequency": f})
    rms = np.sqrt(variance)
    data = xr.Dataset(
        {"vibration_cumulative": falls * rms, "vibration_by_mode": rms.expand_dims(mode=[1]), "vibration_rms": rms}
    )
    upper, lower = plot.vibration(data.assign(frequency=("mode", [459.0]))).axes
    assert upper.texts and bool(lower.texts) == drawn
    assert ("zero but for rounding" in lower.get_title(loc="left") + lower.get_title()) != drawn
    assert (max(np.max(line.get_ydata()) for line in lower.lines[:3]) > 0) == drawn
