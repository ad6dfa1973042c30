"""A real browser; skipped where there is no Chromium, unless FLEXAPOD_BROWSER=required."""

import os
import shutil
from collections.abc import Callable, Iterator

import numpy as np
import pytest

# Where software stands in for a graphics card it draws what WebGL asks for, not the rest of a page as well: that took
# 2.9 s of the processor to load the page of a robot, not 1.3, and 0.26 s a second as long as it was open, not 0.05.
ARGUMENTS = [
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",
]  # fmt: skip


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


def difference(one, other) -> int:
    """Number of pixels that differ visibly."""
    return int((np.abs(one - other).max(axis=-1) > 24).sum())
