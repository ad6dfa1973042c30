"""The server of `flexapod view`: one page for everybody who connects, a session of their own for each."""

from __future__ import annotations

import asyncio
import contextlib
import io
import threading
import traceback
import warnings
from typing import TYPE_CHECKING, Any, cast

import viser

from flexapod.app.browser.access import AccessControl
from flexapod.app.browser.background import LOG, Debouncer, Threads
from flexapod.app.browser.client_limits import CallbackPool
from flexapod.app.browser.running import CorePool, ResultMemory
from flexapod.common.lazy_imports import LazyModule, load_module
from flexapod.common.resources import limit_arenas, release_memory

if TYPE_CHECKING:
    from flexapod.app.browser import session as browser_session
    from flexapod.app.browser.client_limits import ClientConnection
    from flexapod.app.browser.header import StudySource
    from flexapod.app.browser.session import Session
else:
    browser_session = LazyModule("flexapod.app.browser.session")

GONE = "Queued a .* on a closed connection"
"""What viser remarks where somebody leaves while their page is being drawn: nothing is wrong then."""

GARBLED = r"\[viser\] .* does not match annotation"
"""What viser remarks of a message that is not as it should be; Python would keep each remark, and the message in it."""

SETTLED = 0.5  # time after somebody has left, when what they leave is collected [s]


class View:
    """A running server that begins with `source` for everybody.

    It listens on `host` and the free `port` (see `free_port`); `name`: another one under which the page is reached, as
    through a proxy.
    """

    def __init__(self, source: StudySource, host: str, port: int, name: str | None = None) -> None:
        for remark in (GONE, GARBLED):
            warnings.filterwarnings("ignore", message=remark)
        limit_arenas()
        self._source, self._cores = source, CorePool()
        self._results = ResultMemory(released=lambda: self._leftovers.request(SETTLED))
        self._sessions: dict[int, Session] = {}
        self._lock = threading.Lock()
        self._leftovers = Debouncer(Threads(lambda error: self._fault(None, error)), release_memory)
        door = AccessControl(host, name, lambda: self._leftovers.request(SETTLED))
        with contextlib.redirect_stdout(io.StringIO()):  # viser announces itself; the command says where it listens
            with door.guard_server():
                self._server = _Server(host=host, port=port, label="flexapod", verbose=False)
        self._server._thread_executor = CallbackPool(self._fault, self._visitor)
        self._server.get_event_loop().set_exception_handler(_unhandled)
        self.port: int = self._server.get_port()
        self._server.gui.configure_theme(
            show_logo=False, show_share_button=False, control_width="large", brand_color=(0, 90, 160)
        )
        self._server.scene.configure_environment_map(None)  # its reflections take seconds where no GPU draws the page
        self._server.scene.configure_default_lights(enabled=False)
        self._loading = threading.Thread(target=_load, name="flexapod-load", daemon=True)
        self._loading.start()
        self._server.on_client_connect(self._connected)
        self._server.on_client_disconnect(self._disconnected)

    @property
    def sessions(self) -> list[Session]:
        """Sessions of those who are connected."""
        with self._lock:
            return list(self._sessions.values())

    def stop(self) -> None:
        """Disconnect everybody and free the port."""
        for session in self.sessions:
            session.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()

    def _connected(self, client: viser.ClientHandle) -> None:
        self._loading.join()

        session = browser_session.Session(client, self._source, self._cores, self._results)
        with self._lock:
            self._sessions[client.client_id] = session
        session.start()
        if client.client_id not in self._server.get_clients():
            self._disconnected(client)  # gone while its session was being made

    def _disconnected(self, client: viser.ClientHandle) -> None:
        with self._lock:
            session = self._sessions.pop(client.client_id, None)
        if session is not None:
            session.close()

    def _visitor(self, client_id: int) -> ClientConnection | None:
        return cast("ClientConnection | None", self._server._websock_server._live_connections.get(client_id))

    def _fault(self, client_id: int | None, error: BaseException) -> None:
        with self._lock:
            session = self._sessions.get(client_id) if client_id is not None else None
        if session is not None:
            session.fault(error)
        else:
            LOG.error("client %s: %s", client_id, "".join(traceback.format_exception(error)))


class _Server(viser.ViserServer):
    """viser's server without its public share links."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        return None


def _load() -> None:
    """Load what the first session needs while its browser fetches the page."""
    for name in (
        "flexapod.app.browser.session",
        *(f"flexapod.app.browser.{panel}_panel" for panel in ("time", "modes")),
    ):
        load_module(name)
    load_module("flexapod.analysis.simulation")
    load_module("xarray")
    load_module("dask.base")  # xarray asks it for its types; of two threads that import it at once one gets half of it


def _unhandled(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """An entry in the log for what viser could not do with a message, without the message."""
    error = context.get("exception")
    if error is None:
        loop.default_exception_handler(context)
    else:
        LOG.error("a message had no effect: %.100s", f"{type(error).__name__}: {error}")
