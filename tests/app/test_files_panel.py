"""What a visitor of the page sends and takes away: one file at a time, bounded, and of a session's own."""

import threading
import time
from types import SimpleNamespace

import pytest
import viser
from viser._messages import FileTransferPart, FileTransferStartUpload

from flexapod import model
from flexapod.app.browser import files_panel, uploads
from flexapod.app.browser.background import Threads
from flexapod.app.browser.document import Document
from flexapod.app.browser.files_panel import FilesPanel
from flexapod.app.browser.network import is_expected
from flexapod.app.browser.study_panel import StudyPanel
from flexapod.app.browser.text_fields import LEFT
from flexapod.app.browser.uploads import LARGEST, MOST_TABLES, UploadFolder, read_upload, store_table
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit

TEXT = model.preset_text("paper-robot")
THREADS = Threads(lambda error: None)


@pytest.fixture
def client(capfd):
    """A client whose messages go nowhere; `sent` are its downloads."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    sent = []
    yield SimpleNamespace(
        gui=server.gui,
        sent=sent,
        _websock_connection=server._websock_server,
        send_file_download=lambda name, content, **_: sent.append((name, content)),
    )
    server.stop()


@pytest.fixture
def panel(client):
    """The tab Files of that client, with a result; `panel.text` is the study, `panel.taken` what was uploaded."""
    sent, faults = UploadFolder(), []
    found = FilesPanel(
        client, Threads(faults.append), sent, lambda: Document(found.text, "study.toml"), lambda: None,
        lambda: found.data, lambda document: found.taken.append(document),
    )  # fmt: skip
    found.text, found.data, found.taken, found.faults = TEXT, "data", [], faults
    yield found
    sent.close()


def until(true, seconds=300.0):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def press(client, label):
    """What the server does with a click: it calls back in one of its few threads."""
    inputs = client.gui._gui_input_handle_from_uuid.values()
    button = next(handle for handle in inputs if getattr(handle, "label", None) == label)
    for callback in button._impl.update_cb:
        callback(SimpleNamespace(client=client, client_id=0, target=button))


def turn(client, label, value):
    """A user's change of an input."""
    inputs = client.gui._gui_input_handle_from_uuid.values()
    handle = next(h for h in inputs if getattr(h, "label", None) == label)
    handle._impl.value = value
    for callback in handle._impl.update_cb:
        callback(SimpleNamespace(client=client, client_id=0, target=handle))


def test_a_download_holds_nobody_up(client, monkeypatch, request):
    """40 clicks on a download filled the threads that answer everybody: another visitor waited for a minute."""
    finish, made = threading.Event(), []

    def figures(_):
        made.append(threading.current_thread().name)
        assert finish.wait(300)
        return b"PNG"

    monkeypatch.setattr(files_panel, "figures", figures)
    panel = request.getfixturevalue("panel")
    try:
        for _ in range(40):
            press(client, "Figures (ZIP of PNG)")  # comes back though nothing is drawn yet
        until(lambda: made)
        assert "One file at a time" in panel._words.content
        press(client, "Study (TOML)")
    finally:
        finish.set()
    until(lambda: client.sent)
    until(lambda: not panel._busy)
    assert made == ["flexapod-files"] and client.sent == [("study-figures.zip", b"PNG")]
    press(client, "Study (TOML)")
    until(lambda: len(client.sent) == 2)
    assert not panel.faults


def test_a_fault_ends_one_download(client, monkeypatch, request):
    monkeypatch.setattr(files_panel, "netcdf", lambda _: 1 / 0)
    panel = request.getfixturevalue("panel")
    press(client, "Results (NetCDF)")
    until(lambda: panel.faults and not panel._busy)
    assert isinstance(panel.faults[0], ZeroDivisionError)
    assert panel._words.content == ""  # nothing is being written any more
    press(client, "Study (TOML)")
    until(lambda: client.sent)


def test_nothing_is_sent_to_somebody_who_left(client, monkeypatch, request):
    monkeypatch.setattr(files_panel, "csv", lambda _: panel.close() or b"1,2")
    panel = request.getfixturevalue("panel")
    press(client, "Results (CSV)")
    until(lambda: panel._closed and not panel._busy)
    assert client.sent == []


def test_a_refused_study_is_sent_with_the_reason(client, panel):
    press(client, "Study (TOML)")
    until(lambda: client.sent and not panel._busy)
    assert "refused" not in panel._words.content
    panel.text = TEXT.replace("100 kg", "-100 kg")
    press(client, "Study (TOML)")
    until(lambda: len(client.sent) == 2 and not panel._busy)
    assert client.sent[1] == ("study.toml", panel.text.encode())
    assert "which is refused" in panel._words.content and "payload.mass = -100 kg" in panel._words.content


def transfer(client, kind, **fields):
    for handler in list(client._websock_connection._incoming_handlers[kind]):
        handler(0, kind(**fields))


def begin(client, number, size=1000, parts=2):
    inputs = client.gui._gui_input_handle_from_uuid.values()
    button = next(handle for handle in inputs if getattr(handle, "label", None) == "Study file")
    transfer(
        client, FileTransferStartUpload, source_component_uuid=button._impl.uuid, transfer_uuid=f"t{number}",
        filename="a.toml", mime_type="text/plain", part_count=parts, size_bytes=size,
    )  # fmt: skip


def part(client, number, index, content):
    transfer(
        client, FileTransferPart, source_component_uuid=None, transfer_uuid=f"t{number}", part_index=index,
        content=content,
    )  # fmt: skip


def test_one_transfer_at_a_time(client, panel):
    """400 transfers that nobody finished held 400 MB."""
    held = client.gui._current_file_upload_states
    for number in range(50):
        begin(client, number)
        part(client, number, 0, b"x" * 500)
        assert list(held) == [f"t{number}"]
    part(client, 3, 1, b"x" * 500)  # of one that was given up
    assert list(held) == ["t49"]
    part(client, 49, 1, b"x" * 500)
    assert not held
    begin(client, 50, parts=1_000_000)
    assert not held and "parts" in panel._words.content
    begin(client, 51, size=LARGEST + 1)
    assert not held and "too large" in panel._words.content
    begin(client, 52, size=LARGEST)
    part(client, 52, 0, b"x" * (LARGEST + 1))  # more than was announced
    assert not held


def test_a_page_that_is_built_anew_forgets_what_was_begun(client, panel):
    begin(client, 1)
    uploads.limit_uploads(client, LARGEST, lambda error: None)
    assert not client.gui._current_file_upload_states


def test_tables_are_bounded_in_number_and_size(monkeypatch, tmp_path):
    for i in range(MOST_TABLES):
        store_table(f"{i}.csv", b"1,2", tmp_path)
    with pytest.raises(InputError, match="one table too many"):
        store_table("more.csv", b"1,2", tmp_path)
    assert store_table("3.csv", b"3,4", tmp_path) == "3.csv"  # in place of the one before
    assert len(list(tmp_path.iterdir())) == MOST_TABLES
    monkeypatch.setattr(uploads, "MOST_BYTES", 3 * MOST_TABLES + 1)
    assert store_table("3.csv", b"3,45", tmp_path)
    with pytest.raises(InputError, match="one table too many"):
        store_table("3.csv", b"3,456", tmp_path)
    assert (tmp_path / "3.csv").read_bytes() == b"3,45"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"a" + b".b" * 30_000 + b" = 1", "too many parts"),
        (b"modes = " + b"9" * 5000, "too many digits"),
        (b"modes = 0x" + b"f" * 5000, "too many digits"),
        (b"a = " + b"{b.c.d.e.f.g = [" * 90 + b"]}" * 90, "too deep"),
        (b"a = 1979-13-45", "not valid TOML"),
    ],
)
def test_uploads_that_would_keep_the_server_busy(tmp_path, content, words):
    begun = time.process_time()
    with pytest.raises(InputError, match=words):
        read_upload("a.toml", content, tmp_path)
    assert time.process_time() - begun < 2.0  # milliseconds; it was 22 s


def test_tables_deep_in_a_study_are_looked_for(tmp_path):
    deep = b"[a]\nb = [{ c = { file = 'x.csv' } }]\n"
    with pytest.raises(InputError, match="was not sent") as refused:
        read_upload("a.toml", deep, tmp_path)
    assert refused.value.key == "a.b[1].c.file"


def test_a_study_with_more_instants_than_the_server_holds():
    """A duration of 2e7 s began by itself and filled the memory, 13 MB a second."""
    study = model.preset("paper-robot")
    uploads.refuse_length(study)
    uploads.refuse_length(model.override(study, duration=0.001 * uploads.MOST_INSTANTS))
    with pytest.raises(InputError, match="stored instants") as refused:
        uploads.refuse_length(model.override(study, duration=2e7))
    assert refused.value.key == "simulation.output_step"
    uploads.refuse_length(model.override(study, duration=2e7, output_step=100.0))
    actuator = model.preset("paper-actuator")
    uploads.refuse_length(actuator)
    with pytest.raises(InputError, match="stored instants"):
        uploads.refuse_length(model.override(actuator, duration=2e7))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"27 mm"', '"27.00 mm"'),
        ('"27 mm"', '"2.7e1 mm"'),
    ],
)
def test_back_to_the_file_and_undo_give_the_text_as_it_was_written(client, before, after):
    """What the page itself shows in a box came back as an edit: 27.00 mm became 27 mm."""
    text = TEXT.replace(before, after)
    assert text != TEXT
    panel = StudyPanel(client, Document(text, None), THREADS, lambda edit: None)
    turn(client, "diameter [mm]", "30" + LEFT)
    turn(client, "modes", "5" + LEFT)
    turn(client, "com x [mm]", "1" + LEFT)
    turn(client, "tolerance", "1e-3" + LEFT)
    changed = panel.document.text
    for written in ('"30 mm"', "modes = 5", '"1 mm", "373', "0.001"):
        assert written in changed
    panel._replace(panel._original)
    assert panel.document.text == text
    panel._undo()
    assert panel.document.text == changed
    for _ in range(4):
        panel._undo()
    assert panel.document.text == text


def test_quick_clicks_are_taken_one_after_the_other(client, monkeypatch):
    """Each click comes in a thread of its own: of two on Undo the first once had the last word."""
    edits: list[str] = []
    panel = StudyPanel(client, Document(TEXT, None), THREADS, lambda edit: edits.append(edit.document.text))
    panel._changed("payload.mass", "90 kg")
    panel._changed("payload.mass", "80 kg")
    show, slow, begun = panel._show, [0.3], threading.Event()

    def late(*found):
        begun.set()
        time.sleep(slow.pop() if slow else 0.0)
        show(*found)

    monkeypatch.setattr(panel, "_show", late)
    first = threading.Thread(target=panel._undo)
    first.start()
    assert begun.wait(300)
    panel._undo()
    first.join(300)
    assert edits[-1] == panel.document.text == TEXT


def test_the_slider_turns_what_a_user_turns(client):
    text = TEXT.replace('"27 mm"', '"27.00 mm"').replace('"100 kg"', '"100.0 kg"')
    panel = StudyPanel(client, Document(text, None), THREADS, lambda edit: None)
    assert panel._knob._choice.value == "leg.piston.diameter"
    before = panel._knob._slider
    panel._knob._choice.value = "payload.mass"  # another slider
    assert panel.document.text == text

    def drag(slider, value):
        slider._impl.value = value
        for callback in slider._impl.update_cb:
            callback(SimpleNamespace(client=client, client_id=0, target=slider))

    drag(panel._knob._slider, 120.0)
    assert '"120 kg"' in panel.document.text and '"27.00 mm"' in panel.document.text
    drag(before, 30.0)  # still on its way when the other number was chosen
    assert '"120 kg"' in panel.document.text and '"30 mm"' in panel.document.text


@pytest.mark.parametrize(
    ("asked", "host", "ours"),
    [
        ("127.0.0.1:8080", "127.0.0.1", True),
        ("localhost:8080", "127.0.0.1", True),
        ("[::1]:8080", "127.0.0.1", True),
        ("evil.example:8080", "127.0.0.1", False),
        ("192.168.0.7:8080", "127.0.0.1", False),
        ("192.168.0.7:8080", "0.0.0.0", True),
        ("[fe80::1]:8080", "::", True),
        ("localhost", "0.0.0.0", True),
        ("robot:8080", "0.0.0.0", True),
        ("ROBOT.local.:8080", "0.0.0.0", True),
        ("robot.lab.example:8080", "192.168.0.7", True),
        ("view.example:8080", "view.example", True),
        ("evil.example:8080", "0.0.0.0", False),
        ("robot.evil.example", "0.0.0.0", False),
        ("192.168.0.7.evil.example:8080", "0.0.0.0", False),
        ("", "0.0.0.0", False),
    ],
)
def test_a_page_is_asked_for_under_a_name_of_this_machine(monkeypatch, asked, host, ours):
    monkeypatch.setattr(
        "flexapod.app.browser.network._own_names", lambda: ("robot", "robot.local", "robot.lab.example")
    )
    assert is_expected(asked, host) is ours
