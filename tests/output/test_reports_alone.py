"""A page that is written asks for nothing beyond its file, whichever control is pressed, and has no barriers."""

import pytest

pytestmark = pytest.mark.web

PAGES = ("paper-robot", "paper-actuator", "replication", "verification")

# Whatever leads out of a page is noted and goes nowhere.
NOTED = """() => {
  window.asked = [];
  const note = (what) => (...given) => { window.asked.push(`${what} ${String(given[0])}`); return null; };
  window.open = note("open");
  window.fetch = note("fetch");
  window.WebSocket = window.EventSource = window.Worker = function (url) { note("socket")(url); };
  navigator.sendBeacon = note("beacon");
  XMLHttpRequest.prototype.open = note("request");
  HTMLFormElement.prototype.submit = HTMLFormElement.prototype.requestSubmit = note("form");
}"""

# Press all that can be pressed, and what appears then (a dialogue), three deep; returns what was pressed.
PRESSED = """async () => {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  const parts = () => [...document.querySelectorAll("button, a, summary, .modebar-btn, [role=button]")];
  const names = [];
  const press = async (part, depth) => {
    const before = new Set(parts());
    names.push((part.dataset.title || part.textContent || part.ariaLabel || part.className.baseVal || "").trim());
    part.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true }));
    await pause(5);
    if (depth < 3) for (const next of parts()) if (!before.has(next)) await press(next, depth + 1);
  };
  for (const part of parts()) if (part.isConnected) await press(part, 0);
  for (const choice of document.querySelectorAll("select")) {
    for (const option of choice.options) {
      choice.value = option.value;
      choice.dispatchEvent(new Event("change", { bubbles: true }));
      await pause(5);
    }
  }
  for (const bar of document.querySelectorAll("input")) bar.dispatchEvent(new Event("input", { bubbles: true }));
  for (const plot of document.querySelectorAll(".plot")) {
    for (const key of ["+", "-", "0", " ", "Home", "End", "ArrowLeft", "ArrowRight"]) {
      plot.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
    }
    const curves = [...plot.querySelectorAll(".legendtoggle, .nsewdrag, a")];
    for (const part of curves) for (const name of ["mousedown", "mouseup", "click", "dblclick"]) {
      part.dispatchEvent(new MouseEvent(name, { bubbles: true, cancelable: true }));
    }
  }
  await pause(300);
  return names;
}"""


@pytest.mark.parametrize("name", PAGES)
def test_a_page_has_no_barriers_and_asks_for_nothing_beyond_its_file(browser, reports, axe, name):
    """plotly 7.1 offered "Share chart...", which sends the chart to its makers' cloud."""
    context = browser.new_context(viewport={"width": 1100, "height": 900}, color_scheme="light")
    file, seen = reports[name].as_uri(), []
    context.route("**/*", lambda route: route.continue_() if route.request.url == file else route.abort())
    context.on("request", lambda request: seen.append(request.url))
    context.add_init_script(f"({NOTED})()")
    page = context.new_page()
    page.set_default_timeout(300_000)
    page.on("framenavigated", lambda frame: seen.append(frame.url.partition("#")[0]))
    page.goto(file)
    charts = page.locator("figure.chart")
    if name != "verification":
        page.locator("html[data-ready=yes]").wait_for(state="attached")
    for which in range(charts.count()):
        charts.nth(which).scroll_into_view_if_needed()
        charts.nth(which).locator(".main-svg").first.wait_for()
    if charts.count():
        names = "buttons => buttons.map((button) => button.dataset.title)"
        buttons = charts.first.locator(".modebar-btn").evaluate_all(names)
        assert buttons == ["Download plot as a PNG", "Zoom", "Pan", "Zoom in", "Zoom out", "Reset axes"]
        settings = "plot => [plot._context.showSendToCloud, plot._context.plotlyServerURL]"
        assert charts.first.locator(".plot").evaluate(settings) == [False, ""]
    assert axe(page) == []
    pressed = page.evaluate(PRESSED)
    assert len(pressed) >= {"verification": 1}.get(name, 20), pressed
    assert not [words for words in pressed if "hare" in words or "loud" in words]
    assert page.evaluate("window.asked") == []
    inside = ("data:", "blob:")
    assert {url for url in seen if not url.startswith(inside)} == {file}
    assert context.pages == [page]
    assert page.evaluate("[...document.querySelectorAll('a[href]')].every((a) => a.getAttribute('href')[0] === '#')")
    context.close()
