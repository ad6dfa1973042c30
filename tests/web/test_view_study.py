"""The page of `flexapod view` in a browser: numbers, words, simulation, files, two people at once."""

import gc
import io
import threading
import time
import weakref
import zipfile
from pathlib import Path

import msgspec
import pytest
import viser
from tests.web.conftest import SHORT, study_text
from viser import _messages
from websockets.sync.client import connect

import flexapod as fx
from flexapod.app.failures import lines_of, parts_of
from flexapod.app.view import files_panel
from flexapod.app.view.session import Session
from flexapod.app.view.uploads import LARGEST
from flexapod.errors import InputError
from flexapod.study import open_results, summary

ANSWER = "misses its rigid path by up to"
LONG = (
    ('duration = "2 s" ', 'duration = "1000 s" '),
    ("tolerance = 1e-4", 'step = "0.5 ms"\noutput_step = "10 ms"'),
    ('hold = "1 s" ', 'hold = "999 s" '),
)
CSV_MOTION = (
    ('type = "roll" ', 'type = "csv"\nfile = "path.csv" '),
    ('amplitude = "26.6 deg"', ""),
    ('duration = "1 s" ', ""),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('profile = "quintic"', ""),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
)


def until(true, seconds=60.0):
    """Wait until something holds; a busy machine takes longer, a fault for ever."""
    end = time.monotonic() + seconds
    while not (found := true()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def only_session(server) -> Session:
    return until(lambda: server.sessions)[0]


def words_of(text: str) -> list[str]:
    """The words of the command line for a study that is refused."""
    with pytest.raises(InputError) as refused:
        fx.loads(text, path="study.toml")
    return [line.strip() for line in lines_of(parts_of(refused.value))]


def download(page, button: str) -> tuple[str, bytes]:
    with page.expect_download() as coming:
        page.get_by_role("button", name=button, exact=True).click()
    return coming.value.suggested_filename, Path(coming.value.path()).read_bytes()


def tab(page, name: str) -> None:
    page.get_by_role("tab", name=name).click()


def test_every_number_can_be_changed_and_is_validated_at_once(view, visit):
    text = study_text(*SHORT)
    server = view(text)
    page, session = visit(server), only_session(server)
    page.get_by_text(ANSWER).wait_for()
    assert page.get_by_text(summary(session.data).sentence).is_visible()

    tab(page, "Study")
    page.get_by_text("[leg]", exact=True).click()
    diameter = page.get_by_label("diameter [mm]", exact=True)
    diameter.fill("-5")
    for line in words_of(text.replace('= "27 mm"', '= "-5 mm"')):
        page.get_by_text(line).first.wait_for()
    assert page.get_by_role("button", name="Simulate").is_disabled()
    assert session.study.robot.legs[0].piston.diameter == 0.027  # the picture shows the last valid study

    page.get_by_label("mouth [mm]", exact=True).fill("300")
    diameter.fill("20")
    page.get_by_text(ANSWER).wait_for()
    wanted = text.replace('= "27 mm"', '= "20 mm"').replace('"315.18 mm"', '"300 mm"')
    assert session.study.robot == fx.loads(wanted).robot
    assert session.data.attrs["study"] == wanted  # comments and all
    page.get_by_label("material", exact=True).click()
    page.get_by_role("option", name="aluminium").click()
    until(lambda: session.study.robot.legs[0].piston.density == 2700)
    page.get_by_role("button", name="Back to the file").click()
    until(lambda: session.study.source_text == text)


def test_a_dragged_number_moves_the_rigid_preview_before_anything_is_simulated(view, visit, monkeypatch):
    server = view(study_text(*SHORT))
    page, session = visit(server), only_session(server)
    page.get_by_text(ANSWER).wait_for()
    tab(page, "Study")
    page.get_by_label("number", exact=True).click()
    page.get_by_role("option", name="motion.amplitude").click()
    monkeypatch.setattr(session, "_settled", lambda: None)
    lengths = page.get_by_role("cell").all_inner_texts()
    slider = page.get_by_role("slider").last
    slider.focus()
    for _ in range(5):
        slider.press("ArrowRight")  # a two-hundredth of 4 deg each
    until(lambda: session.study.motion.amplitude == pytest.approx(0.0366519, rel=1e-5))  # 2.1 deg
    assert session.data is None
    until(lambda: page.get_by_role("cell").all_inner_texts() != lengths)


def test_simulate_shows_progress_and_can_be_cancelled(view, visit):
    server = view(study_text(*LONG))
    page, session = visit(server), only_session(server)
    page.get_by_role("progressbar").wait_for()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("Cancelled").wait_for()
    assert not session.busy and session.data is None
    until(lambda: not [t for t in threading.enumerate() if t.name == "flexapod-simulation"])
    page.get_by_role("button", name="Simulate").click()
    page.get_by_role("button", name="Cancel").wait_for()
    page.context.close()  # who leaves takes the simulation along
    until(lambda: not [t for t in threading.enumerate() if t.name == "flexapod-simulation"])
    assert server.sessions == []


def test_downloads(view, visit, tmp_path):
    text = study_text(*SHORT)
    server = view(text)
    page, session = visit(server), only_session(server)
    page.get_by_text(ANSWER).wait_for()
    tab(page, "Files")
    assert download(page, "Study (TOML)") == ("study.toml", text.encode())
    name, content = download(page, "Results (NetCDF)")
    assert name == "study.nc"
    (tmp_path / name).write_bytes(content)
    stored = open_results(tmp_path / name)
    assert stored.com_deviation.equals(session.data.com_deviation)
    assert stored.attrs["study_file"] == "study.toml"  # and not where it lies on the server
    name, content = download(page, "Results (CSV)")
    assert name == "study.csv" and content.startswith(b"time [s],")
    name, content = download(page, "Figures (ZIP of PNG)")
    assert all(n.endswith(".png") for n in zipfile.ZipFile(io.BytesIO(content)).namelist())
    name, content = download(page, "Report (HTML)")
    assert name == "study-report.html" and b"</html>" in content


@pytest.fixture
def sender(view, visit):
    """A page with the tab Files open: `send(button, name, content)`."""
    server = view(study_text(*SHORT))
    page, session = visit(server), only_session(server)
    tab(page, "Files")

    def send(button: str, name: str, content: bytes) -> None:
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
        ("b.toml", b"\xff\xfe\x00", "it is no UTF-8 text"),
        ("c.toml", b"#" * (LARGEST + 1), "is too large"),
        ("d.toml", study_text(*CSV_MOTION).encode(), "is a table that was not sent"),
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
    tab(page, "Files")
    actuator = study_text(('duration = "10 s"', 'duration = "0.2 s"'), preset="paper-actuator")
    sender("Study file", "beam.toml", actuator.encode())
    page.get_by_text("The tip leaves the hub's line").wait_for()
    tab(page, "Study")
    page.get_by_text("[simulation]", exact=True).click()
    page.get_by_label("modes", exact=True).fill("2")
    until(lambda: session.study.simulation.modes == 2 and session.data is not None)
    assert session.data.sizes["mode"] == 2


def test_two_people_have_a_state_each_and_a_fault_stays_with_one(view, visit, monkeypatch):
    def broken(data):
        raise RuntimeError("the pen is broken")

    monkeypatch.setattr(files_panel.downloads, "figures", broken)
    server = view(study_text(*SHORT))
    one, two = visit(server), visit(server)
    until(lambda: len(server.sessions) == 2)
    for page in (one, two):
        page.get_by_text(ANSWER).wait_for()
    first, second = server.sessions
    tab(one, "Study")
    one.get_by_text("[payload]", exact=True).click()
    one.get_by_label("mass [kg]", exact=True).first.fill("50")
    until(lambda: {s.study.robot.payload.mass for s in (first, second)} == {50.0, 100.0})
    tab(one, "Files")
    one.get_by_role("button", name="Figures").click()
    one.get_by_text("unexpected RuntimeError: the pen is broken").wait_for()
    assert not two.get_by_text("RuntimeError").is_visible()
    one.context.close()
    until(lambda: len(server.sessions) == 1)
    tab(two, "Study")
    two.get_by_text("[payload]", exact=True).click()
    two.get_by_label("mass [kg]", exact=True).first.fill("60")
    until(lambda: server.sessions[0].study.robot.payload.mass == 60.0 and server.sessions[0].data is not None)


def guest(server, **headers):
    """Somebody who connects as a browser does, without one."""
    camera = _messages.ViewerCameraMessage(
        wxyz=(1, 0, 0, 0), position=(1, 1, 1), fov=1.0, near=0.1, far=10.0, image_height=10, image_width=10,
        look_at=(0, 0, 0), up_direction=(0, 0, 1),
    )  # fmt: skip
    socket = connect(
        f"ws://127.0.0.1:{server.port}", subprotocols=[f"viser-v{viser.__version__}"], max_size=None, **headers
    )
    socket.send(msgspec.msgpack.encode(camera.as_serializable_dict([])))
    return socket


def test_who_comes_and_goes_leaves_nothing(view):
    server = view(study_text(*SHORT))

    def visit() -> weakref.ref:
        with guest(server):
            session = until(lambda: server.sessions)[0]
            until(lambda: session.data is not None)
            left = weakref.ref(session)
            scene = weakref.ref(session.scene)
        until(lambda: not server.sessions)
        return left, scene

    visit()
    threads, left = threading.active_count(), []
    for _ in range(4):
        left += visit()
    gc.collect()
    until(lambda: gc.collect() >= 0 and not [r for r in left if r() is not None])
    pool = 32  # viser's callbacks share a pool that grows to this size and no further
    assert threading.active_count() <= threads + pool


def test_a_page_of_another_site_gets_nothing(view, caplog):
    server = view(study_text(*SHORT))
    with guest(server, origin="http://evil.example"):
        until(lambda: "refused" in caplog.text)
        assert server.sessions == []
