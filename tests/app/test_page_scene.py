"""The scene, the time panel and the modes of `flexapod view` in a browser: every control, and what is seen."""

import io

import numpy as np
import pytest
from PIL import Image
from tests.helpers.browser import difference
from tests.helpers.guests import until
from tests.helpers.short_runs import SHORT, SPACE, study_text

import flexapod as fx
from flexapod.app.browser.scene import PARTS

pytestmark = pytest.mark.web

PIXELS = 60  # that must differ before two pictures count as different: more than the noise of a blinking edge


def picture(page) -> np.ndarray:
    """What the panel leaves of the page, (rows, columns, 3)."""
    shot = page.screenshot(clip={"x": 0, "y": 0, "width": 490, "height": 700})
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=int)


def settled(page) -> np.ndarray:
    """The picture once it stands still."""
    seen = [picture(page)]

    def still() -> bool:
        page.wait_for_timeout(150)
        seen.append(picture(page))
        return difference(seen[-1], seen[-2]) == 0

    until(still)
    return seen[-1]


def moved(page, before) -> np.ndarray:
    """The picture once it differs from another one."""
    seen = []
    until(lambda: seen.append(picture(page)) or difference(seen[-1], before) > PIXELS)
    return seen[-1]


def changed(page, before) -> np.ndarray:
    """The picture once it differs from another one and stands still."""
    moved(page, before)
    return settled(page)


def back(page, before) -> None:
    """Wait until the picture is as it was."""
    until(lambda: difference(picture(page), before) < PIXELS)


def row(page, label):
    """The input of a label."""
    return page.locator("label", has_text=label).locator("xpath=ancestor::*[.//input][1]").last


def write(page, label, value):
    row(page, label).locator("input").last.fill(str(value))


def pick(page, label, option):
    row(page, label).locator("input").first.click()
    page.get_by_role("option", name=option, exact=True).click()


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def pause(page) -> None:
    """Press Pause, and wait until nothing moves by itself: what is written before that counts only for the still."""
    press(page, "Pause")
    page.get_by_role("button", name="Animate", exact=True).wait_for()


def at(page, time) -> None:
    """Wait until the chart has its cursor at a time, and the numbers below it are of that time."""
    page.get_by_text(f"At {time:g} s, in").wait_for()
    until(lambda: cursor(page) == pytest.approx(time))


def cursor(page) -> float | None:
    """Where the cursor of the chart stands: the instant at which the last line rises to the upper edge."""
    return page.evaluate(
        "() => { const d = Object.values(window.__viserTestpoints.uplots)[0]?.chart.data; if (!d) return null;"
        " const mark = d[d.length - 1]; return d[0][mark.indexOf(Math.max(...mark))]; }"
    )


def start(show, text):
    """A page that shows a result, and its session."""
    page, session = show(text)
    page.locator(".u-title").wait_for()
    page.locator("button:enabled", has_text="Play").wait_for()
    return page, session


def turn(page, label, value, place) -> np.ndarray:
    """Write a number that moves what is drawn at `place()`; the picture after it."""
    before = np.array(place())
    write(page, label, value)
    until(lambda: (np.array(place()) != before).any())
    return settled(page)


def test_time_scene_and_charts(show):
    page, session = start(show, study_text(*SHORT))
    page.get_by_text("times larger than they are").wait_for()
    first = settled(page)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 200  # a lit scene, not a blank page

    write(page, "time [s]", 0.12)  # scrub
    at(page, 0.12)
    assert session.scene.time == pytest.approx(0.12)
    middle = changed(page, first)

    pick(page, "speed", "1/100")  # play, pause, and on to the end
    press(page, "Play")
    moved(page, middle)
    press(page, "Pause")
    page.get_by_role("button", name="Play", exact=True).wait_for()
    stopped = session.time_panel._time
    assert 0.12 < stopped < 0.2
    still = picture(page)
    assert session.time_panel._time == stopped
    pick(page, "speed", "2 x")
    press(page, "Play")
    until(lambda: session.scene.time == pytest.approx(0.2))
    page.get_by_text("At 0.2 s, in").wait_for()
    page.get_by_role("button", name="Play", exact=True).wait_for()
    moved(page, still)

    last = now = settled(page)
    parts = ("rigid ghost", "paths", "deviation arrow", "labels", "grid", "frames")
    for name in parts:  # hide what is shown, show what is hidden, one after the other
        row(page, name).locator("input").click()
        now = changed(page, now)
    for name in parts:
        row(page, name).locator("input").click()
        until(lambda name=name: session.scene._shown[name] == PARTS[name])
    back(page, last)

    now = last
    for name, words in (("force", "Force of the drive"), ("stroke margin", "Stroke left"), ("bending", "Bending")):
        pick(page, "leg colours", name)
        page.get_by_text(words).first.wait_for()
        now = changed(page, now)
    pick(page, "leg colours", "plain")
    page.get_by_text("Legs by number").wait_for()
    back(page, last)

    titles = {"leg forces": "Force of the drives", "tip deflections": "Piston tips", "energies": "works"}
    for name, title in titles.items():
        pick(page, "chart", name)
        page.locator(".u-title", has_text=title).wait_for()

    write(page, "magnify", 1)  # true size and back
    page.get_by_text("drawn in true size").wait_for()
    moved(page, last)
    press(page, "Automatic factor")
    page.get_by_text("times larger than they are").wait_for()
    assert session.scene.scale == session.scene.automatic > 1


def test_modes_are_listed_drawn_and_recomputed_at_another_pose(show):
    text = study_text(*SHORT)
    page, session = start(show, text)
    page.get_by_role("tab", name="Modes").click()
    study = fx.loads(text)
    home = fx.modes(study)
    words = f"{float(home.frequency[2]):.4g} Hz, {home.kind.values[2]}"
    until(lambda: row(page, "mode").locator("input").first.input_value().startswith("1: "))
    before = settled(page)

    pick(page, "mode", f"3: {words}")  # choosing shows it moving
    page.get_by_role("button", name="Pause", exact=True).wait_for()
    moving = moved(page, before)
    moved(page, moving)
    pause(page)
    still = settled(page)
    up = turn(page, "phase [deg]", 89, lambda: session.scene._drawn.robot._platform.position)
    write(page, "phase [deg]", 271)
    down = changed(page, up)
    write(page, "amplitude", 1)
    small = changed(page, down)
    assert difference(small, still) > 0

    write(page, "heave [mm]", 20)  # another pose
    expected = fx.modes(study, {"heave": 0.02})
    page.get_by_text(f"1: {float(expected.frequency[0]):.4g} Hz").or_(
        page.get_by_role("cell", name=f"{float(expected.frequency[0]):.4g}", exact=True)
    ).first.wait_for()
    write(page, "heave [mm]", 300)  # out of reach: the words of the command line
    page.get_by_text("longer than its stroke allows").wait_for()
    press(page, "Home")
    page.get_by_role("cell", name=f"{float(home.frequency[0]):.4g}", exact=True).first.wait_for()
    assert not page.get_by_text("longer than its stroke allows").count()

    press(page, "Animate")  # two panels never move the scene at once
    page.get_by_role("button", name="Pause", exact=True).wait_for()
    page.get_by_role("tab", name="Time").click()
    write(page, "time [s]", 0.1)
    until(lambda: session.scene.driver is None)
    at(page, 0.1)
    quiet = settled(page)
    assert difference(quiet, settled(page)) == 0


def test_the_single_actuator_is_drawn_and_its_frequencies_follow_the_length(show):
    text = study_text(('duration = "10 s"', 'duration = "0.5 s"'), preset="paper-actuator")
    page, session = start(show, text)
    page.locator(".u-title", has_text="Tip in the frame of the hub").wait_for()
    first = settled(page)
    write(page, "time [s]", 0.5)
    at(page, 0.5)
    moved(page, first)
    page.get_by_role("tab", name="Modes").click()
    a = fx.loads(text).actuator

    def lowest(length):  # (beta_1 L)^2 = 3.5160, in every textbook
        return 3.5160 / (2 * np.pi) * np.sqrt(a.EI / (a.rhoA * length**4))

    page.get_by_role("cell", name=f"{lowest(1.83):.3g}", exact=False).first.wait_for()
    write(page, "free length [m]", 3)
    page.get_by_role("cell", name=f"{lowest(3.0):.3g}", exact=False).first.wait_for()
    write(page, "shapes", 5)
    page.get_by_role("cell", name="5", exact=True).wait_for()
    until(lambda: not session.scene._nodes["ghost"].visible)
    straight = settled(page)
    pick(page, "mode", f"2: {6.2669 * lowest(3.0):.4g} Hz")  # (beta_2 / beta_1)^2, in every textbook; it moves
    page.get_by_role("button", name="Pause", exact=True).wait_for()
    moving = moved(page, straight)
    moved(page, moving)
    pause(page)

    def beam():
        return session.scene._nodes["beam"].vertices

    up = turn(page, "phase [deg]", 89, beam)
    write(page, "phase [deg]", 270)
    moved(page, up)
    turn(page, "amplitude", 25, beam)
    far = turn(page, "phase [deg]", 90, beam)
    line = beam().reshape(-1, 8, 3).mean(axis=1)
    assert line[0] == pytest.approx([0, 0, 0], abs=1e-9)  # clamped at the hub
    assert abs(line[-1, 2]) == pytest.approx(0.25 * 3.0, rel=1e-3)  # the tip moves most, a quarter of the length
    assert line[-1, 2] * line[len(line) // 2, 2] < 0  # the second mode has a node
    write(page, "amplitude", 1)
    moved(page, far)
    assert session.study.actuator.free_length == 1.83  # looking at another length changes no study


def test_an_actuator_in_space_is_drawn_about_both_its_axes(show):
    page, session = start(show, SPACE)
    page.locator(".u-title", has_text="Tip in the frame of the hub").wait_for()

    def beam(node="beam"):
        return session.scene._nodes[node].vertices.reshape(-1, 8, 3).mean(axis=1)

    write(page, "time [s]", 0.75)
    at(page, 0.75)
    data = session.data.sel(time=0.75, method="nearest")
    axis = np.array([np.cos(data.elevation) * np.cos(data.angle), np.cos(data.elevation) * np.sin(data.angle)])
    assert data.angle > 0.9 and abs(data.elevation) < 0.2
    assert beam("inside")[1, :2] == pytest.approx(0.06 * axis, abs=1e-6)  # the mouth, from the pivot
    page.get_by_role("tab", name="Modes").click()
    found = fx.modes(session.study)
    kinds = [str(kind) for kind in found.kind.values]
    away = {"bending (elevation)": [np.sin(0.349066), 0, np.cos(0.349066)], "bending (rotation)": [0, 1, 0]}
    for kind, direction in away.items():  # the first mode is chosen already: to pick it would move nothing
        place = kinds.index(kind)
        name = f"{place + 1}: {float(found.frequency[place]):.4g} Hz, {kind}"
        page.get_by_role("cell", name=kind).first.wait_for()
        pick(page, "mode", name)
        page.get_by_role("button", name="Pause", exact=True).wait_for()
        pause(page)
        turn(page, "phase [deg]", 89, beam)
        turn(page, "phase [deg]", 90, beam)  # seen, before the next mode: a text is read when the writer pauses
        until(lambda: session.scene.drawn.startswith(f"mode {place + 1}"))  # noqa: B023
        moved = beam()[-1] - 1.26 * np.array([np.cos(0.349066), 0, -np.sin(0.349066)])
        assert np.abs(moved @ direction) == pytest.approx(np.linalg.norm(moved), rel=1e-3)
        assert np.linalg.norm(moved) > 0.01
    place = kinds.index("twisting")
    pick(page, "mode", f"{place + 1}: {float(found.frequency[place]):.4g} Hz, twisting")
    page.get_by_role("button", name="Pause", exact=True).wait_for()
    seen = session.scene._nodes["stripe"].points.copy()
    until(lambda: np.abs(session.scene._nodes["stripe"].points - seen).max() > 1e-3)


def test_another_result_is_shown_at_the_same_time_and_factor(show):
    page, session = start(show, study_text(*SHORT))
    write(page, "time [s]", 0.1)
    write(page, "magnify", 50)
    until(lambda: session.scene.scale == 50 and session.scene.time == pytest.approx(0.1))
    before, chart = session.data, page.locator(".u-title").element_handle()
    press(page, "Simulate")
    until(lambda: session.data is not before and session.scene.data is session.data)
    assert session.scene.scale == 50 and session.scene.time == pytest.approx(0.1)
    chart.wait_for_element_state("hidden")  # another one takes its place
    at(page, 0.1)
