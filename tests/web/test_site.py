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


#: What somebody new wants to know, what is typed into the search, and the page that answers.
TASKS = [
    ("what does my data sheet's axial rigidity mean here", "axial rigidity", "how-to/data-sheet-rigidity"),
    ("plot drive torque against time for two payloads", "torque two payloads", "how-to/torque-of-two-payloads"),
    ("what is a preload, and in which unit is it given", "preload nut", "reference/study-file/leg"),
    ("which call gives the stiffness matrix", "stiffness tool equilibrium", "reference/python/statics-and-modes"),
    ("which axes and unit has tool_deviation", "tool_deviation", "reference/variables/paths-and-deviations"),
    ("move along a table of my own", "motion csv", "how-to/motion-from-csv"),
    ("was this compared with another program", "Exudyn accuracy", "accuracy"),
    ("first frequency over the workspace", "first frequency poses", "how-to/map-of-frequencies"),
    ("my sweep was killed", "sweep killed", "sweep"),
    ("where does foreshortening come from", "foreshortening", "theory/T3-leg"),
    ("how do I cite it", "cite", "how-to/cite"),
    ("a delta robot to start from", "delta carriages", "gallery/delta"),
]


@pytest.mark.parametrize(("task", "words", "page"), TASKS, ids=[task[0] for task in TASKS])
def test_the_search_leads_to_the_answer(reader, task, words, page):
    reader.goto((SITE / "search.html").as_uri() + f"?q={words.replace(' ', '+')}")
    reader.wait_for_function("document.querySelector('.search-summary')?.textContent.match(/found|match/)")
    links = [link.get_attribute("href") for link in reader.query_selector_all("ul.search li > a")][:8]
    assert any(link.split("#")[0].split("?")[0] == f"{page}.html" for link in links), f"{task}: {links}"
