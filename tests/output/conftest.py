"""Every kind of page that is written, in a browser."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from tests.helpers.short_runs import SHORT, SPACE, study_text
from xarray import Dataset

from flexapod.analysis import modes, run
from flexapod.app.cli.commands_proof import _write
from flexapod.model import Study, loads
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
