"""Somebody who speaks as a browser does and sends what none sends: nothing of it reaches the log as a traceback."""

import dataclasses
import gc
import math
import subprocess
import sys
import threading
import weakref

import msgspec
import pytest
from tests.helpers.guests import CAMERA, guest, said, until
from tests.helpers.short_runs import SHORT, study_text
from viser import GuiButtonHandle, GuiSliderHandle, GuiTextHandle

from flexapod.app.browser import background
from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource
from flexapod.app.browser.server import View
from flexapod.common import resources
from flexapod.model import loads

pytestmark = pytest.mark.web

NO_NUMBERS = (math.nan, math.inf, -math.inf)
HUGE = (1e308, -1e308, 1e-320, 2**63 - 1, -(2**63), 0, -1, 0.5)
OTHER_TYPES = ("", "nan", "1", True, False)
TEXTS = (
    "nan", "-inf", "1e999", "1e308", "-1e308", "1e-320 mm", "1e400 GPa", "9" * 1900, "9" * 5000, "\x00", "<b>", "{0}",
    "\"'\\", "[1, 2]", "١٢", "1 " + "m" * 1000, "2 mm/s^-400",
)  # fmt: skip


@pytest.fixture(autouse=True)
def all_entries(monkeypatch):
    """Every entry of the log, however many there were before."""
    monkeypatch.setattr(background, "MOST_LINES", 1e9)
    monkeypatch.setattr(background.FEW, "_left", 1e9)


@pytest.fixture(scope="module")
def server():
    text = study_text(*SHORT)
    running = View(StudySource(document=Document(text, None), study=loads(text)), "127.0.0.1", 0)
    yield running
    running.stop()


@pytest.fixture
def session(server, caplog, capfd):
    """A session of a guest, `guest`; after the test nothing has failed, and the session does what it is asked."""
    with guest(server) as client:
        found = until(lambda: server.sessions)[0]
        until(lambda: found.data is not None and found.modes_panel._inside._modes is not None)
        found.guest = client
        yield found
        settled(found)
        before = found.data
        found.study_panel._replace(found.study_panel._original)
        found.simulate()
        until(lambda: found.data is not before and found.data is not None and not found.busy)
        until(lambda: "misses its rigid path" in said(found))
        assert "unexpected" not in said(found)
    until(lambda: not server.sessions)
    assert "Traceback" not in caplog.text
    assert "Traceback" not in "".join(capfd.readouterr())


def send(session, kind, **fields) -> None:
    session.guest.socket.send(msgspec.msgpack.encode({"type": kind, **fields}))


def settled(session) -> None:
    """Wait until all that was sent is read and answered."""
    until(lambda: session.guest.socket.ping().wait(300))
    connection = session.guest.server._visitor(session.client.client_id)
    until(lambda: not connection.work)
    # Texts are read 0.4 s after the last letter, by a thread that ends then; what it does may begin others.
    until(lambda: not [t for t in threading.enumerate() if t.name == "flexapod-latest"])
    until(lambda: not connection.work and not session.busy)


def camera(**changed) -> dict:
    return {**CAMERA.as_serializable_dict([]), **changed}


def bad_cameras():
    """A camera with one number that is none, in each place; one in no place at all; one that looks at itself."""
    good = camera()
    for name in (field.name for field in dataclasses.fields(CAMERA)):
        for number in NO_NUMBERS:
            value = good[name]
            yield {**good, name: (number, *value[1:]) if isinstance(value, tuple | list) else number}
    zero = (0.0, 0.0, 0.0)
    yield camera(position=zero, look_at=zero, up_direction=zero, wxyz=(0, 0, 0, 0))
    yield camera(position=(1e308, -1e308, 1e308), look_at=(-1e308, 1e308, 1e308))


def test_a_camera_that_is_nowhere_is_ignored_in_words(session, server, caplog):
    """The next press of Reset view failed: "Camera look_at must be finite"."""
    session.guest.server = server
    for bad in bad_cameras():
        session.guest.socket.send(msgspec.msgpack.encode(bad))
        until(lambda: session.guest.socket.ping().wait(300))
        press(session, "Reset view")
    settled(session)
    assert all(math.isfinite(x) for x in session.client.camera.position)
    assert "a message is ignored: a number in a ViewerCameraMessage is not finite" in caplog.text
    assert session.guest.messages["RunJavascriptMessage"] > 20  # the camera is placed each time


def press(session, label) -> None:
    handles = session.client.gui._gui_input_handle_from_uuid.values()
    button = next(x for x in handles if isinstance(x, GuiButtonHandle) and x.label == label)
    send(session, "GuiUpdateMessage", uuid=button._impl.uuid, updates={"value": True})


def test_values_that_an_input_cannot_have_change_nothing(session, server, caplog):
    session.guest.server = server
    inputs_before = dict(session.client.gui._gui_input_handle_from_uuid)
    for uuid, handle in inputs_before.items():
        if isinstance(handle, GuiTextHandle | GuiButtonHandle):
            continue  # the next tests
        for value in NO_NUMBERS + HUGE + OTHER_TYPES:
            send(session, "GuiUpdateMessage", uuid=uuid, updates={"value": value})
        settled(session)
        if isinstance(handle, GuiSliderHandle):
            assert handle.min <= handle.value <= handle.max, handle.label
        for name in ("update_cb", "removed", "is_button", "uuid", "value_", "nonsense"):
            send(session, "GuiUpdateMessage", uuid=uuid, updates={name: 1})
    settled(session)
    assert "a message had no effect: it is none of the options" in caplog.text
    assert not [h for h in inputs_before.values() if h._impl.removed]


def test_texts_that_are_no_numbers_are_refused_in_words(session, server):
    session.guest.server = server
    for text in TEXTS:
        handles = session.client.gui._gui_input_handle_from_uuid.values()
        fields = [handle for handle in handles if isinstance(handle, GuiTextHandle)]
        assert len(fields) > 30
        write(session, fields, text)
        if text in ("nan", "1e999", "<b>"):
            until(lambda: not session._valid)
        session.study_panel._replace(session.study_panel._original)
        until(lambda: session._valid)


def write(session, fields, text) -> None:
    """Type a text into fields, leave them, and wait until they are read."""
    for handle in fields:
        send(session, "GuiUpdateMessage", uuid=handle._impl.uuid, updates={"value": text + "\N{EM SPACE}"})
    until(lambda: session.guest.socket.ping().wait(300))
    connection = session.guest.server._visitor(session.client.client_id)
    until(lambda: not connection.work)


def test_uploads_that_are_none_are_refused_in_words(session, server):
    session.guest.server = server
    panel = session.files_panel
    handles = session.client.gui._gui_input_handle_from_uuid
    uploads = [uuid for uuid, handle in handles.items() if "Upload" in type(handle).__name__]
    assert len(uploads) == 2
    counts = ((0, 0), (-1, 5), (1, -5), (1, 2**62), (2**62, 5), (1, 0), (2, 10))
    for uuid in (*uploads, "nobody"):
        for number, (parts, size) in enumerate(counts):
            transfer = f"{uuid}-{number}"
            send(
                session, "FileTransferStartUpload", source_component_uuid=uuid, transfer_uuid=transfer,
                filename="../../\x00etc/passwd", mime_type="", part_count=parts, size_bytes=size,
            )  # fmt: skip
            for part in (0, -1, 2**62, 0):
                send(
                    session, "FileTransferPart", source_component_uuid=None, transfer_uuid=transfer, part_index=part,
                    content=b"hello",
                )  # fmt: skip
            settled(session)
    bad = (
        "nan",
        "inf",
        "1e999",
        "-1e308",
        "1e308",
        '"nan mm"',
        "true",
        "[]",
        "9" * 5000,
        "1e-400",
        "0x7fffffffffffffffff",
    )
    text = study_text(*SHORT)
    for number in bad:
        for line in ("mass = ", "duration = ", "tolerance = ", "home_height = "):
            key = next(row for row in text.splitlines() if row.startswith(line))
            panel._take("study.toml", text.replace(key, line + number).encode())
            assert session.files_panel is panel, (line, number)  # refused
    for table in (
        b"",
        b"\xff\xfe",
        b"time [s], roll [deg]\n0, nan\n1, inf\n",
        b"," * 100_000,
        b"time [s]\n" + b"9" * 5000,
    ):
        panel._keep("path.csv", table)
        motion = '[motion]\ntype = "csv"\nfile = "path.csv"\n[simulation]\nmodes = 1\nduration = "0.1 s"\n'
        panel._take("study.toml", (text.split("[motion]")[0] + motion).encode())
        assert session.files_panel is panel, table[:20]


@pytest.mark.parametrize(
    "message",
    [
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": None}},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": [1.0, math.nan]}},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": {"a": 1}}},
        {"type": "GuiUpdateMessage", "uuid": 5, "updates": {}},
        {"type": "GuiUpdateMessage", "uuid": "x", "updates": [1]},
        camera(position="abc"),
        camera(position=(1.0, 2.0)),
        camera(fov=None),
        camera(wxyz=[[1, 0, 0, 0]]),
        {"type": "ViewerCameraMessage"},
        {"type": "FileTransferPart", "transfer_uuid": "x", "source_component_uuid": 1, "part_index": 0, "content": b""},
        {"type": "FileTransferStartUpload", "transfer_uuid": "x", "part_count": "many", "size_bytes": math.nan},
    ],
    ids=lambda message: message["type"],
)
def test_who_sends_another_form_is_sent_away_with_a_line(server, message, caplog, capfd):
    with guest(server) as client:
        until(lambda: server.sessions)
        client.socket.send(msgspec.msgpack.encode(message))
        until(lambda: not client._thread.is_alive())
    until(lambda: not server.sessions)
    assert client.socket.close_code == 1007
    until(lambda: "a connection is closed: " in caplog.text)
    assert "Traceback" not in caplog.text + "".join(capfd.readouterr())


def hostile_visit(server, number: int) -> list[weakref.ref]:
    """Somebody comes, begins what they do not end, sends nonsense, and goes; what must go with them."""
    with guest(server) as client:
        session = until(lambda: server.sessions)[0]
        session.guest = client
        if number % 2:  # others leave while all is computed
            until(lambda: session.data is not None)
        found = session.client.gui._gui_input_handle_from_uuid
        upload = until(lambda: [uuid for uuid, handle in list(found.items()) if "Upload" in type(handle).__name__])[0]
        send(
            session, "FileTransferStartUpload", source_component_uuid=upload, transfer_uuid=f"{number}",
            filename="a.csv", mime_type="", part_count=2, size_bytes=900_000,
        )  # fmt: skip
        send(
            session, "FileTransferPart", source_component_uuid=None, transfer_uuid=f"{number}", part_index=0,
            content=bytes(450_000),
        )  # fmt: skip
        for handle in list(found.values())[:20]:
            send(session, "GuiUpdateMessage", uuid=handle._impl.uuid, updates={"value": math.nan})
        left = [session, session.client, session.scene, session.study_panel, session.client._websock_connection]
        left = [weakref.ref(part) for part in [*left, server._visitor(session.client.client_id)]]
        if number % 3 == 0:
            send(session, "GuiUpdateMessage", uuid="x" * 1_000_000, updates={})
        else:
            until(lambda: client.socket.ping().wait(300))
    until(lambda: not server.sessions)
    return left


def test_of_hostile_visitors_nothing_stays(server):
    """Sessions, connections, halves of uploads and messages go; of what is in use no more stays than of one."""
    for number in range(6):  # fills caches
        hostile_visit(server, number)
    until(lambda: not [t for t in threading.enumerate() if t.name.startswith("flexapod-") and "view" not in t.name])
    gc.collect()
    before = sys.getallocatedblocks()
    left = [ref for number in range(18) for ref in hostile_visit(server, number)]
    until(lambda: gc.collect() >= 0 and not [ref for ref in left if ref() is not None])
    inside = server._server._websock_server
    until(lambda: not inside._client_state_from_id and not inside._live_connections)
    assert not server._server._connected_clients
    assert not inside._broadcast_buffer.generator_cursors
    assert not server._server.gui._current_file_upload_states
    # A session of this study is more than 150 000 blocks of Python's memory; eighteen leave less than half of one.
    until(lambda: gc.collect() >= 0 and sys.getallocatedblocks() - before < 75_000)


POOLS = """
import ctypes, sys, threading
from flexapod.app.browser import server
from flexapod.common import resources
from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource
from flexapod.model import loads, preset_text

if sys.argv[1] == "as before":
    server.limit_arenas = lambda: None
text = preset_text("paper-robot")
view = server.View(StudySource(document=Document(text, None), study=loads(text)), "127.0.0.1", 0)
here = threading.Barrier(13)
def take():
    kept = bytearray(100_000)  # from the pool of this thread
    here.wait(300)
    here.wait(300)
threads = [threading.Thread(target=take) for _ in range(12)]
for thread in threads:
    thread.start()
here.wait(300)
library = ctypes.CDLL(None)
library.fopen.restype, library.fclose.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
library.malloc_info.argtypes = [ctypes.c_int, ctypes.c_void_p]
file = library.fopen(sys.argv[2].encode(), b"w")
library.malloc_info(0, file)
library.fclose(file)
here.wait(300)
resources.release_memory()
view.stop()
"""


@pytest.mark.skipif(resources._glibc() is None, reason="another C library")
def test_threads_of_the_server_share_their_memory(tmp_path):
    """Each of sixteen pools, on two cores, kept what sessions had freed in it: 65 MB after 100 visits, now 10."""
    pools = {}
    for how in ("now", "as before"):
        told = tmp_path / f"{how}.xml"
        subprocess.run([sys.executable, "-c", POOLS, how, str(told)], check=True, timeout=300, capture_output=True)
        pools[how] = told.read_text().count("<heap nr=")
    assert pools["now"] <= resources.MOST_ARENAS + 1 < pools["as before"]  # one more that was there before
