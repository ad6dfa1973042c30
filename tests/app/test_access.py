"""The door of the page's server, from outside: who gets in, what is taken, what every answer carries. No browser."""

import gc
import logging
import socket
import sys
import time
import urllib.error
import urllib.request
from contextlib import ExitStack

import msgspec
import pytest
import viser
from tests.helpers.guests import CAMERA, guest, said, until
from tests.helpers.short_runs import SHORT, study_text
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from flexapod.app.browser import access, background, client_limits
from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource
from flexapod.app.browser.network import admits_client, client_key, is_expected, is_same_site
from flexapod.app.browser.server import View
from flexapod.model import loads

pytestmark = pytest.mark.web

VERSIONS = [f"viser-v{viser.__version__}"]
HANDSHAKE = (
    "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==", f"Sec-WebSocket-Protocol: {VERSIONS[0]}",
)  # fmt: skip


def packed(**message) -> bytes:
    return msgspec.msgpack.encode(message)


GREETING = msgspec.msgpack.encode(CAMERA.as_serializable_dict([]))
EMPTY_LISTS = b"\xdd" + (1_900_000).to_bytes(4, "big") + b"\x90" * 1_900_000
"""1.9 MB that become 120 MB when they are decoded."""


@pytest.fixture(scope="module")
def server():
    text = study_text(*SHORT)
    running = View(StudySource(document=Document(text, None), study=loads(text)), "127.0.0.1", 0)
    yield running
    running.stop()


@pytest.fixture(autouse=True)
def all_entries(monkeypatch):
    """Every entry of the log, however many there were before."""
    monkeypatch.setattr(background, "MOST_LINES", 1e9)
    monkeypatch.setattr(background.FEW, "_left", 1e9)


def asked(server, *lines: str) -> tuple[int, dict[str, str]]:
    """Status and headers of the answer to a request."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=300) as line:
        line.sendall("\r\n".join(["GET / HTTP/1.1", *lines, "", ""]).encode())
        answer = b""
        while b"\r\n\r\n" not in answer and (more := line.recv(65536)):
            answer += more
    first, *rest = answer.split(b"\r\n\r\n")[0].decode().split("\r\n")
    return int(first.split()[1]), dict(entry.split(": ", 1) for entry in rest)


def here(server) -> str:
    return f"127.0.0.1:{server.port}"


def ended(server, message, **options) -> int:
    """Somebody sends a message; the code with which they are sent away."""
    with connect(f"ws://{here(server)}", subprotocols=VERSIONS, max_size=None, **options) as line:
        try:
            line.send(message)
            while True:
                line.recv(timeout=300)
        except ConnectionClosed as closed:
            return closed.rcvd.code


def test_every_answer_carries_the_headers(server):
    place = f"Host: {here(server)}"
    answers = {
        "the page": (200, asked(server, place)),
        "a websocket": (101, asked(server, place, *HANDSHAKE)),
        "no page": (404, _of(server, "/nowhere")),
        "a path too long": (404, _of(server, "/" + "a" * 5000)),
        "a refusal": (403, asked(server, "Host: evil.example")),
    }
    for what, (status, (found, headers)) in answers.items():
        assert found == status, what
        assert headers["X-Content-Type-Options"] == "nosniff", what
        assert headers["X-Frame-Options"] == "DENY", what
        assert headers["Referrer-Policy"] == "no-referrer", what
        assert "camera=()" in headers["Permissions-Policy"], what
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy, what
        assert "http" not in policy and "*" not in policy, what  # nothing beyond this server
        assert "Server" not in headers, what


def _of(server, path):
    request = urllib.request.Request(f"http://{here(server)}{path}")
    try:
        with urllib.request.urlopen(request, timeout=300) as answer:
            return answer.status, dict(answer.headers)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, dict(error.headers)


@pytest.mark.parametrize(
    ("lines", "status"),
    [
        (["Host: {here}", "Host: {here}"], 400),
        (["Host: {here}", "Host: evil.example"], 400),
        ([], 400),
        (["Host: evil.example"], 403),
        (["Host: {here}", "Accept-Encoding: gzip", "Accept-Encoding: br"], 200),
        (["Host: {here}", *HANDSHAKE, "Origin: http://evil.example"], 403),
        (["Host: {here}", *HANDSHAKE, "Origin: null"], 403),
        (["Host: {here}", *HANDSHAKE, "Origin: http://{here}", "Origin: http://{here}"], 400),
        (["Host: {here}", *HANDSHAKE, "Origin: http://127.0.0.1:1"], 403),
        (["Host: {here}", *HANDSHAKE, "Origin: http://{here}"], 101),
        (["Host: {here}", *HANDSHAKE, "Origin: https://{here}"], 101),
        (["Host: evil.example", *HANDSHAKE, "Origin: http://evil.example"], 403),
    ],
)
def test_who_gets_in(server, lines, status):
    """Decided in the handshake, before there is anything of a session."""
    lines = [line.replace("{here}", here(server)) for line in lines]
    assert asked(server, *lines)[0] == status
    assert server.sessions == []


@pytest.mark.parametrize(
    ("origin", "host", "same"),
    [
        ("https://robots.example", "robots.example", True),
        ("https://robots.example", "robots.example:443", True),
        ("http://robots.example", "robots.example:80", True),
        ("https://Robots.example:8443", "robots.example:8443", True),
        ("https://[::1]:8080", "[::1]:8080", True),
        ("https://robots.example", "robots.example:80", False),
        ("https://robots.example", "evil.example", False),
        ("ftp://robots.example", "robots.example", False),
        ("robots.example", "robots.example", False),
        ("", "", False),
    ],
)
def test_origin_and_host_are_one_site(origin, host, same):
    assert is_same_site(origin, host) is same


def test_a_proxy_has_a_name_of_its_own(server):
    assert not is_expected("robots.example", "127.0.0.1")
    assert is_expected("robots.example", "127.0.0.1", "robots.example")
    assert is_expected("Robots.example:443", "127.0.0.1", "robots.example")
    assert not is_expected("evil.example", "127.0.0.1", "robots.example")
    assert is_expected("localhost:8080", "127.0.0.1", "robots.example")


def resident() -> float:
    """Memory that this process holds [MB]."""
    with open("/proc/self/statm") as found:
        return int(found.read().split()[1]) * 4096 / 1e6


def test_garbage_leaves_nothing_and_is_told_in_a_line(server, caplog):
    """20 messages each that nobody can read: 3.4 GB stayed, with a traceback each."""
    garbage = {
        "text": ("x" * 1_900_000, 1007),
        "bytes": (b"\xc1" * 1_900_000, 1007),
        "a million lists": (EMPTY_LISTS, 1007),
        "lists in the place of a file": (packed(type="FileTransferPart", content=[[]] * 1_000_000), 1007),
        "a long word": (packed(type="GuiUpdateMessage", uuid="x" * 1_000_000, updates={}), 1007),
        "no such field": (packed(type="GuiUpdateMessage", colour="red"), 1007),
        "too much": (bytes(3_000_000), 1009),
    }
    for message, _ in garbage.values():
        ended(server, message)
    gc.collect()
    before = resident()
    for what, (message, code) in garbage.items():
        for _ in range(20):
            assert ended(server, message) == code, what
        # One message is 2 MB with its copies; decoded, the lists are 120 MB. 20 of them once took 140 to 3400 MB.
        assert resident() - before < 50, what
    assert "Traceback" not in caplog.text
    assert max(len(record.getMessage()) for record in caplog.records) < 200
    assert server.sessions == []


def test_pieces_without_end_are_not_gathered(server):
    with connect(f"ws://{here(server)}", subprotocols=VERSIONS, max_size=None) as line:
        with pytest.raises(ConnectionClosed):
            line.send(b"" for _ in range(100_000))
            while True:
                line.recv(timeout=300)


def test_who_does_not_say_that_a_page_is_there_does_not_stay(server, monkeypatch):
    assert client_limits.FIRST_MESSAGE == 10
    monkeypatch.setattr(client_limits, "FIRST_MESSAGE", 0.3)
    assert ended(server, packed(type="GuiUpdateMessage", uuid="none", updates={})) == 1008


def test_who_has_said_so_may_be_silent(server, monkeypatch):
    monkeypatch.setattr(client_limits, "FIRST_MESSAGE", 2.0)
    with guest(server) as client:
        session = until(lambda: server.sessions)[0]
        until(lambda: session.data is not None)
        time.sleep(2.2)
        assert client._thread.is_alive()
    until(lambda: not server.sessions)


def test_another_version_is_sent_away_without_a_word_in_the_terminal(server, capfd):
    with connect(f"ws://{here(server)}", subprotocols=["viser-v0.0"]) as line:
        with pytest.raises(ConnectionClosed) as closed:
            line.recv(timeout=300)
    assert closed.value.rcvd.code == 1002 and "Version mismatch" in closed.value.rcvd.reason
    assert capfd.readouterr() == ("", "")


def test_messages_for_others_go_nowhere(server):
    """viser keeps the remark that a form was touched, whatever it holds, and sends it to everybody, later ones too."""
    buffer = server._server._websock_server._broadcast_buffer.message_from_id
    with guest(server) as client:
        until(lambda: server.sessions)
        before = len(buffer)
        for i in range(20):
            client.socket.send(packed(type="GuiFormDirtyMessage", uuid=f"{i}" + 50_000 * "x"))
            client.socket.send(packed(type="ShareUrlRequest"))
        until(lambda: client.socket.ping().wait(300))
        client.socket.send(GREETING)
        session = server.sessions[0]
        until(lambda: session.data is not None)
        assert len(buffer) == before
    until(lambda: not server.sessions)


def test_a_message_that_cannot_be_followed_ends_nothing(server, caplog):
    """Of the right form, with nonsense in it: a line in the log, and the session goes on."""
    with guest(server) as client:
        session = until(lambda: server.sessions)[0]
        until(lambda: session.data is not None)
        handle = next(iter(session.client.gui._gui_input_handle_from_uuid.values()))
        client.socket.send(packed(type="GuiUpdateMessage", uuid=handle._impl.uuid, updates={"nonsense": 1}))
        until(lambda: gc.collect() >= 0 and "had no effect" in caplog.text)
        assert "Traceback" not in caplog.text
        until(lambda: "misses its rigid path" in said(session))
    until(lambda: not server.sessions)


def page_from(server, address, **headers):
    return connect(
        f"ws://{here(server)}", subprotocols=VERSIONS, source_address=(address, 0), additional_headers=headers
    )


def refused(server, address, **headers) -> bytes:
    """What somebody is told who is not let in."""
    with pytest.raises(InvalidStatus) as found:
        page_from(server, address, **headers)
    assert found.value.response.status_code == 503
    return found.value.response.body


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="127.0.0.2 is this machine on Linux")
def test_one_address_does_not_keep_all_others_out(server, monkeypatch):
    """32 pages of one were all that there were."""
    monkeypatch.setattr(access, "MOST_VISITORS", 6)
    with ExitStack() as pages:
        for _ in range(3):  # as many as are still free
            pages.enter_context(page_from(server, "127.0.0.1"))
        assert b"3 pages are open, 3 of them from your address" in refused(server, "127.0.0.1")
        assert asked(server, f"Host: {here(server)}")[0] == 200  # the page itself is no session
        pages.enter_context(page_from(server, "127.0.0.2"))
        refused(server, "127.0.0.1")
        with page_from(server, "127.0.0.2"):  # of two that are free one who has one gets another, then no more
            assert b"5 pages are open, 2 of them from your address" in refused(server, "127.0.0.2")
        until(lambda: len(server._server._websock_server._live_connections) == 4)
        pages.enter_context(page_from(server, "127.0.0.3"))  # who is new comes in, whatever the others do
        pages.enter_context(page_from(server, "127.0.0.4"))
        refused(server, "127.0.0.5")  # six of six
    until(lambda: not server._server._websock_server._live_connections)
    page_from(server, "127.0.0.1").close()


def test_who_comes_through_a_proxy_is_counted_by_the_address_that_it_tells(monkeypatch):
    """A proxy on this machine that `--name` speaks of; nobody else is believed."""
    text = study_text(*SHORT)
    source = StudySource(document=Document(text, None), study=loads(text))
    monkeypatch.setattr(access, "MOST_VISITORS", 4)
    for name in ("robots.example", None):
        server = View(source, "127.0.0.1", 0, name)
        with ExitStack() as pages:
            for address in ("198.51.100.1", "203.0.113.9, 198.51.100.1"):  # the first entry is anybody's
                pages.enter_context(page_from(server, "127.0.0.1", **{"X-Forwarded-For": address}))
            refused(server, "127.0.0.1", **{"X-Forwarded-For": "198.51.100.1"})
            if name is None:
                refused(server, "127.0.0.1", **{"X-Forwarded-For": "198.51.100.2"})
            else:
                pages.enter_context(page_from(server, "127.0.0.1", **{"X-Forwarded-For": "198.51.100.2"}))
        server.stop()


@pytest.mark.parametrize(
    ("peer", "forwarded", "found"),
    [
        ("127.0.0.1", None, "127.0.0.1"),
        ("192.0.2.7", None, "192.0.2.7"),
        ("::ffff:192.0.2.7", None, "192.0.2.7"),
        ("2001:db8:1:2:3:4:5:6", None, "2001:db8:1:2::/64"),
        ("fe80::1%eth0", None, "fe80::/64"),
        ("127.0.0.1", "192.0.2.7", "192.0.2.7"),
        ("::1", "198.51.100.1,  2001:db8::9", "2001:db8::/64"),
        ("127.0.0.1", "nonsense", "127.0.0.1"),
        ("127.0.0.1", "", "127.0.0.1"),
        ("192.0.2.7", "198.51.100.1", "192.0.2.7"),  # not from this machine: nobody's word
        ("", None, ""),
    ],
)
def test_whose_a_connection_is(peer, forwarded, found):
    assert client_key(peer, forwarded) == found


@pytest.mark.parametrize("greedy", range(7))
def test_whoever_is_new_finds_a_place(greedy):
    """However many addresses take all they get, one after the other: each leaves half of what it found."""
    there = 0
    for _ in range(greedy):
        own = 0
        while admits_client(own, there, 64):
            own, there = own + 1, there + 1
    assert 64 - there == 64 // 2**greedy
    assert admits_client(0, there, 64)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="127.0.0.2 is this machine on Linux")
def test_connections_that_say_nothing_are_counted(server, monkeypatch):
    """As many of one address as are still free."""
    monkeypatch.setattr(client_limits, "MOST_CONNECTIONS", 6)
    silent = [socket.create_connection(("127.0.0.1", server.port), timeout=300) for _ in range(3)]
    try:
        with socket.create_connection(("127.0.0.1", server.port), timeout=300) as line:
            with pytest.raises(ConnectionResetError):
                if line.recv(1) == b"":
                    raise ConnectionResetError
        with socket.create_connection(("127.0.0.1", server.port), timeout=300, source_address=("127.0.0.2", 0)) as line:
            line.sendall(f"GET / HTTP/1.1\r\nHost: {here(server)}\r\n\r\n".encode())
            assert line.recv(65536).startswith(b"HTTP/1.1 200")
    finally:
        for line in silent:
            line.close()
    until(lambda: _answers(server))


def _answers(server) -> bool:
    try:
        return asked(server, f"Host: {here(server)}")[0] == 200
    except OSError:
        return False


def test_the_log_is_bounded(monkeypatch):
    few, written = background.LogLimiter(), []
    monkeypatch.setattr(background, "MOST_LINES", 5)
    few._left = 5.0
    log = logging.getLogger("flexapod.test.few")
    log.addFilter(few)
    keep = logging.Handler()
    keep.emit = lambda record: written.append(record.getMessage())
    log.addHandler(keep)
    for i in range(1000):
        log.warning("%d %s", i, "x" * 100_000)
    assert 5 <= len(written) <= 10  # one a second more
    assert max(map(len, written)) < 10_000
    few._left = 1.0
    log.warning("the last")
    assert "entries were left out.) the last" in written[-1]
