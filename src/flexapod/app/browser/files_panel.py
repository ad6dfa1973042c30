"""The tab "Files": downloads of a study and its results, upload of a study file."""

from __future__ import annotations

import io
import threading
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from viser import ClientHandle, Icon, IconName

from flexapod.app.browser import markup
from flexapod.app.browser.background import Threads
from flexapod.app.browser.document import Document, read
from flexapod.app.browser.uploads import LARGEST, UploadFolder, limit_uploads, read_upload, store_table, study_download
from flexapod.common.errors import FlexapodError
from flexapod.common.files import temporary_folder
from flexapod.common.lazy_imports import LazyModule

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis import store
    from flexapod.model import ActuatorStudy, Study
    from flexapod.output.report import figures as report_figures
    from flexapod.output.report import report as report_report
else:
    store = LazyModule("flexapod.analysis.store")
    report_figures = LazyModule("flexapod.output.report.figures")
    report_report = LazyModule("flexapod.output.report.report")

_ONE_AT_A_TIME = threading.Lock()  # neither NetCDF nor the drawing of figures promises to work in parallel


def netcdf(data: Dataset) -> bytes:
    """``results.nc``; of the study file it keeps the name, not the folders of whoever runs the server."""
    named = data.assign_attrs(study_file=Path(str(data.attrs.get("study_file", ""))).name)
    with _ONE_AT_A_TIME, temporary_folder() as folder:
        return store.save(named, folder / "results.nc").read_bytes()


def csv(data: Dataset) -> bytes:
    """``results.csv``."""
    with temporary_folder() as folder:
        return store.save_csv(data, folder / "results.csv").read_bytes()


def figures(data: Dataset) -> bytes:
    """A ZIP archive of the standard figures, PNG."""
    with _ONE_AT_A_TIME, temporary_folder() as folder:
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as files:
            for figure in report_figures.draw_figures(data, folder, ("png",)):
                files.write(figure.png, figure.png.name)
        return archive.getvalue()


def report(study: Study | ActuatorStudy, data: Dataset) -> bytes:
    """``report.html``, one file."""
    with _ONE_AT_A_TIME:
        return report_report.robot_report(study, data).encode()


ACKNOWLEDGED = 0.5  # time in which the browser shows that a file has arrived, before the page is built anew [s]
_BUSY = "One file at a time: wait until the one before is done."
_NO_RESULTS = "There are no results yet: press Simulate, or wait until it is done."


class FilesPanel:
    """The tab "Files" of one client; one file is written or read at a time, in a thread of the session.

    `sent`: the tables that this person has sent; `document`, `study`, `data` give the study file as it stands, the
    study that is computed, and the results that are shown, or None; `on_upload` is called with the document of a valid
    study file that was sent.
    """

    def __init__(
        self,
        client: ClientHandle,
        threads: Threads,
        sent: UploadFolder,
        document: Callable[[], Document],
        study: Callable[[], Study | ActuatorStudy],
        data: Callable[[], Dataset | None],
        on_upload: Callable[[Document], None],
    ) -> None:
        self._client, self._document, self._study, self._data = client, document, study, data
        self._threads, self._sent, self._on_upload = threads, sent, on_upload
        self._lock, self._busy, self._closed = threading.Lock(), False, False
        gui = client.gui
        self._words = gui.add_html("")
        with gui.add_folder("Download"):
            text = gui.add_button("Study (TOML)", icon=Icon.FILE_TEXT)
            text.on_click(lambda _: self._do(self._send_study))
            self._offer("Results (NetCDF)", Icon.DATABASE, ".nc", netcdf)
            self._offer("Results (CSV)", Icon.TABLE, ".csv", csv)
            self._offer("Figures (ZIP of PNG)", Icon.PHOTO, "-figures.zip", figures)
            self._offer("Report (HTML)", Icon.REPORT, "-report.html", lambda found: report(self._study(), found))
        with gui.add_folder("Upload"):
            gui.add_html(markup.block(f"A study file (TOML, UTF-8) of at most {LARGEST / 1e6:g} MB.", "soft"))
            study_file = gui.add_upload_button("Study file", icon=Icon.UPLOAD, mime_type=".toml,text/plain")
            gui.add_html(markup.block("Tables that a study names (CSV) first, then the study.", "soft"))
            table = gui.add_upload_button("Table", icon=Icon.UPLOAD, mime_type=".csv,text/csv,.json")
        study_file.on_upload(lambda _: self._do(lambda: self._take(study_file.value.name, study_file.value.content)))
        table.on_upload(lambda _: self._do(lambda: self._keep(table.value.name, table.value.content)))
        limit_uploads(client, LARGEST, self._refused)

    def close(self) -> None:
        """Send nothing any more; what is being written is dropped."""
        self._closed = True

    def _do(self, work: Callable[[], None]) -> None:
        """Do some work in the background, unless some is being done: a button that waits would hold up others."""
        with self._lock:
            if self._busy:
                self._words.content = markup.block(_BUSY, "warning")
                return
            self._busy = True
        self._threads.start("files", lambda: self._done(work))

    def _done(self, work: Callable[[], None]) -> None:
        try:
            work()
        finally:
            self._busy = False

    def _offer(self, label: str, icon: IconName, ending: str, make: Callable[[Dataset], bytes]) -> None:
        button = self._client.gui.add_button(label, icon=icon)

        def send() -> None:
            data = self._data()
            if data is None:
                self._words.content = markup.block(_NO_RESULTS, "warning")
                return
            button.disabled = True
            self._words.content = markup.block(f"Writing {label} ...", "soft")
            try:
                self._send(self._name(ending), make(data))
            except Exception:
                self._words.content = ""  # what went wrong is said above the tabs
                raise
            finally:
                button.disabled = False

        button.on_click(lambda _: self._do(send))

    def _send_study(self) -> None:
        found = read(self._document())
        ending, content = study_download(found.document, found.study)
        self._send(self._name(ending), content)
        if found.error is not None:
            remark = markup.block("The study is sent as it stands, which is refused:", "warning")
            self._words.content += remark + markup.error_html(found.error)

    def _send(self, name: str, content: bytes) -> None:
        if self._closed:
            return
        self._client.send_file_download(name, content, save_immediately=True)
        self._words.content = markup.block(f"Sent: {name} ({len(content) / 1e6:.2g} MB).", "good")

    def _name(self, ending: str) -> str:
        path = self._document().path
        return (Path(path).stem if path else "study") + ending

    def _take(self, name: str, content: bytes) -> None:
        try:
            document = read_upload(name, content, self._sent.folder)
        except FlexapodError as error:
            self._refused(error)
            return
        self._words.content = markup.block(f"Taken: {name}.", "good")
        time.sleep(ACKNOWLEDGED)
        self._on_upload(document)

    def _keep(self, name: str, content: bytes) -> None:
        try:
            kept = store_table(name, content, self._sent.folder)
        except FlexapodError as error:
            self._refused(error)
            return
        self._words.content = markup.block(f"Kept: {kept}. A study may name it as file = {kept!r}.", "good")

    def _refused(self, error: FlexapodError) -> None:
        self._words.content = markup.error_html(error)
