"""The tab of the error budget in a real browser: of a robot's result, of its study after a change, of none."""

import pytest
from tests.helpers.guests import until
from tests.helpers.short_runs import SHORT, study_text

pytestmark = pytest.mark.web

HEXAPOD = study_text(
    ('duration = "0.6 s" ', 'duration = "0.1 s" '),
    ('hold = "0.6 s" ', 'hold = "0.05 s" '),
    ('surge = "80 mm", pitch = "6 deg"', 'surge = "2 mm", pitch = "0.2 deg"'),
    preset="machine-hexapod",
)


def test_the_budget_of_a_result_and_of_a_change(show):
    page, session = show(HEXAPOD)
    until(lambda: session.data is not None and not session.busy)
    page.get_by_role("tab", name="Budget").click()
    page.get_by_text("the largest deviation; world axes").wait_for()
    first = session.budget_panel._html.content
    assert "The largest culprit" in first and "Pose accuracy" in first
    bars = page.locator(".flexapod-bar")
    assert bars.count() >= 8 and all(bar.is_visible() for bar in bars.all())
    panel = page.locator("table", has_text="root of the sum of squares")
    assert "base joints" in panel.inner_text() and "heat" in panel.inner_text()
    # without heat its rows go
    text = HEXAPOD[: HEXAPOD.index("[heat]")] + HEXAPOD[HEXAPOD.index("[tolerances]") :]
    _, session = show(text)
    until(lambda: "largest deviation" in session.budget_panel._html.content)
    assert "heat" not in session.budget_panel._html.content


def test_an_actuator_has_none(show):
    page, session = show(study_text(preset="paper-actuator"))
    until(lambda: "single actuator" in session.budget_panel._html.content)
    page.get_by_role("tab", name="Budget").click()
    page.get_by_text("Error budgets are those of robots").wait_for()


def test_a_robot_of_ideal_parts_has_that_of_its_pistons(show):
    _, session = show(study_text(*SHORT))
    until(lambda: "at home" in session.budget_panel._html.content and session.data is not None)
    assert "stretch" in session.budget_panel._html.content
