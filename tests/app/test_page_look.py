"""How much of the page the robot gets, measured on pictures: beside the panel, above it on a phone; the notice."""

import io

import numpy as np
import pytest
from PIL import Image
from tests.helpers.browser import difference
from tests.helpers.guests import until
from tests.helpers.samples import sample_text
from tests.helpers.short_runs import SHORT, study_text

pytestmark = pytest.mark.web

WIDE, PHONE = {"width": 1440, "height": 900}, {"width": 390, "height": 844}
STUDIES = {
    "machine-hexapod": study_text(preset="machine-hexapod"),
    "paper-robot": study_text(*SHORT),
    "hexaglide": sample_text("hexaglide"),
    "planar": sample_text("planar"),
    "paper-actuator": study_text(('duration = "10 s"', 'duration = "1 s"'), preset="paper-actuator"),
}
PANEL = "document.querySelector('[role=tablist]').closest('.mantine-Paper-root').getBoundingClientRect()"


def room(page) -> tuple[int, int, int, int]:
    """What the panel leaves of the page: left, upper, right, lower edge [px]."""
    size = page.viewport_size
    left, top, width = page.evaluate(f"(() => {{ const p = {PANEL}; return [p.left, p.top, p.width]; }})()")
    beside = width < 0.5 * size["width"]
    return (0, 0, int(left), size["height"]) if beside else (0, 0, size["width"], int(top))


def drawn(page, session) -> np.ndarray:
    """Where something is drawn in the room, once it stands still, (rows, columns); without the grid."""
    session.scene.visible("grid", False)
    left, top, right, bottom = room(page)

    def seen() -> np.ndarray:
        shot = page.screenshot(clip={"x": left, "y": top, "width": right - left, "height": bottom - top})
        return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=int)

    shots = [seen()]

    def still() -> bool:
        page.wait_for_timeout(400)
        shots.append(seen())
        return difference(shots[-1], shots[-2]) == 0 and shots[-1].min() < 200

    until(still)
    return shots[-1].min(axis=-1) < 200


def box(found: np.ndarray) -> tuple[float, float, float, float]:
    """Left, upper, right and lower edge of what is drawn, in widths and heights of the room."""
    rows, columns = np.flatnonzero(found.any(axis=1)), np.flatnonzero(found.any(axis=0))
    return (
        columns[0] / found.shape[1], rows[0] / found.shape[0], columns[-1] / found.shape[1], rows[-1] / found.shape[0]
    )  # fmt: skip


def without_notice(page) -> None:
    page.evaluate("document.getElementById('webgl-software-rendering')?.remove()")
    if page.locator(".flexapod-notice").count():
        page.get_by_role("button", name="Close").click()


@pytest.mark.parametrize("size", [WIDE, PHONE], ids=["wide", "phone"])
@pytest.mark.parametrize("name", STUDIES)
def test_the_robot_has_the_room_that_the_panel_leaves(show, name, size):
    """The machine took a third of it; on a phone the panel stood before the legs, and beams were half outside."""
    page, session = show(STUDIES[name], **size)
    until(lambda: session.data is not None and not session.busy)
    without_notice(page)
    left, top, right, bottom = box(drawn(page, session))
    # Nothing is cut: 8 % on each side are left for labels and thick legs, which take some of it.
    assert min(left, top) > 0.002 and max(right, bottom) < 0.998
    # As near as that: what is drawn reaches from margin to margin, across or upright, but for labels that are short
    # (130 px have room for them) and for the motion, which the picture holds, too.
    assert max(right - left, bottom - top) > 0.75
    if name == "machine-hexapod":
        assert (right - left) * (bottom - top) > 0.45


def test_a_camera_that_was_moved_stays_until_it_is_called_back(show):
    """Another size of the window, as a phone that is turned, fits the robot anew only where nobody moved the camera."""
    page, session = show(study_text(*SHORT), **WIDE)
    until(lambda: session.data is not None and not session.busy)
    without_notice(page)

    def camera():
        found = session.client.camera
        return np.concatenate([found.position, found.look_at])

    def comes(other) -> np.ndarray:
        until(lambda: not np.allclose(camera(), other, atol=1e-3))
        page.wait_for_timeout(500)
        return camera()

    drawn(page, session)
    first = camera()
    page.set_viewport_size(PHONE)
    phone = comes(first)
    assert np.linalg.norm(phone[:3] - phone[3:]) > np.linalg.norm(first[:3] - first[3:])  # from farther away
    page.locator("canvas[data-engine]").click(position={"x": 20, "y": 40})
    page.keyboard.press("s", delay=300)
    moved = comes(phone)
    page.set_viewport_size(WIDE)
    page.wait_for_timeout(500)
    assert camera() == pytest.approx(moved, abs=1e-6)
    page.get_by_role("button", name="Reset view").click()
    assert comes(moved) == pytest.approx(first, abs=1e-3)


def at_the_foot(page, place) -> bool:
    _, _, right, foot = room(page)
    return foot - 60 < place["y"] < place["y"] + place["height"] <= foot and place["x"] + place["width"] <= right


def test_the_notice_of_software_rendering_is_small_at_the_foot_and_comes_once(desk):
    """It covered a quarter of the picture, on a phone the robot, at every visit until somebody closed it."""
    _, visit, errors = desk
    errors.clear()
    page = visit()
    notice = page.locator(".flexapod-notice")
    notice.wait_for()
    assert "without a graphics card" in notice.inner_text()
    for size in (WIDE, PHONE):
        page.set_viewport_size(size)
        until(lambda: at_the_foot(page, notice.bounding_box()))  # once the panel has its place
        place = notice.bounding_box()
        assert place["width"] * place["height"] < 0.03 * size["width"] * size["height"]
    theirs = page.locator("#webgl-software-rendering")
    assert theirs.count() == 1 and not theirs.is_visible()  # this is such a browser, and viser says so at length
    notice.get_by_role("button", name="Close").click()
    assert not notice.count()
    again = page.context.new_page()
    again.goto(page.url)
    again.get_by_role("tab", name="Study").wait_for()
    again.wait_for_function("window.flexapodPicture")
    assert not again.locator(".flexapod-notice").count()
    page.context.close()
    assert not errors


def test_the_long_notice_is_hidden_before_any_script_runs(desk):
    """Packed for those who take it packed, and not."""
    import gzip
    import urllib.request

    for packed in ("gzip", "identity"):
        request = urllib.request.Request(f"http://127.0.0.1:{desk[0].port}/", headers={"Accept-Encoding": packed})
        with urllib.request.urlopen(request, timeout=300) as answer:
            assert answer.headers["Content-Encoding"] == packed
            body = answer.read()
            assert int(answer.headers["Content-Length"]) == len(body)
        text = gzip.decompress(body) if packed == "gzip" else body
        style = text.index(b"#webgl-software-rendering { display: none; }")
        assert text.index(b"<head>") < style < text.index(b"</head>")
