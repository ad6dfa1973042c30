"""A real browser for the page and for reports; skipped where there is no Chromium, unless FLEXAPOD_BROWSER=required."""

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from tests.texts import replaced
from tests.web.guests import until
from xarray import Dataset

from flexapod.analysis import modes, run
from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource, open_source
from flexapod.app.browser.network import free_port
from flexapod.app.browser.server import GONE, View
from flexapod.app.browser.session import Session
from flexapod.app.cli.commands_proof import _write
from flexapod.model import Study, loads, preset_text
from flexapod.output.report.figures import draw_figures
from flexapod.output.report.report import robot_report
from flexapod.verification.pack import verify
from flexapod.verification.paper.claim import (
    BREAKS,
    DONE,
    HOLDS,
    IN_PART,
    INCOMPLETE,
    MISPRINT,
    MISSES,
    NEXT,
    NOT,
    OPEN,
    OWN,
    REACHES,
    USELESS,
    VARIANT,
    Claim,
)
from flexapod.verification.paper.report import paper_page
from flexapod.verification.paper.study import PaperStudy

HOST = "127.0.0.1"
# Where software stands in for a graphics card it draws what WebGL asks for, not the rest of a page as well: that took
# 2.9 s of the processor to load the page of a robot, not 1.3, and 0.26 s a second as long as it was open, not 0.05.
ARGUMENTS = [
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",
]  # fmt: skip

#: A motion of 0.2 s: computed in a moment.
SHORT = (
    ('duration = "1 s" ', 'duration = "0.15 s" '),
    ('hold = "1 s" ', 'hold = "0.05 s" '),
    ('duration = "2 s" ', 'duration = "0.2 s" '),
    ('amplitude = "26.6 deg"', 'amplitude = "2 deg"'),
)

#: A motion that is computed for minutes, unless somebody cancels it.
LONG = (
    ('duration = "2 s" ', 'duration = "1000 s" '),
    ("tolerance = 1e-4", 'step = "0.5 ms"\noutput_step = "10 ms"'),
    ('hold = "1 s" ', 'hold = "999 s" '),
)

#: An actuator in space, for a second.
SPACE = (Path(__file__).parents[2] / "examples" / "actuator-in-space.toml").read_text(encoding="utf-8")
SPACE = SPACE.replace('duration = "2.5 s"', 'duration = "1 s"\ntolerance = 1e-2')


def study_text(*changes: tuple[str, str], preset: str = "paper-robot") -> str:
    """The text of a preset with pieces replaced."""
    return replaced(preset_text(preset), *changes)


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


@pytest.fixture(scope="session")
def axe() -> Callable[[object], list[str]]:
    """`axe(page)`: what axe-core finds on a page that is critical or serious."""
    try:
        from axe_playwright_python.sync_playwright import Axe
    except ImportError:
        if os.environ.get("FLEXAPOD_BROWSER") == "required":
            raise
        pytest.skip("axe-playwright-python is not installed")

    def findings(page: object) -> list[str]:
        found = Axe().run(page).response["violations"]
        return [
            f"{finding['impact']}: {finding['help']}: {part['html']}"
            for finding in found
            if finding["impact"] in ("critical", "serious")
            for part in finding["nodes"]
        ]

    return findings


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


class Reports(dict):
    """Files of every kind of page that is written, each when it is asked for: of runs, replication, verification."""

    def __init__(self, place: Path) -> None:
        super().__init__()
        self.place = place

    def __missing__(self, name: str) -> Path:
        file = self.place / f"{name}.html"
        if name == "verification":
            (done,) = verify(["cubic-hexapod"])
            absent = replace(done, checks=(), not_run="Nastran is not installed: buy it")
            _write([done, absent], file, None)
        elif name == "replication":
            file.write_text(self._replication(), encoding="utf-8")
        else:
            file.write_text(robot_report(*result(name)), encoding="utf-8")
        self[name] = file
        return file

    def _replication(self) -> str:
        """The page of `flexapod replicate` with short runs in place of the paper's, and a claim of every verdict."""
        (study, robot), (_, actuator) = result("paper-robot"), result("paper-actuator")
        parts = {name: robot for name in ("robot", "robot-rigid", "jump")}
        parts |= {"actuator-3": actuator, "modes": modes(study)}
        verdicts = {
            HOLDS: OWN,
            IN_PART: OWN,
            NOT: OWN,
            OPEN: OWN,
            MISPRINT: OWN,
            INCOMPLETE: OWN,
            DONE: NEXT,
            USELESS: NEXT,
        }
        verdicts |= {REACHES: VARIANT, MISSES: VARIANT, BREAKS: VARIANT}
        claims = [
            Claim(whose=whose, where="Fig. 9", says="5 mm", ours="3 µm", verdict=v, reason="Legs are stiff.")
            for v, whose in verdicts.items()
        ]
        return paper_page(
            PaperStudy(parts=parts), claims, {"Robot": draw_figures(robot, self.place / "figures", ("png",))}
        )


@cache
def result(name: str) -> tuple[Study, Dataset]:
    """A short run of a preset or of the actuator in space."""
    texts = {
        "paper-robot": study_text(*SHORT),
        "paper-actuator": study_text(('duration = "10 s"', 'duration = "1 s"'), preset="paper-actuator"),
        "actuator-in-space": SPACE,
    }
    study = loads(texts[name])
    return study, run(study)


@pytest.fixture(scope="session")
def reports(tmp_path_factory) -> Reports:
    return Reports(tmp_path_factory.mktemp("reports"))


@pytest.fixture(scope="module")
def windows(browser) -> Iterator[dict[str, object]]:
    """Windows by their settings, from test to test: a new one takes twice as long to show a report."""
    found: dict[str, object] = {}
    yield found
    for page in found.values():
        page.context.close()


@pytest.fixture
def read(browser, windows, reports) -> Iterator[Callable[..., object]]:
    """`read(preset)`: the report in a window of its own; fails on an error in it, or if it asks for anything."""
    pages, errors, asked = [], [], []
    heard = {
        "pageerror": lambda error: errors.append(str(error)),
        "console": lambda said: errors.append(said.text) if said.type == "error" else None,
        "request": lambda request: asked.append(request.url),
    }

    def go(preset: str = "paper-robot", **settings: object) -> object:
        settings = {"viewport": {"width": 1100, "height": 900}} | settings
        page = windows.get(repr(settings)) or browser.new_context(**settings).new_page()
        windows[repr(settings)] = page
        page.emulate_media(media="screen")
        page.mouse.move(0, 0)
        page.set_default_timeout(300_000)  # the machine may be busy: what is waited for comes, or the test is wrong
        for event, hear in heard.items():
            page.on(event, hear)
        pages.append(page)
        page.goto(reports[preset].as_uri())
        if settings.get("java_script_enabled", True):
            page.locator("html[data-ready=yes]").wait_for(state="attached")
        return page

    yield go
    for page in pages:
        for event, hear in heard.items():
            page.remove_listener(event, hear)
        page.goto("about:blank")  # what is open draws
    assert not errors
    outside = [url for url in asked if not url.startswith(("data:", "blob:"))]
    assert all(url.endswith(".html") for url in outside) and len(outside) == len(pages)
