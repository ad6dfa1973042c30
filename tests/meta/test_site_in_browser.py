"""The site as a reader meets it: no barriers, nothing from elsewhere, nothing too wide. `make docs` first."""

import os
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

SITE = Path(__file__).parents[2] / "build" / "site"
PAGES = (
    "index.html", "start.html", "gallery/index.html", "gallery/sag_by_hand.html", "how-to/index.html",
    "theory/T3-leg.html", "reference/commands/run.html", "reference/python/simulation.html", 
    "reference/study-file/leg-drive.html", "reference/variables/energies.html",
)  # fmt: skip

NEEDED = os.environ.get("FLEXAPOD_SITE") == "required"
pytestmark = [
    pytest.mark.web,
    pytest.mark.skipif(not SITE.exists() and not NEEDED, reason="there is no build/site: make docs"),
]


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


#: What somebody new wants to know, what is typed into the search, the page that answers, which links lead there from
#: the start page, and words of the answer.
TASKS = [
    ("what does my data sheet's axial rigidity mean here", "axial rigidity", "how-to/data-sheet-rigidity",
     ("How to", "axial rigidity means here"), "rigidity of the ball nut, K in N/µm at a preload"),
    ("plot drive torque against time for two payloads", "torque two payloads", "how-to/torque-of-two-payloads",
     ("How to", "Plot drive torque against time for two payloads"), "force * lead / (2 pi)"),
    ("what is a preload, and in which unit is it given", "preload nut", "reference/study-file/leg-drive",
     ("Reference", "[leg.drive]", "leg.drive.nut, preloaded"), "preload"),
    ("which call gives the stiffness matrix", "stiffness tool equilibrium", "reference/python/statics-and-modes",
     ("Reference", "Statics and modes", "fx.stiffness"), "flexapod.stiffness("),
    ("which axes and unit has tool_deviation", "tool_deviation", "reference/variables/paths-and-deviations",
     ("Reference", "Paths and deviations"), "tool_deviation"),
    ("move along a table of my own", "motion csv", "how-to/motion-from-csv",
     ("How to", "Say a motion of your own"), "csv"),
    ("was this compared with another program", "Exudyn accuracy", "accuracy",
     ("Verification and accuracy", "How accurate, how fast"), "Path of the payload against Exudyn"),
    ("first frequency over the workspace", "first frequency poses", "how-to/map-of-frequencies",
     ("How to", "Map the first frequency over poses"), "flexapod map"),
    ("my sweep was killed", "sweep killed", "sweep",
     ("How to", "Sweeps"), "killed"),
    ("where does foreshortening come from", "foreshortening", "theory/T3-leg",
     ("Theory", "T3 The sliding flexible leg", "Foreshortening and mass moments — distribution.py"),
     "An inextensible line that bends"),
    ("how do I cite it", "cite", "how-to/cite",
     ("How to", "Cite"), "CITATION.cff"),
    ("a delta robot to start from", "delta carriages", "gallery/delta",
     ("Gallery", "A linear delta"), "flexapod new --example delta"),
]  # fmt: skip


@pytest.fixture(scope="module")
def desk(browser):
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    yield context.new_page()
    context.close()


@pytest.mark.parametrize(("task", "words", "page", "links", "answer"), TASKS, ids=[task[0] for task in TASKS])
def test_the_search_leads_to_the_answer(desk, task, words, page, links, answer):
    desk.goto((SITE / "search.html").as_uri() + f"?q={words.replace(' ', '+')}")
    desk.wait_for_function("document.querySelector('.search-summary')?.textContent.match(/found|match/)")
    found = [link.get_attribute("href") for link in desk.query_selector_all("ul.search li > a")][:8]
    assert any(link.split("#")[0].split("?")[0] == f"{page}.html" for link in found), f"{task}: {found}"


@pytest.mark.parametrize(("task", "words", "page", "links", "answer"), TASKS, ids=[task[0] for task in TASKS])
def test_three_clicks_lead_to_the_answer(desk, task, words, page, links, answer):
    assert len(links) <= 3
    desk.goto((SITE / "index.html").as_uri())
    for link in links:
        desk.locator(f'a:visible:text-is("{link}"), a:visible:has-text("{link}")').first.click()
    assert desk.url.split("#")[0] == (SITE / f"{page}.html").as_uri()
    assert answer in desk.locator("article").inner_text(), task
