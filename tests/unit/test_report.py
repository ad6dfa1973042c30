"""The report of a run: the answer first, the study in words, everything within the page."""

import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from flexapod.app.html import replay as replay_figure
from flexapod.app.interactive import MOST_POINTS
from flexapod.app.replay import FRAMES, locked_modes, replay
from flexapod.app.report import robot_report, write_report
from flexapod.app.study_words import study_words
from flexapod.model import loads, preset, preset_text
from flexapod.study import simulate, simulate_actuator

POINTS = 6 + 6 * 9 + 2 * 6 + 4  # of a frame: bases, pistons, platforms, centres


@pytest.fixture(scope="module")
def study():
    return preset("paper-robot")


@pytest.fixture(scope="module")
def robot(study):
    return simulate(study, step=1e-3, output_step=5e-3)


@pytest.fixture(scope="module")
def page(study, robot):
    return robot_report(study, robot)


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
    words = " ".join(study_words(study, None))
    for part in ("6-UPS", "100 kg", "roll 26.6 deg in 1 s", "assumed-modes, 3 lateral shapes", "static equilibrium"):
        assert part in words.replace("\N{NO-BREAK SPACE}", " ")
    text = preset_text("paper-actuator")
    words = " ".join(study_words(loads(text), None)).replace("\N{NO-BREAK SPACE}", " ")
    for part in ("3.66 m", "rotation at 0.785 rad/s", "extension at 0.1 m/s", "released from 5 mm"):
        assert part in words


def test_words_of_other_motions(study):
    text = preset_text("paper-robot")
    head, tail = text.split("[motion]")[0], "[simulation]" + text.split("[simulation]")[1]
    points_of = 'type = "waypoints"\npoints = [{ time = "1 s", heave = "10 mm" }, { time = "2 s", heave = 0 }]\n'
    words = " ".join(study_words(loads(f"{head}[motion]\n{points_of}{tail}"), None))
    assert "through 2 points" in words


def test_frames_of_the_replay_follow_the_result(study, robot):
    told = replay(study, robot)
    frames = points(told["points"])
    assert frames.shape == (FRAMES, POINTS, 3)
    com = 1e3 * robot.com_position_rigid.sel(time=told["time"], method="nearest").values
    # 32 bit floats of 1 m in mm: 1e-4 mm.
    np.testing.assert_allclose(frames[:, -1], com, atol=1e-3)
    factor = float(re.search(r"drawn (\S+) times", told["words"])[1])
    deviation = robot.com_deviation.sel(time=told["time"], method="nearest").values
    np.testing.assert_allclose(frames[:, -3], com + 1e3 * factor * deviation, atol=1e-3)
    np.testing.assert_allclose(np.array(told["values"])[:, 2], 1e6 * deviation[:, 2], atol=6e-3)  # two places shown
    numbers = [point for trace in told["traces"] for point in trace["take"]]
    assert max(numbers) == POINTS - 1 and min(numbers) == -1


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
