"""Access control of the page's server: clients it admits, text of its refusals, headers of every answer."""

from __future__ import annotations

import gzip
import http
import re
import threading
import traceback
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, cast

import viser
from websockets.asyncio import server as websockets_server
from websockets.asyncio.server import ServerConnection, serve
from websockets.http11 import Request, Response

from flexapod.app.browser.background import CONNECTIONS, LOG
from flexapod.app.browser.client_limits import LARGEST_MESSAGE, ClientConnection
from flexapod.app.browser.network import admits_client, client_key, is_expected, is_same_site, names_in_words

MOST_VISITORS = 64
"""Pages that are open at once; one address has at most as many as are still free (`admits_client`)."""
QUEUE = 4  # frames of one visitor that wait for their turn
CLOSING = 2.0  # time for a visitor to agree that it is over [s]

PROTOCOL_ERROR, INVALID_DATA, POLICY_VIOLATION = 1002, 1007, 1008  # why a connection is closed, RFC 6455
VERSION = f"viser-v{viser.__version__}"

Handler = Callable[[ServerConnection], Awaitable[None]]
Process = Callable[[ServerConnection, Request], Response | None]

_ONE_AT_A_TIME = threading.Lock()


class AccessControl:
    """Checks on every client that connects to `host`, where the server listens.

    `name`: another one under which the page is reached; `left`: called in the event loop when somebody has left.
    """

    def __init__(self, host: str, name: str | None, left: Callable[[], None]) -> None:
        self._host, self._name, self._left = host, name, left
        self._stands = False

    @contextmanager
    def guard_server(self) -> Iterator[None]:
        """Guard the server that viser starts in this block; viser has no other way to set its limits."""
        with _ONE_AT_A_TIME:
            websockets_server.serve = cast("Any", self._serve)
            try:
                yield
            finally:
                websockets_server.serve = serve
        if not self._stands:
            raise RuntimeError("viser does not serve by websockets.asyncio.server.serve any more")

    def _serve(self, handler: Handler, *place: Any, process_request: Process, **options: Any) -> serve:
        self._stands = True
        own = {
            "max_size": LARGEST_MESSAGE,
            "max_queue": QUEUE,
            "close_timeout": CLOSING,
            "create_connection": ClientConnection,
            "server_header": None,
            "logger": CONNECTIONS,
            "process_request": lambda connection, request: self._answer(process_request, connection, request),
            "process_response": _with_headers,
        }
        return serve(lambda connection: self._receive(handler, connection), *place, **options | own)

    def _answer(self, process: Process, connection: ServerConnection, request: Request) -> Response | None:
        """Refuse a request with a text, or leave it to viser."""
        refused = self._refusal(connection, request)
        if refused is not None:
            LOG.warning("a request is refused (%d): %s", *refused)
            return connection.respond(refused[0], f"{refused[1]}\n")
        accepted = request.headers.get_all("Accept-Encoding")
        if len(accepted) > 1:  # viser expects one line
            del request.headers["Accept-Encoding"]
            request.headers["Accept-Encoding"] = ", ".join(accepted)
        try:
            return _styled(process(connection, request))
        except (OSError, ValueError):  # a path that no file can have
            return connection.respond(http.HTTPStatus.NOT_FOUND, "There is no such page.\n")

    def _refusal(self, connection: ServerConnection, request: Request) -> tuple[http.HTTPStatus, str] | None:
        """Status and words of a refusal; None where everything is in order."""
        headers = request.headers
        twice = [name for name in ("Host", "Origin", "Upgrade") if len(headers.get_all(name)) > 1]
        if twice:
            return http.HTTPStatus.BAD_REQUEST, f"The request has more than one line {twice[0]}."
        asked, origin = headers.get("Host", ""), headers.get("Origin")
        if not asked:
            return http.HTTPStatus.BAD_REQUEST, "The request has no line Host."
        if not is_expected(asked, self._host, self._name):
            names = names_in_words(self._host, self._name)
            words = f"The page is not served under the name {asked[:100]!r}, but under {names}."
            return http.HTTPStatus.FORBIDDEN, words
        if "Upgrade" in headers and origin is not None and not is_same_site(origin, asked):
            return http.HTTPStatus.FORBIDDEN, f"The page that connects came from another site: {origin[:100]!r}."
        return self._full(connection, request)

    def _full(self, connection: ServerConnection, request: Request) -> tuple[http.HTTPStatus, str] | None:
        """Status and words for a page where there is no place for one more of its address."""
        if "Upgrade" not in request.headers:
            return None
        forwarded = request.headers.get_all("X-Forwarded-For") if self._name else []
        visitor, there = (
            cast("ClientConnection", connection),
            cast("set[ClientConnection]", connection.server.connections),
        )
        visitor.whose = client_key(visitor.peer, forwarded[-1] if forwarded else None)
        own = sum(other.whose == visitor.whose for other in there)
        if admits_client(own, len(there), MOST_VISITORS):
            return None
        words = f"{len(there)} pages are open, {own} of them from your address; it may have no more now. "
        return http.HTTPStatus.SERVICE_UNAVAILABLE, words + "Close one, or try again later."

    async def _receive(self, handler: Handler, connection: ServerConnection) -> None:
        """Leave a connection to viser; whatever ends it, nothing of it stays."""
        if connection.subprotocol != VERSION:  # viser would close it, too, and print what it was sent
            await connection.close(PROTOCOL_ERROR, f"Version mismatch. Client: another one, Server: {VERSION[7:]}")
            return
        try:
            await handler(connection)
        except TimeoutError:
            LOG.warning("a connection is closed: it did not say that it shows the page")
            await connection.close(POLICY_VIOLATION, "no first message")
        except Exception as error:
            LOG.warning("a connection is closed: %.100s", f"{type(error).__name__}: {error}")
            traceback.clear_frames(error.__traceback__)  # they keep what was sent
            await connection.close(INVALID_DATA, "unreadable")
        finally:
            self._left()


STYLE = b"<style>#webgl-software-rendering { display: none; }</style>"
"""In the head of the page, before any script runs: viser's notice covers the robot; `assets/picture.js` has another."""


def _styled(response: Response | None) -> Response | None:
    """The page with our style in it; other answers as they are."""
    if response is not None and response.headers.get("Content-Type", "").startswith("text/html"):
        response.body = _with_style(bytes(response.body), response.headers["Content-Encoding"] == "gzip")
        del response.headers["Content-Length"]
        response.headers["Content-Length"] = str(len(response.body))
    return response


@lru_cache(maxsize=4)
def _with_style(body: bytes, packed: bool) -> bytes:
    text = gzip.decompress(body) if packed else body
    text = text.replace(b"</head>", STYLE + b"</head>", 1)
    return gzip.compress(text) if packed else text


def _with_headers(_: ServerConnection, request: Request, response: Response) -> None:
    for name, value in security_headers(request.headers.get_all("Host")).items():
        response.headers[name] = value


_PAGE = {
    "default-src": "'none'",
    "script-src": "'unsafe-inline' 'unsafe-eval'",  # viser's page is one file that unpacks and compiles its own program
    "style-src": "'unsafe-inline'",
    "img-src": "'self' data: blob:",
    "font-src": "data:",
    "worker-src": "blob: data:",
    "connect-src": "'self' data: blob:",
    "base-uri": "'none'",
    "form-action": "'none'",
    "frame-ancestors": "'none'",
}
_FEATURES = ("camera", "microphone", "geolocation", "usb", "serial", "midi", "payment", "display-capture")
_PLAIN = re.compile(r"[a-z0-9.:\[\]-]+", re.IGNORECASE)


def security_headers(asked: Sequence[str]) -> dict[str, str]:
    """Headers that limit what the page may load, who may embed it, and what a browser reports to others.

    `asked`: lines ``Host`` of the request; browsers that do not count websockets as 'self' are told the address.
    """
    policy = dict(_PAGE)
    if len(asked) == 1 and _PLAIN.fullmatch(asked[0]):
        policy["connect-src"] += f" ws://{asked[0]} wss://{asked[0]}"
    return {
        "Content-Security-Policy": "; ".join(f"{name} {value}" for name, value in policy.items()),
        "Cross-Origin-Resource-Policy": "same-origin",
        "Permissions-Policy": ", ".join(f"{feature}=()" for feature in _FEATURES),
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "X-Frame-Options": "DENY",
    }
