"""`flexapod view`: a study or its results as an interactive page in the browser."""

from __future__ import annotations

import signal
import socket
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import Json
from flexapod.common.errors import InputError
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text.terminal import print_answer

if TYPE_CHECKING:
    from flexapod.app.browser import header, network, server
else:
    header = LazyModule("flexapod.app.browser.header")
    network = LazyModule("flexapod.app.browser.network")
    server = LazyModule("flexapod.app.browser.server")

LOCAL = "127.0.0.1"
PACKAGES = ("msgspec", "viser", "websockets")  # what the page alone needs

File = Annotated[Path, typer.Argument(metavar="FILE", help="Study file (TOML), or results.nc of `flexapod run`.")]
Host = Annotated[
    str,
    typer.Option("--host", metavar="ADDRESS", help="Address to listen on; 0.0.0.0 lets everyone on the network in."),
]
Port = Annotated[
    int | None,
    typer.Option("--port", metavar="N", min=0, max=65535, help="Port; default: the first free from 8080 on."),
]
Name = Annotated[
    str | None,
    typer.Option("--name", metavar="NAME", help="Another name under which the page is reached, as through a proxy."),
]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Do not open the page in the browser.")]


@report_failures
def view(
    file: File,
    host: Host = LOCAL,
    port: Port = None,
    name: Name = None,
    no_browser: NoBrowser = False,
    json: Json = False,
) -> None:
    """Look at a study or its results in the browser: 3D, charts, modes, every number to turn. Ctrl-C ends it."""
    _check_packages()

    source, free = header.open_source(file), network.free_port(host, port)

    _end_by_signals()
    running = server.View(source, host, free, name)
    try:
        page = network.address(host, running.port)
        _say(page, host, json=json)
        if not no_browser:
            import webbrowser

            webbrowser.open(page)
        _wait_for_a_signal()
    except KeyboardInterrupt:
        pass
    finally:
        running.stop()


def _check_packages() -> None:
    """Refuse, before anything is read, to show a page without what it is made with."""
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if missing:
        raise InputError(
            "is not installed, which the page needs",
            key="flexapod view",
            value=", ".join(missing),
            next_step='Install it: pip install "flexapod[page]"',
        )


def _end_by_signals() -> None:
    """End as by Ctrl-C where the system says so (SIGTERM), or the terminal goes (SIGHUP): what was sent is deleted."""
    kinds = [signal.Signals[kind] for kind in ("SIGTERM", "SIGHUP") if kind in signal.Signals.__members__]
    ended = False

    def end(_number: int, _frame: FrameType | None) -> None:
        nonlocal ended
        if not ended:  # both may come, one after the other: the end itself is not interrupted
            ended = True
            raise KeyboardInterrupt

    for kind in kinds:
        if signal.getsignal(kind) is not signal.SIG_IGN:  # as nohup has switched SIGHUP off
            signal.signal(kind, end)


def _wait_for_a_signal() -> None:
    """Sleep until a signal ends it, also where another thread received it: a mere sleep would not wake."""
    woken, wakes = socket.socketpair()
    with woken, wakes:
        wakes.setblocking(False)
        signal.set_wakeup_fd(wakes.fileno(), warn_on_full_buffer=False)
        try:
            while True:
                woken.recv(1)
        finally:
            signal.set_wakeup_fd(-1)


def _say(page: str, host: str, *, json: bool) -> None:
    local = network.is_local(host)
    said = f"The page is at {page} ; Ctrl-C ends it."
    if not local:
        said += (
            f"\nIt listens on {host}: everyone on the network who reaches this machine can open the page, see the "
            "study, download its results, upload studies of their own and have them computed here. "
            "There is no password."
        )
    # at once: whoever reads the address may end it before another line is written
    print_answer([said], lambda: {"address": page, "local": local}, json=json)
