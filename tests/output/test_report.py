"""The report of a run: the answer first, the study in words, everything within the page."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from tests.helpers.texts import replaced

from flexapod.analysis import simulate, simulate_actuator
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.summary import summary
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.model import loads, preset, preset_text
from flexapod.output.report.replay import FRAMES, MOST_POINTS, locked_modes, replay
from flexapod.output.report.report import robot_report, write_report
from flexapod.output.text import html
from flexapod.output.text.answers import axes_table, distances_table, run_items
from flexapod.output.text.html import replay as replay_figure
from flexapod.output.text.parts import Lines
from flexapod.output.text.study import modes_section, study_items
from flexapod.output.text.terminal import print_items

pytestmark = pytest.mark.unit

POINTS = 6 + 6 * 9 + 2 * 6 + 4 + 2  # of a frame: bases, pistons, platforms, centres, tools
PRESCRIBED = 'drive = { type = "prescribed" }'


@pytest.fixture(scope="module")
def study():
    return preset("paper-robot")


@pytest.fixture(scope="module")
def robot(study):
    return simulate(study, step=1e-3, output_step=5e-3)


@pytest.fixture(scope="module")
def page(study, robot):
    return robot_report(study, robot)


def changed(*changes, name="paper-robot"):
    """A preset with pieces of its text replaced."""
    return loads(replaced(preset_text(name), *changes))


@pytest.fixture(scope="module")
def tool():
    """A study whose tool is not at the centre of mass, and its result."""
    study = changed(
        ('# tool = [0, 0, "100 mm"] ', 'tool = [0, 0, "100 mm"] '),
        (PRESCRIBED, 'drive = { type = "servo", stiffness = "20 N/um", damping = "500 N s/m" }'),
        (
            "[simulation]",
            '[load]\nwrench = { law = "step", amplitude = [100, 0, 0, 0, 0, -2], time = 0.2 }\n\n[simulation]',
        ),
    )
    return study, simulate(study, step=1e-3, output_step=5e-3, duration=0.5)


class Page(HTMLParser):
    """Sections in order, data of the figures, addresses, and elements left open."""

    def __init__(self, text):
        super().__init__()
        self.sections, self.data, self.links, self.inside = [], [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag == "section":
            self.sections.append(given["id"])
        self.inside = given.get("type") if tag == "script" else None
        self.links += [given[name] for name in ("src", "href") if name in given]

    def handle_data(self, data):
        if self.inside == "application/json":
            self.data.append(json.loads(data))
            self.inside = None


def points(packed):
    import base64

    shape = [int(part) for part in packed["shape"].split(",")]
    return np.frombuffer(base64.b64decode(packed["bdata"]), dtype="<f4").reshape(shape)


def test_the_answer_comes_first_and_everything_is_there(page):
    found = Page(page)
    assert "misses its rigid path by up to" in page.split("</h1>")[0]
    assert found.sections == [
        "deviation", "warnings", "study", "replay", "figures", "modes", "solver", "toml", "repeat",
    ]  # fmt: skip
    for words in ("Newton iterations", "flexapod run study.toml", "[motion]", "plotly", "21.71"):
        assert words in page


def test_the_page_needs_nothing_from_outside(page):
    assert len(page) < 10e6
    assert all(link.startswith(("data:", "#")) for link in Page(page).links)
    assert "default-src 'none'" in page and "connect-src" not in page  # a browser fetches nothing for it


def test_curves_that_zoom_are_those_of_the_result(page, robot):
    charts = Page(page).data[1:]  # the first is the replay
    assert len(charts) == 7
    largest = max(np.abs(points({**t["y"], "shape": "-1"})).max() for t in charts[0]["data"] if t["yaxis"] == "y6")
    # Thinning keeps the extremes; 32 bit floats hold 7 digits.
    assert largest == pytest.approx(1e6 * float(np.abs(robot.com_deviation.sel(axis="z")).max()), rel=1e-6)


def test_long_runs_stay_small(study):
    """Ten seconds at 1 ms: 10 001 instants of six legs."""
    data = simulate(study, fidelity="rigid", step=1e-3, duration=10.0, output_step=1e-3)
    assert data.sizes["time"] == 10_001
    page = robot_report(study, data)
    assert len(page) < 10e6
    assert {"replay", "figures", "modes"} <= set(Page(page).sections)
    lengths = [
        len(points({**t["x"], "shape": "-1"})) for c in Page(page).data[1:] for t in c["data"] if t["type"] == "scatter"
    ]
    assert max(lengths) <= MOST_POINTS + 2
    assert "thinned for this page" in page


def test_study_in_words(study):
    words = html.parts(study_items(study, None))
    for part in ("6-UPS", "100 kg", "roll 26.6 deg in 1 s", "assumed-modes, 3 lateral shapes", "static equilibrium"):
        assert part in words.replace("\N{NO-BREAK SPACE}", " ")
    text = preset_text("paper-actuator")
    words = html.parts(study_items(loads(text), None)).replace("\N{NO-BREAK SPACE}", " ")
    for part in ("3.66 m", "rotation at 0.785 rad/s", "extension at 0.1 m/s", "released from 5 mm"):
        assert part in words


def test_words_of_other_motions(study):
    text = preset_text("paper-robot")
    head, tail = text.split("[motion]")[0], "[simulation]" + text.split("[simulation]")[1]
    points_of = 'type = "waypoints"\npoints = [{ time = "1 s", heave = "10 mm" }, { time = "2 s", heave = 0 }]\n'
    words = html.parts(study_items(loads(f"{head}[motion]\n{points_of}{tail}"), None))
    assert "through 2 points" in words


def test_frames_of_the_replay_follow_the_result(study, robot):
    told = replay(study, robot)
    frames = points(told["points"])
    assert frames.shape == (FRAMES, POINTS, 3)
    com = 1e3 * robot.com_position_rigid.sel(time=told["time"], method="nearest").values
    # 32 bit floats of 1 m in mm: 1e-4 mm.
    np.testing.assert_allclose(frames[:, -3], com, atol=1e-3)
    factor = float(re.search(r"drawn (\S+) times", told["words"])[1])
    deviation = robot.com_deviation.sel(time=told["time"], method="nearest").values
    np.testing.assert_allclose(frames[:, -5], com + 1e3 * factor * deviation, atol=1e-3)
    np.testing.assert_allclose(frames[:, -2:], frames[:, [-5, -3]], atol=1e-3)  # the tool is the centre of mass
    np.testing.assert_allclose(np.array(told["values"])[:, 2], 1e6 * deviation[:, 2], atol=6e-3)  # two places shown
    numbers = [point for trace in told["traces"] for point in trace["take"]]
    assert max(numbers) == POINTS - 1 and min(numbers) == -1


def test_the_replay_is_that_of_a_tool_apart(tool):
    study, data = tool
    told = replay(study, data)
    at = data.sel(time=told["time"], method="nearest")
    frames, factor = points(told["points"]), float(re.search(r"drawn (\S+) times", told["words"])[1])
    np.testing.assert_allclose(frames[:, -1], 1e3 * at.tool_position_rigid, atol=1e-3)
    # The drawn payload is a rigid body: it moves with its centre of mass and turns about it, both magnified.
    turned = exponential(factor * at.rotation_deviation.values) @ matrix(at.platform_quaternion_rigid.values)
    arm = turned @ (study.robot.payload.tool - study.robot.payload.com)
    drawn = 1e3 * (at.com_position_rigid + factor * at.com_deviation).values + 1e3 * arm
    np.testing.assert_allclose(frames[:, -2], drawn, atol=1e-3)
    assert "tool" in told["what"]
    assert told["unit"] == "µm"
    shown = 1e6 * np.linalg.norm(at.tool_deviation, axis=1)
    np.testing.assert_allclose(np.array(told["values"])[:, 3], shown, rtol=1e-3, atol=0.06)  # one place shown
    traces = {trace.get("name"): trace for trace in told["traces"]}
    assert traces["deviation of the tool"]["take"] == [POINTS - 1, POINTS - 2]
    np.testing.assert_allclose(traces["path of the tool, flexible"]["z"], frames[:, -2, 2], atol=5e-3)  # six digits


def test_the_tool_is_told_first(tool):
    study, data = tool
    page = robot_report(study, data).replace("\N{NO-BREAK SPACE}", " ")
    assert summary(data, "tool").sentence in page.split("</h1>")[0]
    assert summary(data).sentence.replace("'", "&#x27;") in page.split("</h1>")[1].split("<nav")[0]
    heads = re.findall(r"<h3>(Tool|Centre of mass)</h3>", page)
    assert heads == ["Tool", "Centre of mass"]


def test_words_of_tool_drives_and_load(tool):
    words = html.parts(study_items(tool[0], None)).replace("\N{NO-BREAK SPACE}", " ")
    for part in (
        "gravity of 9.81 m/s² along -z",
        "Centre of mass at [0, 373, 0] mm from the platform&#x27;s centre, the tool at [0, 0, 100] mm",
        "damping of 0.5 % of the critical one",
        "Drives: servo, a spring of 20 N/µm and a damper of 500 N s/m",
        "Load: Fx 100 N and Mz -2 N m from t = 0.2 s on, at the tool",
    ):
        assert part in words


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        (PRESCRIBED, "prescribed, the stroke follows its command exactly"),
        ('drive = { type = "servo", stiffness = "2 N/um" }', "a spring of 2 N/µm between"),
        ('drive = { type = "force" }', "force, that which the rigid robot needs."),
        (
            'drive = { type = "force", feedback = { stiffness = "5 N/um", damping = 100 } }',
            "corrected by 5 N/µm and 100 N s/m on the stroke",
        ),
    ],
)
def test_words_of_drives(drive, words):
    text = html.parts(study_items(changed((PRESCRIBED, drive)), None)).replace("\N{NO-BREAK SPACE}", " ")
    assert words in text and "Load: none" in text and "which is the tool, too" in text


@pytest.mark.parametrize(
    ("wrench", "words"),
    [
        ('law = "constant", value = [0, 0, -50, 0, 0, 0]', "Fz -50 N, constant"),
        ('law = "sine", amplitude = [5, 0, 0, 0, 0, 0], frequency = 20', "Fx 5 N, times a sine of 20 Hz, at the tool"),
    ],
)
def test_words_of_loads(wrench, words):
    study = changed(("[simulation]", f"[load]\nwrench = {{ {wrench} }}\n\n[simulation]"), ("-9.81]", "0]"))
    text = html.parts(study_items(study, None)).replace("\N{NO-BREAK SPACE}", " ")
    assert words in text and "no gravity" in text


def test_legs_with_unlike_drives_are_told_apart(study):
    robot, servo = study.robot, loads(changed((PRESCRIBED, 'drive = { type = "servo", stiffness = 1e6 }')).source_text)
    legs = (servo.robot.legs[0], *robot.legs[1:])
    words = html.parts(study_items(study.replace(robot=robot.replace(legs=legs)), None))
    assert "Drives: leg 1: servo" in words and "legs 2, 3, 4, 5, 6: prescribed" in words


def test_modes_say_what_is_held(study, tool):
    """The springs of servo drives give way in a mode: 21.7 Hz become fewer, and nothing is locked."""
    (plain,) = modes_section(study, describe(study))
    assert "Drives locked" in plain
    (soft,) = modes_section(tool[0], describe(tool[0]))
    assert "Drives locked" not in soft and "springs and dampers of the servo drives" in soft


def test_words_of_a_driven_beam():
    held = ("rotation = { rate = 0.785 }  # rad/s (section 2.2); or", "# rad/s (section 2.2); or")
    torque = ("[initial]", '[load]\ntorque = { law = "constant", value = 30 }\n\n[initial]')
    gravity = ("gravity = 0 ", "gravity = 9.81 ")
    study = changed(held, torque, gravity, ("damping = 0 ", "damping = 0.01 "), name="paper-actuator")
    words = html.parts(study_items(study, None)).replace("\N{NO-BREAK SPACE}", " ")
    for part in ("by a torque of 30 N m, so that", "gravity of 9.81 m/s² along -y", "damping of 1 % of the critical"):
        assert part in words


def test_a_study_can_be_taken_out_of_the_page_as_it_was():
    """Spaces between numbers and units stay spaces: a file's name may have them, and its text a hash."""
    text = 'file = "a 2 m.csv"\nlength = "27 mm"  # < 1 kN'
    written = "file = &quot;a 2 m.csv&quot;\nlength = &quot;27 mm&quot;  # &lt; 1 kN"
    assert html.parts([Lines(text)]) == f'<pre tabindex="0" role="group" aria-label="Text">{written}</pre>'


def test_limits_of_the_replay_hold_every_frame(study, robot):
    told = replay(study, robot, locked_modes(study))
    everything = [points(told["points"]).reshape(-1, 3)]
    everything += [points(end).reshape(-1, 3) for mode in told["modes"] for end in mode["ends"]]
    assert len(told["modes"]) == 6 and told["modes"][0]["title"].startswith("Mode 1: 21.71 Hz")
    for i, name in enumerate("xyz"):
        low, high = told["layout"]["scene"][f"{name}axis"]["range"]
        assert all(low < part[:, i].min() and part[:, i].max() < high for part in everything)


def test_replay_of_an_actuator_is_in_its_plane():
    study = preset("paper-actuator")
    data = simulate_actuator(study, step=1e-3, duration=1.0)
    told = replay(study, data)
    frames = points(told["points"])
    assert frames.shape[2] == 2 and "scaleanchor" in told["layout"]["yaxis"]
    # The straight beam's end: the free length from the pivot, at the angle of the hub.
    at = data.sel(time=told["time"], method="nearest")
    end = 1e3 * at.length.values[:, None] * np.stack([np.cos(at.angle), np.sin(at.angle)], axis=1)
    np.testing.assert_allclose(frames[:, -2], end, atol=1e-3)
    page = robot_report(study, data)
    assert "to zoom" in told["mouse"] and "turn" not in page.split('id="replay"')[1].split("</section>")[0]
    assert Page(page).sections[0] == "deflection" and '<figure class="replay">' in page


def test_a_result_whose_table_is_gone_has_a_report_without_replay(robot, tmp_path):
    odd = robot.assign_attrs(study=robot.attrs["study"].replace('type = "roll"', 'type = "nothing"'))
    text = write_report(odd, tmp_path).read_text(encoding="utf-8")
    assert "replay" not in Page(text).sections and "misses its rigid path" in text


def test_data_cannot_end_their_element(tmp_path):
    made = replay_figure("title", {"words": "</script><b>"})
    assert (
        "</script><b>" not in made
        and json.loads(re.search(r"json\">(.*)</script>", made)[1])["words"] == "</script><b>"
    )


def test_pictures_stand_below_the_figures_that_zoom(page):
    """On paper, and where no script runs, every figure is a picture."""
    assert page.count('src="data:image/png') == 8 == page.count("<figure ")


def test_the_terminal_tells_of_the_tool_first(tool, tmp_path, capsys):
    print_items(run_items(*tool))
    lines = capsys.readouterr().out
    assert lines.startswith("The tool misses its rigid path")
    assert lines.index("The payload's centre of mass") < lines.index("peak / travel")


def test_small_shares_of_the_travel_keep_their_digits(tool, capsys):
    # They stood with the decimals of the largest: 0.0 beside 2.3.
    found = summary(tool[1], "com")
    shares = (None, 0.0123, 234.0)
    axes = [replace(axis, per_cent=share) for axis, share in zip(found.axes, shares, strict=True)]
    found = replace(found, axes=axes)
    print_items([axes_table(found)])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[-1] for line in lines if line.split()[:1] in (["x"], ["y"], ["z"])] == ["n/a", "0.012", "230"]
    table = html.parts([distances_table(found)])
    assert all(words in table for words in ("n/a", "0.012\N{NO-BREAK SPACE}%", "230\N{NO-BREAK SPACE}%"))


def test_an_axis_stays_with_its_number():
    shown = html.escape("x 4.33 µm, y 9.39 µm; mesh of 5 cm")
    assert shown == "x~4.33~µm, y~9.39~µm; mesh of 5~cm".replace("~", "\N{NO-BREAK SPACE}")


def test_labels_of_the_replayed_axes_have_the_middle_to_themselves(study, robot):
    """Labels stand in the middle of their axes, where ticks and the numbers of the legs lay below them."""
    scene = replay(study, robot)["layout"]["scene"]
    for name in "xyz":
        axis = scene[f"{name}axis"]
        (low, high), ticks = axis["range"], axis["tickvals"]
        middle = (low + high) / 2
        assert len(ticks) == 2 and low <= ticks[0] < ticks[1] <= high
        assert min(abs(tick - middle) for tick in ticks) > 0.15 * (high - low)


def test_a_machine_with_real_parts_has_its_error_budget():
    warm = loads(preset_text("paper-robot") + "\n[heat]\nreference = 20\npiston = 22\nexpansion = { piston = 12e-6 }\n")
    data = simulate(warm, fidelity="lumped", modes=None, step=1e-3, output_step=5e-3, duration=0.1)
    made = robot_report(warm, data)
    assert Page(made).sections[:2] == ["deviation", "budget"]
    assert re.search(r"The largest culprit at the pose of t = 0.1\ss is the heat of the pistons", made)
    assert "Error budget at rest, at the pose of the largest deviation" in made  # the chart
    at = data.time.values[int(np.linalg.norm(data.tool_deviation, axis=1).argmax())]
    assert f"the pose of t = {at:.4g}\N{NO-BREAK SPACE}s" in made


def test_a_report_names_the_parts_that_are_not_ideal():
    machine, ideal = (html.parts(study_items(preset(name), None)) for name in ("machine-hexapod", "paper-robot"))
    assert "Other parts that count: give of the joints at the base," in machine
    assert "heat of the screws, friction of the joints at the base." in machine
    assert "Tolerances: base joints, platform joints, leg offset, lead." in machine
    assert "Other parts" not in ideal and "Tolerances" not in ideal
