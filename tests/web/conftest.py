"""A real browser that looks at a real server; skipped where there is no Chromium, unless FLEXAPOD_BROWSER=required."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from flexapod.app.view import session
from flexapod.app.view.network import free_port
from flexapod.app.view.opening import open_source
from flexapod.app.view.server import GONE, View
from flexapod.model import preset_text

HOST = "127.0.0.1"
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

#: A motion of 0.2 s: computed in a moment.
SHORT = (
    ('duration = "1 s" ', 'duration = "0.15 s" '),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
    ('amplitude = "26.6 deg"', 'amplitude = "2 deg"'),
)


def study_text(*changes: tuple[str, str], preset: str = "paper-robot") -> str:
    """The text of a preset with pieces replaced."""
    text = preset_text(preset)
    for old, new in changes:
        assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in {preset}"
        text = text.replace(old, new)
    return text


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.parent == Path(__file__).parent:
            item.add_marker(pytest.mark.filterwarnings(f"ignore:{GONE}"))


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    """Headless Chromium with software WebGL."""
    required = os.environ.get("FLEXAPOD_BROWSER") == "required"
    chromium = shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        if required:
            raise
        pytest.skip("playwright is not installed")
    if chromium is None:
        if required:
            pytest.fail("FLEXAPOD_BROWSER=required, and there is no chromium")
        pytest.skip("there is no chromium")
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        yield running
        running.close()


@pytest.fixture
def view(tmp_path, monkeypatch) -> Iterator[Callable[..., View]]:
    """`view(text)` or `view(path)`: a server in this process that shows a study or results."""
    monkeypatch.setattr(session, "QUICK", float("inf"))  # a busy machine is slow, and simulates at once all the same
    running: list[View] = []

    def serve(what: str | Path) -> View:
        path = what
        if isinstance(what, str):
            path = tmp_path / "study.toml"
            path.write_text(what, encoding="utf-8")
        running.append(View(open_source(Path(path)), HOST, free_port(HOST, 0)))
        return running[-1]

    yield serve
    for server in running:
        server.stop()


@pytest.fixture
def visit(browser) -> Iterator[Callable[..., object]]:
    """`visit(server)`: a page in a window of its own; the test fails if the page reports an error."""
    contexts, errors = [], []

    def go(server: View, **size: int) -> object:
        context = browser.new_context(viewport={"width": 900, "height": 700} | size, accept_downloads=True)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(60_000)  # the machine may be busy: what is waited for comes, or the test is wrong
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
        page.goto(f"http://{HOST}:{server.port}/?fixedDpr=0.5")  # coarse pictures of constant size: software draws them
        page.get_by_role("tab", name="Study").wait_for()
        return page

    yield go
    for context in contexts:
        context.close()
    assert not errors
