"""The server of `flexapod view`: one page for everybody who connects, a session of their own for each."""

from __future__ import annotations

import asyncio
import contextlib
import io
import logging
import threading
import traceback
import warnings
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import viser

from flexapod.app.view.cores import Cores
from flexapod.app.view.network import is_expected
from flexapod.loading import loaded

if TYPE_CHECKING:
    from flexapod.app.view.session import Session
    from flexapod.app.view.source import Source

__all__ = ["GONE", "View"]

GONE = "Queued a .* on a closed connection"
"""What viser remarks where somebody leaves while their page is being drawn: nothing is wrong then."""

POLICY_VIOLATION = 1008  # why a connection is closed, RFC 6455

_LOG = logging.getLogger("flexapod.view")


class View:
    """A running server.

    Parameters
    ----------
    source : Source
        What everybody begins with.
    host, port
        Where to listen; the port must be free (see `free_port`).
    """

    def __init__(self, source: Source, host: str, port: int) -> None:
        warnings.filterwarnings("ignore", message=GONE)
        self._source, self._cores = source, Cores()
        self._sessions: dict[int, Session] = {}
        self._lock = threading.Lock()
        with contextlib.redirect_stdout(io.StringIO()):  # viser announces itself; the command says where it listens
            self._server = _Server(host=host, port=port, label="flexapod", verbose=False)
        self._server._thread_executor = _Guarded(self._fault)
        self.port, self._host = self._server.get_port(), host
        self._server.gui.configure_theme(
            show_logo=False, show_share_button=False, control_width="large", brand_color=(0, 90, 160)
        )
        self._server.scene.configure_environment_map(None)  # its reflections take seconds where no GPU draws the page
        self._server.scene.configure_default_lights(enabled=False)
        threading.Thread(target=_load, name="flexapod-load", daemon=True).start()
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
        if not _from_here(self._server, client, self._host):
            _LOG.warning("client %s refused: its page came from another site", client.client_id)
            _hang_up(self._server, client)
            return
        from flexapod.app.view.session import Session

        session = Session(client, self._source, self._cores)
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

    def _fault(self, client_id: int | None, error: BaseException) -> None:
        with self._lock:
            session = self._sessions.get(client_id) if client_id is not None else None
        if session is not None:
            session.fault(error)
        else:
            _LOG.error("client %s: %s", client_id, "".join(traceback.format_exception(error)))


class _Server(viser.ViserServer):
    """viser's server without its public share links."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        return None


class _Guarded(ThreadPoolExecutor):
    """The pool in which viser calls back; what a callback raises is told to the client that it belongs to."""

    def __init__(self, fault: Callable[[int | None, BaseException], None]) -> None:
        super().__init__(max_workers=32, thread_name_prefix="flexapod-view")
        self._fault = fault

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        return super().submit(self._guarded, fn, *args, **kwargs)

    def _guarded(self, fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        try:
            return fn(*args, **kwargs)
        except Exception as error:
            self._fault(getattr(args[0], "client_id", None) if args else None, error)
            return None


def _load() -> None:
    """Load what the first session needs while its browser fetches the page."""
    for name in ("flexapod.app.view.session", *(f"flexapod.app.view.{panel}_panel" for panel in ("time", "modes"))):
        loaded(name)
    loaded("flexapod.study.simulation")
    loaded("xarray")


def _hang_up(server: viser.ViserServer, client: viser.ClientHandle) -> None:
    connection: Any = server._websock_server._live_connections.get(client.client_id)
    if connection is not None:
        asyncio.run_coroutine_threadsafe(connection.close(POLICY_VIOLATION), server.get_event_loop())


def _from_here(server: viser.ViserServer, client: viser.ClientHandle, host: str) -> bool:
    """Whether a connection comes from the page of this server, not from a page of some other site."""
    connection: Any = server._websock_server._live_connections.get(client.client_id)
    headers = connection.request.headers if connection is not None and connection.request is not None else {}
    origin, asked = headers.get("Origin"), headers.get("Host", "")
    return is_expected(asked, host) and (origin is None or origin.partition("://")[2] == asked)
