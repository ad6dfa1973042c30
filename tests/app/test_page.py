"""What viser's page lacks and ours adds: typed numbers, keys that stay in their place, a way back, names for all."""

import time

import numpy as np
import pytest
from tests.helpers.guests import until
from tests.helpers.short_runs import SHORT, study_text

from flexapod.app.browser.text_fields import SETTLED

pytestmark = pytest.mark.web

ANSWER = "misses its rigid path by up to"
PICTURE = "canvas[data-engine]"
ACTUATOR = study_text(('duration = "10 s"', 'duration = "0.2 s"'), preset="paper-actuator")


@pytest.fixture
def opened(show):
    page, session = show(study_text(*SHORT))
    page.get_by_text(ANSWER).wait_for()
    until(lambda: session.data is not None and not session.busy)
    return page, session


def camera(session):
    """Where the camera is and looks."""
    found = session.client.camera
    return np.concatenate([found.position, found.look_at])


def stands(session):
    """Where the camera is once it stands still."""
    seen = [camera(session)]

    def still():
        session.table.wait_for_timeout(200)
        seen.append(camera(session))
        return np.array_equal(seen[-1], seen[-2])

    until(still)
    return seen[-1]


def test_typed_numbers_mean_what_they_mean_in_a_file(opened):
    """2e2 became 22, 1.5e2 1.52 and 1,000 one: the page computed another study than the one that was typed."""
    page, session = opened
    page.get_by_role("tab", name="Study").click()
    page.get_by_role("button", name="[payload]").press("Enter")  # folders open by keys, too
    mass = page.get_by_label("mass [kg]", exact=True).first
    for text, value, shown in (("2e2", 200.0, "200"), ("27,5 kg", 27.5, "27.5"), ("1.5e2", 150.0, "150")):
        mass.click()
        mass.fill("")
        mass.press_sequentially(text)  # letter by letter, as people write
        mass.press("Enter")
        until(lambda value=value: session.study.robot.payload.mass == value)
        until(lambda shown=shown: mass.input_value() == shown)
    mass.fill("1,000")
    page.get_by_text("has a comma that may be a decimal mark or set thousands apart").first.wait_for()
    page.locator("button:disabled", has_text="Simulate").wait_for()
    assert session.study.robot.payload.mass == 150.0 and mass.input_value() == "1,000"
    mass.fill("")
    page.wait_for_timeout(600)
    assert mass.input_value() == ""  # it is still being written in
    mass.press("Tab")
    until(lambda: mass.input_value() == "150" and session._valid)
    page.get_by_text(ANSWER).wait_for()
    page.get_by_role("tab", name="Time").click()
    time = page.get_by_label("time [s]", exact=True).first
    time.fill("5e-2")
    page.get_by_text("At 0.05 s, in").wait_for()
    time.fill("100 ms")
    page.get_by_text("At 0.1 s, in").wait_for()
    time.press("Enter")
    until(lambda: time.input_value() == "0.1")
    page.get_by_label("magnify", exact=True).fill("1e3")
    until(lambda: session.scene.scale == 1000.0)


def test_what_is_being_typed_is_not_overwritten_by_an_answer_to_what_was_typed_before(opened):
    """Letters went where a late answer came between them: 1.5e2 became another number."""
    page, session = opened
    page.get_by_role("tab", name="Study").click()
    page.get_by_role("button", name="[payload]").press("Enter")
    mass = page.get_by_label("mass [kg]", exact=True).first
    mass.fill("27.5")
    mass.press("Enter")
    until(lambda: session.study.robot.payload.mass == 27.5)
    handles = session.client.gui._gui_input_handle_from_uuid.values()
    handle = next(x for x in handles if getattr(x, "label", "") == "mass [kg]")
    until(lambda: handle.value == mass.input_value() == "27.5")
    mass.click()
    mass.fill("")
    held = texts_of(mass)
    for letter in "1.5e2":
        mass.press(letter)
        before = held().count("27.5")

        def comes(before=before):  # once more if the page has put it away before it was shown
            session.client._websock_connection.queue_message(_late(handle._impl.uuid, "27.5"))
            page.wait_for_timeout(500)
            return held().count("27.5") > before

        until(comes)  # it has come, and had to go
    assert mass.input_value() == "1.5e2"
    mass.press("Enter")
    until(lambda: session.study.robot.payload.mass == 150.0 and mass.input_value() == "150")
    # What is left takes the text of the server, which may say its own once more after that.
    session.client._websock_connection.queue_message(_late(handle._impl.uuid, "151"))
    until(lambda: "151" in (*held(), mass.input_value()))


def texts_of(field):
    """A function that gives all texts that a field has held and that others have replaced, from now on."""
    field.evaluate(
        """field => {
            field.held = [];
            new MutationObserver((changes) => field.held.push(...changes.map((change) => change.oldValue)))
                .observe(field, { attributes: true, attributeFilter: ["value"], attributeOldValue: true });
        }"""
    )
    return lambda: field.evaluate("field => field.held")


def test_keys_in_the_panel_do_not_move_the_camera_and_a_button_brings_it_back(opened):
    page, session = opened
    session.table = page
    first = stands(session)
    page.get_by_role("tab", name="Time").focus()
    for key in ("w", "a", "q", "ArrowLeft", "ArrowUp"):
        page.keyboard.press(key, delay=80)
    page.get_by_role("slider", name="time [s]").focus()
    page.keyboard.press("ArrowRight")
    page.get_by_text("study.toml", exact=True).click()  # nothing has the focus
    page.keyboard.press("s", delay=80)
    assert np.array_equal(stands(session), first)
    page.locator(PICTURE).click(position={"x": 60, "y": 600})

    def moved():
        page.keyboard.press("s", delay=200)  # a busy machine may draw nothing while a key is down
        return not np.allclose(camera(session), first, atol=1e-3)

    until(moved)
    stands(session)
    page.get_by_role("button", name="Reset view").click()
    until(lambda: np.allclose(camera(session), first, atol=1e-3))
    page.get_by_role("button", name="Reset view").press("d")  # nor do keys move it from there
    assert np.allclose(stands(session), first, atol=1e-3)


def test_slider_and_picture_agree_after_pause_and_arrow_keys(opened):
    """A time that was on its way to the browser while a key was pressed had the last word there, not in the picture."""
    page, session = opened
    panel = session.time_panel
    slider = page.get_by_role("slider", name="time [s]")
    page.get_by_role("button", name="Play", exact=True).click()
    until(lambda: panel._player.playing and panel._time > 0.01)
    slider.focus()
    panel.pause()
    late = False
    while not late:  # on a busy machine the key may take longer than what is late can be
        begin = time.monotonic()
        slider.press("ArrowLeft")  # on a busy machine it may have come to the end, where no key leads to the right
        session.client._websock_connection.queue_message(_late(panel._dial._slider._impl.uuid, 0.123))
        late = time.monotonic() - begin < SETTLED
    page.wait_for_timeout(1e3 * SETTLED + 500)
    until(lambda: float(slider.get_attribute("aria-valuenow")) == pytest.approx(session.scene.time, abs=6e-4))
    until(lambda: panel._dial.value == pytest.approx(session.scene.time, abs=6e-4))
    until(lambda: f"At {panel._dial.value:.4g} s" in page.locator(".flexapod-readout").inner_text())
    until(lambda: float(page.get_by_label("time [s]", exact=True).first.input_value()) == panel._dial.value)


def _late(uuid, value):
    """A value of an input that was sent before the user changed it."""
    from viser._messages import GuiUpdateMessage

    return GuiUpdateMessage(uuid, {"value": value})


def test_the_tab_is_called_after_the_study_and_a_refused_upload_is_not_called_successful(opened):
    page, _ = opened
    assert page.title() == "study.toml - flexapod"
    page.get_by_role("tab", name="Files").click()
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Study file", exact=True).click()
    chooser.value.set_files({"name": "bad.toml", "mimeType": "text/plain", "buffer": b"[robot\n"})
    page.get_by_text("is not valid TOML").first.wait_for()
    page.get_by_text("The tab Files says whether it is taken.").first.wait_for()
    assert not page.get_by_text("successfully").count()
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Study file", exact=True).click()
    chooser.value.set_files({"name": "beam.toml", "mimeType": "text/plain", "buffer": ACTUATOR.encode()})
    until(lambda: page.title() == "beam.toml - flexapod")


def test_nothing_of_a_robot_stays_where_an_actuator_is_drawn(show):
    """Both had a node /ghost: the beam's rigid line stood where the robot's ghost platform had been, 0.9 m too high."""
    _, session = show(study_text(*SHORT))
    until(lambda: session.data is not None and not session.busy)
    robot = set(session.client.scene._handle_from_node_name)
    _, session = show(ACTUATOR)
    until(lambda: session.data is not None and not session.busy)
    shared = robot & set(session.client.scene._handle_from_node_name)
    # These stand at the origin in both, or are placed anew.
    assert shared <= {"", "/WorldAxes", "/frame", "/grid", "/light", "/light_around"}


@pytest.mark.parametrize("text", [study_text(*SHORT), ACTUATOR], ids=["robot", "actuator"])
def test_no_serious_finding_of_axe_on_the_page(show, axe, text):
    page, session = show(text)
    until(lambda: session.data is not None and not session.busy)
    for tab in ("Time", "Study", "Modes", "Budget", "Files"):
        page.get_by_role("tab", name=tab).click()
        page.wait_for_timeout(300)
        page.locator("[role=button][aria-expanded=false]").evaluate_all(
            "folders => folders.forEach((folder) => folder.offsetParent && folder.click())"
        )
        page.wait_for_timeout(500)
        assert axe(page) == []
