"""`flexapod view`: a study or its results as an interactive page in the browser."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json

__all__ = ["add"]

LOCAL = "127.0.0.1"

File = Annotated[Path, typer.Argument(metavar="FILE", help="Study file (TOML), or results.nc of `flexapod run`.")]
Host = Annotated[
    str,
    typer.Option("--host", metavar="ADDRESS", help="Address to listen on; 0.0.0.0 lets everyone on the network in."),
]
Port = Annotated[
    int | None,
    typer.Option("--port", metavar="N", min=0, max=65535, help="Port; default: the first free from 8080 on."),
]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Do not open the page in the browser.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("view")(view)


@guarded
def view(file: File, host: Host = LOCAL, port: Port = None, no_browser: NoBrowser = False, json: Json = False) -> None:
    """Look at a study or its results in the browser: 3D, charts, modes, every number to turn. Ctrl-C ends it."""
    from flexapod.app.view.network import address, free_port
    from flexapod.app.view.opening import open_source

    source, free = open_source(file), free_port(host, port)
    from flexapod.app.view.server import View

    running = View(source, host, free)
    try:
        page = address(host, running.port)
        _say(page, host, json=json)
        if not no_browser:
            import webbrowser

            webbrowser.open(page)
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        pass
    finally:
        running.stop()


def _say(page: str, host: str, *, json: bool) -> None:
    from flexapod.app.terminal import print_json, print_text
    from flexapod.app.view.network import is_local

    local = is_local(host)
    if json:
        print_json({"address": page, "local": local})
        return
    print_text(f"The page is at {page} ; Ctrl-C ends it.")
    if not local:
        print_text(
            f"It listens on {host}: everyone on the network who reaches this machine can open the page, see the study, "
            "download its results, upload studies of their own and have them computed here. There is no password."
        )
