"""The page of `flexapod view` in a browser: numbers, words, simulation, files, two people at once."""

import io
import threading
import zipfile
from pathlib import Path

import pytest
from tests.helpers.guests import until
from tests.helpers.short_runs import LONG, SHORT, study_text

import flexapod as fx
from flexapod.analysis import open_results, summary
from flexapod.app.browser import files_panel
from flexapod.app.browser.running import CoreUsage
from flexapod.app.browser.uploads import LARGEST
from flexapod.common.errors import InputError
from flexapod.output.report import figures
from flexapod.output.text.parts import error_lines, error_parts

pytestmark = pytest.mark.web

ANSWER = "misses its rigid path by up to"
POINTS = """[motion]
type = "waypoints"  # two poses
points = [
  { time = "0.05 s", roll = "1 deg" },  # there
  { time = "0.1 s", heave = "1 mm" },   # and back
]
[simulation]
duration = "0.2 s"
modes = 1
"""
CSV_MOTION = (
    ('type = "roll" ', 'type = "csv"\nfile = "path.csv" '),
    ('amplitude = "26.6 deg"', ""),
    ('duration = "1 s" ', ""),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('profile = "quintic"', ""),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
)


def words_of(text: str) -> list[str]:
    """The words of the command line for a study that is refused."""
    with pytest.raises(InputError) as refused:
        fx.loads(text, path="study.toml")
    return [line.strip() for line in error_lines(error_parts(refused.value))]


def answered(page, session) -> None:
    """Wait until the page shows the answer to the study that the session has: what is below it stays where it is."""
    until(lambda: session.data is not None and not session.busy)
    page.get_by_text(summary(session.data).sentence).wait_for()


def download(page, session, button: str) -> tuple[str, bytes]:
    until(lambda: not session.files_panel._busy)  # with the file before
    with page.expect_download() as coming:
        page.get_by_role("button", name=button, exact=True).click()
    return coming.value.suggested_filename, Path(coming.value.path()).read_bytes()


def tab(page, name: str) -> None:
    page.get_by_role("tab", name=name).click()


def press_inside(page, folder: str, button: str) -> None:
    """Open a folder and press a button in it, as a user does: when the folder has stopped opening."""
    page.get_by_text(folder, exact=True).click()
    found, places = page.get_by_role("button", name=button), []
    found.wait_for()
    until(lambda: places.append(found.bounding_box()) or places[-20:] == [places[-1]] * 20)  # half a second
    found.click()


def test_every_number_can_be_changed_and_is_validated_at_once(show):
    text = study_text(*SHORT)
    page, session = show(text)
    answered(page, session)
    tab(page, "Study")
    page.get_by_text("[leg]", exact=True).click()
    diameter = page.get_by_label("diameter [mm]", exact=True)
    diameter.fill("-5")
    for line in words_of(text.replace('= "27 mm"', '= "-5 mm"')):
        page.get_by_text(line).first.wait_for()
    page.locator("button:disabled", has_text="Simulate").wait_for()
    assert session.study.robot.legs[0].piston.diameter == 0.027  # the picture shows the last valid study

    page.get_by_label("mouth [mm]", exact=True).fill("300")
    diameter.click()
    page.wait_for_timeout(200)  # as people do: of two messages within 50 ms the page sends one
    diameter.fill("20")
    page.get_by_text("Preview, right to about 1 %").wait_for()
    page.get_by_role("button", name="Simulate").click()
    until(lambda: session.data is not None and session.data.attrs["tolerance"] == 1e-4)
    page.get_by_text("Preview, right to about 1 %").wait_for(state="hidden")
    answered(page, session)
    wanted = text.replace('= "27 mm"', '= "20 mm"').replace('"315.18 mm"', '"300 mm"')
    assert session.study.robot == fx.loads(wanted).robot
    assert session.data.attrs["study"] == wanted  # comments and all
    page.get_by_label("material", exact=True).click()
    page.get_by_role("option", name="aluminium").click()
    until(lambda: session.study.robot.legs[0].piston.density == 2700)
    answered(page, session)
    page.get_by_role("button", name="Back to the file").click()
    until(lambda: session.study.source_text == text)


def test_a_dragged_number_moves_the_rigid_preview_before_anything_is_simulated(show, monkeypatch):
    page, session = show(study_text(*SHORT))
    page.get_by_text(ANSWER).wait_for()
    tab(page, "Study")
    page.get_by_label("number", exact=True).click()
    page.get_by_role("option", name="motion.amplitude").click()
    page.get_by_text("motion.amplitude = 2 deg").wait_for()
    monkeypatch.setattr(session._settling, "_work", lambda: None)
    lengths = page.get_by_role("cell").all_inner_texts()
    slider = page.get_by_role("slider").last
    slider.focus()
    for _ in range(5):
        slider.press("ArrowRight")  # a two-hundredth of 4 deg each
    until(lambda: session.study.motion.amplitude == pytest.approx(0.0366519, rel=1e-5))  # 2.1 deg
    assert session.data is None
    until(lambda: page.get_by_role("cell").all_inner_texts() != lengths)


def test_what_is_below_the_answer_stays_under_the_mouse(show):
    """While a change was answered everything below went up and down by 86 pixels, and quick clicks missed."""
    page, session = show(study_text(*SHORT), height=1600)
    tab(page, "Study")
    page.get_by_text("[payload]", exact=True).click()
    mass = page.get_by_label("mass [kg]", exact=True).first
    undo = page.get_by_role("button", name="Undo")
    for number in (99, 98, 97):
        mass.fill(str(number))
        until(lambda number=number: session.study.robot.payload.mass == number)
        answered(page, session)
        if number == 99:
            page.get_by_text("Preview, right to about 1 %").wait_for()
            page.evaluate(
                "button => { window.places = []; const look = () => {"
                " window.places.push(button.getBoundingClientRect().y); requestAnimationFrame(look); }; look(); }",
                undo.element_handle(),
            )
    box = undo.bounding_box()
    for _ in range(3):
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        page.wait_for_timeout(200)  # as fast as people click
    until(lambda: session.study.robot.payload.mass == 100)
    answered(page, session)
    places = page.evaluate("window.places")
    assert max(places) - min(places) <= 2  # a button that is pressed goes down by one


def test_simulate_shows_progress_and_can_be_cancelled(show):
    page, session = show(study_text(*LONG))
    until(lambda: float(page.get_by_role("progressbar").get_attribute("aria-valuenow")) > 0)
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("Cancelled").wait_for()
    assert not session.busy and session.data is None
    until(lambda: not [t for t in threading.enumerate() if t.name == "flexapod-simulation"])
    places = session._cores
    taken = []
    while places._free:
        taken.append(CoreUsage())
        assert places.acquire(taken[-1], lambda: False, lambda: None)
    page.get_by_role("button", name="Simulate").click()
    page.get_by_text("Waiting for a free core").wait_for()
    places.release(taken.pop())
    page.get_by_text("Simulating.").wait_for()
    page.get_by_role("button", name="Cancel").click()
    until(lambda: places._free)
    while taken:
        places.release(taken.pop())


def test_points_and_tables_are_added_and_taken_out(show):
    motion = study_text(*SHORT).split("[motion]")[0] + POINTS
    page, session = show(motion)
    answered(page, session)
    tab(page, "Study")
    page.get_by_role("button", name="Add a point").click()
    page.get_by_role("button", name="Take out points[3]").wait_for()
    until(lambda: [p.time for p in session.study.motion.points] == pytest.approx([0.05, 0.1, 0.15]))
    answered(page, session)
    page.get_by_role("button", name="Take out points[1]").click()
    until(lambda: [p.time for p in session.study.motion.points] == pytest.approx([0.1, 0.15]))
    answered(page, session)
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").click()
    until(lambda: session.study.source_text == motion)
    answered(page, session)
    page.get_by_role("button", name="Add [load]").click()
    until(lambda: "wrench" in session.study.source_text)
    answered(page, session)
    press_inside(page, "[load]", "Take out [load]")
    until(lambda: "wrench" not in session.study.source_text)
    answered(page, session)
    press_inside(page, "[leg]", "Six different legs")
    page.get_by_text("[[leg]] 6", exact=True).wait_for()
    until(lambda: session.study.source_text.count("\n[[leg]]") == 6)
    answered(page, session)
    press_inside(page, "[[leg]] 1", "All legs as this one")
    page.get_by_text("[leg]", exact=True).wait_for()
    until(lambda: session.study.source_text.split() == motion.split() and session.data is not None)


def test_downloads(show, tmp_path, monkeypatch):
    drawn, draw = [], figures.draw_figures

    def once(data, folder, formats):
        drawn.extend([] if drawn else draw(data, tmp_path / "figures", formats))
        return drawn

    monkeypatch.setattr(figures, "draw_figures", once)  # the same figures for the archive and the report
    text = study_text(*SHORT)
    page, session = show(text)
    page.get_by_text(ANSWER).wait_for()
    tab(page, "Files")
    assert download(page, session, "Study (TOML)") == ("study.toml", text.encode())
    name, content = download(page, session, "Results (NetCDF)")
    assert name == "study.nc"
    (tmp_path / name).write_bytes(content)
    stored = open_results(tmp_path / name)
    assert stored.com_deviation.equals(session.data.com_deviation)
    assert stored.attrs["study_file"] == "study.toml"  # and not where it lies on the server
    name, content = download(page, session, "Results (CSV)")
    assert name == "study.csv" and content.startswith(b"time [s],")
    name, content = download(page, session, "Figures (ZIP of PNG)")
    assert zipfile.ZipFile(io.BytesIO(content)).namelist() == [figure.png.name for figure in drawn]
    name, content = download(page, session, "Report (HTML)")
    assert name == "study-report.html" and b"</html>" in content


@pytest.fixture
def sender(show):
    """A page with the tab Files open: `send(button, name, content)`."""
    page, session = show(study_text(*SHORT))
    tab(page, "Files")

    def send(button: str, name: str, content: bytes) -> None:
        until(lambda: not session.files_panel._busy)  # with the file before
        with page.expect_file_chooser() as chooser:
            page.get_by_role("button", name=button, exact=True).click()
        chooser.value.set_files({"name": name, "mimeType": "text/plain", "buffer": content})

    send.page, send.session = page, session
    return send


def test_uploads_are_refused_in_the_words_of_the_command_line(sender):
    page, before = sender.page, sender.session.study
    bad = study_text(*SHORT, ("100 kg", "-100 kg"))
    sender("Study file", "study.toml", bad.encode())
    for line in words_of(bad):
        page.get_by_text(line).first.wait_for()
    for name, content, words in [
        ("a.toml", b"[robot\n", "is not valid TOML"),
        ("b.toml", b"\xff\xfe\x00", "it is not UTF-8 text"),
        ("c.toml", b"#" * (LARGEST + 1), "is too large"),
        ("d.toml", study_text(*CSV_MOTION).replace("path.csv", "other.csv").encode(), "is a table that was not sent"),
        ("e.toml", study_text(*CSV_MOTION).replace("path.csv", "/etc/passwd").encode(), "motion.file = /etc/passwd"),
        ("<img src=x onerror=alert(1)>.toml", b"[robot\n", "is not valid TOML"),
    ]:
        sender("Study file", name, content)
        page.get_by_text(words).first.wait_for()
    assert sender.session.study == before


def test_an_uploaded_study_takes_the_place_of_the_one_before(sender):
    page, session = sender.page, sender.session
    sender("Table", "path.csv", b"time [s], roll [deg]\n0, 0\n0.05, 0.5\n0.1, 1\n")
    page.get_by_text("Kept: path.csv").wait_for()
    sender("Study file", "mine.toml", study_text(*CSV_MOTION).encode())
    page.get_by_text("mine.toml", exact=True).wait_for()
    until(lambda: session.study.motion.type == "csv" and session.data is not None)
    tab(page, "Study")
    page.get_by_text("[payload]", exact=True).click()
    page.get_by_label("mass [kg]", exact=True).first.fill("90")  # the table it names is still there
    until(lambda: session.study.robot.payload.mass == 90.0 and session.data is not None)
    tab(page, "Files")
    actuator = study_text(('duration = "10 s"', 'duration = "0.2 s"'), preset="paper-actuator")
    sender("Study file", "beam.toml", actuator.encode())
    page.get_by_text("The tip leaves the hub's line").wait_for()
    tab(page, "Study")
    page.get_by_text("[simulation]", exact=True).click()
    page.get_by_label("modes", exact=True).fill("2")
    until(lambda: session.study.simulation.modes == 2 and session.data is not None)
    assert session.data.sizes["mode"] == 2


def test_two_people_have_a_state_each_and_a_fault_stays_with_one(desk, show, monkeypatch):
    def broken(data):
        raise RuntimeError("the pen is broken")

    monkeypatch.setattr(files_panel, "figures", broken)
    server, visit, _ = desk
    one, first = show(study_text(*SHORT))
    two = visit()
    second = until(lambda: [s for s in server.sessions if s is not first])[0]
    for page in (one, two):
        page.get_by_text(ANSWER).wait_for()
    tab(one, "Study")
    one.get_by_text("[payload]", exact=True).click()
    one.get_by_label("mass [kg]", exact=True).first.fill("50")
    until(lambda: {s.study.robot.payload.mass for s in (first, second)} == {50.0, 100.0})
    until(lambda: first.data is not None)
    tab(one, "Files")
    one.get_by_role("button", name="Figures").click()
    one.get_by_text("unexpected RuntimeError: the pen is broken").wait_for()
    assert not two.get_by_text("RuntimeError").is_visible()
    two.context.close()  # who leaves takes nobody along
    until(lambda: server.sessions == [first])
    tab(one, "Study")
    one.get_by_label("mass [kg]", exact=True).first.fill("60")
    until(lambda: first.study.robot.payload.mass == 60.0 and first.data is not None)
