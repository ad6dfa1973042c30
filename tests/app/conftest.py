"""The command as a user types it, in an empty folder of its own; the page in a browser."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.helpers.guests import until
from tests.helpers.short_runs import SHORT, study_text
from typer.testing import CliRunner, Result

from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource, open_source
from flexapod.app.browser.network import free_port
from flexapod.app.browser.server import GONE, View
from flexapod.app.browser.session import Session
from flexapod.app.cli.cli import app
from flexapod.model import loads

HOST = "127.0.0.1"
Command = Callable[..., Result]


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def flexapod(folder) -> Command:
    """`flexapod("check", "a.toml")` -> exit_code, stdout, stderr."""
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments], prog_name="flexapod")


@pytest.fixture
def study(folder) -> Callable[..., Path]:
    """A file from a preset, with pieces of its text replaced: `study(("100 kg", "-100 kg"))`."""

    def write(*changes: tuple[str, str], preset: str = "paper-robot", more: str = "") -> Path:
        path = folder / "study.toml"
        path.write_text(study_text(*changes, preset=preset) + more, encoding="utf-8")
        return Path(path.name)

    return write


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("web"):
            item.add_marker(pytest.mark.filterwarnings(f"ignore:{GONE}"))


def told(error: str) -> bool:
    """Whether an error of the browser's console counts.

    viser's client collects what changes in controls and applies it once a frame: a control that changed and went within
    one frame (another study was opened, and the browser was behind) is called "non-existent". It is gone by then.
    """
    return not error.startswith("Tried to update non-existent component")


@pytest.fixture
def view(tmp_path) -> Iterator[Callable[..., View]]:
    """`view(text)`: a server in this process that shows a study."""
    running: list[View] = []

    def serve(text: str) -> View:
        path = tmp_path / "study.toml"
        path.write_text(text, encoding="utf-8")
        running.append(View(open_source(path), HOST, free_port(HOST, 0)))
        return running[-1]

    yield serve
    for server in running:
        server.stop()


@pytest.fixture(scope="session")
def desk(browser, tmp_path_factory) -> Iterator[tuple[View, Callable[..., object], list[str]]]:
    """One server for all tests with a browser; `visit()`: another page that shows it; what went wrong in the pages."""
    path = tmp_path_factory.mktemp("view") / "study.toml"
    path.write_text(study_text(*SHORT), encoding="utf-8")
    errors: list[str] = []

    def visit() -> object:
        page = browser.new_context(viewport={"width": 900, "height": 700}, accept_downloads=True).new_page()
        page.set_default_timeout(300_000)  # the machine may be busy: what is waited for comes, or the test is wrong
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if said.type == "error" and told(said.text) else None)
        page.goto(f"http://{HOST}:{server.port}/?fixedDpr=0.5")  # coarse pictures of constant size: software draws them
        page.get_by_role("tab", name="Study").wait_for()
        return page

    server = View(open_source(path), HOST, free_port(HOST, 0))
    yield server, visit, errors
    server.stop()


@pytest.fixture(scope="module")
def table(desk) -> Iterator[tuple[object, Session]]:
    """A page that stays open from test to test, and its session: a page takes longer to load than most tests.

    No longer than for a file: as long as it is open it draws, on half a core where software does.
    """
    server, visit, _ = desk
    until(lambda: not server.sessions)
    page = visit()
    page.get_by_text("misses its rigid path by up to").wait_for()
    page.wait_for_timeout(300)  # as where people look: they see a page before they ask for another
    yield page, server.sessions[0]
    page.context.close()
    until(lambda: not server.sessions)


@pytest.fixture
def show(table, desk, tmp_path) -> Iterator[Callable[..., tuple[object, Session]]]:
    """`show(text)`: the open page with another study from its beginning, and its session; pages report no error."""
    page, found = table
    desk[2].clear()

    def begin(text: str, **size: int) -> tuple[object, Session]:
        page.set_viewport_size({"width": 900, "height": 700} | size)
        path = str(tmp_path / "study.toml")
        before = page.get_by_role("tab", name="Study").element_handle()
        found.open(StudySource(document=Document(text, path), study=loads(text, path=path)))
        before.wait_for_element_state("hidden")
        page.get_by_role("tab", name="Study").wait_for()
        return page, found

    yield begin
    found.cancel()
    found.time_panel.pause()
    found.modes_panel.pause()  # what moves on is a thread that tests after this one would count
    assert not desk[2]
    assert found in desk[0].sessions
