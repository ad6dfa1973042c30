"""Figures of the paper's study show what they are to show: numbers apart, bands for what is quick, words at spikes."""

import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PolyCollection
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import proj3d

import flexapod as fx
from flexapod import model, plot
from flexapod.output.figures.robot3d import label_positions
from flexapod.verification.paper import clamped_legs, engine_figures, figures, printed_figures, variants

pytestmark = pytest.mark.unit

MARKER = 3.0  # points: radius of a joint, and its edge


@pytest.fixture(scope="module")
def robot():
    return fx.simulate(model.preset("paper-robot"))


def boxes(figure):
    """The first panel and the extents of its numbers [pixels], which are centred on their places."""
    axes = figure.axes[0]
    figure.canvas.draw()
    found = {}
    for text in axes.texts:
        if text.get_text().isdigit():
            size = text.get_window_extent(figure.canvas.get_renderer())
            (x, y), half = seen(axes, 1e-3 * np.array([text.get_position_3d()]))[0], (size.width / 2, size.height / 2)
            found[int(text.get_text())] = Bbox([[x - half[0], y - half[1]], [x + half[0], y + half[1]]])
    return axes, found


def seen(axes, points):
    """Where points (n, 3) [m] are in the picture [pixels]."""
    x, y, _ = proj3d.proj_transform(*(1e3 * points.T), axes.M)
    return axes.transData.transform(np.column_stack([x, y]))


@pytest.mark.parametrize("name", ["paper-robot", "paper-robot-radii", "tripod"])
def test_numbers_touch_neither_joints_nor_each_other(name):
    """5 lay beside 6 and 6 on joint 5, 3 and 4 on their joints."""
    study = variants.tripod().study if name == "tripod" else model.preset(name)
    figure = plot.robot_3d(fx.simulate(study, fidelity="rigid", duration=0.01), 0.0)
    axes, numbers = boxes(figure)
    joints, points = seen(axes, study.robot.base_joints), MARKER * figure.dpi / 72
    assert sorted(numbers) == list(range(1, len(joints) + 1))
    for leg, box in numbers.items():
        gaps = np.maximum([box.x0, box.y0] - joints, joints - [box.x1, box.y1]).max(axis=1)
        assert gaps.min() > points
        assert np.argmin(gaps) == leg - 1  # beside its own joint
        assert not any(box.overlaps(other) for number, other in numbers.items() if number != leg)


def test_a_number_is_beside_the_leg_and_away_from_its_pair():
    """Seen along y from the front, x is to the right and z up: a pair in the middle parts, a joint alone goes aside."""
    joints = np.array([[-0.05, 0, 0], [0.05, 0, 0], [0.0, 0, 0.9]])
    moved = label_positions(joints, joints, -90, 0) - joints
    assert moved[0, 0] < 0 < moved[1, 0] and abs(moved[0, 1]) < 1e-12
    assert abs(moved[2, 0]) > abs(moved[2, 2])  # not on the leg, which rises
    assert np.linalg.norm(moved, axis=1) == pytest.approx(0.045 * np.hypot(0.1, 0.9))


def test_tips_have_scales_of_their_own(robot):
    """At 48 um of sag in direction b, 5 um in direction a were a flat line."""
    for axes, direction in zip(plot.tip_deflections(robot).axes, "ab", strict=True):
        values = 1e6 * robot.tip_deflection.sel(direction=direction)
        assert "µm" in axes.get_ylabel()
        low, high = axes.get_ylim()
        assert float(values.max() - values.min()) > 0.8 * (high - low)


def test_quick_shapes_are_bands_with_their_first_swings():
    """400 swings and more in a picture of 700 points were solid ink."""
    time = np.linspace(0, 10, 10001)
    slow, quick = np.cos(2 * np.pi * time), 1e-3 * (np.cos(80 * np.pi * time) - 0.05 * time)
    data = xr.Dataset({"mode_amplitude": (("time", "mode"), np.stack([slow, quick], axis=1))},
                      {"time": time, "mode": [1, 2]})  # fmt: skip
    first, second, beside_it = plot.actuator_modes(data).axes
    assert len(first.lines[0].get_ydata()) == len(time) and not first.collections
    (band,) = second.collections
    assert isinstance(band, PolyCollection)
    assert len(second.lines[0].get_xdata()) <= 600  # of ten thousand instants
    # Between 1 - 0.05 t and -1 - 0.05 t, of 1e-3. With 25 instants a swing a maximum is missed by 1 - cos(pi / 25) =
    # 0.008, and the middle drifts by 0.001 in a swing.
    for edge, side in zip(second.lines, (-1, 1), strict=False):
        np.testing.assert_allclose(edge.get_ydata(), side - 0.05 * edge.get_xdata(), atol=0.01)
    assert beside_it.lines[0].get_xdata()[-1] == pytest.approx(13 / 80, abs=0.01)


def test_forces_of_flexible_legs_are_bands_and_those_of_rigid_ones_lines(robot):
    """A hundred half swings in a panel of a third of a page were solid ink; spikes are to be seen as they are."""
    below = [axes for axes in plot.actuator_forces(robot).axes if not axes.get_title(loc="left")]
    gap = robot.actuator_force - robot.actuator_force_rigid
    assert len(below) == 6
    for axes, leg in zip(below, robot.leg.values, strict=True):
        (area,) = axes.collections
        values, at = gap.sel(leg=leg).values, axes.lines[0].get_xdata()
        low, high = (line.get_ydata() for line in axes.lines[:2])
        block = np.searchsorted(at, robot.time.values, side="right") - 1  # an edge holds until its next instant
        assert isinstance(area, PolyCollection)
        # Every maximum is inside; between two of them a straight edge may be below the next but one.
        assert np.mean((low[block] <= values + 1e-9) & (values <= high[block] + 1e-9)) > 0.95
        assert high.max() == pytest.approx(values.max(), rel=1e-6) and low.min() == pytest.approx(
            values.min(), rel=1e-6
        )
    rigid = plot.actuator_forces(fx.simulate(model.preset("paper-robot"), fidelity="rigid", step=5e-4))
    assert not any(axes.collections for axes in rigid.axes)


def test_a_start_with_a_jump_is_a_band_with_its_first_swings():
    """Two vibrations of 45 and 56 Hz for 2 s: 200 half swings in 700 points."""
    time = np.linspace(0, 2, 4001)
    y = np.cos(90 * np.pi * time) + 0.5 * np.cos(50 * np.pi * time)
    jump = xr.Dataset({"com_deviation": (("time", "axis"), 1e-4 * np.stack([0 * y, y, np.cos(112 * np.pi * time)], 1))},
                      {"time": time, "axis": list("xyz")})  # fmt: skip
    figure = engine_figures.start_jump(0.01 * jump, jump)
    above, beside, below, last = figure.axes
    assert len(above.collections) == len(below.collections) == 1 and not beside.collections and not last.collections
    # The largest of five neighbouring maxima is that of both together, 150 um, but for the phase of one to the other.
    _, high = (line.get_ydata() for line in above.lines[:2])
    assert high.min() > 120 and high.max() <= 150 + 1e-9
    assert beside.lines[0].get_xdata()[-1] == pytest.approx(engine_figures.START)
    names = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert sorted(names) == ["Y, rate jumps at the start", "Z, rate jumps at the start", "smooth start"]


def test_the_burst_of_the_balance_is_told_and_falls_with_the_tolerance(robot):
    """2.9 uJ of 164 J in the first tenth of a second, unexplained."""

    def burst(data):
        energies = sum(data[f"energy_{name}"] for name in ("kinetic", "potential", "strain", "dissipated"))
        balance = (energies - data.work_drive).values
        return np.abs(balance - balance[0])[data.time.values < 0.1].max()

    finer = fx.simulate(model.preset("paper-robot"), tolerance=1e-5)  # in as much time: its share of the tolerance
    assert burst(finer) < 0.2 * burst(robot) < 0.2 * 1e-7 * 164
    title = plot.energies(robot).axes[-1].get_title(loc="left")
    most, whole = re.search(r"off by up to ([\d.]+) µJ of (\d+) J", title).groups()
    assert 1e-6 * float(most) == pytest.approx(burst(robot), rel=0.05) and int(whole) == 164
    parts = {name: robot for name in ("robot", "robot-rigid")} | {"modes": fx.modes(model.preset("paper-robot"))}
    study = type("Study", (), {"__getitem__": lambda _, name: parts[name]})()
    told = next(title for _, name, title, _ in figures._robot(study) if name == "energies")
    assert "burst at the start is the error of the drives' work" in told and "0.0001, with which it falls" in told


def test_lighter_pistons_show_their_deviation():
    """The figure of accuracy had vibrations alone."""
    count = len(variants.PISTONS)
    light = xr.Dataset(
        {"deviation_peak": (("piston", "axis"), 1e-6 * np.arange(1, 3 * count + 1).reshape(count, 3)),
         **{name: ("piston", 1e-6 * np.arange(1.0, count + 1)) for name in ("payload_vibration", "tip_vibration")},
         "piston_mass": ("piston", np.linspace(3, 0.5, count))},
        {"inner": ("piston", [pair[1] for pair in variants.PISTONS]), "axis": list("xyz")},
    )  # fmt: skip
    first, *others = engine_figures.light_pistons(light).axes
    assert len(others) == 2 and "deviation [µm]" in first.get_ylabel()
    drawn = np.unique(np.concatenate([line.get_ydata() for line in first.lines]))
    np.testing.assert_allclose(drawn, np.arange(3, 3 * count + 1, 3), rtol=1e-12)


def test_no_mode_is_shown_twice(monkeypatch, robot):
    """The first bending modes stood among the lowest ones, too."""
    modes = fx.modes(model.preset("paper-robot"))
    shown = []
    monkeypatch.setattr(plot, "modes_3d", lambda _, labels: shown.append(labels))
    parts = {"robot": robot, "robot-rigid": robot, "modes": modes}
    study = type("Study", (), {"__getitem__": lambda _, name: parts[name]})()
    for _, name, _, make in figures._robot(study):
        if name.startswith("modes-"):
            make()
    bending, lowest = shown
    assert not set(bending) & set(lowest)
    assert sorted([*bending, *lowest]) == list(range(1, 10))


def test_spikes_of_the_forces_have_a_word():
    data = fx.simulate(model.preset("paper-robot"), fidelity="rigid", step=5e-4)
    figure = printed_figures.forces_rigid(data)
    words = [text.get_text() for axes in figure.axes for text in axes.texts if "elsewhere" in text.get_text()]
    assert len(words) == 6 and set(words) == {
        "elsewhere at\nmost 20 mN"
    }  # its digits are rounding: 11 or 12 by processor
    parts = {"robot": data, "robot-rigid": data, "modes": fx.modes(model.preset("paper-robot"))}
    study = type("Study", (), {"__getitem__": lambda _, name: parts[name]})()
    title = next(title for _, name, title, _ in figures._robot(study) if name == "forces-rigid")
    assert "up to 3.1 N, are those of a fixed step of 0.5 ms" in title


def test_what_welded_robots_do_not_reach_is_said():
    """Where a curve is missing, the panel says so and how near it comes: 0.9 of y, 0.3 of z here."""
    table = variants.clamped_legs()
    along = {name: list(labels) for name, labels in {**table.along, "roll": variants.ROLLS}.items()}
    shape = tuple(map(len, along.values()))
    values = {name: (("reading", "arm", "roll"), np.zeros(shape)) for name in table.columns if name != "deviation"}
    grown = np.array([1e-3, 4.5e-3, 3e-3]) * np.linspace(0, 1, shape[2])[:, None]
    values["deviation"] = (("reading", "arm", "roll", "axis"), np.broadcast_to(grown, (*shape, 3)))
    data = xr.Dataset(values, {**along, "axis": list("xyz")})
    reached = data.copy(deep=True)
    reached["deviation"] = 100 * data.deviation
    for found, said in ((data, True), (reached, False)):
        figure = clamped_legs.clamped_legs_figure(found)
        words = " ".join(text.get_text() for text in figure.axes[-1].texts)
        assert ("y 5 mm: not reached,\nat most 90 % of that" in words) == said
        assert ("z 10 mm: not reached,\nat most 30 % of that" in words) == said


def test_figure_2_has_the_solid_and_its_hub():
    actuator, robot = model.preset("paper-actuator").actuator, model.preset("paper-robot").robot
    above, below = figures.actuator_solid(actuator, robot.legs[0], 0.915).axes
    # 74 cells along 3.66 m, 4 across 0.15 m: tops, fronts, ends; and those of the shell.
    assert len(above.patches) == 74 * 4 + 74 + 4 + 3
    assert {text.get_text() for text in above.texts} == {"rigid hub, a shell", "deformable beam"}
    assert {"cylinder", "piston of 27 mm"} <= {text.get_text() for text in below.texts}
