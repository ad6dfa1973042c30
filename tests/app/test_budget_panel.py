"""The tab of the error budget as HTML: sentences, a bar for each part, the table."""

import pytest

from flexapod import model
from flexapod.analysis.error_budget.text import Bar
from flexapod.app.browser.budget_panel import budget_html, chart_html
from flexapod.output.scene.style import ERRORS

pytestmark = pytest.mark.unit


def test_bars_are_as_long_as_the_errors_and_names_are_not_live():
    rows = [
        Bar("<b>", 0, {"repeatable": 3e-6, "random": 1e-6}, 0.8),
        Bar("small", 1, {"repeatable": 1e-6}, 0.2),
    ]
    html = chart_html(rows)
    assert "&lt;b&gt;" in html
    assert [html.count(f"width:{share:.2f}%") for share in (45.0, 15.0)] == [1, 2]
    assert html.count(f"background:{ERRORS['random'][1]}") == 2  # the bar, the legend
    assert "4 µm, 80 %" in html
    assert not chart_html([])


def test_a_study_at_home_and_an_actuator():
    html = budget_html(model.preset("machine-hexapod"))
    assert "The largest culprit" in html and "at home; world axes" in html
    assert "root of the sum of squares" in html
    assert "those of robots" in budget_html(model.preset("paper-actuator"))
