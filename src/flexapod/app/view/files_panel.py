"""Downloads of a study and its results, upload of a study file."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from viser import Icon, IconName

from flexapod.app.view import downloads, words
from flexapod.app.view.document import Document
from flexapod.app.view.limits import limit_uploads
from flexapod.app.view.uploads import LARGEST, read_upload, store_table
from flexapod.errors import FlexapodError

if TYPE_CHECKING:
    from viser import ClientHandle
    from xarray import Dataset

    from flexapod.model import ActuatorStudy, Study

__all__ = ["FilesPanel"]

ACKNOWLEDGED = 0.5  # time in which the browser shows that a file has arrived, before the page is built anew [s]
_NO_RESULTS = "There are no results yet: press Simulate, or wait until it is done."


class FilesPanel:
    """The tab "Files" of one client.

    Parameters
    ----------
    client : viser.ClientHandle
    document : callable
        Gives the study file as it stands.
    study, data : callable
        Give the study that is computed, and the results that are shown, or None.
    on_upload : callable
        Called with the document of a valid study file that was sent.
    """

    def __init__(
        self,
        client: ClientHandle,
        document: Callable[[], Document],
        study: Callable[[], Study | ActuatorStudy],
        data: Callable[[], Dataset | None],
        on_upload: Callable[[Document], None],
    ) -> None:
        self._client, self._document, self._study, self._data = client, document, study, data
        self._on_upload = on_upload
        self._folder = tempfile.TemporaryDirectory(prefix="flexapod-uploads-", ignore_cleanup_errors=True)
        gui = client.gui
        self._words = gui.add_html("")
        with gui.add_folder("Download"):
            text = gui.add_button("Study (TOML)", icon=Icon.FILE_TEXT)
            text.on_click(lambda _: self._send(self._name(".toml"), self._document().text.encode()))
            self._offer("Results (NetCDF)", Icon.DATABASE, ".nc", downloads.netcdf)
            self._offer("Results (CSV)", Icon.TABLE, ".csv", downloads.csv)
            self._offer("Figures (ZIP of PNG)", Icon.PHOTO, "-figures.zip", downloads.figures)
            self._offer(
                "Report (HTML)", Icon.REPORT, "-report.html", lambda found: downloads.report(self._study(), found)
            )
        with gui.add_folder("Upload"):
            gui.add_html(words.block(f"A study file (TOML, UTF-8) of at most {LARGEST / 1e6:g} MB.", "soft"))
            sent = gui.add_upload_button("Study file", icon=Icon.UPLOAD, mime_type=".toml,text/plain")
            gui.add_html(words.block("Tables that a study names (CSV) first, then the study.", "soft"))
            table = gui.add_upload_button("Table", icon=Icon.UPLOAD, mime_type=".csv,text/csv")
        sent.on_upload(lambda _: self._take(sent.value.name, sent.value.content))
        table.on_upload(lambda _: self._keep(table.value.name, table.value.content))
        limit_uploads(client, LARGEST, self._too_large)

    def close(self) -> None:
        """Delete the tables that were sent."""
        self._folder.cleanup()

    def _offer(self, label: str, icon: IconName, ending: str, make: Callable[[Dataset], bytes]) -> None:
        button = self._client.gui.add_button(label, icon=icon)

        def send(_: object) -> None:
            data = self._data()
            if data is None:
                self._words.content = words.block(_NO_RESULTS, "warning")
                return
            button.disabled = True
            self._words.content = words.block(f"Writing {label} ...", "soft")
            try:
                self._send(self._name(ending), make(data))
            finally:
                button.disabled = False

        button.on_click(send)

    def _send(self, name: str, content: bytes) -> None:
        self._client.send_file_download(name, content, save_immediately=True)
        self._words.content = words.block(f"Sent: {name} ({len(content) / 1e6:.2g} MB).", "good")

    def _name(self, ending: str) -> str:
        path = self._document().path
        return (Path(path).stem if path else "study") + ending

    def _take(self, name: str, content: bytes) -> None:
        try:
            document = read_upload(name, content, Path(self._folder.name))
        except FlexapodError as error:
            self._words.content = words.error_html(error)
            return
        self._words.content = words.block(f"Taken: {name}.", "good")
        time.sleep(ACKNOWLEDGED)
        self._on_upload(document)

    def _keep(self, name: str, content: bytes) -> None:
        try:
            kept = store_table(name, content, Path(self._folder.name))
        except FlexapodError as error:
            self._words.content = words.error_html(error)
            return
        self._words.content = words.block(f"Kept: {kept}. A study may name it as file = {kept!r}.", "good")

    def _too_large(self, error: FlexapodError) -> None:
        self._words.content = words.error_html(error)
