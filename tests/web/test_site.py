"""The site as a reader meets it: no barriers, nothing from elsewhere, nothing too wide. `make docs` first."""

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

SITE = Path(__file__).parents[2] / "build" / "site"
PAGES = (
    "index.html", "start.html", "gallery/index.html", "gallery/sag_by_hand.html", "how-to/index.html",
    "theory/T3-leg.html", "reference/commands/run.html", "reference/python/simulation.html", 
    "reference/study-file/leg.html", "reference/variables/energies.html",
)  # fmt: skip

pytestmark = pytest.mark.skipif(not SITE.exists(), reason="there is no build/site: make docs")


@pytest.fixture(params=["light", "dark"])
def reader(request, browser):
    context = browser.new_context(viewport={"width": 390, "height": 844}, color_scheme=request.param)
    yield context.new_page()
    context.close()


@pytest.mark.parametrize("name", PAGES)
def test_a_page_has_no_barriers_and_loads_only_what_lies_beside_it(reader, name):
    asked = []
    reader.on("request", lambda request: asked.append(request.url))
    reader.goto((SITE / name).as_uri())
    found = Axe().run(reader).response["violations"]
    assert not [x["id"] for x in found if x["impact"] in ("serious", "critical")]
    assert not [url for url in asked if not url.startswith("file:") and not url.startswith("data:")]
    assert reader.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0


def test_the_search_finds_a_key_a_call_and_a_chapter(reader):
    for words, page in (("preload", "study-file"), ("workspace_map", "python"), ("foreshortening", "theory")):
        reader.goto((SITE / "search.html").as_uri() + f"?q={words}")
        reader.wait_for_selector("ul.search li a")
        reader.wait_for_timeout(300)
        assert any(page in link.get_attribute("href") for link in reader.query_selector_all("ul.search li a"))
