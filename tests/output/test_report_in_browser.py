"""The report as it is mailed: one file opened from disk, without a server and without a network."""

import base64
import hashlib
import json
import re
from time import monotonic, sleep

import numpy as np
import pytest

pytestmark = pytest.mark.web

REPLAY = "figure.replay"
# Contrast of every piece of text that is seen with what is behind it, by the formula of WCAG 2.2.
CONTRASTS = """() => {
  const parse = (color) => {
    const [r, g, b, a = 1] = color.match(/[\\d.]+/g).map(Number);
    return [r, g, b, a];
  };
  const luminance = (color) => {
    const linear = color.slice(0, 3).map((v) => (v <= 10.31 ? v / 3294.6 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  };
  const behind = (part) => {
    for (; part; part = part.parentElement) {
      const color = parse(getComputedStyle(part).backgroundColor);
      if (color[3] === 1) return color;
    }
    return [255, 255, 255, 1];
  };
  const seen = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const part = node.parentElement, style = getComputedStyle(part), box = part.getBoundingClientRect();
    if (!node.data.trim() || /^(script|style|option)$/i.test(part.tagName) || !box.width) continue;
    if (style.visibility === "hidden") continue;
    const back = behind(part), front = parse(part instanceof SVGElement ? style.fill : style.color);
    const share = front[3] * style.opacity * (part instanceof SVGElement ? style.fillOpacity : 1);
    const mixed = front.map((v, i) => share * v + (1 - share) * back[i]);
    const [low, high] = [luminance(mixed), luminance(back)].sort((a, b) => a - b);
    seen.push([(high + 0.05) / (low + 0.05), node.data.trim()]);
  }
  return seen;
}"""
NAMELESS = """() => [...document.querySelectorAll("a, button, input, select, img, [tabindex]")]
  .filter((part) => part.getClientRects().length)
  .filter((part) => !(part.ariaLabel || part.alt || part.textContent.trim() || part.labels?.length))
  .map((part) => part.outerHTML.slice(0, 200))"""


def chart(page, which=0):
    """A figure that zooms, in the window and drawn."""
    figure = page.locator("figure.chart").nth(which)
    figure.scroll_into_view_if_needed()
    figure.locator(".main-svg").first.wait_for()
    return figure


def limits(figure, axis="xaxis"):
    return figure.locator(".plot").evaluate(f"plot => plot._fullLayout.{axis}.range.map(Number)")


def look(page):
    """A fingerprint of the replay's picture, without the ring of the keyboard's place."""
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(300)
    return hashlib.sha256(page.locator(f"{REPLAY} .plot").screenshot()).hexdigest()


def part(page, name):
    return page.locator(f"{REPLAY} [data-part={name}]")


def scrub(page, frame):
    part(page, "scrub").evaluate(f"bar => {{ bar.value = {frame}; bar.dispatchEvent(new Event('input')); }}")


def stored(page):
    """What the page holds of its replay, and the points of its frames."""
    told = json.loads(page.locator(f"{REPLAY} script").text_content())
    shape = [int(size) for size in told["points"]["shape"].split(",")]
    return told, np.frombuffer(base64.b64decode(told["points"]["bdata"]), dtype="<f4").reshape(shape)


def wait_for_readout(page, words):
    part(page, "readout").filter(has_text=words).wait_for()


def wait_until(true):
    """Ask until it is so: the page's policy forbids what the browser's own waiting would evaluate in it."""
    end = monotonic() + 300
    while not true():
        assert monotonic() < end
        sleep(0.05)


def test_answer_first_and_all_sections(read):
    page = read()
    assert "misses its rigid path by up to" in page.locator("h1").inner_text()
    assert page.locator("h2").first.inner_text() == "Deviation by axis"
    assert page.locator("nav a").count() == page.locator("section").count()
    assert page.locator("img").count() == page.locator("figure").count()


def test_a_figure_is_zoomed_by_dragging_and_shown_whole_again(read):
    page = read()
    figure = chart(page)
    before = limits(figure)
    box = figure.locator(".draglayer .xy .nsewdrag").bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 0.4 * box["width"], y, steps=5)
    page.mouse.up()
    low, high = limits(figure)
    # Where the mouse was, to a few pixels of a panel that is some 200 wide.
    assert low - before[0] == pytest.approx(0.3 * (before[1] - before[0]), abs=0.03 * (before[1] - before[0]))
    assert high - before[0] == pytest.approx(0.7 * (before[1] - before[0]), abs=0.03 * (before[1] - before[0]))
    assert limits(figure, "xaxis2") == [low, high]  # the panels share time
    page.mouse.dblclick(x, y)
    wait_until(lambda: limits(figure) == before)
    assert limits(figure) == before


def test_a_figure_answers_the_keyboard(read):
    page = read()
    figure = chart(page)
    before = limits(figure)
    figure.locator(".plot").focus()
    page.keyboard.press("+")
    width = before[1] - before[0]
    assert limits(figure) == [pytest.approx(before[0] + 0.1 * width), pytest.approx(before[0] + 0.9 * width)]
    page.keyboard.press("ArrowRight")
    assert limits(figure)[0] == pytest.approx(before[0] + 0.18 * width)
    page.keyboard.press("0")
    assert limits(figure) == before
    buttons = figure.locator(".modebar-btn")
    assert all(buttons.nth(i).get_attribute("tabindex") == "0" for i in range(buttons.count()))


def test_the_replay_plays_and_is_scrubbed(read):
    page = read()
    page.locator(REPLAY).scroll_into_view_if_needed()
    start = look(page)
    assert part(page, "readout").inner_text().startswith("t = 0.000 s")
    part(page, "speed").select_option("0.1")
    part(page, "play").click()
    wait_until(lambda: not part(page, "readout").inner_text().startswith("t = 0.000"))
    wait_for_readout(page, "t = 0.200 s")  # it stops by itself at the end
    assert part(page, "play").inner_text() == "Play"
    end = look(page)
    assert end != start
    scrub(page, 100)  # of 201 instants
    wait_for_readout(page, "t = 0.100 s")
    assert look(page) not in (start, end)
    page.locator(f"{REPLAY} .plot").focus()
    page.keyboard.press("Home")
    wait_for_readout(page, "t = 0.000 s")
    assert look(page) == start
    part(page, "choice").select_option(label=part(page, "choice").locator("option").nth(1).inner_text())
    wait_for_readout(page, "Mode 1")
    assert look(page) != start


def test_buttons_of_the_replay_stand_clear_of_its_legend(read):
    page = read()
    page.locator(f"{REPLAY} .modebar-btn").first.wait_for()
    buttons = [b.bounding_box() for b in page.locator(f"{REPLAY} .modebar-btn").all()]
    names = [t.bounding_box() for t in page.locator(f"{REPLAY} .legendtext").all()]
    assert len(names) > 3
    assert max(b["y"] + b["height"] for b in buttons) <= min(t["y"] for t in names)


def test_the_keys_reach_every_control_in_order(read):
    page = read()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "theme"
    page.locator(f"{REPLAY} .plot").focus()
    page.keyboard.press(" ")
    wait_until(lambda: not part(page, "readout").inner_text().startswith("t = 0.000"))
    part(page, "play").focus()
    seen = []
    for _ in range(3):
        page.keyboard.press("Tab")
        seen.append(page.evaluate("document.activeElement.dataset.part"))
    assert seen == ["scrub", "speed", "choice"]
    assert part(page, "scrub").get_attribute("aria-label") == "Time"


def test_light_and_dark(read):
    def paper(page):
        return page.evaluate("getComputedStyle(document.body).backgroundColor")

    page = read(color_scheme="dark")
    figure = chart(page)
    assert paper(page) == "rgb(22, 25, 29)"
    dark = figure.locator(".plot").evaluate("plot => [plot._fullLayout.paper_bgcolor, plot._fullData[1].line.color]")
    page.locator("#theme").click()
    assert paper(page) == "rgb(255, 255, 255)"
    wait_until(lambda: figure.locator(".plot").evaluate("plot => plot._fullLayout.paper_bgcolor") == "#ffffff")
    light = figure.locator(".plot").evaluate("plot => [plot._fullLayout.paper_bgcolor, plot._fullData[1].line.color]")
    assert dark[0] == "#16191d" and light[1] == "#0b3c5d" and dark[1] != light[1]


def test_on_paper_figures_are_pictures(read):
    page = read(color_scheme="dark")
    figure = chart(page)
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert figure.locator("img").is_visible() and not figure.locator(".plot").is_visible()
    assert not page.locator("#theme").is_visible() and not part(page, "play").is_visible()
    assert page.locator(f"{REPLAY} img").is_visible()
    assert page.pdf(format="A4").startswith(b"%PDF")


@pytest.mark.parametrize("preset", ["paper-robot", "paper-actuator"])
def test_on_paper_the_replay_is_a_picture_and_figures_go_two_a_page(read, preset):
    page = read(preset, viewport={"width": 680, "height": 1000})  # A4 between its margins: 180 mm
    page.emulate_media(media="print")
    assert page.locator(f"{REPLAY} img").is_visible() and page.locator(f"{REPLAY} .still").is_visible()
    assert not page.locator(f"{REPLAY} .moving").is_visible() and not page.locator("nav").is_visible()
    heights = page.evaluate("[...document.querySelectorAll('figure:not(.tall) img')].map((p) => p.clientHeight)")
    assert len(heights) >= 3 and max(heights) <= 108 * 96 / 25.4 + 1  # of 269 mm
    assert page.evaluate("document.documentElement.scrollWidth") <= 680


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("preset", ["paper-robot", "paper-actuator", "replication"])
def test_words_have_contrast_and_controls_have_names(read, preset, scheme):
    """WCAG 2.2: contrast of 4.5 to 1 (1.4.3), names of controls and pictures (4.1.2), links that lead somewhere."""
    page = read(preset, color_scheme=scheme)
    for which in range(page.locator("figure.chart").count()):
        chart(page, which)
    assert page.evaluate("document.documentElement.lang") == "en"
    seen = page.evaluate(CONTRASTS)
    assert len(seen) > 100
    assert [words for ratio, words in seen if ratio < 4.5] == []
    assert page.evaluate(NAMELESS) == []
    assert page.evaluate(
        "[...document.querySelectorAll('nav a')].every((a) => document.getElementById(a.hash.slice(1)))"
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_focus_is_seen_wherever_the_keys_lead(read, scheme):
    """Tab goes from top to bottom, and what has the focus has a ring (WCAG 2.2: 2.4.3, 2.4.7)."""
    page = read(color_scheme=scheme)
    chart(page)
    page.evaluate("window.scrollTo(0, 0)")
    page.locator("#theme").focus()
    tops, rings = [], set()
    for _ in range(32):
        page.keyboard.press("Tab")
        top, ring = page.evaluate(
            "(() => { const at = document.activeElement, style = getComputedStyle(at);"
            " return [Math.round(at.closest('nav, figure').getBoundingClientRect().top + scrollY),"
            " `${style.outlineStyle} ${style.outlineWidth} ${style.outlineColor}`]; })()"
        )
        tops.append(top)
        rings.add(ring)
    assert tops == sorted(tops) and len(set(tops)) >= 3  # links, replay, a figure
    color = {"light": "rgb(11, 92, 148)", "dark": "rgb(124, 192, 238)"}[scheme]
    assert rings == {f"solid 3px {color}"}


def test_without_scripts_the_pictures_are_there(read):
    page = read(java_script_enabled=False)
    assert page.locator("figure img").first.is_visible()
    assert not page.locator(".controls").is_visible()


def test_on_a_phone_figures_stay_pictures_and_nothing_runs_over(read):
    page = read(viewport={"width": 390, "height": 800})
    figure = page.locator("figure.chart").first
    figure.scroll_into_view_if_needed()
    assert figure.locator("img").is_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_the_actuator_is_replayed_in_its_plane(read):
    page = read("paper-actuator")
    page.locator(REPLAY).scroll_into_view_if_needed()
    start = look(page)
    scrub(page, 120)  # of 241 instants
    wait_for_readout(page, "t = 0.500 s")
    assert look(page) != start
    assert not part(page, "choice").is_visible()


def test_an_actuator_in_space_is_replayed_in_space(read):
    page = read("actuator-in-space")
    told, points = stored(page)
    assert points.shape[2] == 3
    page.locator(REPLAY).scroll_into_view_if_needed()
    assert page.locator(f"{REPLAY} .plot").evaluate("plot => plot.data[1].type") == "scatter3d"
    (tip,) = (i for i, trace in enumerate(told["traces"]) if trace["name"] == "tip")
    path = points[:, told["traces"][tip]["take"][0]]
    assert (np.ptp(path, axis=0) > 100).all()  # mm: it slews and rises


def test_the_number_is_of_the_instant_that_is_drawn(read):
    """Frames of a run of 10 s are 42 ms apart: a picture between two of them has a number that nobody computed."""
    page = read("paper-actuator")
    told, points = stored(page)
    page.locator(REPLAY).scroll_into_view_if_needed()
    part(page, "speed").select_option("0.1")
    part(page, "play").click()
    wait_until(lambda: not part(page, "readout").inner_text().startswith("t = 0.000"))
    part(page, "play").click()
    wait_until(lambda: part(page, "play").inner_text() == "Play")
    page.wait_for_timeout(500)  # what was asked for last is drawn
    time, shown = re.match(r"t = ([\d.]+) s: .* tip (\S+) ", part(page, "readout").inner_text()).groups()
    # The run has 1001 instants, of which every fourth or fifth is a frame; three places tell them apart.
    (frame,) = (i for i, instant in enumerate(told["time"]) if f"{instant:.3f}" == time)
    assert 0 < frame < len(told["time"]) - 1
    assert float(shown.replace("\N{MINUS SIGN}", "-")) == told["values"][frame][0]
    (tip,) = (i for i, trace in enumerate(told["traces"]) if trace["name"] == "tip")
    drawn = page.locator(f"{REPLAY} .plot").evaluate(f"plot => [plot.data[{tip}].x[0], plot.data[{tip}].y[0]]")
    assert drawn == pytest.approx(points[frame, told["traces"][tip]["take"][0]].tolist())
    assert int(part(page, "scrub").input_value()) == frame


def test_the_beam_fills_its_axes(read):
    """In equal scales, in the limits of what moves: axes as wide as the page would make it a speck."""
    page = read("paper-actuator")
    page.locator(f"{REPLAY} .main-svg").first.wait_for()
    told, _ = stored(page)
    (low, high), (bottom, top) = (told["layout"][name]["range"] for name in ("xaxis", "yaxis"))
    for name, ends in (("xaxis", (low, high)), ("yaxis", (bottom, top))):
        assert limits(page.locator(REPLAY), name) == pytest.approx(ends, abs=0.02 * (high - low))
    across, up = page.locator(f"{REPLAY} .plot").evaluate(
        "plot => [plot._fullLayout.xaxis._length, plot._fullLayout.yaxis._length]"
    )
    assert across / (high - low) == pytest.approx(up / (top - bottom), rel=0.02)
    assert max(across, up) > 500  # pixels of a page of 1100
